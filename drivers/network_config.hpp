#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace steadyboom::drivers {

/// What sits on the bus. The controller comes first, the crane's devices follow.
enum class Device : std::uint8_t {
    controller,         ///< CiA 301: NMT manager, SYNC producer
    strain_link,        ///< CiA 404: bending strain at both boom joints
    boom_inclinometer,  ///< CiA 410
    load_pin,           ///< CiA 404
    hook_inclinometer,  ///< CiA 410: angle of the load line
    drum_encoder,       ///< CiA 406
    servo_valve,        ///< CiA 408, with the piston's transducer
    safety_io,          ///< CiA 401: cut-off valve, emergency stop
};
inline constexpr std::size_t device_count = 8;

/// The process data objects, by what is in them.
enum class Pdo : std::uint8_t {
    strain,         ///< from the strain link
    boom_angle,     ///< from the boom inclinometer
    load_pin,       ///< from the load pin
    line_angle,     ///< from the hook inclinometer
    drum,           ///< from the drum encoder
    valve_status,   ///< from the servo valve: status word, spool
    valve_piston,   ///< from the servo valve: piston, load pressure
    safety_inputs,  ///< from the safety inputs
    safety_outputs,
    valve_command,
    valve_twin,  ///< valve_command with every bit of its data inverted; there only if the valve is protected
};
inline constexpr std::size_t pdo_count = 11;
inline constexpr std::size_t tpdo_count = 8;  ///< the first ones, which devices send

/// Every process value inside the PDOs.
enum class Signal : std::uint8_t {
    strain_lower,
    strain_upper,
    strain_lower_status,
    strain_upper_status,
    boom_angle,
    line_tension,
    line_tension_status,
    line_angle,
    line_length,
    valve_status_word,
    spool,
    piston,
    load_pressure,
    cutoff_open,
    emergency_stop_healthy,
    cutoff_energised,
    valve_control_word,
    valve_set_point,
    none,  ///< no signal of the table
};
inline constexpr std::size_t signal_count = static_cast<std::size_t>(Signal::none);

template <typename Enum>
[[nodiscard]] constexpr std::size_t index_of(Enum value) noexcept {
    return static_cast<std::size_t>(value);
}

/// Lower-case names as configuration, logs and the DBC spell them ("strain_link", "valve_status", "boom_angle").
[[nodiscard]] std::string_view name_of(Device device) noexcept;
[[nodiscard]] std::string_view name_of(Pdo pdo) noexcept;
[[nodiscard]] std::string_view name_of(Signal signal) noexcept;

/// Whether a device's PDOs end with a counter and a CRC (drivers/protection.hpp), or it cannot do that.
enum class Protection : std::uint8_t { none, e2e };

/// How the servo valve is spoken to.
enum class ValveProfile : std::uint8_t {
    cia408,  ///< control word, status word
    j1939,   ///< ISO 11783-7 auxiliary valve command and estimated flow (docs/j1939-valve.md)
};

/// When a device sends a PDO.
enum class Transmission : std::uint8_t {
    sync,   ///< transmission type 1: on each SYNC
    event,  ///< transmission type 255 with the event timer
};

enum class RawType : std::uint8_t { bit, u8, u16, i16, u32, i32 };
enum class ByteOrder : std::uint8_t { little_endian, big_endian };

/// Units that a device may be described in.
enum class Unit : std::uint8_t {
    none,
    microstrain,
    deg,
    rad,
    N,
    kN,
    m,
    mm,
    um,
    percent_of_travel,  ///< of the spool's
    Pa,
    bar,
    MPa,
};

struct DeviceConfig {
    std::uint8_t node_id = 0;                     ///< 1 to 127, all different
    ValveProfile profile = ValveProfile::cia408;  ///< of the servo valve only
    Protection protection = Protection::none;
    bool canopen = true;             ///< false: no NMT, SDO or heartbeat, nothing but its PDOs
    bool required = true;            ///< the crane is not ready before it is operational
    bool configure = true;           ///< the manager may write transmission, event timer and heartbeat time by SDO
    int heartbeat_ms = 100;          ///< producer time 1017h; 0: the device has none
    int heartbeat_timeout_ms = 0;    ///< consumer time: unheard for longer, it is lost; 0 exactly if heartbeat_ms is
    std::uint32_t device_type = 0;   ///< object 1000h as it must read; 0: not asked
    std::uint32_t vendor_id = 0;     ///< object 1018h:01; 0: not asked
    std::uint32_t product_code = 0;  ///< object 1018h:02; 0: not asked
};

