#include "runtime/overrun_monitor.hpp"

#include <gtest/gtest.h>

namespace steadyboom::runtime {
namespace {

bool broken_within(OverrunMonitor& monitor, int punctual_ticks) {
    bool broken = false;
    for (int i = 0; i < punctual_ticks; ++i) {
        broken = monitor.broken(0) || broken;
    }
    return broken;
}

TEST(OverrunMonitor, PunctualTicksAreFine) {
    OverrunMonitor monitor;
    EXPECT_FALSE(broken_within(monitor, 1000));
}

TEST(OverrunMonitor, TwoDeadlinesPassedOverAtOnceBreakTheSchedule) {
    for (const std::uint64_t skipped : {2U, 3U, 1000U}) {
        OverrunMonitor monitor;
        EXPECT_TRUE(monitor.broken(skipped)) << skipped;
        EXPECT_FALSE(monitor.broken(0)) << "one such event is told once";
    }
}

TEST(OverrunMonitor, TwoSingleOverrunsAreToleratedAndTheThirdIsNot) {
    OverrunMonitor monitor;
    EXPECT_FALSE(monitor.broken(1));
    EXPECT_FALSE(broken_within(monitor, 10));
    EXPECT_FALSE(monitor.broken(1));
    EXPECT_FALSE(broken_within(monitor, 10));
    EXPECT_TRUE(monitor.broken(1));
}

// First overrun at tick 1, second at 2; the third counts together with the first at tick 200 and no longer at 201.
TEST(OverrunMonitor, OverrunIsForgottenAfter200Ticks) {
    for (const bool within : {true, false}) {
        OverrunMonitor monitor;
        EXPECT_FALSE(monitor.broken(1));
        EXPECT_FALSE(monitor.broken(1));
        EXPECT_FALSE(broken_within(monitor, within ? 197 : 198));
        EXPECT_EQ(monitor.broken(1), within);
    }
}

TEST(OverrunMonitor, BrokenScheduleStaysBrokenUntilTheFirstOverrunIsForgotten) {
    OverrunMonitor monitor;
    (void)monitor.broken(1);
    (void)monitor.broken(1);
    EXPECT_TRUE(monitor.broken(1));
    for (int tick = 4; tick <= 200; ++tick) {
        EXPECT_TRUE(monitor.broken(0)) << tick;
    }
    EXPECT_FALSE(monitor.broken(0));
}

TEST(OverrunMonitor, EverySecondTickTooLateIsBroken) {
    OverrunMonitor monitor;
    int broken = 0;
    for (int i = 0; i < 400; ++i) {
        broken += monitor.broken(i % 2 == 0 ? 1 : 0) ? 1 : 0;
    }
    EXPECT_EQ(broken, 400 - 4);
}

}  // namespace
}  // namespace steadyboom::runtime
