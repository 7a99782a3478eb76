#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can_bus.hpp"

namespace steadyboom::drivers {

/// A frame is charged against a socket's receive buffer with this much, whatever it holds (Linux 6.1 on x86-64).
inline constexpr int kernel_bytes_per_frame = 768;

struct SocketCanOptions {
    std::vector<CanFilter> filters = {};  ///< in the kernel; empty lets everything through
    bool error_messages = true;           ///< deliver the interface's error messages as frames with `error` set
    /// Asked of SO_RCVBUFFORCE, else of SO_RCVBUF, which cuts it to what net.core.rmem_max holds, 555 by default.
    int receive_buffer_frames = most_frames_a_tick;
    /// Whether every frame must come from another machine: what comes from this one is then a spoof. Not set: yes
    /// unless the interface is virtual (vcan, vxcan), where all senders are on this machine.
    std::optional<bool> expect_remote = {};
};

/// A Linux CAN interface through one non-blocking CAN_RAW socket. Every failure after construction is a value in
/// BusStatus or SendResult. CanFrame::stamp_ns is CLOCK_MONOTONIC at the moment of receive().
///
/// A socket never comes back to an interface that was deleted and made anew; a new one does. As the one who receives
/// and sends must not open sockets, another thread calls tend(), and the next receive() or send() takes over what it
/// opened.
class SocketCanBus final : public CanBus {
  public:
    /// Throws std::runtime_error that names the interface and the remedy.
    explicit SocketCanBus(std::string interface, SocketCanOptions options = {});
    ~SocketCanBus() override;

    std::size_t receive(std::span<CanFrame> into) noexcept override;
    SendResult send(std::span<const CanFrame> frames) noexcept override;
    [[nodiscard]] BusStatus status() const noexcept override { return status_; }

    /// Opens a socket anew if the interface is gone and there is one of its name again, and closes the one that was
    /// replaced. For one thread beside the one that receives and sends, a few times a second; may block.
    void tend() noexcept;

    /// Readable when frames or an error wait; for ppoll. Changes when a new socket is taken over.
    [[nodiscard]] int fd() const noexcept { return fd_; }

    /// What the receive buffer holds, as the kernel granted it.
    [[nodiscard]] int receive_buffer_frames() const noexcept { return granted_buffer_bytes_ / kernel_bytes_per_frame; }

    [[nodiscard]] const std::string& interface() const noexcept { return interface_; }
    [[nodiscard]] bool expects_remote() const noexcept { return expects_remote_; }

  private:
    struct Buffers;

    void take_over_fresh_socket() noexcept;
    [[nodiscard]] bool accept(std::size_t index, std::int64_t stamp_ns, CanFrame& into) noexcept;
    void note_interface(BusError error) noexcept;
    void note_receive_error(int error) noexcept;
    void note_overflow(std::uint32_t socket_total) noexcept;

    std::string interface_;
    SocketCanOptions options_;
    std::unique_ptr<Buffers> buffers_;
    BusStatus status_;
    std::uint32_t socket_overflow_frames_ = 0;
    int granted_buffer_bytes_ = 0;
    bool expects_remote_ = false;
    int fd_ = -1;

    // Between the two threads; -1: none.
    std::atomic<bool> gone_{false};
    std::atomic<int> fresh_fd_{-1};    ///< from tend() to the next receive() or send()
    std::atomic<int> retired_fd_{-1};  ///< back to tend(), to be closed
};

/// Driver of an interface as the kernel names it: "vcan", "vxcan", a hardware driver's name; empty when it says none or
/// there is no such interface. Throws std::runtime_error for what is no interface's name.
[[nodiscard]] std::string interface_driver(const std::string& interface);

/// All senders are on this machine: vcan or vxcan.
[[nodiscard]] bool is_virtual_driver(const std::string& driver) noexcept;

}  // namespace steadyboom::drivers