struct PdoConfig {
    Device device = Device::controller;  ///< that sends or takes it; another than by default for sensors alone
    std::uint8_t number = 1;             ///< 1 to 4: TPDO1, RPDO1, ...; with the node id it makes the identifier
    std::uint32_t extended_id = 0;       ///< 29-bit identifier instead; 0: none
    std::uint8_t length_bytes = 0;       ///< without the protection's two bytes; 0: where its signals end
    std::uint16_t data_id = 0;  ///< what the CRC is taken over besides the frame; all different, unused by the twin
    Transmission transmission = Transmission::sync;  ///< of what a device sends
    int event_ms = 0;  ///< period of the event timer, at most one tick; 0 with Transmission::sync
};

/// Where a value lies in its PDO and what it means. All numbers are in `unit`: value = raw * scale + offset.
struct SignalConfig {
    bool mapped = true;  ///< false: the device does not send it
    std::uint16_t object = 0;
    std::uint8_t subindex = 0;
    RawType type = RawType::u8;
    std::uint8_t byte_offset = 0;
    std::uint8_t bit = 0;  ///< of that byte, 0 to 7; of RawType::bit only
    ByteOrder byte_order = ByteOrder::little_endian;
    Unit unit = Unit::none;
    double scale = 1.0;  ///< may be negative
    double offset = 0.0;
    double lowest = 0.0;  ///< what a sound device can say; beyond it a sample is bad
    double highest = 0.0;
    double fastest_1_s = 0.0;  ///< largest change in one second that physics allows; 0: not checked
};

/// Where the valve keeps the time after which it centres itself without commands, and the longest that is safe. The
/// object must hold 1 to `longest_raw`; 0 would mean that it never does.
struct ValveTimeoutConfig {
    std::uint16_t object = 0x1400;  ///< 0: not asked
    std::uint8_t subindex = 5;      ///< 1400h:05 is the event timer of RPDO1 in ms (CiA 301)
    std::uint32_t longest_raw = 25;
};

/// The network of one crane. Defaults are those of the virtual crane.
struct NetworkConfig {
    double spool_travel_m = 7.6e-3;          ///< opening at 100 % of travel
    std::int64_t period_ns = 5'000'000;      ///< one tick: SYNC to SYNC
    std::uint32_t bit_rate_bit_s = 500'000;  ///< 125 000, 250 000, 500 000 or 1 000 000
    ValveTimeoutConfig valve_timeout;
    std::array<DeviceConfig, device_count> devices = default_devices();
    std::array<PdoConfig, pdo_count> pdos = default_pdos();
    std::array<SignalConfig, signal_count> signals = default_signals();

    [[nodiscard]] DeviceConfig& operator[](Device device) noexcept { return devices[index_of(device)]; }
    [[nodiscard]] const DeviceConfig& operator[](Device device) const noexcept { return devices[index_of(device)]; }
    [[nodiscard]] PdoConfig& operator[](Pdo pdo) noexcept { return pdos[index_of(pdo)]; }
    [[nodiscard]] const PdoConfig& operator[](Pdo pdo) const noexcept { return pdos[index_of(pdo)]; }
    [[nodiscard]] SignalConfig& operator[](Signal signal) noexcept { return signals[index_of(signal)]; }
    [[nodiscard]] const SignalConfig& operator[](Signal signal) const noexcept { return signals[index_of(signal)]; }

    /// The same for all devices.
    void protect_all(Protection protection) noexcept;

    [[nodiscard]] static std::array<DeviceConfig, device_count> default_devices();
    [[nodiscard]] static std::array<PdoConfig, pdo_count> default_pdos();
    [[nodiscard]] static std::array<SignalConfig, signal_count> default_signals();
};

/// The device that sends or takes a PDO by default.
[[nodiscard]] Device default_device_of(Pdo pdo) noexcept;

/// What a PDO is, whatever the configuration: one with sensor values alone, which may come from any device; one that
/// the controller sends. And which PDO a signal is in.
[[nodiscard]] bool carries_sensors_alone(Pdo pdo) noexcept;
[[nodiscard]] bool from_controller(Pdo pdo) noexcept;
[[nodiscard]] Pdo pdo_of(Signal signal) noexcept;

/// Bits that a value takes in its PDO.
[[nodiscard]] constexpr std::uint8_t size_bits(RawType type) noexcept {
    constexpr std::array<std::uint8_t, 6> bits = {1, 8, 16, 16, 32, 32};
    return bits[index_of(type)];
}

/// "deg", "%"; empty for none.
[[nodiscard]] std::string_view name_of(Unit unit) noexcept;

/// Units in which this signal may be described.
[[nodiscard]] bool measures(Unit unit, Signal signal) noexcept;

}  // namespace steadyboom::drivers
