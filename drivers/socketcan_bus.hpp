#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/can_bus.hpp"

namespace steadyboom::drivers {

struct SocketCanOptions {
    std::vector<CanFilter> filters = {};  ///< in the kernel; empty lets everything through
    bool error_messages = true;           ///< deliver the interface's error messages as frames with `error` set
    /// Asked of SO_RCVBUFFORCE, else of SO_RCVBUF (then cut to net.core.rmem_max). The kernel's default holds 278
    /// frames.
    int receive_buffer_bytes = 4 * 1024 * 1024;
};

/// A Linux CAN interface through one non-blocking CAN_RAW socket. Every failure after construction is a value in
/// BusStatus or SendResult. Stamps are CLOCK_MONOTONIC at the moment of receive().
class SocketCanBus final : public CanBus {
  public:
    /// Throws std::runtime_error that names the interface and the remedy.
    explicit SocketCanBus(std::string interface, SocketCanOptions options = {});
    ~SocketCanBus() override;

    std::size_t receive(std::span<CanFrame> into) noexcept override;
    SendResult send(std::span<const CanFrame> frames) noexcept override;
    [[nodiscard]] BusStatus status() const noexcept override { return status_; }

    /// Readable when frames or an error wait; for ppoll. Changes with reopen().
    [[nodiscard]] int fd() const noexcept { return fd_; }

    /// What the kernel granted, its own bookkeeping included.
    [[nodiscard]] int receive_buffer_bytes() const noexcept { return granted_buffer_bytes_; }

    [[nodiscard]] const std::string& interface() const noexcept { return interface_; }

    /// After BusError::gone: a socket never comes back to an interface that was deleted and made anew, a new one does.
    /// Counters go on. Not for the control tick (it closes and opens sockets). Returns whether the interface is there;
    /// if not, the old socket is kept.
    bool reopen() noexcept;

  private:
    struct Buffers;

    void note_receive_error(int error) noexcept;
    void note_overflow(std::uint32_t socket_total) noexcept;

    std::string interface_;
    SocketCanOptions options_;
    std::unique_ptr<Buffers> buffers_;
    BusStatus status_;
    std::uint32_t socket_overflow_frames_ = 0;
    int granted_buffer_bytes_ = 0;
    int fd_ = -1;
};

}  // namespace steadyboom::drivers
