#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "drivers/can_frame.hpp"
#include "drivers/network_config.hpp"
#include "drivers/protection.hpp"
#include "plant/crane_measurement.hpp"

namespace steadyboom::drivers {

/// What a message is for (CiA 301).
enum class MessageKind : std::uint8_t { nmt, sync, pdo, heartbeat, emergency, sdo_request, sdo_answer };

/// Every message that the network can have, in the order of the table: NMT, SYNC, the PDOs in the order of Pdo, then
/// for each Device its heartbeat, emergency message, SDO request to it and SDO answer from it. A configuration may
/// leave some out (MessageRow::present).
enum class Message : std::uint8_t {
    nmt,
    sync,
    first_pdo,
    first_heartbeat = first_pdo + pdo_count,
    first_emergency = first_heartbeat + device_count,
    first_sdo_request = first_emergency + device_count,
    first_sdo_answer = first_sdo_request + device_count,
    none = first_sdo_answer + device_count,  ///< no message of the table
};
inline constexpr std::size_t message_count = static_cast<std::size_t>(Message::none);

[[nodiscard]] constexpr Message message_of(Pdo pdo) noexcept {
    return static_cast<Message>(index_of(Message::first_pdo) + index_of(pdo));
}
[[nodiscard]] constexpr Message heartbeat_of(Device device) noexcept {
    return static_cast<Message>(index_of(Message::first_heartbeat) + index_of(device));
}
[[nodiscard]] constexpr Message emergency_of(Device device) noexcept {
    return static_cast<Message>(index_of(Message::first_emergency) + index_of(device));
}
[[nodiscard]] constexpr Message sdo_request_to(Device device) noexcept {
    return static_cast<Message>(index_of(Message::first_sdo_request) + index_of(device));
}
[[nodiscard]] constexpr Message sdo_answer_of(Device device) noexcept {
    return static_cast<Message>(index_of(Message::first_sdo_answer) + index_of(device));
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

inline constexpr std::uint8_t sync_counter_last = 240;  ///< 1019h; the counter runs from 1 to this

/// When a message is sent.
enum class Cycle : std::uint8_t {
    every_tick,  ///< by the controller, each period
    on_sync,     ///< by a device, in answer to each SYNC
    timer,       ///< each interval_ns
    on_demand,
};

struct MessageRow {
    Message message = Message::none;
    std::string name;     ///< "strain_link_tpdo1", "load_pin_heartbeat"
    bool present = true;  ///< part of the network as it is configured
    MessageKind kind = MessageKind::nmt;
    Device device = Device::controller;  ///< sends it, or acts on it if it is from_controller
    Pdo pdo = Pdo::strain;               ///< of MessageKind::pdo only
    std::uint32_t id = 0;                ///< COB-ID on the bus
    bool extended = false;               ///< 29-bit identifier
    std::uint8_t length_bytes = 0;       ///< exact, protection included
    Cycle cycle = Cycle::on_demand;
    std::int64_t interval_ns = 0;  ///< of Cycle::timer
    bool from_controller = false;
    Protection protection = Protection::none;
    std::uint16_t data_id = 0;
};

/// One process value: where it lies in its PDO and what it means, in SI: value = raw * scale + offset.
struct SignalRow {
    Signal signal = Signal::none;
    std::string_view name;
    bool present = true;  ///< its device sends it
    Message message = Message::none;
    std::uint16_t object = 0;  ///< CANopen index
    std::uint8_t subindex = 0;
    RawType type = RawType::u8;
    std::uint8_t byte_offset = 0;
    std::uint8_t bit = 0;  ///< of that byte; of RawType::bit only
    ByteOrder byte_order = ByteOrder::little_endian;
    std::string_view unit;    ///< unit of the value here: "rad", "m", ...; "" for words and bits
    double scale_unit = 1.0;  ///< units per raw step, not 0
    double offset_unit = 0.0;
    double lowest_unit = 0.0;  ///< values outside [lowest, highest] are bad
    double highest_unit = 0.0;
    double largest_step_unit = 0.0;              ///< from one tick to the next; 0: not checked
    plant::Sensor sensor = plant::sensor_count;  ///< channel it feeds, or sensor_count
    Signal status = Signal::none;                ///< its CiA 404 status byte, if the device sends one
};

/// The one source of identifiers, lengths, scales, limits and cycles; built and checked once from the configuration.
class DeviceTable {
  public:
    /// Throws std::invalid_argument naming the key, its value and what is allowed. Keys are spelt as in a network file
    /// ("device.load_pin.node_id").
    explicit DeviceTable(const NetworkConfig& config);

    [[nodiscard]] const NetworkConfig& config() const noexcept { return config_; }
    [[nodiscard]] const DeviceConfig& config(Device device) const noexcept { return config_[device]; }
    [[nodiscard]] const std::array<MessageRow, message_count>& messages() const noexcept { return messages_; }
    [[nodiscard]] const std::array<SignalRow, signal_count>& signals() const noexcept { return signals_; }
    [[nodiscard]] const MessageRow& row(Message message) const noexcept { return messages_[index_of(message)]; }
    [[nodiscard]] const MessageRow& row(Pdo pdo) const noexcept { return row(message_of(pdo)); }
    [[nodiscard]] const SignalRow& row(Signal signal) const noexcept { return signals_[index_of(signal)]; }
    [[nodiscard]] std::uint8_t node_id(Device device) const noexcept { return config_[device].node_id; }

    /// Message with this identifier, or Message::none.
    [[nodiscard]] Message message_with(std::uint32_t id, bool extended = false) const noexcept;

    /// Empty frame of this message: identifier, length, zero data.
    [[nodiscard]] CanFrame blank(Message message, std::int64_t now_ns) const noexcept;

    /// Most frames that the controller sends in one tick: one for the network's management, the PDOs, SYNC. The
    /// interface's transmit queue should be as long.
    [[nodiscard]] std::size_t most_frames_a_tick() const noexcept;

  private:
    NetworkConfig config_;
    std::array<MessageRow, message_count> messages_;
    std::array<SignalRow, signal_count> signals_;
    std::array<Message, standard_id_count> by_id_{};
};

/// Bits of a frame on the wire, interframe space included, with no stuff bit.
[[nodiscard]] constexpr std::uint32_t nominal_frame_bits(std::uint32_t length_bytes, bool extended = false) noexcept {
    return (extended ? 67U : 47U) + 8U * length_bytes;
}

/// The same with as many stuff bits as can be: all but 13 bits are subject to stuffing, and after the first five every
/// fourth can bring one. 135 for 8 bytes and an 11-bit identifier.
[[nodiscard]] constexpr std::uint32_t worst_case_frame_bits(std::uint32_t length_bytes,
                                                            bool extended = false) noexcept {
    const std::uint32_t nominal_bits = nominal_frame_bits(length_bytes, extended);
    return nominal_bits + (nominal_bits - 13U - 1U) / 4U;
}

/// Share of the bus that the table's messages take, 1 being all of it.
struct BusLoad {
    double nominal_share = 0.0;     ///< the cyclic messages, without stuff bits
    double worst_case_share = 0.0;  ///< with all the stuff bits they can have, and an SDO request and answer each tick
};

inline constexpr double largest_bus_load_share = 0.70;  ///< worst case above which a configuration is refused

[[nodiscard]] BusLoad bus_load(const DeviceTable& table) noexcept;

}  // namespace steadyboom::drivers
