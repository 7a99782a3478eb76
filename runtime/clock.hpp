#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace steadyboom::runtime {

/// Steady time in ns. What it counts from is the clock's own business; it never goes back.
class Clock {
  public:
    virtual ~Clock() = default;
    [[nodiscard]] virtual std::int64_t now_ns() const noexcept = 0;
    /// Returns at or after the deadline; at once when it has passed.
    virtual void sleep_until(std::int64_t deadline_ns) noexcept = 0;
};

/// CLOCK_MONOTONIC. Sleeps to absolute deadlines, so that no error adds up.
class MonotonicClock final : public Clock {
  public:
    [[nodiscard]] std::int64_t now_ns() const noexcept override;
    void sleep_until(std::int64_t deadline_ns) noexcept override;
};

/// Stands still until it is told otherwise; a sleep ends exactly on its deadline and takes no time. For lockstep.
/// One thread moves it, any may read it.
class SimulatedClock final : public Clock {
  public:
    explicit SimulatedClock(std::int64_t start_ns = 0) noexcept : now_ns_(start_ns) {}
    [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_.load(std::memory_order_acquire); }
    void sleep_until(std::int64_t deadline_ns) noexcept override {
        now_ns_.store(std::max(deadline_ns, now_ns()), std::memory_order_release);
    }
    void advance(std::int64_t duration_ns) noexcept { sleep_until(now_ns() + duration_ns); }

  private:
    std::atomic<std::int64_t> now_ns_;
};

}  // namespace steadyboom::runtime
