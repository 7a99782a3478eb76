#include "drivers/device_table.hpp"

#include "drivers/auxiliary_valve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "drivers/emcy.hpp"
#include "drivers/sdo_format.hpp"

namespace steadyboom::drivers {
namespace {

constexpr std::uint32_t nmt_id = 0x000;
constexpr std::uint32_t sync_id = 0x080;
constexpr std::uint32_t tpdo1_code = 0x180;
constexpr std::uint32_t rpdo1_code = 0x200;
constexpr std::uint32_t next_pdo_code = 0x100;  ///< from PDO n to PDO n + 1
constexpr std::uint32_t heartbeat_code = 0x700;

constexpr std::int64_t ns_per_ms = 1'000'000;
constexpr std::uint32_t extended_id_count = 1U << 29U;

/// What a signal feeds, and which status byte speaks for it.
struct Meaning {
    plant::Sensor sensor = plant::sensor_count;
    Signal status = Signal::none;
};

Meaning meaning_of(Signal signal) noexcept {
    switch (signal) {
        case Signal::strain_lower:
            return {plant::strain_lower_microstrain, Signal::strain_lower_status};
        case Signal::strain_upper:
            return {plant::strain_upper_microstrain, Signal::strain_upper_status};
        case Signal::boom_angle:
            return {plant::boom_angle_rad};
        case Signal::line_tension:
            return {plant::line_tension_N, Signal::line_tension_status};
        case Signal::line_angle:
            return {plant::line_angle_rad};
        case Signal::line_length:
            return {plant::line_length_m};
        case Signal::spool:
            return {plant::spool_m};
        case Signal::piston:
            return {plant::piston_m};
        case Signal::load_pressure:
            return {plant::load_pressure_Pa};
        default:
            return {};
    }
}

struct SiUnit {
    std::string_view name;
    double per_unit;
};

SiUnit si_unit(Unit unit, double spool_travel_m) noexcept {
    switch (unit) {
        case Unit::none:
            return {"", 1.0};
        case Unit::microstrain:
            return {"microstrain", 1.0};
        case Unit::deg:
            return {"rad", std::numbers::pi / 180.0};
        case Unit::rad:
            return {"rad", 1.0};
        case Unit::N:
            return {"N", 1.0};
        case Unit::kN:
            return {"N", 1.0e3};
        case Unit::m:
            return {"m", 1.0};
        case Unit::mm:
            return {"m", 1.0e-3};
        case Unit::um:
            return {"m", 1.0e-6};
        case Unit::percent_of_travel:
            return {"m", 0.01 * spool_travel_m};
        case Unit::Pa:
            return {"Pa", 1.0};
        case Unit::bar:
            return {"Pa", 1.0e5};
        case Unit::MPa:
            return {"Pa", 1.0e6};
    }
    return {"", 1.0};
}

template <typename Value>
[[noreturn]] void refuse(const std::string& key, Value value, const std::string& allowed) {
    std::ostringstream text;
    if constexpr (sizeof(Value) == 1) {
        text << key << " = " << static_cast<int>(value);
    } else {
        text << key << " = " << value;
    }
    text << ": " << allowed;
    throw std::invalid_argument(text.str());
}

std::string key_of(Device device, std::string_view key) {
    return "device." + std::string(name_of(device)) + "." + std::string(key);
}
std::string key_of(Pdo pdo, std::string_view key) {
    return "pdo." + std::string(name_of(pdo)) + "." + std::string(key);
}
std::string key_of(Signal signal, std::string_view key) {
    return "signal." + std::string(name_of(signal)) + "." + std::string(key);
}

void check_bus(const NetworkConfig& config) {
    if (!std::isfinite(config.spool_travel_m) || config.spool_travel_m <= 0.0 || config.spool_travel_m > 1.0) {
        refuse("spool_travel_m", config.spool_travel_m, "allowed is above 0 up to 1");
    }
    if (config.period_ns < 100'000 || config.period_ns > 1'000'000'000) {
        refuse("period_ns", config.period_ns, "allowed is 100000 to 1000000000");
    }
    switch (config.bit_rate_bit_s) {
        case 125'000:
        case 250'000:
        case 500'000:
        case 1'000'000:
            break;
        default:
            refuse("bit_rate_bit_s", config.bit_rate_bit_s, "allowed is 125000, 250000, 500000 or 1000000");
    }
}

void check_devices(const NetworkConfig& config) {
    std::array<std::optional<Device>, 128> taken{};
    for (std::size_t i = 0; i < device_count; ++i) {
        const auto device = static_cast<Device>(i);
        const auto& d = config[device];
        if (d.node_id < 1 || d.node_id > 127) {
            refuse(key_of(device, "node_id"), d.node_id, "allowed is 1 to 127");
        }
        if (taken[d.node_id]) {
            refuse(key_of(device, "node_id"), d.node_id,
                   std::string(name_of(*taken[d.node_id])) + " has this node id; allowed is one that no other has");
        }
        taken[d.node_id] = device;
        if (d.heartbeat_ms < 0 || d.heartbeat_ms > 65'535) {
            refuse(key_of(device, "heartbeat_ms"), d.heartbeat_ms, "allowed is 0 to 65535");
        }
        if (!d.canopen && (d.heartbeat_ms != 0 || device == Device::controller)) {
            refuse(key_of(device, "canopen"), "false",
                   device == Device::controller ? "allowed is true" : "allowed with heartbeat_ms = 0 alone");
        }
        const bool timeout_fits =
            d.heartbeat_ms == 0 ? d.heartbeat_timeout_ms == 0 : d.heartbeat_timeout_ms > d.heartbeat_ms;
        if (!timeout_fits && device != Device::controller) {
            refuse(key_of(device, "heartbeat_timeout_ms"), d.heartbeat_timeout_ms,
                   d.heartbeat_ms == 0 ? "allowed is 0, as there is no heartbeat to wait for"
                                       : "allowed is more than heartbeat_ms");
        }
    }
}

/// Samples may come as far apart as the interlock lets them grow old. A protected message is scored tick by tick, and
/// the valve's state and the emergency stop shall be seen in the tick in which they change.
std::int64_t longest_timer_ticks(const NetworkConfig& config, Pdo pdo) {
    const bool each_tick = config[config[pdo].device].protection == Protection::e2e || !carries_sensors_alone(pdo);
    return each_tick ? 1 : 3;
}

void check_pdos(const NetworkConfig& config) {
    for (std::size_t i = 0; i < pdo_count; ++i) {
        const auto pdo = static_cast<Pdo>(i);
        const auto& p = config[pdo];
        const Device usual = default_device_of(pdo);
        const bool any = carries_sensors_alone(pdo);
        if (any ? p.device == Device::controller || index_of(p.device) >= device_count : p.device != usual) {
            refuse(key_of(pdo, "device"), name_of(p.device),
                   any ? "allowed is any device but the controller" : "allowed is " + std::string(name_of(usual)));
        }
        if (p.number < 1 || p.number > 4) {
            refuse(key_of(pdo, "number"), p.number, "allowed is 1 to 4");
        }
        const bool timer = p.transmission == Transmission::event && !from_controller(pdo);
        const bool timer_fits =
            timer ? p.event_ms >= 1 && p.event_ms * ns_per_ms <= longest_timer_ticks(config, pdo) * config.period_ns
                  : p.event_ms == 0;
        if (!timer_fits) {
            refuse(
                key_of(pdo, "event_ms"), p.event_ms,
                !timer ? "allowed is 0, as this PDO is not sent by a timer"
                : longest_timer_ticks(config, pdo) == 1
                    ? "allowed is at least 1 and at most one tick: what protects it, or moves the valve, counts ticks"
                    : "allowed is at least 1 and at most three ticks: an older sample is a missing one");
        }
        if (p.extended_id >= extended_id_count) {
            refuse(key_of(pdo, "extended_id"), p.extended_id, "allowed is 0 to 536870911 (29 bits)");
        }
        for (std::size_t j = 0; j < i && pdo != Pdo::valve_twin; ++j) {
            if (p.data_id == config.pdos[j].data_id) {
                refuse(key_of(pdo, "data_id"), p.data_id,
                       "pdo." + std::string(name_of(static_cast<Pdo>(j))) +
                           " has this data id; allowed is one that no other has");
            }
        }
    }
}

/// Codes that devices use to say that they have no value.
std::vector<std::int64_t> no_value_codes(RawType type) {
    switch (type) {
        case RawType::u16:
            return {0xFFFE, 0xFFFF};
        case RawType::i16:
            return {-0x8000, 0x7FFF};
        case RawType::u32:
            return {0xFFFF'FFFE, 0xFFFF'FFFF};
        case RawType::i32:
            return {-0x8000'0000LL, 0x7FFF'FFFF};
        case RawType::u8:
            return {0xFE, 0xFF};
        case RawType::bit:
            break;
    }
    return {};
}

void check_signal(Signal signal, const SignalConfig& s) {
    if (!measures(s.unit, signal)) {
        refuse(key_of(signal, "unit"), name_of(s.unit), "allowed is a unit of what this signal measures");
    }
    if (!std::isfinite(s.scale) || s.scale == 0.0) {
        refuse(key_of(signal, "scale"), s.scale, "allowed is any finite number but 0");
    }
    if (!std::isfinite(s.offset)) {
        refuse(key_of(signal, "offset"), s.offset, "allowed is any finite number");
    }
    if (!std::isfinite(s.lowest) || !std::isfinite(s.highest) || s.lowest >= s.highest) {
        refuse(key_of(signal, "lowest"), s.lowest, "allowed is a finite number below highest");
    }
    if (!std::isfinite(s.fastest_1_s) || s.fastest_1_s < 0.0) {
        refuse(key_of(signal, "fastest_1_s"), s.fastest_1_s,
               "allowed is a finite number of at least 0; 0: not checked");
    }
    if (s.bit > 7 || (s.bit != 0 && s.type != RawType::bit)) {
        refuse(key_of(signal, "bit"), s.bit, "allowed is 0 to 7 for type \"bit\", else 0");
    }
    if (8 * s.byte_offset + size_bits(s.type) > 8 * longest_frame_bytes) {
        refuse(key_of(signal, "byte_offset"), s.byte_offset, "the value would end beyond the frame's eighth byte");
    }
    const bool needs_bit =
        signal == Signal::cutoff_open || signal == Signal::emergency_stop_healthy || signal == Signal::cutoff_energised;
    if (needs_bit != (s.type == RawType::bit)) {
        refuse(key_of(signal, "type"), static_cast<int>(s.type), needs_bit ? "allowed is a bit" : "a bit is too small");
    }
    const bool is_word = signal == Signal::valve_status_word || signal == Signal::valve_control_word;
    if (is_word && s.type != RawType::u16) {
        refuse(key_of(signal, "type"), static_cast<int>(s.type), "allowed is u16 (CiA 408)");
    }
    if (meaning_of(signal).sensor == plant::sensor_count) {
        return;
    }
    for (const auto raw : no_value_codes(s.type)) {
        const double value = static_cast<double>(raw) * s.scale + s.offset;
        const double half_step = 0.5 * std::abs(s.scale);
        if (value >= s.lowest - half_step && value <= s.highest + half_step) {
            const bool at_the_top = (raw > 0) == (s.scale > 0.0);
            refuse(key_of(signal, at_the_top ? "highest" : "lowest"), at_the_top ? s.highest : s.lowest,
                   "the raw code " + std::to_string(raw) +
                       ", which devices send for \"no value\", would lie within the limits");
        }
    }
}

/// ISO 11783-7 says where everything lies; a table that says otherwise describes another valve.
void check_auxiliary_valve(const NetworkConfig& config) {
    const auto& valve = config[Device::servo_valve];
    if (valve.canopen) {
        refuse(key_of(Device::servo_valve, "canopen"), "true", "allowed with profile \"j1939\" is false");
    }
    if (valve.protection != Protection::none) {
        refuse(key_of(Device::servo_valve, "protection"), "e2e", "allowed with profile \"j1939\" is none");
    }
    const auto check_message = [&](Pdo pdo, std::uint32_t first_pgn) {
        const auto& p = config[pdo];
        const std::uint32_t pgn = p.extended_id >> 8U & 0x3'FFFFU;
        if (pgn < first_pgn || pgn > first_pgn + 15) {
            refuse(key_of(pdo, "extended_id"), p.extended_id,
                   "allowed is one of parameter group " + std::to_string(first_pgn) + " to " +
                       std::to_string(first_pgn + 15) + " (ISO 11783-7)");
        }
        if (p.length_bytes != auxiliary_valve_bytes) {
            refuse(key_of(pdo, "length_bytes"), p.length_bytes, "allowed with profile \"j1939\" is 8");
        }
    };
    check_message(Pdo::valve_command, auxiliary_valve_command_pgn);
    check_message(Pdo::valve_status, auxiliary_valve_flow_pgn);
    for (const auto word : {Signal::valve_control_word, Signal::valve_status_word}) {
        if (config[word].mapped) {
            refuse(key_of(word, "mapped"), "true", "allowed with profile \"j1939\" is false");
        }
    }
    const auto lies = [](const SignalConfig& s, RawType type, std::uint8_t byte_offset, double scale) {
        return s.mapped && s.type == type && s.byte_offset == byte_offset && s.unit == Unit::percent_of_travel &&
               std::abs(std::abs(s.scale) - scale) < 1.0e-9;
    };
    const auto& set_point = config[Signal::valve_set_point];
    const bool standard = lies(set_point, RawType::u8, 0, 100.0 / standard_flow_steps);
    const bool extended = lies(set_point, RawType::u16, 3, 100.0 / extended_flow_steps);
    if (!(standard || extended) || set_point.offset != 0.0) {
        refuse(key_of(Signal::valve_set_point, "scale"), set_point.scale,
               "allowed with profile \"j1939\" is type \"u8\" at byte 0 with scale 0.4 or -0.4, or \"u16\" at byte 3 "
               "with scale 0.0015625 or -0.0015625, unit \"%\", offset 0");
    }
    const auto& spool = config[Signal::spool];
    if (!lies(spool, RawType::u8, 0, 1.0) || spool.offset != -125.0 * spool.scale ||
        std::signbit(spool.scale) != std::signbit(set_point.scale)) {
        refuse(
            key_of(Signal::spool, "scale"), spool.scale,
            "allowed with profile \"j1939\" is type \"u8\" at byte 0, unit \"%\", scale 1 and offset -125, or -1 and "
            "125 if the set-point's scale is negative");
    }
}

void check_signals(const NetworkConfig& config) {
    std::array<std::array<std::optional<Signal>, 64>, pdo_count> owner{};
    for (std::size_t i = 0; i < signal_count; ++i) {
        const auto signal = static_cast<Signal>(i);
        const auto& s = config[signal];
        if (!s.mapped) {
            const bool optional = meaning_of(signal).sensor != plant::sensor_count ||
                                  signal == Signal::strain_lower_status || signal == Signal::strain_upper_status ||
                                  signal == Signal::line_tension_status ||
                                  (config[Device::servo_valve].profile == ValveProfile::j1939 &&
                                   (signal == Signal::valve_control_word || signal == Signal::valve_status_word));
            if (!optional) {
                refuse(key_of(signal, "mapped"), "false", "the controller cannot do without this signal");
            }
            continue;
        }
        check_signal(signal, s);
        for (std::size_t bit = 8U * s.byte_offset + s.bit; bit < 8U * s.byte_offset + s.bit + size_bits(s.type);
             ++bit) {
            auto& other = owner[index_of(pdo_of(signal))][bit];
            if (other) {
                refuse(key_of(signal, "byte_offset"), s.byte_offset,
                       std::string(name_of(*other)) + " lies there in the same PDO");
            }
            other = signal;
        }
    }
}

/// Bytes of the values in this PDO.
std::uint8_t values_bytes(const NetworkConfig& config, Pdo pdo) {
    // The twin repeats the command.
    const Pdo mapped = pdo == Pdo::valve_twin ? Pdo::valve_command : pdo;
    std::size_t end_bytes = 0;
    for (std::size_t i = 0; i < signal_count; ++i) {
        const auto& s = config.signals[i];
        if (s.mapped && pdo_of(static_cast<Signal>(i)) == mapped) {
            end_bytes = std::max<std::size_t>(end_bytes, s.byte_offset + (size_bits(s.type) + 7U) / 8U);
        }
    }
    const auto& p = config[mapped];
    if (p.length_bytes != 0) {
        if (p.length_bytes < end_bytes || p.length_bytes > longest_frame_bytes) {
            refuse(key_of(mapped, "length_bytes"), p.length_bytes,
                   "allowed is " + std::to_string(end_bytes) + " (where its last signal ends) to 8, or 0");
        }
        end_bytes = p.length_bytes;
    }
    const bool is_protected = config[config[pdo].device].protection == Protection::e2e;
    if (is_protected && end_bytes + protection_bytes > longest_frame_bytes) {
        refuse(key_of(config[pdo].device, "protection"), "e2e",
               "counter and CRC need two bytes, and " + std::string(name_of(pdo)) + " has " +
                   std::to_string(end_bytes) + " of 8");
    }
    return static_cast<std::uint8_t>(end_bytes);
}

const NetworkConfig& checked(const NetworkConfig& config) {
    check_bus(config);
    check_devices(config);
    check_pdos(config);
    check_signals(config);
    if (config[Device::servo_valve].profile == ValveProfile::j1939) {
        check_auxiliary_valve(config);
    }
    return config;
}

MessageRow pdo_row(const NetworkConfig& config, Pdo pdo) {
    const auto& p = config[pdo];
    const Device device = p.device;
    const bool out = from_controller(pdo);
    const bool is_protected = config[device].protection == Protection::e2e;
    MessageRow row;
    row.message = message_of(pdo);
    row.name = std::string(name_of(device)) + (out ? "_rpdo" : "_tpdo") + std::to_string(p.number);
    row.present = values_bytes(config, pdo) > 0 && (pdo != Pdo::valve_twin || is_protected);
    row.kind = MessageKind::pdo;
    row.device = device;
    row.pdo = pdo;
    row.id = (out ? rpdo1_code : tpdo1_code) + (p.number - 1U) * next_pdo_code + config[device].node_id;
    if (p.extended_id != 0) {
        row.id = p.extended_id;
        row.extended = true;
    }
    row.length_bytes =
        static_cast<std::uint8_t>(values_bytes(config, pdo) + (is_protected ? protection_bytes : std::uint8_t{0}));
    row.from_controller = out;
    row.cycle = out ? Cycle::every_tick : p.transmission == Transmission::sync ? Cycle::on_sync : Cycle::timer;
    row.interval_ns = row.cycle == Cycle::timer ? p.event_ms * ns_per_ms : 0;
    // The twin's counter and CRC are the command's, inverted.
    row.protection = pdo == Pdo::valve_twin ? Protection::none : config[device].protection;
    row.data_id = p.data_id;
    return row;
}

MessageRow service_row(const NetworkConfig& config, MessageKind kind, Device device) {
    const bool is_controller = device == Device::controller;
    const auto& d = config[device];
    MessageRow row;
    row.kind = kind;
    row.device = device;
    const std::string name(name_of(device));
    row.present = d.canopen;
    switch (kind) {
        case MessageKind::heartbeat:
            row.message = heartbeat_of(device);
            row.name = name + "_heartbeat";
            // A device without heartbeat still sends its boot-up message.
            row.id = heartbeat_code + d.node_id;
            row.length_bytes = 1;
            row.cycle = d.heartbeat_ms > 0 ? Cycle::timer : Cycle::on_demand;
            row.interval_ns = d.heartbeat_ms * ns_per_ms;
            row.from_controller = is_controller;
            break;
        case MessageKind::emergency:
            row.message = emergency_of(device);
            row.name = name + "_emergency";
            row.id = emergency_code + d.node_id;
            row.length_bytes = 8;
            row.present = d.canopen && !is_controller;
            break;
        case MessageKind::sdo_request:
            row.message = sdo_request_to(device);
            row.name = name + "_sdo_request";
            row.id = sdo_request_code + d.node_id;
            row.length_bytes = 8;
            row.from_controller = true;
            row.present = d.canopen && !is_controller;
            break;
        default:
            row.message = sdo_answer_of(device);
            row.name = name + "_sdo_answer";
            row.id = sdo_response_code + d.node_id;
            row.length_bytes = 8;
            row.present = d.canopen && !is_controller;
            break;
    }
    return row;
}

std::array<MessageRow, message_count> message_rows(const NetworkConfig& config) {
    std::array<MessageRow, message_count> rows;
    const auto put = [&rows](MessageRow row) {
        const auto i = index_of(row.message);
        rows[i] = std::move(row);
    };
    MessageRow nmt;
    nmt.message = Message::nmt;
    nmt.name = "nmt";
    nmt.id = nmt_id;
    nmt.length_bytes = 2;
    nmt.from_controller = true;
    put(nmt);
    MessageRow sync = nmt;
    sync.message = Message::sync;
    sync.kind = MessageKind::sync;
    sync.name = "sync";
    sync.id = sync_id;
    sync.length_bytes = 1;
    sync.cycle = Cycle::every_tick;
    put(sync);
    for (std::size_t i = 0; i < pdo_count; ++i) {
        put(pdo_row(config, static_cast<Pdo>(i)));
    }
    for (std::size_t i = 0; i < device_count; ++i) {
        for (const auto kind :
             {MessageKind::heartbeat, MessageKind::emergency, MessageKind::sdo_request, MessageKind::sdo_answer}) {
            put(service_row(config, kind, static_cast<Device>(i)));
        }
    }
    return rows;
}

SignalRow signal_row(const NetworkConfig& config, Signal signal) {
    const auto& s = config[signal];
    const auto si = si_unit(s.unit, config.spool_travel_m);
    const auto meaning = meaning_of(signal);
    SignalRow row;
    row.signal = signal;
    row.name = name_of(signal);
    row.present = s.mapped;
    row.message = message_of(pdo_of(signal));
    row.object = s.object;
    row.subindex = s.subindex;
    row.type = s.type;
    row.byte_offset = s.byte_offset;
    row.bit = s.bit;
    row.byte_order = s.byte_order;
    row.unit = si.name;
    row.scale_unit = s.scale * si.per_unit;
    row.offset_unit = s.offset * si.per_unit;
    row.lowest_unit = s.lowest * si.per_unit;
    row.highest_unit = s.highest * si.per_unit;
    row.largest_step_unit = s.fastest_1_s * si.per_unit * 1.0e-9 * static_cast<double>(config.period_ns);
    row.sensor = s.mapped ? meaning.sensor : plant::sensor_count;
    row.status = meaning.status != Signal::none && config[meaning.status].mapped ? meaning.status : Signal::none;
    return row;
}

std::array<SignalRow, signal_count> signal_rows(const NetworkConfig& config) {
    std::array<SignalRow, signal_count> rows;
    for (std::size_t i = 0; i < signal_count; ++i) {
        rows[i] = signal_row(config, static_cast<Signal>(i));
    }
    return rows;
}

}  // namespace

DeviceTable::DeviceTable(const NetworkConfig& config)
    : config_(checked(config)), messages_(message_rows(config)), signals_(signal_rows(config)) {
    by_id_.fill(Message::none);
    for (const auto& row : messages_) {
        if (!row.present) {
            continue;
        }
        const auto entry = message_with(row.id, row.extended);
        if (entry != row.message && entry != Message::none) {
            std::ostringstream text;
            text << row.name << " and " << this->row(entry).name << " would both be identifier " << std::hex << "0x"
                 << row.id << ": give one of them another number or node";
            throw std::invalid_argument(text.str());
        }
        if (!row.extended) {
            by_id_[row.id] = row.message;
        }
    }
}

Message DeviceTable::message_with(std::uint32_t id, bool extended) const noexcept {
    if (!extended) {
        return id < standard_id_count ? by_id_[id] : Message::none;
    }
    for (const auto& row : messages_) {
        if (row.present && row.extended && row.id == id) {
            return row.message;
        }
    }
    return Message::none;
}

CanFrame DeviceTable::blank(Message message, std::int64_t now_ns) const noexcept {
    CanFrame frame;
    frame.id = row(message).id;
    frame.extended = row(message).extended;
    frame.length = row(message).length_bytes;
    frame.stamp_ns = now_ns;
    return frame;
}

std::size_t DeviceTable::most_frames_a_tick() const noexcept {
    constexpr std::size_t management = 1;
    return management + static_cast<std::size_t>(std::ranges::count_if(messages_, [](const MessageRow& row) {
               return row.present && row.from_controller && row.cycle == Cycle::every_tick;
           }));
}

BusLoad bus_load(const DeviceTable& table) noexcept {
    BusLoad load;
    const auto& config = table.config();
    const auto share = [&config](std::uint32_t bits, std::int64_t interval_ns) {
        return bits * (1.0e9 / static_cast<double>(interval_ns)) / config.bit_rate_bit_s;
    };
    for (const auto& row : table.messages()) {
        if (!row.present || row.cycle == Cycle::on_demand) {
            continue;
        }
        const auto interval_ns = row.cycle == Cycle::timer ? row.interval_ns : config.period_ns;
        load.nominal_share += share(nominal_frame_bits(row.length_bytes, row.extended), interval_ns);
        load.worst_case_share += share(worst_case_frame_bits(row.length_bytes, row.extended), interval_ns);
    }
    load.worst_case_share += share(2U * worst_case_frame_bits(longest_frame_bytes), config.period_ns);
    return load;
}

}  // namespace steadyboom::drivers
