#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "drivers/can_frame.hpp"
#include "plant/crane_measurement.hpp"

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

/// Every message of the network, in the order of the table.
enum class Message : std::uint8_t {
    nmt,
    sync,
    strain_tpdo1,
    boom_angle_tpdo1,
    load_pin_tpdo1,
    line_angle_tpdo1,
    drum_tpdo1,
    valve_tpdo1,
    valve_tpdo2,
    safety_tpdo1,
    safety_rpdo1,
    valve_rpdo1,
    controller_heartbeat,
    strain_heartbeat,
    boom_angle_heartbeat,
    load_pin_heartbeat,
    line_angle_heartbeat,
    drum_heartbeat,
    valve_heartbeat,
    safety_heartbeat,
    none,  ///< no message of the table
};
inline constexpr std::size_t message_count = static_cast<std::size_t>(Message::none);

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
    safety_inputs,
    safety_outputs,
    valve_control_word,
    valve_set_point,
    none,  ///< no signal of the table
};
inline constexpr std::size_t signal_count = static_cast<std::size_t>(Signal::none);

template <typename Enum>
[[nodiscard]] constexpr std::size_t index_of(Enum value) noexcept {
    return static_cast<std::size_t>(value);
}

/// CiA 301 NMT command specifiers, first byte of the NMT message.
enum class NmtCommand : std::uint8_t {
    start = 0x01,
    stop = 0x02,
    enter_pre_operational = 0x80,
    reset_node = 0x81,
    reset_communication = 0x82,
};

/// CiA 301 NMT states as a heartbeat carries them.
enum class NodeState : std::uint8_t {
    boot_up = 0x00,
    stopped = 0x04,
    operational = 0x05,
    pre_operational = 0x7F,
    unknown = 0xFF,  ///< never heard
};

/// CiA 404 status byte 6150h.
enum class SampleStatus : std::uint8_t { ok = 0, overflow = 3, underflow = 5 };

inline constexpr std::int64_t heartbeat_interval_ns = 100'000'000;       ///< 1017h of every node
inline constexpr std::int64_t heartbeat_consumer_time_ns = 250'000'000;  ///< 1016h of every consumer
inline constexpr std::uint8_t sync_counter_last = 240;                   ///< 1019h; the counter runs from 1 to this
inline constexpr std::int64_t valve_full_scale_raw = 16384;              ///< CiA 408: 100 % of the spool's travel
inline constexpr std::uint8_t cutoff_bit = 0x01;                  ///< 6200h:01 energise cut-off, 6000h:01 cut-off open
inline constexpr std::uint8_t emergency_stop_healthy_bit = 0x02;  ///< 6000h:01

/// What differs from crane to crane. Defaults are the network's own.
struct NetworkConfig {
    /// Node id of each Device, 1 to 127, all different.
    std::array<std::uint8_t, device_count> node_ids = {0x01, 0x10, 0x14, 0x18, 0x19, 0x1C, 0x20, 0x28};
    double spool_travel_m = 7.6e-3;          ///< opening at a set-point of +-16384
    std::int64_t period_ns = 5'000'000;      ///< one tick: SYNC to SYNC
    std::uint32_t bit_rate_bit_s = 500'000;  ///< 125 000, 250 000, 500 000 or 1 000 000
};

enum class RawType : std::uint8_t { u8, u16, i16, u32, i32 };

/// When a message is sent.
enum class Cycle : std::uint8_t {
    every_tick,  ///< by the controller, each period
    on_sync,     ///< by a device, transmission type 1
    heartbeat,   ///< each heartbeat_interval_ns
    on_demand,
};

struct MessageRow {
    Message message = Message::none;
    std::string_view name;
    Device device = Device::controller;  ///< sends it (TPDO, heartbeat) or acts on it (RPDO)
    std::uint16_t function_code = 0;     ///< identifier without the node
    bool node_in_id = true;              ///< identifier is function code + node id
    std::uint8_t length_bytes = 0;       ///< exact; PDOs leave two bytes for a counter and a checksum
    Cycle cycle = Cycle::on_demand;
    bool from_controller = false;
    std::uint32_t id = 0;  ///< COB-ID on the bus
};

