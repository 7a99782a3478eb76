#pragma once

#include <poll.h>

#include <chrono>
#include <cstdlib>
#include <span>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "drivers/socketcan_bus.hpp"

namespace steadyboom::test_support {

/// A shell line that must succeed.
inline void run(const std::string& command) {
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

/// Receives until `expected` frames are there: the kernel may deliver after the send has returned. Ends at once when
/// they are, after 10 s without any when they are not.
inline std::size_t await(drivers::SocketCanBus& bus, std::span<drivers::CanFrame> into, std::size_t expected) {
    std::size_t count = 0;
    pollfd ready{.fd = bus.fd(), .events = POLLIN, .revents = 0};
    while (count < expected && ::poll(&ready, 1, 10'000) == 1) {
        count += bus.receive(into.subspan(count));
    }
    return count;
}

/// Looks again and again until `reached()`, for as long as a busy machine may need. Whether it was.
template <class Condition>
bool eventually(const Condition& reached, int seconds = 30) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
    while (!reached()) {
        if (std::chrono::steady_clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
}

}  // namespace steadyboom::test_support
