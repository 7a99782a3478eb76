#include "runtime/clock.hpp"

#include <cerrno>
#include <ctime>

namespace steadyboom::runtime {

namespace {
constexpr std::int64_t ns_per_s = 1'000'000'000;
}

std::int64_t MonotonicClock::now_ns() const noexcept {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * ns_per_s + now.tv_nsec;
}

void MonotonicClock::sleep_until(std::int64_t deadline_ns) noexcept {
    const timespec deadline{deadline_ns / ns_per_s, deadline_ns % ns_per_s};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
    }
}

}  // namespace steadyboom::runtime