/// One process value: where it lies in its PDO and what it means. value = raw * scale, little-endian on the bus.
struct SignalRow {
    Signal signal = Signal::none;
    std::string_view name;
    Message message = Message::none;
    std::uint16_t object = 0;  ///< CANopen index
    std::uint8_t subindex = 0;
    RawType type = RawType::u8;
    std::uint8_t byte_offset = 0;
    std::string_view unit;     ///< unit of the value; "" for bit fields
    double scale_unit = 1.0;   ///< units per raw step
    double lowest_unit = 0.0;  ///< values outside [lowest, highest] are rejected on receipt
    double highest_unit = 0.0;
    plant::Sensor sensor = plant::sensor_count;  ///< channel it feeds, or sensor_count
    Signal status = Signal::none;                ///< its CiA 404 status byte, if the device has one
};

/// The one source of identifiers, lengths, scales, limits and cycles; built and checked once from the configuration.
class DeviceTable {
  public:
    /// Throws std::invalid_argument naming the field, its value and what is allowed.
    explicit DeviceTable(const NetworkConfig& config);

    [[nodiscard]] const NetworkConfig& config() const noexcept { return config_; }
    [[nodiscard]] const std::array<MessageRow, message_count>& messages() const noexcept { return messages_; }
    [[nodiscard]] const std::array<SignalRow, signal_count>& signals() const noexcept { return signals_; }
    [[nodiscard]] const MessageRow& row(Message message) const noexcept { return messages_[index_of(message)]; }
    [[nodiscard]] const SignalRow& row(Signal signal) const noexcept { return signals_[index_of(signal)]; }
    [[nodiscard]] std::uint8_t node_id(Device device) const noexcept { return config_.node_ids[index_of(device)]; }

    /// Message with this 11-bit identifier, or Message::none.
    [[nodiscard]] Message message_with(std::uint32_t id) const noexcept {
        return id < standard_id_count ? by_id_[id] : Message::none;
    }

    /// Empty frame of this message: identifier, length, zero data.
    [[nodiscard]] CanFrame blank(Message message, std::int64_t now_ns) const noexcept;

  private:
    NetworkConfig config_;
    std::array<MessageRow, message_count> messages_;
    std::array<SignalRow, signal_count> signals_;
    std::array<Message, standard_id_count> by_id_{};
};

/// Lower-case name of a device, as configuration and logs spell it ("strain_link").
[[nodiscard]] std::string_view name_of(Device device) noexcept;

/// Bits of an 11-bit frame on the wire, interframe space included, with no stuff bit.
[[nodiscard]] constexpr std::uint32_t nominal_frame_bits(std::uint32_t length_bytes) noexcept {
    return 47U + 8U * length_bytes;
}

/// The same with as many stuff bits as can be: 34 + 8 n bits are subject to stuffing, and after the first five every
/// fourth can bring one. 135 for 8 bytes.
[[nodiscard]] constexpr std::uint32_t worst_case_frame_bits(std::uint32_t length_bytes) noexcept {
    return nominal_frame_bits(length_bytes) + (34U + 8U * length_bytes - 1U) / 4U;
}

/// Share of the bus that the table's cyclic messages take, 1 being all of it.
struct BusLoad {
    double nominal_share = 0.0;     ///< without stuff bits
    double worst_case_share = 0.0;  ///< every frame with all the stuff bits it can have
};

inline constexpr double largest_bus_load_share = 0.70;  ///< worst case above which a configuration is refused

/// Throws as DeviceTable does.
[[nodiscard]] BusLoad bus_load(const NetworkConfig& config);

}  // namespace steadyboom::drivers
