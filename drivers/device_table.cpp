#include "drivers/device_table.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace steadyboom::drivers {
namespace {

constexpr std::uint16_t nmt_code = 0x000;
constexpr std::uint16_t sync_code = 0x080;
constexpr std::uint16_t tpdo1_code = 0x180;
constexpr std::uint16_t rpdo1_code = 0x200;
constexpr std::uint16_t tpdo2_code = 0x280;
constexpr std::uint16_t heartbeat_code = 0x700;

constexpr double rad_per_deg = std::numbers::pi / 180.0;
constexpr double rad_per_millidegree = rad_per_deg / 1000.0;

std::array<MessageRow, message_count> message_rows() {
    using enum Message;
    constexpr auto tick = Cycle::every_tick;
    constexpr auto sampled = Cycle::on_sync;
    constexpr auto beat = Cycle::heartbeat;
    return {{
        {nmt, "nmt", Device::controller, nmt_code, false, 2, Cycle::on_demand, true},
        {sync, "sync", Device::controller, sync_code, false, 1, tick, true},
        {strain_tpdo1, "strain_tpdo1", Device::strain_link, tpdo1_code, true, 6, sampled, false},
        {boom_angle_tpdo1, "boom_angle_tpdo1", Device::boom_inclinometer, tpdo1_code, true, 4, sampled, false},
        {load_pin_tpdo1, "load_pin_tpdo1", Device::load_pin, tpdo1_code, true, 5, sampled, false},
        {line_angle_tpdo1, "line_angle_tpdo1", Device::hook_inclinometer, tpdo1_code, true, 4, sampled, false},
        {drum_tpdo1, "drum_tpdo1", Device::drum_encoder, tpdo1_code, true, 4, sampled, false},
        {valve_tpdo1, "valve_tpdo1", Device::servo_valve, tpdo1_code, true, 4, sampled, false},
        {valve_tpdo2, "valve_tpdo2", Device::servo_valve, tpdo2_code, true, 6, sampled, false},
        {safety_tpdo1, "safety_tpdo1", Device::safety_io, tpdo1_code, true, 1, sampled, false},
        {safety_rpdo1, "safety_rpdo1", Device::safety_io, rpdo1_code, true, 1, tick, true},
        {valve_rpdo1, "valve_rpdo1", Device::servo_valve, rpdo1_code, true, 4, tick, true},
        {controller_heartbeat, "controller_heartbeat", Device::controller, heartbeat_code, true, 1, beat, true},
        {strain_heartbeat, "strain_heartbeat", Device::strain_link, heartbeat_code, true, 1, beat, false},
        {boom_angle_heartbeat, "boom_angle_heartbeat", Device::boom_inclinometer, heartbeat_code, true, 1, beat, false},
        {load_pin_heartbeat, "load_pin_heartbeat", Device::load_pin, heartbeat_code, true, 1, beat, false},
        {line_angle_heartbeat, "line_angle_heartbeat", Device::hook_inclinometer, heartbeat_code, true, 1, beat, false},
        {drum_heartbeat, "drum_heartbeat", Device::drum_encoder, heartbeat_code, true, 1, beat, false},
        {valve_heartbeat, "valve_heartbeat", Device::servo_valve, heartbeat_code, true, 1, beat, false},
        {safety_heartbeat, "safety_heartbeat", Device::safety_io, heartbeat_code, true, 1, beat, false},
    }};
}

// Limits are what a sound device on any crane can say, not what this crane should do: a slack line's load pin reads a
// little below zero, a spool overshoots its travel.
std::array<SignalRow, signal_count> signal_rows(double travel_m) {
    using enum Signal;
    using enum RawType;
    using M = Message;
    constexpr auto no_sensor = plant::sensor_count;
    const double spool_m_per_raw = travel_m / static_cast<double>(valve_full_scale_raw);
    return {{
        {strain_lower, "strain_lower", M::strain_tpdo1, 0x7130, 1, i16, 0, "microstrain", 0.1, -3200.0, 3200.0,
         plant::strain_lower_microstrain, strain_lower_status},
        {strain_upper, "strain_upper", M::strain_tpdo1, 0x7130, 2, i16, 2, "microstrain", 0.1, -3200.0, 3200.0,
         plant::strain_upper_microstrain, strain_upper_status},
        {strain_lower_status, "strain_lower_status", M::strain_tpdo1, 0x6150, 1, u8, 4, "", 1.0, 0.0, 255.0, no_sensor,
         none},
        {strain_upper_status, "strain_upper_status", M::strain_tpdo1, 0x6150, 2, u8, 5, "", 1.0, 0.0, 255.0, no_sensor,
         none},
        {boom_angle, "boom_angle", M::boom_angle_tpdo1, 0x6110, 0, i32, 0, "rad", rad_per_millidegree,
         -90.0 * rad_per_deg, 120.0 * rad_per_deg, plant::boom_angle_rad, none},
        {line_tension, "line_tension", M::load_pin_tpdo1, 0x9130, 1, i32, 0, "N", 1.0, -1.0e5, 2.0e6,
         plant::line_tension_N, line_tension_status},
        {line_tension_status, "line_tension_status", M::load_pin_tpdo1, 0x6150, 1, u8, 4, "", 1.0, 0.0, 255.0,
         no_sensor, none},
        {line_angle, "line_angle", M::line_angle_tpdo1, 0x6110, 0, i32, 0, "rad", rad_per_millidegree,
         -90.0 * rad_per_deg, 90.0 * rad_per_deg, plant::line_angle_rad, none},
        {line_length, "line_length", M::drum_tpdo1, 0x6004, 0, u32, 0, "m", 1.0e-4, 0.0, 1000.0, plant::line_length_m,
         none},
        {valve_status_word, "valve_status_word", M::valve_tpdo1, 0x6041, 0, u16, 0, "", 1.0, 0.0, 65535.0, no_sensor,
         none},
        {spool, "spool", M::valve_tpdo1, 0x6301, 1, i16, 2, "m", spool_m_per_raw, -1.25 * travel_m, 1.25 * travel_m,
         plant::spool_m, none},
        {piston, "piston", M::valve_tpdo2, 0x2000, 1, i32, 0, "m", 1.0e-6, -1.0, 1.0, plant::piston_m, none},
        {load_pressure, "load_pressure", M::valve_tpdo2, 0x2000, 2, u16, 4, "Pa", 1.0e4, 0.0, 6.0e7,
         plant::load_pressure_Pa, none},
        {safety_inputs, "safety_inputs", M::safety_tpdo1, 0x6000, 1, u8, 0, "", 1.0, 0.0, 255.0, no_sensor, none},
        {safety_outputs, "safety_outputs", M::safety_rpdo1, 0x6200, 1, u8, 0, "", 1.0, 0.0, 255.0, no_sensor, none},
        {valve_control_word, "valve_control_word", M::valve_rpdo1, 0x6040, 0, u16, 0, "", 1.0, 0.0, 65535.0, no_sensor,
         none},
        {valve_set_point, "valve_set_point", M::valve_rpdo1, 0x6300, 1, i16, 2, "m", spool_m_per_raw, -travel_m,
         travel_m, no_sensor, none},
    }};
}

void check(const NetworkConfig& config) {
    if (!std::isfinite(config.spool_travel_m) || config.spool_travel_m <= 0.0 || config.spool_travel_m > 1.0) {
        throw std::invalid_argument("spool_travel_m = " + std::to_string(config.spool_travel_m) +
                                    ": allowed is above 0 up to 1");
    }
    if (config.period_ns < 100'000 || config.period_ns > 1'000'000'000) {
        throw std::invalid_argument("period_ns = " + std::to_string(config.period_ns) +
                                    ": allowed is 100000 to 1000000000");
    }
    switch (config.bit_rate_bit_s) {
        case 125'000:
        case 250'000:
        case 500'000:
        case 1'000'000:
            break;
        default:
            throw std::invalid_argument("bit_rate_bit_s = " + std::to_string(config.bit_rate_bit_s) +
                                        ": allowed is 125000, 250000, 500000 or 1000000");
    }
    std::array<bool, 128> taken{};
    for (std::size_t i = 0; i < device_count; ++i) {
        const auto node = config.node_ids[i];
        const auto complaint =
            "node id of " + std::string(name_of(static_cast<Device>(i))) + " = " + std::to_string(node) + ": ";
        if (node < 1 || node > 127) {
            throw std::invalid_argument(complaint + "allowed is 1 to 127");
        }
        if (taken[node]) {
            throw std::invalid_argument(complaint + "another device has it already");
        }
        taken[node] = true;
    }
}

}  // namespace

