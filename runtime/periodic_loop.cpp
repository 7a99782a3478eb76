#include "runtime/periodic_loop.hpp"

#include <stdexcept>
#include <string>

namespace steadyboom::runtime {

namespace {

void add(std::atomic<std::uint64_t>& counter, std::uint64_t more) noexcept {
    counter.store(counter.load(std::memory_order_relaxed) + more, std::memory_order_relaxed);
}

void note(DurationHistogram& histogram, Seqlock<WorstDuration>& published, WorstDuration& worst,
          std::int64_t duration_ns, std::uint64_t tick) noexcept {
    histogram.record(duration_ns);
    if (duration_ns > worst.duration_ns) {
        worst = {duration_ns, tick};
        published.store(worst);
    }
}

}  // namespace

PeriodicLoop::PeriodicLoop(Clock& clock, std::int64_t period_ns, std::int64_t start_ns)
    : clock_(clock), period_ns_(period_ns), start_ns_(start_ns) {
    if (period_ns <= 0) {
        throw std::invalid_argument("the loop's period_ns is " + std::to_string(period_ns) + ", it must be positive");
    }
}

TickStart PeriodicLoop::wait() noexcept {
    const std::int64_t deadline_ns = due_ns(next_tick_);
    clock_.sleep_until(deadline_ns);
    const std::int64_t woke_ns = clock_.now_ns();
    const std::int64_t latency_ns = woke_ns - deadline_ns;
    if (latency_ns >= period_ns_) {
        const auto passed = static_cast<std::uint64_t>(latency_ns / period_ns_);
        next_tick_ += passed;
        skipped_ticks_ += passed;
    }
    current_ = {next_tick_, due_ns(next_tick_), woke_ns, latency_ns, skipped_ticks_};
    add(statistics_.ticks, 1);
    add(statistics_.skipped, skipped_ticks_);
    note(statistics_.wake_up_latency, statistics_.worst_wake_up_latency, worst_wake_up_latency_, latency_ns,
         next_tick_);
    skipped_ticks_ = 0;
    ++next_tick_;
    return current_;
}

void PeriodicLoop::finish() noexcept {
    const std::int64_t now_ns = clock_.now_ns();
    note(statistics_.execution_time, statistics_.worst_execution_time, worst_execution_time_, now_ns - current_.woke_ns,
         current_.tick);
    const std::int64_t late_ns = now_ns - due_ns(next_tick_);
    if (late_ns > 0) {
        const auto missed = static_cast<std::uint64_t>((late_ns + period_ns_ - 1) / period_ns_);
        next_tick_ += missed;
        skipped_ticks_ += missed;
        add(statistics_.overruns, 1);
    }
}

}  // namespace steadyboom::runtime
