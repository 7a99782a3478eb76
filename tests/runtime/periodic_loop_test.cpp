#include "runtime/periodic_loop.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace steadyboom::runtime {
namespace {

constexpr std::int64_t period_ns = 5'000'000;
constexpr std::int64_t start_ns = 123'456'789;

// A machine that wakes the loop late by whatever the test says next.
class LateClock final : public Clock {
  public:
    [[nodiscard]] std::int64_t now_ns() const noexcept override { return time_ns; }
    void sleep_until(std::int64_t deadline_ns) noexcept override {
        last_deadline_ns = deadline_ns;
        time_ns = std::max(time_ns, deadline_ns + late_ns);
    }
    std::int64_t time_ns = start_ns - 1;
    std::int64_t late_ns = 0;
    std::int64_t last_deadline_ns = 0;
};

TEST(PeriodicLoop, TickKIsDueAtStartPlusKPeriodsAfterAMillionTicks) {
    LateClock clock;
    PeriodicLoop loop(clock, period_ns, start_ns);
    for (std::uint64_t k = 0; k < 1'000'000; ++k) {
        clock.late_ns = static_cast<std::int64_t>(k * 7919 % 100'000);
        const TickStart start = loop.wait();
        ASSERT_EQ(start.tick, k);
        ASSERT_EQ(start.due_ns, start_ns + static_cast<std::int64_t>(k) * period_ns);
        ASSERT_EQ(clock.last_deadline_ns, start.due_ns);
        ASSERT_EQ(start.wake_up_latency_ns, clock.late_ns);
        clock.time_ns += 1'000'000;
        loop.finish();
    }
    EXPECT_EQ(loop.statistics().ticks, 1'000'000U);
    EXPECT_EQ(loop.statistics().overruns, 0U);
    EXPECT_EQ(loop.statistics().skipped, 0U);
}

TEST(PeriodicLoop, AnOverrunSkipsToTheNextDeadlineStillToCome) {
    LateClock clock;
    PeriodicLoop loop(clock, period_ns, start_ns);
    EXPECT_EQ(loop.wait().tick, 0U);
    clock.time_ns += 2 * period_ns + period_ns / 2;
    loop.finish();

    const TickStart next = loop.wait();
    EXPECT_EQ(next.tick, 3U);
    EXPECT_EQ(next.due_ns, start_ns + 3 * period_ns);
    EXPECT_EQ(next.skipped_ticks, 2U);
    EXPECT_EQ(next.wake_up_latency_ns, 0);
    loop.finish();

    EXPECT_EQ(loop.wait().skipped_ticks, 0U);
    EXPECT_EQ(loop.statistics().overruns, 1U);
    EXPECT_EQ(loop.statistics().skipped, 2U);
    EXPECT_EQ(loop.statistics().ticks, 3U);
}

TEST(PeriodicLoop, ATickThatEndsExactlyOnTheNextDeadlineSkipsNothing) {
    LateClock clock;
    PeriodicLoop loop(clock, period_ns, start_ns);
    loop.wait();
    clock.time_ns = start_ns + period_ns;
    loop.finish();
    EXPECT_EQ(loop.wait().tick, 1U);
    EXPECT_EQ(loop.statistics().overruns, 0U);
}

TEST(PeriodicLoop, OneNanosecondOverIsAnOverrun) {
    LateClock clock;
    PeriodicLoop loop(clock, period_ns, start_ns);
    loop.wait();
    clock.time_ns = start_ns + period_ns + 1;
    loop.finish();
    EXPECT_EQ(loop.wait().tick, 2U);
    EXPECT_EQ(loop.statistics().overruns, 1U);
}

TEST(PeriodicLoop, AWakeUpHalfASecondLateRunsOnceAsTheNewestDueTick) {
    LateClock clock;
    PeriodicLoop loop(clock, period_ns, start_ns);
    loop.wait();
    loop.finish();

    clock.late_ns = 500'000'000 + 1'000;
    const TickStart late = loop.wait();
    EXPECT_EQ(late.tick, 101U);
    EXPECT_EQ(late.skipped_ticks, 100U);
    EXPECT_EQ(late.due_ns, start_ns + 101 * period_ns);
    EXPECT_EQ(late.wake_up_latency_ns, 500'001'000);
    clock.late_ns = 0;
    loop.finish();

    const TickStart next = loop.wait();
    EXPECT_EQ(next.tick, 102U);
    EXPECT_EQ(next.woke_ns, start_ns + 102 * period_ns);
}

TEST(PeriodicLoop, NeverRunsTwoTicksForOneDeadlineWhateverTheDelays) {
    LateClock clock;
    PeriodicLoop loop(clock, period_ns, start_ns);
    std::uint64_t seed = 1;
    const auto random_ns = [&](std::int64_t below_ns) {
        seed = seed * 6364136223846793005U + 1442695040888963407U;
        return static_cast<std::int64_t>(seed >> 33U) % below_ns;
    };
    std::uint64_t expected_tick = 0;
    for (int i = 0; i < 100'000; ++i) {
        clock.late_ns = random_ns(3 * period_ns);
        const TickStart start = loop.wait();
        ASSERT_EQ(start.tick, expected_tick + start.skipped_ticks);
        ASSERT_GE(start.woke_ns, start.due_ns);
        ASSERT_LT(start.woke_ns, start.due_ns + period_ns);
        clock.time_ns += random_ns(3 * period_ns);
        loop.finish();
        expected_tick = start.tick + 1;
    }
    EXPECT_EQ(loop.statistics().ticks + loop.statistics().skipped, expected_tick);
}

TEST(PeriodicLoop, StatisticsKeepTheWorstAndTheTickItWasIn) {
    LateClock clock;
    PeriodicLoop loop(clock, period_ns, start_ns);
    for (int k = 0; k < 1000; ++k) {
        clock.late_ns = k == 417 ? 90'000 : 10'000;
        loop.wait();
        clock.time_ns += k == 200 ? 3'000'000 : 1'000'000;
        loop.finish();
    }
    const LoopStatistics& statistics = loop.statistics();
    EXPECT_EQ(statistics.worst_wake_up_latency.load().duration_ns, 90'000);
    EXPECT_EQ(statistics.worst_wake_up_latency.load().tick, 417U);
    EXPECT_EQ(statistics.worst_execution_time.load().duration_ns, 3'000'000);
    EXPECT_EQ(statistics.worst_execution_time.load().tick, 200U);
    EXPECT_NEAR(static_cast<double>(statistics.wake_up_latency.quantile_ns(0.5)), 10'000.0, 10'000.0 / 32);
    EXPECT_NEAR(static_cast<double>(statistics.execution_time.quantile_ns(0.999)), 1'000'000.0, 1'000'000.0 / 32);
}

TEST(PeriodicLoop, RunsInsideARealtimeSectionWithoutAllocatingUntilStopped) {
    SimulatedClock clock(start_ns);
    PeriodicLoop loop(clock, period_ns);
    std::atomic<bool> stop{false};
    std::uint64_t ticks_in_section = 0;
    TickStart last;
    loop.run(
        [&](const TickStart& start) noexcept {
            ticks_in_section += in_realtime_section() ? 1U : 0U;
            last = start;
            clock.advance(start.tick % 10 == 9 ? 2 * period_ns : 1'000);
            stop = start.tick >= 999;
        },
        stop);
    EXPECT_EQ(ticks_in_section, loop.statistics().ticks);
    EXPECT_EQ(last.tick, 999U);
    EXPECT_EQ(last.due_ns, start_ns + 1000 * period_ns);
    EXPECT_FALSE(in_realtime_section());
}

TEST(PeriodicLoop, APeriodThatIsNotPositiveIsRejectedAtStart) {
    SimulatedClock clock;
    EXPECT_THROW(PeriodicLoop(clock, 0), std::invalid_argument);
    EXPECT_THROW(PeriodicLoop(clock, -1), std::invalid_argument);
}

TEST(MonotonicClock, SleepsToTheDeadlineAndNotLess) {
    MonotonicClock clock;
    const std::int64_t deadline_ns = clock.now_ns() + 2'000'000;
    clock.sleep_until(deadline_ns);
    EXPECT_GE(clock.now_ns(), deadline_ns);
    clock.sleep_until(deadline_ns - 1'000'000'000);
}

}  // namespace
}  // namespace steadyboom::runtime
