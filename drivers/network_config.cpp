#include "drivers/network_config.hpp"

namespace steadyboom::drivers {
namespace {

struct PdoRow {
    std::string_view name;
    Device device;
    bool from_controller;
};
constexpr std::array<PdoRow, pdo_count> pdo_rows = {{
    {"strain", Device::strain_link, false},
    {"boom_angle", Device::boom_inclinometer, false},
    {"load_pin", Device::load_pin, false},
    {"line_angle", Device::hook_inclinometer, false},
    {"drum", Device::drum_encoder, false},
    {"valve_status", Device::servo_valve, false},
    {"valve_piston", Device::servo_valve, false},
    {"safety_inputs", Device::safety_io, false},
    {"safety_outputs", Device::safety_io, true},
    {"valve_command", Device::servo_valve, true},
    {"valve_twin", Device::servo_valve, true},
}};

enum class Quantity : std::uint8_t { none, strain, angle, force, length, opening, pressure };

struct NamedSignal {
    std::string_view name;
    Pdo pdo;
    Quantity quantity;
};
constexpr std::array<NamedSignal, signal_count> signal_rows = {{
    {"strain_lower", Pdo::strain, Quantity::strain},
    {"strain_upper", Pdo::strain, Quantity::strain},
    {"strain_lower_status", Pdo::strain, Quantity::none},
    {"strain_upper_status", Pdo::strain, Quantity::none},
    {"boom_angle", Pdo::boom_angle, Quantity::angle},
    {"line_tension", Pdo::load_pin, Quantity::force},
    {"line_tension_status", Pdo::load_pin, Quantity::none},
    {"line_angle", Pdo::line_angle, Quantity::angle},
    {"line_length", Pdo::drum, Quantity::length},
    {"valve_status_word", Pdo::valve_status, Quantity::none},
    {"spool", Pdo::valve_status, Quantity::opening},
    {"piston", Pdo::valve_piston, Quantity::length},
    {"load_pressure", Pdo::valve_piston, Quantity::pressure},
    {"cutoff_open", Pdo::safety_inputs, Quantity::none},
    {"emergency_stop_healthy", Pdo::safety_inputs, Quantity::none},
    {"cutoff_energised", Pdo::safety_outputs, Quantity::none},
    {"valve_control_word", Pdo::valve_command, Quantity::none},
    {"valve_set_point", Pdo::valve_command, Quantity::opening},
}};

constexpr std::array<std::string_view, device_count> device_names = {
    "controller",        "strain_link",  "boom_inclinometer", "load_pin",
    "hook_inclinometer", "drum_encoder", "servo_valve",       "safety_io",
};

struct UnitRow {
    std::string_view name;
    Quantity quantity;
};
constexpr std::array<UnitRow, 13> unit_rows = {{
    {"", Quantity::none},
    {"microstrain", Quantity::strain},
    {"deg", Quantity::angle},
    {"rad", Quantity::angle},
    {"N", Quantity::force},
    {"kN", Quantity::force},
    {"m", Quantity::length},
    {"mm", Quantity::length},
    {"um", Quantity::length},
    {"%", Quantity::opening},
    {"Pa", Quantity::pressure},
    {"bar", Quantity::pressure},
    {"MPa", Quantity::pressure},
}};

template <typename Enum, typename Rows>
std::string_view name_in(const Rows& rows, Enum value) noexcept {
    return index_of(value) < rows.size() ? rows[index_of(value)].name : "none";
}

}  // namespace

std::string_view name_of(Device device) noexcept {
    return index_of(device) < device_count ? device_names[index_of(device)] : "none";
}
std::string_view name_of(Pdo pdo) noexcept {
    return name_in(pdo_rows, pdo);
}
std::string_view name_of(Signal signal) noexcept {
    return name_in(signal_rows, signal);
}
std::string_view name_of(Unit unit) noexcept {
    return name_in(unit_rows, unit);
}

Device default_device_of(Pdo pdo) noexcept {
    return pdo_rows[index_of(pdo)].device;
}
bool carries_sensors_alone(Pdo pdo) noexcept {
    return !from_controller(pdo) && pdo != Pdo::valve_status && pdo != Pdo::safety_inputs;
}
bool from_controller(Pdo pdo) noexcept {
    return pdo_rows[index_of(pdo)].from_controller;
}
Pdo pdo_of(Signal signal) noexcept {
    return signal_rows[index_of(signal)].pdo;
}
bool measures(Unit unit, Signal signal) noexcept {
    const Quantity quantity = signal_rows[index_of(signal)].quantity;
    // The spool's own travel may be described by a length as well as by a share of it.
    return unit_rows[index_of(unit)].quantity == quantity ||
           (quantity == Quantity::opening && unit_rows[index_of(unit)].quantity == Quantity::length);
}

void NetworkConfig::protect_all(Protection protection) noexcept {
    for (auto& device : devices) {
        device.protection = protection;
    }
}

std::array<DeviceConfig, device_count> NetworkConfig::default_devices() {
    constexpr std::array<std::uint8_t, device_count> node_ids = {0x01, 0x10, 0x14, 0x18, 0x19, 0x1C, 0x20, 0x28};
    // Object 1000h: the profile's number in the low word.
    constexpr std::array<std::uint32_t, device_count> device_types = {0, 404, 410, 404, 410, 406, 408, 401};
    std::array<DeviceConfig, device_count> devices;
    for (std::size_t i = 0; i < device_count; ++i) {
        devices[i].node_id = node_ids[i];
        devices[i].device_type = device_types[i];
        devices[i].heartbeat_timeout_ms = 250;
        devices[i].protection = Protection::e2e;
    }
    devices[index_of(Device::drum_encoder)].required = false;  // the observer does without it
    return devices;
}

std::array<PdoConfig, pdo_count> NetworkConfig::default_pdos() {
    std::array<PdoConfig, pdo_count> pdos;
    for (std::size_t i = 0; i < pdo_count; ++i) {
        pdos[i].device = pdo_rows[i].device;
        pdos[i].data_id = static_cast<std::uint16_t>(0x5B00 + i);
    }
    pdos[index_of(Pdo::valve_piston)].number = 2;
    pdos[index_of(Pdo::valve_twin)].number = 2;
    return pdos;
}

// Limits are what a sound device on any crane can say, not what this crane should do: a slack line's load pin reads a
// little below zero, a spool overshoots its travel.
std::array<SignalConfig, signal_count> NetworkConfig::default_signals() {
    using enum RawType;
    constexpr auto little = ByteOrder::little_endian;
    constexpr double percent_a_step = 100.0 / 16384.0;  // CiA 408: 16384 is full travel
    return {{
        {true, 0x7130, 1, i16, 0, 0, little, Unit::microstrain, 0.1, 0.0, -3200.0, 3200.0, 2.0e5},
        {true, 0x7130, 2, i16, 2, 0, little, Unit::microstrain, 0.1, 0.0, -3200.0, 3200.0, 2.0e5},
        {true, 0x6150, 1, u8, 4, 0, little, Unit::none, 1.0, 0.0, 0.0, 255.0, 0.0},
        {true, 0x6150, 2, u8, 5, 0, little, Unit::none, 1.0, 0.0, 0.0, 255.0, 0.0},
        {true, 0x6110, 0, i32, 0, 0, little, Unit::deg, 1.0e-3, 0.0, -90.0, 120.0, 40.0},
        {true, 0x9130, 1, i32, 0, 0, little, Unit::N, 1.0, 0.0, -1.0e5, 2.0e6, 5.0e7},
        {true, 0x6150, 1, u8, 4, 0, little, Unit::none, 1.0, 0.0, 0.0, 255.0, 0.0},
        {true, 0x6110, 0, i32, 0, 0, little, Unit::deg, 1.0e-3, 0.0, -90.0, 90.0, 200.0},
        {true, 0x6004, 0, u32, 0, 0, little, Unit::m, 1.0e-4, 0.0, 0.0, 1000.0, 10.0},
        {true, 0x6041, 0, u16, 0, 0, little, Unit::none, 1.0, 0.0, 0.0, 65535.0, 0.0},
        {true, 0x6301, 1, i16, 2, 0, little, Unit::percent_of_travel, percent_a_step, 0.0, -125.0, 125.0, 0.0},
        {true, 0x2000, 1, i32, 0, 0, little, Unit::um, 1.0, 0.0, -1.0e6, 1.0e6, 2.0e6},
        {true, 0x2000, 2, u16, 4, 0, little, Unit::MPa, 0.01, 0.0, 0.0, 60.0, 2000.0},
        {true, 0x6000, 1, bit, 0, 0, little, Unit::none, 1.0, 0.0, 0.0, 1.0, 0.0},
        {true, 0x6000, 1, bit, 0, 1, little, Unit::none, 1.0, 0.0, 0.0, 1.0, 0.0},
        {true, 0x6200, 1, bit, 0, 0, little, Unit::none, 1.0, 0.0, 0.0, 1.0, 0.0},
        {true, 0x6040, 0, u16, 0, 0, little, Unit::none, 1.0, 0.0, 0.0, 65535.0, 0.0},
        {true, 0x6300, 1, i16, 2, 0, little, Unit::percent_of_travel, percent_a_step, 0.0, -100.0, 100.0, 0.0},
    }};
}

}  // namespace steadyboom::drivers
