#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/can_frame.hpp"

namespace steadyboom::drivers {

/// What is wrong with a bus, as far as its last call could tell.
enum class BusError : std::uint8_t {
    none,
    no_room,  ///< the transmit queue is full (ENOBUFS, EAGAIN): a pulled cable shows like this
    down,     ///< the interface is down (ENETDOWN)
    gone,     ///< the interface was deleted or unplugged (ENXIO, ENODEV): reopen
    other,
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
    std::uint64_t received_frames = 0;        ///< error messages included
    std::uint64_t sent_frames = 0;
    std::uint64_t send_dropped_frames = 0;
    std::uint64_t receive_overflow_frames = 0;  ///< came in while the receive buffer was full
    std::uint64_t malformed_frames = 0;         ///< received with a length that no CAN frame has
    std::uint64_t error_frames = 0;             ///< error messages of the interface
    std::uint64_t local_frames = 0;             ///< came from this machine (MSG_DONTROUTE): on a physical bus, a spoof
    std::uint64_t receive_errors = 0;           ///< calls that ended in an error
    std::uint64_t send_errors = 0;
};

/// Lets frames through whose 11-bit identifier equals `id`. Extended and remote twins come through too, so that the
/// receiver can count them.
struct CanFilter {
    std::uint32_t id = 0;
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
