#include "hil/bus_monitor_view.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "drivers/pdo_codec.hpp"
#include "drivers/sdo_abort.hpp"
#include "drivers/sdo_format.hpp"

namespace steadyboom::hil {

namespace {

using drivers::Device;
using drivers::Message;
using drivers::MessageKind;
using drivers::MessageRow;
using drivers::NodeState;
using drivers::Signal;

constexpr double s_per_ns = 1.0e-9;
constexpr double ms_per_ns = 1.0e-6;

constexpr std::string_view bold = "\033[1m";
constexpr std::string_view red = "\033[31m";
constexpr std::string_view plain = "\033[0m";

struct Paint {
    bool colour;
    [[nodiscard]] std::string operator()(std::string_view code, std::string text) const {
        return colour && !text.empty() ? fmt::format("{}{}{}", code, text, plain) : text;
    }
};

std::string age_text(std::int64_t age_ns) {
    const double age_ms = ms_per_ns * static_cast<double>(age_ns);
    return age_ms < 1000.0 ? fmt::format("{:.0f} ms", age_ms) : fmt::format("{:.1f} s", 1.0e-3 * age_ms);
}

std::string_view text_of(drivers::ReceiverState state) noexcept {
    switch (state) {
        case drivers::ReceiverState::no_data:
            return "no_data";
        case drivers::ReceiverState::init:
            return "init";
        case drivers::ReceiverState::valid:
            return "valid";
        case drivers::ReceiverState::invalid:
            return "invalid";
    }
    return "";
}

std::string state_text(NodeState state) {
    if (state == NodeState::unknown) {
        return "never heard";
    }
    const auto word = word_for(node_state_words(), static_cast<std::int64_t>(state));
    return word.empty() ? fmt::format("state {:#04x}", static_cast<unsigned>(state)) : std::string(word);
}

double value_of(const MessageField& field, std::int64_t raw) noexcept {
    return static_cast<double>(raw) * field.scale + field.offset;
}

/// Decimals that a raw step asks for.
int decimals(const MessageField& field) noexcept {
    int count = 0;
    for (double step = std::abs(field.scale); step < 0.999 && count < 6; step *= 10.0) {
        ++count;
    }
    return count;
}

std::string value_text(const MessageField& field, std::int64_t raw) {
    if (const auto word = word_for(field.words, raw); !word.empty()) {
        return fmt::format("{} {}", field.name, word);
    }
    return fmt::format("{} {:.{}f}{}{}", field.name, value_of(field, raw), decimals(field),
                       field.unit.empty() ? "" : " ", field.unit);
}

/// Whether a field says no more than that all is well: a flag that is not set, the ok of a status byte.
bool says_nothing(const BusMonitor& monitor, const MessageField& field, std::int64_t raw) noexcept {
    if (field.signal == Signal::none || raw != 0) {
        return false;
    }
    const bool flag = field.size_bits == 1 && field.shift_bits > 0;
    return flag || std::ranges::any_of(monitor.table().signals(), [&field](const drivers::SignalRow& signal) {
               return signal.status == field.signal;
           });
}

/// "reads 1018h:01", "writes 1017h:00 = 0x64", "aborts 1000h:00, ..."
std::string sdo_text(const drivers::CanFrame& frame) {
    const auto specifier = drivers::sdo::specifier_of(frame.data[0]);
    const std::string object = fmt::format("{:04X}h:{:02X}", frame.data[1] + 256U * frame.data[2], frame.data[3]);
    std::uint32_t value = 0;
    for (std::size_t i = 4; i > 0; --i) {
        value = 256U * value + frame.data[3 + i];
    }
    if (specifier == drivers::sdo::abort_command) {
        return fmt::format("aborts {}: {:#010x} {}", object, value,
                           drivers::text_of(static_cast<drivers::SdoAbort>(value)));
    }
    const bool request = frame.id >= drivers::sdo_request_code;
    if (request && specifier == drivers::sdo::upload_request) {
        return "reads " + object;
    }
    if (request && specifier == drivers::sdo::download_request) {
        return fmt::format("writes {} = {:#x}", object, value);
    }
    if (!request && specifier == drivers::sdo::upload_response) {
        return fmt::format("{} is {:#x}", object, value);
    }
    return request ? fmt::format("command {:#04x}", frame.data[0]) : object + " is written";
}

/// The newest values of a message, protection left out.
std::string values_text(const BusMonitor& monitor, const MessageRow& row) {
    const auto& newest = monitor.traffic(row.message).newest;
    if (row.kind == MessageKind::sdo_request || row.kind == MessageKind::sdo_answer) {
        return sdo_text(newest);
    }
    std::string text;
    for (const auto& field : monitor.fields(row.message)) {
        const bool protection = row.kind == MessageKind::pdo && field.signal == Signal::none;
        const auto raw = monitor.raw(field, newest);
        if (!protection && !says_nothing(monitor, field, raw)) {
            text += (text.empty() ? "" : "  ") + value_text(field, raw);
        }
    }
    return text;
}

/// What is wrong with a message, empty if nothing.
std::string trouble_text(const MessageTraffic& traffic) {
    std::string text;
    const auto count = [&text](std::string_view what, std::uint64_t times) {
        if (times > 0) {
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", what, times);
        }
    };
    count("wrong length", traffic.wrong_length_frames);
    count("out of range", traffic.out_of_range_values);
    count("called faulty", traffic.faulty_values);
    if (traffic.receiver) {
        const auto& status = traffic.receiver->status();
        count("CRC", status.wrong_checksum_frames);
        count("sequence", status.wrong_sequence_frames);
        count("repeated", status.repeated_frames);
        count("quality", status.poor_quality_frames);
        count("lost", status.lost_frames);
        if (traffic.frames > 0 && traffic.receiver->state() != drivers::ReceiverState::valid) {
            text += fmt::format("{}protection {}", text.empty() ? "" : ", ", text_of(traffic.receiver->state()));
        }
    }
    return text;
}

std::string hex_id(std::uint32_t id, bool extended) {
    return fmt::format(fmt::runtime(extended ? "{:08X}" : "{:03X}"), id);
}

std::string device_line(const BusMonitor& monitor, const MonitorView& view, Device device) {
    const Paint paint{view.colour};
    const auto& config = monitor.table().config(device);
    const auto& traffic = monitor.traffic(device);
    const auto& heartbeat = monitor.traffic(heartbeat_of(device));
    std::string line = paint(bold, fmt::format("{} {:#04x}", name_of(device), config.node_id));
    const bool operational = traffic.state == NodeState::operational;
    line += ": " + (operational ? state_text(traffic.state) : paint(red, state_text(traffic.state)));
    if (heartbeat.frames > 0) {
        const auto age_ns = view.now_ns - heartbeat.newest.stamp_ns;
        const bool lost = config.heartbeat_timeout_ms > 0 &&
                          ms_per_ns * static_cast<double>(age_ns) > static_cast<double>(config.heartbeat_timeout_ms);
        const std::string text = fmt::format("heartbeat {} ago", age_text(age_ns));
        line += ", " + (lost ? paint(red, text + ": lost") : text);
    } else if (config.heartbeat_ms == 0) {
        line += ", has no heartbeat";
    }
    if (traffic.boot_ups > 0) {
        line += fmt::format(", boot-ups {}", traffic.boot_ups);
    }
    return line + '\n';
}

std::string emergency_line(const DeviceTraffic& traffic, const MonitorView& view) {
    if (traffic.emergencies == 0) {
        return {};
    }
    const auto& emergency = traffic.last_emergency;
    const std::string text =
        fmt::format("     emergency {:#06x} {}, register {:#04x}, {} ago, {} in all", emergency.code,
                    drivers::emergency_text(emergency.code), emergency.error_register,
                    age_text(view.now_ns - traffic.last_emergency_ns), traffic.emergencies);
    return Paint{view.colour}(emergency.is_reset() ? std::string_view() : red, text) + '\n';
}

bool shown(const MessageRow& row, const MessageTraffic& traffic) noexcept {
    const bool heard = traffic.frames > 0 || traffic.wrong_length_frames > 0;
    const bool expected = row.kind == MessageKind::pdo || row.kind == MessageKind::sync;
    return row.present &&
           (expected || (heard && row.kind != MessageKind::heartbeat && row.kind != MessageKind::emergency));
}

}  // namespace

std::string monitor_text(const BusMonitor& monitor, const MonitorView& view) {
    const Paint paint{view.colour};
    std::string text = paint(bold, view.source);
    text += fmt::format(": {:.1f} s, {} frames, {:.0f}/s, bus load {:.1f} % of {} kbit/s\n",
                        s_per_ns * static_cast<double>(view.now_ns - monitor.first_ns()), monitor.frames(),
                        view.recent ? monitor.recent_rate_Hz() : monitor.mean_rate_Hz(),
                        100.0 * (view.recent ? monitor.recent_load_share() : monitor.mean_load_share()),
                        monitor.table().config().bit_rate_bit_s / 1000U);
    if (!view.interface_state.empty()) {
        text += paint(red, view.interface_state) + '\n';
    }
    const auto count = [&](std::string_view what, std::uint64_t times) {
        const std::string piece = fmt::format("{} {}", what, times);
        return times > 0 ? paint(red, piece) : piece;
    };
    text += fmt::format("{}, {}, {}, {}, {}", count("unknown identifier", monitor.unknown_id_frames()),
                        count("remote", monitor.remote_frames()), count("CAN FD", monitor.fd_frames()),
                        count("error messages", monitor.error_frames()), count("lost", view.lost_frames));
    if (view.cut_lines > 0) {
        text += ", " + count("cut lines", view.cut_lines);
    }
    text += '\n';
    if (!monitor.unknown_ids().empty()) {
        std::vector<std::pair<std::uint64_t, std::pair<bool, std::uint32_t>>> most;
        for (const auto& [key, frames] : monitor.unknown_ids()) {
            most.push_back({frames, key});
        }
        std::ranges::sort(most, std::greater());
        text += "unknown:";
        for (std::size_t i = 0; i < std::min<std::size_t>(most.size(), 8); ++i) {
            text += fmt::format(" {} x {}", hex_id(most[i].second.second, most[i].second.first), most[i].first);
        }
        text += most.size() > 8 ? fmt::format(" and {} more\n", most.size() - 8) : "\n";
    }
    text += fmt::format("\n{:<5}{:<30}{:>8}{:>9}  {}\n", "id", "message", "rate/s", "age", "newest values");

    for (std::size_t i = 0; i < drivers::device_count; ++i) {
        const auto device = static_cast<Device>(i);
        text += device_line(monitor, view, device);
        text += emergency_line(monitor.traffic(device), view);
        for (const auto& row : monitor.table().messages()) {
            const auto& traffic = monitor.traffic(row.message);
            if (row.device != device || !shown(row, traffic)) {
                continue;
            }
            const bool heard = traffic.frames > 0;
            text += fmt::format(
                "{:<5}{:<30}{:>8}{:>9}  ", hex_id(row.id, row.extended), row.name,
                heard ? fmt::format("{:.1f}", view.recent ? traffic.recent_rate_Hz : traffic.mean_rate_Hz()) : "",
                heard ? age_text(view.now_ns - traffic.newest.stamp_ns) : "never");
            if (const auto trouble = trouble_text(traffic); !trouble.empty()) {
                text += paint(red, "[" + trouble + "]") + "  ";
            }
            text += heard ? values_text(monitor, row) : "";
            text.erase(text.find_last_not_of(' ') + 1);
            text += '\n';
        }
    }
    return text;
}

std::string monitor_json(const BusMonitor& monitor, const MonitorView& view) {
    using Json = nlohmann::ordered_json;
    const auto age_s = [&view](bool ever, std::int64_t stamp_ns) {
        return ever ? Json(s_per_ns * static_cast<double>(view.now_ns - stamp_ns)) : Json(nullptr);
    };
    Json json;
    json["source"] = view.source;
    json["duration_s"] = s_per_ns * static_cast<double>(view.now_ns - monitor.first_ns());
    json["frames"] = monitor.frames();
    json["rate_Hz"] = monitor.mean_rate_Hz();
    json["bus_load"] = monitor.mean_load_share();
    json["unknown_id_frames"] = monitor.unknown_id_frames();
    json["unknown_ids"] = Json::array();
    for (const auto& [key, frames] : monitor.unknown_ids()) {
        json["unknown_ids"].push_back({{"id", key.second}, {"extended", key.first}, {"frames", frames}});
    }
    json["remote_frames"] = monitor.remote_frames();
    json["fd_frames"] = monitor.fd_frames();
    json["error_frames"] = monitor.error_frames();
    json["last_error_class"] = monitor.error_frames() > 0 ? Json(monitor.last_error_frame().id) : Json(nullptr);
    json["lost_frames"] = view.lost_frames;
    json["cut_lines"] = view.cut_lines;
    json["interface_state"] = view.interface_state;
    json["devices"] = Json::array();
    for (std::size_t i = 0; i < drivers::device_count; ++i) {
        const auto device = static_cast<Device>(i);
        const auto& traffic = monitor.traffic(device);
        const auto& heartbeat = monitor.traffic(heartbeat_of(device));
        Json node{{"name", name_of(device)},
                  {"node_id", monitor.table().node_id(device)},
                  {"state", traffic.state == NodeState::unknown ? Json(nullptr) : Json(state_text(traffic.state))},
                  {"heartbeat_age_s", age_s(heartbeat.frames > 0, heartbeat.newest.stamp_ns)},
                  {"boot_ups", traffic.boot_ups},
                  {"emergencies", traffic.emergencies}};
        if (traffic.emergencies > 0) {
            const auto& emergency = traffic.last_emergency;
            node["last_emergency"] = {{"code", emergency.code},
                                      {"text", drivers::emergency_text(emergency.code)},
                                      {"error_register", emergency.error_register},
                                      {"age_s", age_s(true, traffic.last_emergency_ns)}};
        }
        node["messages"] = Json::array();
        for (const auto& row : monitor.table().messages()) {
            if (row.device != device || !row.present) {
                continue;
            }
            const auto& seen = monitor.traffic(row.message);
            Json message{{"name", row.name},
                         {"id", row.id},
                         {"frames", seen.frames},
                         {"rate_Hz", seen.mean_rate_Hz()},
                         {"age_s", age_s(seen.frames > 0, seen.newest.stamp_ns)},
                         {"wrong_length_frames", seen.wrong_length_frames},
                         {"out_of_range_values", seen.out_of_range_values},
                         {"faulty_values", seen.faulty_values}};
            if (seen.receiver) {
                const auto& status = seen.receiver->status();
                message["protection"] = {{"state", text_of(seen.receiver->state())},
                                         {"good_frames", status.good_frames},
                                         {"repeated_frames", status.repeated_frames},
                                         {"wrong_sequence_frames", status.wrong_sequence_frames},
                                         {"wrong_checksum_frames", status.wrong_checksum_frames},
                                         {"poor_quality_frames", status.poor_quality_frames},
                                         {"lost_frames", status.lost_frames},
                                         {"erroneous_ticks", status.erroneous_ticks},
                                         {"silent_ticks", status.silent_ticks}};
            }
            if (seen.frames > 0) {
                message["values"] = Json::object();
                for (const auto& field : monitor.fields(row.message)) {
                    const auto raw = monitor.raw(field, seen.newest);
                    Json value{{"raw", raw}, {"value", value_of(field, raw)}, {"unit", field.unit}};
                    if (const auto word = word_for(field.words, raw); !word.empty()) {
                        value["word"] = word;
                    }
                    message["values"][field.name] = std::move(value);
                }
            }
            node["messages"].push_back(std::move(message));
        }
        json["devices"].push_back(std::move(node));
    }
    return json.dump(2) + '\n';
}

std::string fit_to_terminal(const std::string& text, std::size_t columns, std::size_t rows) {
    std::string fitted;
    std::size_t row = 0;
    const auto line_count = static_cast<std::size_t>(std::ranges::count(text, '\n'));
    for (std::size_t begin = 0; begin < text.size();) {
        const auto end = text.find('\n', begin);
        if (row + 1 == rows && line_count > rows) {
            return fitted + fmt::format("... {} more lines", line_count - row);
        }
        std::size_t column = 0;
        for (std::size_t i = begin; i < end; ++i) {
            if (text[i] == '\033') {
                const auto code_end = text.find('m', i);
                fitted.append(text, i, code_end - i + 1);
                i = code_end;
            } else if (column < columns) {
                fitted += text[i];
                ++column;
            }
        }
        ++row;
        begin = end + 1;
        if (row < line_count && row < rows) {
            fitted += '\n';
        }
    }
    return fitted;
}

}  // namespace steadyboom::hil
