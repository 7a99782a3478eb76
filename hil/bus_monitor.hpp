#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "drivers/can_frame.hpp"
#include "drivers/device_table.hpp"
#include "drivers/emcy.hpp"
#include "drivers/protection.hpp"
#include "hil/message_fields.hpp"

namespace steadyboom::hil {

/// What was seen of one message.
struct MessageTraffic {
    std::uint64_t frames = 0;  ///< wrong lengths not counted
    std::int64_t first_ns = 0;
    drivers::CanFrame newest;
    std::uint64_t wrong_length_frames = 0;
    std::uint64_t out_of_range_values = 0;
    std::uint64_t faulty_values = 0;                     ///< the device's status byte says so
    std::optional<drivers::ProtectedReceiver> receiver;  ///< of protected messages
    double recent_rate_Hz = 0.0;                         ///< in the last window that was closed

    /// Over the whole time; 0 with fewer than two frames.
    [[nodiscard]] double mean_rate_Hz() const noexcept;

  private:
    friend class BusMonitor;
    std::uint64_t frames_before_window_ = 0;
};

/// What was seen of one device beside its messages.
struct DeviceTraffic {
    drivers::NodeState state = drivers::NodeState::unknown;
    std::uint64_t boot_ups = 0;
    std::uint64_t emergencies = 0;
    drivers::Emergency last_emergency;
    std::int64_t last_emergency_ns = 0;
};

/// Looks at a bus and takes no part in it: every frame decoded by the one table, and what is wrong counted. Time is
/// what the frames' stamps say.
class BusMonitor {
  public:
    static constexpr std::size_t most_unknown_ids = 1000;  ///< counted apart; further ones only in the sum

    explicit BusMonitor(drivers::DeviceTable table);

    void take(const drivers::CanFrame& frame);
    void take_fd_frame(std::int64_t stamp_ns) noexcept;

    /// Ends a window for rates and bus load and begins the next.
    void close_window(std::int64_t now_ns) noexcept;

    [[nodiscard]] const drivers::DeviceTable& table() const noexcept { return table_; }
    [[nodiscard]] const MessageTraffic& traffic(drivers::Message message) const noexcept {
        return messages_[index_of(message)];
    }
    [[nodiscard]] const DeviceTraffic& traffic(drivers::Device device) const noexcept {
        return devices_[index_of(device)];
    }
    [[nodiscard]] const std::vector<MessageField>& fields(drivers::Message message) const noexcept {
        return fields_[index_of(message)];
    }
    [[nodiscard]] std::int64_t raw(const MessageField& field, const drivers::CanFrame& frame) const noexcept;

    [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }  ///< error messages not counted
    [[nodiscard]] std::uint64_t unknown_id_frames() const noexcept { return unknown_id_frames_; }
    [[nodiscard]] std::uint64_t remote_frames() const noexcept { return remote_frames_; }
    [[nodiscard]] std::uint64_t fd_frames() const noexcept { return fd_frames_; }
    [[nodiscard]] std::uint64_t error_frames() const noexcept { return error_frames_; }
    [[nodiscard]] const drivers::CanFrame& last_error_frame() const noexcept { return last_error_frame_; }

    /// Frames by (29-bit, identifier) that the table does not have.
    [[nodiscard]] const std::map<std::pair<bool, std::uint32_t>, std::uint64_t>& unknown_ids() const noexcept {
        return unknown_ids_;
    }

    [[nodiscard]] std::int64_t first_ns() const noexcept { return first_ns_; }
    [[nodiscard]] std::int64_t last_ns() const noexcept { return last_ns_; }

    /// Share of the bus that all frames took, without stuff bits: over the whole time, and in the last window.
    [[nodiscard]] double mean_load_share() const noexcept;
    [[nodiscard]] double recent_load_share() const noexcept { return recent_load_share_; }
    [[nodiscard]] double mean_rate_Hz() const noexcept;
    [[nodiscard]] double recent_rate_Hz() const noexcept { return recent_rate_Hz_; }

  private:
    void note_time(std::int64_t stamp_ns) noexcept;
    void note_service(const drivers::MessageRow& row, const drivers::CanFrame& frame) noexcept;
    void check_values(const drivers::MessageRow& row, const drivers::CanFrame& frame, MessageTraffic& traffic) noexcept;

    drivers::DeviceTable table_;
    std::array<MessageTraffic, drivers::message_count> messages_;
    std::array<std::vector<MessageField>, drivers::message_count> fields_;
    std::array<DeviceTraffic, drivers::device_count> devices_;
    std::map<std::pair<bool, std::uint32_t>, std::uint64_t> unknown_ids_;
    std::uint64_t frames_ = 0;
    std::uint64_t unknown_id_frames_ = 0;
    std::uint64_t remote_frames_ = 0;
    std::uint64_t fd_frames_ = 0;
    std::uint64_t error_frames_ = 0;
    drivers::CanFrame last_error_frame_;
    std::uint64_t bits_ = 0;  ///< without stuff bits
    std::int64_t first_ns_ = 0;
    std::int64_t last_ns_ = 0;
    bool any_ = false;
    std::int64_t window_begin_ns_ = 0;
    bool window_begun_ = false;
    std::uint64_t frames_before_window_ = 0;
    std::uint64_t bits_before_window_ = 0;
    double recent_load_share_ = 0.0;
    double recent_rate_Hz_ = 0.0;
};

}  // namespace steadyboom::hil
