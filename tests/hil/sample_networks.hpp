#pragma once

#include "drivers/network_config.hpp"

namespace steadyboom::hil {

/// No device with counter and checksum, as bought ones are.
inline drivers::NetworkConfig unprotected_network() {
    drivers::NetworkConfig config;
    for (auto& device : config.devices) {
        device.protection = drivers::Protection::none;
    }
    return config;
}

/// Devices that differ from the virtual crane's in all that a network file can say.
inline drivers::NetworkConfig foreign_network() {
    using drivers::Signal;
    drivers::NetworkConfig config;
    auto& inclinometer = config[drivers::Device::boom_inclinometer];
    inclinometer.node_id = 0x0A;
    inclinometer.protection = drivers::Protection::none;
    inclinometer.heartbeat_ms = 0;
    inclinometer.heartbeat_timeout_ms = 0;
    config[drivers::Pdo::boom_angle].number = 3;
    config[drivers::Pdo::boom_angle].transmission = drivers::Transmission::event;
    config[drivers::Pdo::boom_angle].event_ms = 4;
    auto& angle = config[Signal::boom_angle];
    angle.type = drivers::RawType::i16;
    angle.byte_order = drivers::ByteOrder::big_endian;
    angle.byte_offset = 3;
    angle.scale = -0.01;
    angle.offset = 90.0;
    auto& tension = config[Signal::line_tension];
    tension.byte_order = drivers::ByteOrder::big_endian;
    tension.unit = drivers::Unit::kN;
    tension.scale = 0.001;
    tension.lowest = -100.0;
    tension.highest = 2000.0;
    config[Signal::valve_status_word].byte_order = drivers::ByteOrder::big_endian;
    config[Signal::valve_control_word].byte_order = drivers::ByteOrder::big_endian;
    config[Signal::valve_set_point].byte_order = drivers::ByteOrder::big_endian;
    config[Signal::load_pressure].mapped = false;
    config[Signal::cutoff_open].bit = 6;
    return config;
}

/// The valve of docs/j1939-valve.md.
inline drivers::NetworkConfig j1939_network() {
    using drivers::Pdo;
    using drivers::Signal;
    drivers::NetworkConfig config;
    auto& valve = config[drivers::Device::servo_valve];
    valve.profile = drivers::ValveProfile::j1939;
    valve.protection = drivers::Protection::none;
    valve.canopen = false;
    valve.configure = false;
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
    return config;
}

}  // namespace steadyboom::hil