DeviceTable::DeviceTable(const NetworkConfig& config)
    : config_((check(config), config)), messages_(message_rows()), signals_(signal_rows(config.spool_travel_m)) {
    by_id_.fill(Message::none);
    for (auto& row : messages_) {
        row.id = row.function_code + (row.node_in_id ? node_id(row.device) : 0U);
        by_id_[row.id] = row.message;
    }
}

CanFrame DeviceTable::blank(Message message, std::int64_t now_ns) const noexcept {
    CanFrame frame;
    frame.id = row(message).id;
    frame.length = row(message).length_bytes;
    frame.stamp_ns = now_ns;
    return frame;
}

std::string_view name_of(Device device) noexcept {
    constexpr std::array<std::string_view, device_count> names = {
        "controller",        "strain_link",  "boom_inclinometer", "load_pin",
        "hook_inclinometer", "drum_encoder", "servo_valve",       "safety_io",
    };
    return index_of(device) < device_count ? names[index_of(device)] : "unknown";
}

BusLoad bus_load(const NetworkConfig& config) {
    const DeviceTable table(config);
    BusLoad load;
    for (const auto& row : table.messages()) {
        if (row.cycle == Cycle::on_demand) {
            continue;
        }
        const auto interval_ns = row.cycle == Cycle::heartbeat ? heartbeat_interval_ns : config.period_ns;
        const double share_per_bit = 1.0e9 / static_cast<double>(interval_ns) / config.bit_rate_bit_s;
        load.nominal_share += nominal_frame_bits(row.length_bytes) * share_per_bit;
        load.worst_case_share += worst_case_frame_bits(row.length_bytes) * share_per_bit;
    }
    return load;
}

}  // namespace steadyboom::drivers
