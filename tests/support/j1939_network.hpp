#pragma once

#include "drivers/network_config.hpp"

namespace steadyboom::test_support {

/// Makes the servo valve the one of docs/j1939-valve.md: valve 0 at address 0x20, led from address 0x26.
inline void make_valve_j1939(drivers::NetworkConfig& config) {
    using drivers::Pdo;
    using drivers::Signal;
    auto& valve = config[drivers::Device::servo_valve];
    valve.profile = drivers::ValveProfile::j1939;
    valve.protection = drivers::Protection::none;
    valve.canopen = valve.configure = false;
    valve.heartbeat_ms = valve.heartbeat_timeout_ms = 0;
    valve.device_type = 0;
    config[Pdo::valve_command].extended_id = 0x0CFE'3026;
    config[Pdo::valve_status].extended_id = 0x0CFE'1020;
    config[Pdo::valve_command].length_bytes = config[Pdo::valve_status].length_bytes = 8;
    config[Signal::valve_control_word].mapped = config[Signal::valve_status_word].mapped = false;
    for (const auto signal : {Signal::valve_set_point, Signal::spool}) {
        config[signal].type = drivers::RawType::u8;
        config[signal].byte_offset = 0;
    }
    config[Signal::valve_set_point].scale = 0.4;
    config[Signal::spool].scale = 1.0;
    config[Signal::spool].offset = -125.0;
}

}  // namespace steadyboom::test_support
