#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace steadyboom::hil::benchmark {

/// A CAN_RAW socket as a textbook uses it: no filters, no error messages, no counters, no stamps, no checks.
class BareCanSocket {
  public:
    /// fd() is negative when there is no such interface or no CAN.
    explicit BareCanSocket(const std::string& interface) noexcept;
    ~BareCanSocket();
    BareCanSocket(const BareCanSocket&) = delete;
    BareCanSocket& operator=(const BareCanSocket&) = delete;

    [[nodiscard]] int fd() const noexcept { return fd_; }

    /// recvmmsg, 64 at a time, until nothing waits; how many frames.
    [[nodiscard]] std::size_t drain() noexcept;

    /// One read or write for each frame.
    [[nodiscard]] std::size_t read_one_by_one() noexcept;
    [[nodiscard]] std::size_t write_one_by_one(std::size_t frames) noexcept;

    /// First two data bytes of the newest frame.
    [[nodiscard]] std::uint32_t newest() const noexcept { return newest_; }

  private:
    int fd_;
    std::uint32_t newest_ = 0;
};

}  // namespace steadyboom::hil::benchmark
