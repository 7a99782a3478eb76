#include "hil/can_table.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/message_fields.hpp"

namespace steadyboom::hil {

namespace {

using drivers::Device;
using drivers::DeviceTable;
using drivers::MessageKind;
using drivers::MessageRow;

constexpr double ms_per_ns = 1.0e-6;

/// Rows of cells, each column as wide as its widest cell; numbers to the right.
class TextTable {
  public:
    TextTable(std::initializer_list<std::string_view> heads, std::string_view to_the_right)
        : to_the_right_(to_the_right) {
        add(std::vector<std::string>(heads.begin(), heads.end()));
    }
    void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

    [[nodiscard]] std::string text() const {
        std::string text;
        for (const auto& row : rows_) {
            std::string line;
            for (std::size_t i = 0; i < row.size(); ++i) {
                std::size_t width = 0;
                for (const auto& other : rows_) {
                    width = std::max(width, other[i].size());
                }
                line += fmt::format(fmt::runtime(to_the_right_[i] == '>' ? "{:>{}}  " : "{:<{}}  "), row[i], width);
            }
            line.erase(line.find_last_not_of(' ') + 1);
            text += line + '\n';
        }
        return text;
    }

  private:
    std::string_view to_the_right_;  ///< one '<' or '>' for each column
    std::vector<std::vector<std::string>> rows_;
};

std::string hex_id(const MessageRow& row) {
    return fmt::format(fmt::runtime(row.extended ? "{:08X}" : "{:03X}"), row.id);
}

std::string cycle_text(const DeviceTable& table, const MessageRow& row) {
    const double period_ms = ms_per_ns * static_cast<double>(table.config().period_ns);
    switch (row.cycle) {
        case drivers::Cycle::every_tick:
            return fmt::format("{} ms", period_ms);
        case drivers::Cycle::on_sync:
            return fmt::format("{} ms, on SYNC", period_ms);
        case drivers::Cycle::timer:
            return fmt::format("{} ms", ms_per_ns * static_cast<double>(row.interval_ns));
        case drivers::Cycle::on_demand:
            break;
    }
    return "on demand";
}

double cycle_ms(const DeviceTable& table, const MessageRow& row) {
    switch (row.cycle) {
        case drivers::Cycle::every_tick:
        case drivers::Cycle::on_sync:
            return ms_per_ns * static_cast<double>(table.config().period_ns);
        case drivers::Cycle::timer:
            return ms_per_ns * static_cast<double>(row.interval_ns);
        case drivers::Cycle::on_demand:
            break;
    }
    return 0.0;
}

/// Share of the bus that this message takes in the worst case.
double worst_case_share(const DeviceTable& table, const MessageRow& row) {
    const double cycle = cycle_ms(table, row);
    return cycle == 0.0 ? 0.0
                        : drivers::worst_case_frame_bits(row.length_bytes, row.extended) / (1.0e-3 * cycle) /
                              table.config().bit_rate_bit_s;
}

std::string_view name_of_protection(drivers::Protection protection) noexcept {
    return protection == drivers::Protection::e2e ? "e2e" : "none";
}

std::string heartbeat_text(const drivers::DeviceConfig& config) {
    if (config.heartbeat_ms == 0) {
        return "none";
    }
    return config.heartbeat_timeout_ms > 0
               ? fmt::format("{} ms, lost after {} ms", config.heartbeat_ms, config.heartbeat_timeout_ms)
               : fmt::format("{} ms", config.heartbeat_ms);
}

std::string identity_text(const drivers::DeviceConfig& config) {
    std::string text;
    const auto append = [&text](std::string_view object, std::uint32_t value) {
        if (value != 0) {
            text += fmt::format("{}{} {:#x}", text.empty() ? "" : ", ", object, value);
        }
    };
    append("1000h", config.device_type);
    append("vendor", config.vendor_id);
    append("product", config.product_code);
    return text.empty() ? "not asked" : text;
}

std::string position_text(const MessageField& field) {
    const std::string bits = field.size_bits == 1 ? "1 bit" : fmt::format("{} bits", field.size_bits);
    return fmt::format("byte {}.{}, {}{}", field.start_bit / 8U, field.start_bit % 8U, bits,
                       field.big_endian ? ", big-endian" : "");
}

std::string scale_text(const MessageField& field) {
    if (field.offset == 0.0) {
        return fmt::format("{:.7g}", field.scale);
    }
    return fmt::format("{:.7g} {} {:.7g}", field.scale, field.offset < 0.0 ? '-' : '+',
                       field.offset < 0.0 ? -field.offset : field.offset);
}

bool is_service(MessageKind kind) noexcept {
    return kind == MessageKind::emergency || kind == MessageKind::sdo_request || kind == MessageKind::sdo_answer;
}

}  // namespace

std::string can_table_text(const DeviceTable& table) {
    const auto& config = table.config();
    const auto load = drivers::bus_load(table);
    const double period_ms = ms_per_ns * static_cast<double>(config.period_ns);
    std::string text = fmt::format(
        "CANopen, {} kbit/s, one tick {} ms ({} Hz), spool travel {} mm\n"
        "bus load {:.1f} % without stuff bits, {:.1f} % at worst, of {:.0f} % allowed\n\n",
        config.bit_rate_bit_s / 1000U, period_ms, 1.0e3 / period_ms, 1.0e3 * config.spool_travel_m,
        100.0 * load.nominal_share, 100.0 * load.worst_case_share, 100.0 * drivers::largest_bus_load_share);

    TextTable devices({"node", "device", "profile", "protection", "required", "set by SDO", "heartbeat", "identity"},
                      "><<<<<<<");
    for (std::size_t i = 0; i < drivers::device_count; ++i) {
        const auto device = static_cast<Device>(i);
        const auto& d = config[device];
        const bool ours = device == Device::controller;
        devices.add({fmt::format("{:#04x}", d.node_id), std::string(name_of(device)),
                     std::string(profile_of(config, device)), ours ? "" : std::string(name_of_protection(d.protection)),
                     ours         ? ""
                     : d.required ? "yes"
                                  : "no",
                     ours          ? ""
                     : d.configure ? "yes"
                                   : "no",
                     heartbeat_text(d), ours ? "" : identity_text(d)});
    }
    text += devices.text() + '\n';

    TextTable messages({"id", "message", "content", "from", "bytes", "cycle", "load", "data id"}, "><<<><><");
    TextTable fields({"message", "field", "place", "type", "scale", "range", "unit", "at most a second"}, "<<<<><<>");
    for (const auto& row : table.messages()) {
        if (!row.present || is_service(row.kind)) {
            continue;
        }
        const double share = worst_case_share(table, row);
        messages.add({hex_id(row), row.name, row.kind == MessageKind::pdo ? std::string(name_of(row.pdo)) : "",
                      std::string(name_of(row.from_controller ? Device::controller : row.device)),
                      std::to_string(row.length_bytes), cycle_text(table, row),
                      share > 0.0 ? fmt::format("{:.2f} %", 100.0 * share) : "",
                      row.protection == drivers::Protection::e2e ? fmt::format("{:#06x}", row.data_id) : ""});
        if (row.kind != MessageKind::pdo) {
            continue;
        }
        for (const auto& field : fields_of(table, row.message)) {
            const double fastest = field.signal == drivers::Signal::none ? 0.0 : config[field.signal].fastest_1_s;
            fields.add({row.name, field.name, position_text(field), field.is_signed ? "signed" : "unsigned",
                        scale_text(field), fmt::format("{:.7g} to {:.7g}", field.lowest, field.highest),
                        std::string(field.unit), fastest > 0.0 ? fmt::format("{:.7g}", fastest) : ""});
        }
    }
    text += messages.text() +
            "each device also: emergency 080 + node, SDO to it 600 + node, from it 580 + node, 8 bytes, on demand\n\n" +
            fields.text();
    return text;
}

std::string can_table_json(const DeviceTable& table) {
    const auto& config = table.config();
    const auto load = drivers::bus_load(table);
    nlohmann::ordered_json json;
    json["bit_rate_bit_s"] = config.bit_rate_bit_s;
    json["period_ms"] = ms_per_ns * static_cast<double>(config.period_ns);
    json["spool_travel_m"] = config.spool_travel_m;
    json["bus_load_nominal"] = load.nominal_share;
    json["bus_load_worst_case"] = load.worst_case_share;
    json["bus_load_allowed"] = drivers::largest_bus_load_share;
    json["devices"] = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < drivers::device_count; ++i) {
        const auto device = static_cast<Device>(i);
        const auto& d = config[device];
        json["devices"].push_back({{"name", name_of(device)},
                                   {"node_id", d.node_id},
                                   {"profile", profile_of(config, device)},
                                   {"protection", name_of_protection(d.protection)},
                                   {"required", d.required},
                                   {"configure", d.configure},
                                   {"heartbeat_ms", d.heartbeat_ms},
                                   {"heartbeat_timeout_ms", d.heartbeat_timeout_ms},
                                   {"device_type", d.device_type},
                                   {"vendor_id", d.vendor_id},
                                   {"product_code", d.product_code}});
    }
    json["messages"] = nlohmann::ordered_json::array();
    for (const auto& row : table.messages()) {
        if (!row.present) {
            continue;
        }
        nlohmann::ordered_json message{{"id", row.id},
                                       {"extended", row.extended},
                                       {"name", row.name},
                                       {"device", name_of(row.device)},
                                       {"from_controller", row.from_controller},
                                       {"length_bytes", row.length_bytes},
                                       {"cycle_ms", cycle_ms(table, row)},
                                       {"worst_case_share", worst_case_share(table, row)},
                                       {"protection", name_of_protection(row.protection)},
                                       {"data_id", row.data_id}};
        message["fields"] = nlohmann::ordered_json::array();
        for (const auto& field : fields_of(table, row.message)) {
            message["fields"].push_back({{"name", field.name},
                                         {"start_bit", field.start_bit},
                                         {"size_bits", field.size_bits},
                                         {"big_endian", field.big_endian},
                                         {"signed", field.is_signed},
                                         {"scale", field.scale},
                                         {"offset", field.offset},
                                         {"lowest", field.lowest},
                                         {"highest", field.highest},
                                         {"unit", field.unit}});
        }
        json["messages"].push_back(std::move(message));
    }
    return json.dump(2) + '\n';
}

}  // namespace steadyboom::hil
