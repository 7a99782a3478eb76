#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/can_bus.hpp"
#include "drivers/can_frame.hpp"
#include "drivers/cia408.hpp"
#include "drivers/device_table.hpp"
#include "drivers/emcy.hpp"
#include "drivers/inverted_twin.hpp"
#include "drivers/j1939_valve.hpp"
#include "drivers/protection.hpp"
#include "drivers/sdo_server.hpp"
#include "plant/crane_measurement.hpp"

namespace steadyboom::drivers {

/// What the valve and the cut-off output were last told.
struct ValveOrder {
    std::uint16_t control_word = 0;  ///< ControlBit bits; 0 before the first order
    double set_point_m = 0.0;        ///< at most the spool's travel
    std::int64_t stamp_ns = 0;       ///< when the last valve order came
    bool ever = false;               ///< a valve order came since the valve started
    bool cutoff_energised = false;
    std::int64_t cutoff_stamp_ns = 0;  ///< when the last cut-off order came
    bool cutoff_ever = false;
};

/// What the valve and the safety inputs report beside the sensors.
struct ValveFeedback {
    ValveStatus status;
    bool cutoff_open = false;
    bool emergency_stop_healthy = true;
};

/// Counters since construction.
struct DeviceNetworkStatus {
    std::uint64_t accepted_frames = 0;
    std::uint64_t unknown_id_frames = 0;
    std::uint64_t wrong_length_frames = 0;
    std::uint64_t remote_or_extended_frames = 0;
    std::uint64_t error_frames = 0;
    std::uint64_t not_operational_frames = 0;  ///< process data for a node that is not operational
    std::uint64_t unknown_orders = 0;          ///< NMT commands that mean nothing
    std::uint64_t lost_replies = 0;            ///< more SDO answers and emergencies than fit between two sends
    std::uint64_t rejected_orders = 0;         ///< wrong checksum or counter, twin missing or not the inverse
};

/// The crane's side of the network: all its devices in one object, each with an NMT state and an object dictionary of
/// its own: 1000h, 1001h, 1017h, 1018h, the communication parameters of its PDOs, and the valve's 1400h:05, its command
/// timeout. A device that the manager may configure comes as bought ones often do: heartbeat off, PDOs on no SYNC.
/// Allocates nothing after construction. A round is receive(), then housekeeping(), then answer_sync() if
/// sync_pending() or timer_due().
class DeviceNetwork {
  public:
    /// Throws std::invalid_argument as DeviceTable does.
    explicit DeviceNetwork(const NetworkConfig& config);

    /// Obeys NMT, takes orders (operational nodes only), notes SYNC. Orders to a protected device count only while
    /// their message is valid (ProtectedReceiver, whose ticks end with SYNC), the valve's only together with their
    /// twin.
    void receive(std::span<const CanFrame> frames, std::int64_t now_ns) noexcept;

    [[nodiscard]] const ValveOrder& valve_order() const noexcept { return order_; }
    [[nodiscard]] bool sync_pending() const noexcept { return sync_pending_; }
    [[nodiscard]] std::uint8_t sync_counter() const noexcept { return sync_counter_; }

    /// TPDOs of every operational node that is not silent, each if it is due, by SYNC or by its timer; values rounded
    /// to the bus's resolution; beyond a channel's range its status byte says overflow or underflow. Valid until the
    /// next call.
    [[nodiscard]] std::span<const CanFrame> answer_sync(const plant::SensorVector& sensors,
                                                        const ValveFeedback& feedback, std::int64_t now_ns) noexcept;

    /// Some PDO's event timer has run out.
    [[nodiscard]] bool timer_due(std::int64_t now_ns) const noexcept;

    /// A device finds something wrong with itself, or well again: an emergency message when that changes.
    void set_fault(Device device, std::uint16_t fault_code, bool present) noexcept;

    /// Entry of a device's object dictionary; null if it has none such. For fault injection.
    [[nodiscard]] ObjectEntry* object(Device device, ObjectAddress address) noexcept;

    /// Boot-up messages first, then heartbeats by 1017h, SDO answers, emergency messages. Valid until the next call.
    [[nodiscard]] std::span<const CanFrame> housekeeping(std::int64_t now_ns) noexcept;

    [[nodiscard]] NodeState state(Device device) const noexcept { return nodes_[index_of(device)].state; }
    [[nodiscard]] const DeviceNetworkStatus& status() const noexcept { return status_; }
    [[nodiscard]] const DeviceTable& table() const noexcept { return table_; }

    /// Identifiers that receive() takes, for the kernel.
    [[nodiscard]] std::vector<CanFilter> filters() const;

    /// A silent device sends nothing at all, but still listens.
    void set_silent(Device device, bool silent) noexcept { nodes_[index_of(device)].silent = silent; }

    /// Keeps back the PDO that carries this channel, and so every other channel in it.
    void set_silent(plant::Sensor sensor, bool silent) noexcept;

    /// Power off and on: the node forgets its orders and boots again.
    void restart(Device device) noexcept;

  private:
    struct Node {
        NodeState state = NodeState::boot_up;  ///< boot_up until its boot-up message has left
        bool silent = false;
        std::int64_t next_heartbeat_ns = 0;
        std::vector<ObjectEntry> dictionary;
        std::optional<SdoServer> server;
        std::uint16_t emergency_code = 0;  ///< of the fault that it has told of
    };

    [[nodiscard]] std::vector<ObjectEntry> dictionary_of(Device device) const;
    [[nodiscard]] std::uint32_t object_raw(Device device, ObjectAddress address) const noexcept;
    [[nodiscard]] std::int64_t event_interval_ns(Pdo pdo) const noexcept;
    [[nodiscard]] bool due(const MessageRow& row, bool synchronous, std::int64_t now_ns) noexcept;
    void reply(const CanFrame& frame) noexcept;
    void answer_sdo(Device device, const CanFrame& frame, std::int64_t now_ns) noexcept;
    [[nodiscard]] Message accepted_message(const CanFrame& frame) noexcept;
    void obey_nmt(const CanFrame& frame) noexcept;
    void obey_nmt(Device device, NmtCommand command) noexcept;
    [[nodiscard]] bool believed(const MessageRow& row, const CanFrame& frame) noexcept;
    void take_order(const MessageRow& row, const CanFrame& frame, std::int64_t now_ns) noexcept;
    void take_valve_order(const CanFrame& frame, std::int64_t now_ns) noexcept;
    void forget_orders(Device device) noexcept;
    [[nodiscard]] bool operational(Device device) const noexcept { return state(device) == NodeState::operational; }

    DeviceTable table_;
    DeviceNetworkStatus status_;
    std::array<Node, device_count> nodes_;  ///< the controller's entry is unused
    std::array<bool, message_count> message_silent_{};
    std::array<std::optional<ProtectedReceiver>, pdo_count> receivers_;  ///< of the protected RPDOs
    InvertedTwin twin_;
    std::optional<J1939Port> j1939_;  ///< of a valve of that profile
    ValveOrder order_;
    bool sync_pending_ = false;
    std::uint8_t sync_counter_ = 0;
    std::array<CanFrame, message_count> answers_;
    std::array<std::int64_t, pdo_count> next_event_ns_{};  ///< of the PDOs sent by timer
    std::array<CanFrame, 64> outbox_;
    std::array<CanFrame, 32> replies_;  ///< SDO answers and emergency messages that wait for the next send
    std::size_t reply_count_ = 0;
};

}  // namespace steadyboom::drivers
