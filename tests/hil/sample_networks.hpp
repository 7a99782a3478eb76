#pragma once

#include "drivers/network_config.hpp"
#include "tests/support/j1939_network.hpp"

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
    drivers::NetworkConfig config;
    test_support::make_valve_j1939(config);
    return config;
}

}  // namespace steadyboom::hil
