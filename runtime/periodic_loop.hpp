#pragma once

#include <atomic>
#include <cstdint>

#include "runtime/clock.hpp"
#include "runtime/duration_histogram.hpp"
#include "runtime/realtime_section.hpp"
#include "runtime/seqlock.hpp"

namespace steadyboom::runtime {

/// One tick of the schedule, at its start.
struct TickStart {
    std::uint64_t tick = 0;               ///< index k
    std::int64_t due_ns = 0;              ///< t0 + k T exactly
    std::int64_t woke_ns = 0;             ///< when the loop was running again
    std::int64_t wake_up_latency_ns = 0;  ///< woke_ns less the deadline that was slept for
    std::uint64_t skipped_ticks = 0;      ///< deadlines passed over since the previous tick
};

/// The longest duration ever and the tick it was in.
struct WorstDuration {
    std::int64_t duration_ns = 0;
    std::uint64_t tick = 0;
};

/// What the loop has done so far. Written by the loop alone, readable from any thread at any time.
class LoopStatistics {
  public:
    DurationHistogram wake_up_latency;
    DurationHistogram execution_time;
    Seqlock<WorstDuration> worst_wake_up_latency;
    Seqlock<WorstDuration> worst_execution_time;
    std::atomic<std::uint64_t> ticks{0};     ///< run
    std::atomic<std::uint64_t> overruns{0};  ///< ticks that ended after the next one was due
    std::atomic<std::uint64_t> skipped{0};   ///< deadlines with no tick of their own
};

/// Calls a function at t0, t0 + T, t0 + 2T, ... of a clock, t0 given once: nothing that happens moves the schedule.
///
/// A deadline missed is skipped, never made up for: a tick that ends after the next deadline is followed by the first
/// deadline still to come; a wake-up later than a whole period runs once, as the newest tick that is due.
class PeriodicLoop {
  public:
    /// The first tick is due at `start_ns` of `clock`. Throws std::invalid_argument unless the period is positive.
    PeriodicLoop(Clock& clock, std::int64_t period_ns, std::int64_t start_ns);

    /// The first tick is due one period from now.
    PeriodicLoop(Clock& clock, std::int64_t period_ns) : PeriodicLoop(clock, period_ns, clock.now_ns() + period_ns) {}

    PeriodicLoop(const PeriodicLoop&) = delete;
    PeriodicLoop& operator=(const PeriodicLoop&) = delete;

    /// Sleeps until the next tick.
    TickStart wait() noexcept;

    /// The work of the tick that wait() started is done.
    void finish() noexcept;

    /// Runs `tick(const TickStart&)` inside a RealtimeSection each period until `stop` is true.
    template <class Tick>
    void run(Tick&& tick, const std::atomic<bool>& stop) noexcept {
        static_assert(noexcept(tick(TickStart{})), "a control tick must be noexcept");
        const RealtimeSection section;
        while (!stop.load(std::memory_order_relaxed)) {
            const TickStart start = wait();
            if (stop.load(std::memory_order_relaxed)) {
                break;
            }
            tick(start);
            finish();
        }
    }

    [[nodiscard]] std::int64_t period_ns() const noexcept { return period_ns_; }
    [[nodiscard]] const LoopStatistics& statistics() const noexcept { return statistics_; }

  private:
    [[nodiscard]] std::int64_t due_ns(std::uint64_t tick) const noexcept {
        return start_ns_ + static_cast<std::int64_t>(tick) * period_ns_;
    }

    Clock& clock_;
    std::int64_t period_ns_;
    std::int64_t start_ns_;
    std::uint64_t next_tick_ = 0;
    std::uint64_t skipped_ticks_ = 0;  ///< since the previous tick
    TickStart current_;
    WorstDuration worst_wake_up_latency_;
    WorstDuration worst_execution_time_;
    LoopStatistics statistics_;
};

}  // namespace steadyboom::runtime
