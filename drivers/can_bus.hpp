#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/can_frame.hpp"

namespace steadyboom::drivers {

/// A control tick reads no more frames than this, and a receive buffer holds no more: whatever has piled up is gone
/// after one tick, and nothing stale waits for the next.
inline constexpr std::size_t most_frames_a_tick = 512;
/// More frames than this in one receive() is a flood; the crane's devices send some twenty a tick.
inline constexpr std::size_t flood_frames = 64;

/// What is wrong with a bus, as far as its last call could tell.
enum class BusError : std::uint8_t {
    none,
    no_room,  ///< the transmit queue is full (ENOBUFS, EAGAIN): a pulled cable shows like this
    down,     ///< the interface is down (ENETDOWN)
    gone,     ///< the interface was deleted or unplugged (ENXIO, ENODEV)
    other,
};

/// Fault confinement of the interface's CAN controller (ISO 11898-1). Severity rises.
enum class LinkState : std::uint8_t {
    active,
    warning,  ///< an error counter reached 96
    passive,  ///< an error counter reached 128: may no longer signal errors to others
    bus_off,  ///< off the bus until somebody restarts it; sends still seem to succeed
};

/// Outcome of one send. Frames are sent in order; the first that finds no room takes the rest with it, none is retried.
struct SendResult {
    std::size_t sent = 0;
    std::size_t dropped = 0;
    BusError error = BusError::none;
};

/// Counters since the bus was made. Nothing is ever dropped without one of them growing.
struct BusStatus {
    BusError receive_error = BusError::none;  ///< until the next frame comes in or a send succeeds
    BusError send_error = BusError::none;     ///< of the newest send
    int last_errno = 0;                       ///< errno behind the newest error, 0 if there was none

    /// As the newest error message tells; active again when the interface comes back, and when a frame from elsewhere
    /// comes in after bus-off.
    LinkState link = LinkState::active;
    std::uint8_t transmit_error_count = 0;  ///< of the controller, by the newest error message that had it
    std::uint8_t receive_error_count = 0;
    std::int64_t newest_kernel_stamp_ns = 0;  ///< wall-clock time of the newest frame's receipt, for records only

    std::uint64_t received_frames = 0;  ///< error messages included
    std::uint64_t sent_frames = 0;
    std::uint64_t send_dropped_frames = 0;
    std::uint64_t receive_overflow_frames = 0;  ///< came in while the receive buffer was full
    std::uint64_t malformed_frames = 0;         ///< received with a length that no CAN frame has
    std::uint64_t local_frames = 0;             ///< came from this machine
    std::uint64_t spoofed_frames = 0;           ///< the same where every sender is elsewhere: dropped
    std::uint64_t floods = 0;                   ///< calls of receive() that found more than flood_frames
    std::uint64_t receive_errors = 0;           ///< calls that ended in an error
    std::uint64_t send_errors = 0;
    std::uint64_t reopens = 0;  ///< sockets taken over after the interface was gone

    std::uint64_t error_frames = 0;  ///< error messages of the interface; of these:
    std::uint64_t bus_offs = 0;
    std::uint64_t passives = 0;
    std::uint64_t warnings = 0;
    std::uint64_t controller_overruns = 0;  ///< the interface itself lost frames
};

/// Lets frames through that have this identifier.
struct CanFilter {
    std::uint32_t id = 0;
    /// False: `id` has 11 bits, and extended and remote twins come through too, so that the receiver can count them.
    /// True: `id` has 29 bits; exactly the extended data frames with it.
    bool extended = false;
};

/// The seam between the product and whatever carries its frames. One thread uses one bus.
class CanBus {
  public:
    CanBus() = default;
    CanBus(const CanBus&) = delete;
    CanBus& operator=(const CanBus&) = delete;
    virtual ~CanBus() = default;

    /// Moves waiting frames into `into`, oldest first, and returns how many. Never blocks; frames beyond
    /// `into.size()` stay for the next call.
    virtual std::size_t receive(std::span<CanFrame> into) noexcept = 0;

    /// Sends in order, never blocks, never retries.
    virtual SendResult send(std::span<const CanFrame> frames) noexcept = 0;

    [[nodiscard]] virtual BusStatus status() const noexcept = 0;
};

}  // namespace steadyboom::drivers
