#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/can_bus.hpp"
#include "drivers/can_frame.hpp"
#include "drivers/command_guard.hpp"
#include "drivers/device_table.hpp"
#include "drivers/network_manager.hpp"
#include "drivers/protection.hpp"
#include "drivers/sample_check.hpp"
#include "drivers/valve_driver.hpp"
#include "plant/crane_measurement.hpp"

namespace steadyboom::drivers {

/// What the controller's side of the network has seen. Counters are since construction.
struct NetworkStatus {
    std::uint64_t accepted_frames = 0;
    std::uint64_t unknown_id_frames = 0;  ///< no device sends this identifier
    std::uint64_t wrong_length_frames = 0;
    std::uint64_t remote_or_extended_frames = 0;
    std::uint64_t error_frames = 0;            ///< the interface's error messages
    std::uint32_t last_error_class = 0;        ///< identifier of the newest one (linux/can/error.h)
    std::uint64_t superseded_frames = 0;       ///< followed by a newer one of the same message in the same tick
    std::uint64_t rejected_frames = 0;         ///< wrong checksum, counter or repetition of a protected message
    std::uint64_t late_frames = 0;             ///< answers to a SYNC of more than two ticks ago
    std::uint64_t unbelieved_frames = 0;       ///< good, but of a message that is not yet or no longer valid
    std::uint64_t out_of_range_values = 0;     ///< beyond the table's limits, "no value" codes, unknown states
    std::uint64_t implausible_values = 0;      ///< out of range, or further from the last one than physics allows
    std::uint64_t faulty_values = 0;           ///< the device itself says that the sample is not good
    std::uint64_t not_operational_frames = 0;  ///< process data of a device that the manager has not started
};

/// The controller's side of the network: frames to a measurement, a guarded command to frames. One decode() and then
/// one encode() make a tick. Allocates nothing after construction.
class CraneNetwork {
  public:
    /// Throws std::invalid_argument as DeviceTable does, and when the worst-case bus load is above 70 %.
    explicit CraneNetwork(const NetworkConfig& config);

    /// Takes only frames whose identifier, length and type are a device's; of a protected message those alone whose
    /// checksum, counter and data id are right, and only while the message as a whole is valid (ProtectedReceiver). The
    /// newest sample of each message wins. A value out of range or too far from the last one is passed over twice
    /// (SampleCheck); one that its device calls faulty makes the channel invalid at once. An invalid channel keeps its
    /// last good value. Ages are in calls of decode(). The stamp is the time of the last encode(): the SYNC on which
    /// the samples were taken. Process data count only from devices that the manager has brought to operational.
    [[nodiscard]] plant::CraneMeasurement decode(std::span<const CanFrame> frames, std::int64_t now_ns) noexcept;

    /// Frames of this tick, in this order: at most one of the manager's, cut-off output, the valve's command, its twin
    /// if it is protected, SYNC. Never more than DeviceTable::most_frames_a_tick(). Valid until the next call.
    [[nodiscard]] std::span<const CanFrame> encode(const GuardedCommand& command, std::int64_t now_ns) noexcept;

    [[nodiscard]] const NetworkStatus& status() const noexcept { return status_; }
    [[nodiscard]] const DeviceTable& table() const noexcept { return *table_; }
    [[nodiscard]] const ValveStatus& valve() const noexcept { return valve_->status(); }
    [[nodiscard]] const NodeStatus& node(Device device) const noexcept { return manager_->status(device); }
    [[nodiscard]] const NetworkManager& manager() const noexcept { return *manager_; }

    /// How far a device's PDO is believed; a message without protection is always valid.
    [[nodiscard]] ReceiverState state(Pdo pdo) const noexcept;
    /// Ticks that the newest answer of a protected message lay behind the newest SYNC when it was decoded, 0 at best.
    [[nodiscard]] std::uint8_t lag_ticks(Pdo pdo) const noexcept;
    /// Of a protected message from a device; nothing else.
    [[nodiscard]] const std::optional<ProtectedReceiver>& receiver(Pdo pdo) const noexcept {
        return inputs_[index_of(pdo)].receiver;
    }

    /// Identifiers that decode() takes, for the kernel.
    [[nodiscard]] std::vector<CanFilter> filters() const;

    /// Of one encode() at most; DeviceTable::most_frames_a_tick() says how many of a given network.
    static constexpr std::size_t most_frames = 5;

  private:
    /// What comes in of one PDO.
    struct Input {
        std::optional<ProtectedReceiver> receiver;
        const CanFrame* newest = nullptr;  ///< of this tick
        bool poor_quality = false;         ///< its sender distrusts it
        std::uint8_t lag_ticks = 0;
    };
    [[nodiscard]] Message accepted_message(const CanFrame& frame) noexcept;
    void decode_heartbeat(Device device, std::uint8_t state_raw, std::int64_t now_ns) noexcept;
    void take_pdo(const MessageRow& row, const CanFrame& frame) noexcept;
    void close_pdo(const MessageRow& row) noexcept;
    void decode_pdo(const MessageRow& row, const CanFrame& frame, bool poor_quality) noexcept;
    void decode_sensor(const SignalRow& row, const CanFrame& frame, bool poor_quality) noexcept;
    void disbelieve(const MessageRow& row) noexcept;
    void append(const CanFrame& frame) noexcept { frames_[frame_count_++] = frame; }

    std::unique_ptr<DeviceTable> table_;  ///< where it stays: the next two refer to it
    std::unique_ptr<NetworkManager> manager_;
    std::unique_ptr<ValveDriver> valve_;
    NetworkStatus status_;
    plant::CraneMeasurement measurement_;
    std::array<Input, pdo_count> inputs_;
    std::array<SampleCheck, plant::sensor_count> checks_;
    std::uint64_t tick_ = 0;
    std::int64_t sync_stamp_ns_ = 0;
    std::uint8_t sync_counter_ = 0;
    std::array<CanFrame, most_frames> frames_;
    std::size_t frame_count_ = 0;
};

}  // namespace steadyboom::drivers
