#include "hil/virtual_valve.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "plant/runge_kutta.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::hil {
namespace {

using plant::ValveState;

// Control words of CiA 408.
constexpr std::uint16_t disabled = 0b0001;
constexpr std::uint16_t hold = 0b0011;
constexpr std::uint16_t active = 0b0111;
constexpr std::uint16_t reset = 0b1000;

constexpr double step_s = 0.0005;
constexpr std::int64_t ms = 1'000'000;

plant::ActuatorParameters actuator(double delay_s = 0.0) {
    plant::ActuatorParameters parameters = test_support::thesis_crane('A').actuator;
    parameters.spool_bandwidth_Hz = 100.0;
    parameters.spool_damping_ratio = 0.8;
    parameters.spool_delay_s = delay_s;
    return parameters;
}

drivers::ValveOrder order(std::uint16_t control_word, double set_point_m, std::int64_t stamp_ns, bool cutoff = true) {
    return {.control_word = control_word,
            .set_point_m = set_point_m,
            .stamp_ns = stamp_ns,
            .ever = true,
            .cutoff_energised = cutoff,
            .cutoff_stamp_ns = stamp_ns,
            .cutoff_ever = true};
}

TEST(VirtualValve, IsCentredAndShutBeforeAnyOrder) {
    VirtualValve valve(actuator(), step_s);
    for (std::int64_t now_ns = 0; now_ns < 1000 * ms; now_ns += ms) {
        valve.obey({}, 0.0, now_ns);
        ASSERT_EQ(valve.state(), ValveState::init);
        ASSERT_FALSE(valve.cutoff_open());
        ASSERT_EQ(valve.next_target_m(), 0.0);
    }
    EXPECT_EQ(valve.timeouts(), 0U);
}

TEST(VirtualValve, OnlyAnActiveValveFollowsItsSetPoint) {
    for (const std::uint16_t mode : {disabled, hold, active}) {
        VirtualValve valve(actuator(), step_s);
        valve.obey(order(mode, 3e-3, 0), 0.0, 0);
        EXPECT_EQ(static_cast<int>(valve.state()), 0b1000 | mode);
        EXPECT_EQ(valve.next_target_m(), mode == active ? 3e-3 : 0.0);
    }
}

TEST(VirtualValve, LeavingActiveCentresIt) {
    for (const std::uint16_t mode : {disabled, hold}) {
        VirtualValve valve(actuator(), step_s);
        valve.obey(order(active, 3e-3, 0), 0.0, 0);
        EXPECT_EQ(valve.next_target_m(), 3e-3);
        valve.obey(order(mode, 3e-3, 0), 0.0, ms);
        EXPECT_EQ(valve.next_target_m(), 0.0);
    }
}

TEST(VirtualValve, SetPointIsHeldToTheTravel) {
    VirtualValve valve(actuator(), step_s);
    valve.obey(order(active, 9e-3, 0), 0.0, 0);
    EXPECT_EQ(valve.next_target_m(), 7.6e-3);
    valve.obey(order(active, -9e-3, 0), 0.0, 0);
    EXPECT_EQ(valve.next_target_m(), -7.6e-3);
}

TEST(VirtualValve, SilenceOf25MillisecondsCentresItAndShutsTheCutoff) {
    VirtualValve valve(actuator(), step_s);
    const drivers::ValveOrder last = order(active, 3e-3, 100 * ms);
    valve.obey(last, 0.0, 125 * ms - 1);
    EXPECT_EQ(valve.state(), ValveState::active);
    EXPECT_TRUE(valve.cutoff_open());
    EXPECT_EQ(valve.next_target_m(), 3e-3);
    valve.obey(last, 0.0, 125 * ms);
    EXPECT_EQ(valve.state(), ValveState::fault_hold);
    EXPECT_FALSE(valve.cutoff_open());
    EXPECT_EQ(valve.next_target_m(), 0.0);
    EXPECT_EQ(valve.timeouts(), 1U);
    valve.obey(last, 0.0, 500 * ms);
    EXPECT_EQ(valve.timeouts(), 1U) << "one silence is one timeout";
}

TEST(VirtualValve, FaultReactionLastsUntilTheSpoolIsCentred) {
    VirtualValve valve(actuator(), step_s);
    valve.obey(order(active, 3e-3, 0), 3e-3, 0);
    for (const double spool_m : {3e-3, -1e-3, 77e-6}) {
        valve.obey(order(active, 3e-3, 0), spool_m, 25 * ms);
        EXPECT_EQ(valve.state(), ValveState::fault_reaction) << spool_m;
        EXPECT_EQ(valve.next_target_m(), 0.0);
        EXPECT_FALSE(valve.cutoff_open());
    }
    valve.obey(order(active, 3e-3, 0), 75e-6, 26 * ms);
    EXPECT_EQ(valve.state(), ValveState::fault_hold);
}

TEST(VirtualValve, SilenceIsAFaultInHoldAndDisabledToo) {
    for (const std::uint16_t mode : {disabled, hold}) {
        VirtualValve valve(actuator(), step_s);
        const drivers::ValveOrder last = order(mode, 0.0, 0);
        valve.obey(last, 0.0, 24 * ms);
        EXPECT_FALSE(drivers::is_fault(valve.state()));
        valve.obey(last, 0.0, 25 * ms);
        EXPECT_EQ(valve.state(), mode == hold ? ValveState::fault_hold : ValveState::fault_disabled);
        EXPECT_FALSE(valve.cutoff_open());
    }
}

TEST(VirtualValve, FaultLastsUntilAResetEdgeOnceCommandsComeAgain) {
    VirtualValve valve(actuator(), step_s);
    valve.obey(order(active, 3e-3, 0), 0.0, 0);
    valve.obey(order(active, 3e-3, 0), 0.0, 25 * ms);
    ASSERT_EQ(valve.state(), ValveState::fault_hold);
    for (const std::uint16_t word : {active, hold, active}) {
        valve.obey(order(word, 3e-3, 30 * ms), 0.0, 30 * ms);
        EXPECT_EQ(valve.state(), ValveState::fault_hold);
        EXPECT_FALSE(valve.cutoff_open()) << "energised, but the valve does not allow it";
        EXPECT_EQ(valve.next_target_m(), 0.0);
    }
    valve.obey(order(disabled, 3e-3, 35 * ms, false), 0.0, 35 * ms);
    EXPECT_EQ(valve.state(), ValveState::fault_disabled);
    valve.obey(order(disabled | reset, 3e-3, 40 * ms, false), 0.0, 40 * ms);
    EXPECT_EQ(valve.state(), ValveState::disabled);
    valve.obey(order(active, 3e-3, 45 * ms), 0.0, 45 * ms);
    EXPECT_EQ(valve.state(), ValveState::active);
    EXPECT_TRUE(valve.cutoff_open());
    EXPECT_EQ(valve.next_target_m(), 3e-3);
    valve.obey(order(active, 3e-3, 45 * ms), 0.0, 70 * ms);
    EXPECT_EQ(valve.timeouts(), 2U);
}

TEST(VirtualValve, OldOrderWithAResetClearsNoFault) {
    VirtualValve valve(actuator(), step_s);
    valve.obey(order(disabled, 0.0, 0), 0.0, 0);
    valve.obey(order(disabled | reset, 0.0, 0), 0.0, 25 * ms);
    valve.obey(order(disabled, 0.0, 0), 0.0, 26 * ms);
    valve.obey(order(disabled | reset, 0.0, 0), 0.0, 27 * ms);
    EXPECT_EQ(valve.state(), ValveState::fault_disabled);
}

TEST(VirtualValve, ReportsADeviationBeyondATenthOfTheTravel) {
    VirtualValve valve(actuator(), step_s);
    valve.obey(order(active, 3e-3, 0), 0.0, 0);
    EXPECT_FALSE(valve.status(3e-3 - 0.75e-3).control_deviation);
    EXPECT_TRUE(valve.status(3e-3 - 0.77e-3).control_deviation);
    EXPECT_TRUE(valve.status(-7.6e-3).limit_touched);
}

TEST(VirtualValve, CutoffOpensOnlyWhileItsOwnOrderEnergisesIt) {
    VirtualValve valve(actuator(), step_s);
    valve.obey(order(hold, 0.0, 0, false), 0.0, 0);
    EXPECT_FALSE(valve.cutoff_open());
    valve.obey(order(hold, 0.0, 0, true), 0.0, 0);
    EXPECT_TRUE(valve.cutoff_open());
    drivers::ValveOrder stale_cutoff = order(hold, 0.0, 20 * ms);
    stale_cutoff.cutoff_stamp_ns = 0;
    valve.obey(stale_cutoff, 0.0, 25 * ms - 1);
    EXPECT_TRUE(valve.cutoff_open());
    valve.obey(stale_cutoff, 0.0, 25 * ms);
    EXPECT_FALSE(valve.cutoff_open());
    EXPECT_EQ(valve.state(), ValveState::hold) << "the valve itself is still spoken to";
    drivers::ValveOrder never_told = order(hold, 0.0, 25 * ms);
    never_told.cutoff_ever = false;
    valve.obey(never_told, 0.0, 25 * ms);
    EXPECT_FALSE(valve.cutoff_open());
}

TEST(VirtualValve, DeadTimeIsTheNearestWholeNumberOfSteps) {
    for (const auto& [delay_s, steps] :
         {std::pair{0.0, 0}, {0.0002, 0}, {0.0003, 1}, {0.0005, 1}, {0.001, 2}, {0.0012, 2}, {0.01, 20}}) {
        VirtualValve valve(actuator(delay_s), step_s);
        for (int step = 0; step < 30; ++step) {
            valve.obey(order(active, 1e-3 * (step + 1), 0), 0.0, 0);
            const double expected_m = step < steps ? 0.0 : std::min(7.6e-3, 1e-3 * (step - steps + 1));
            ASSERT_EQ(valve.next_target_m(), expected_m) << delay_s << " s, step " << step;
        }
    }
}

// x'' = omega^2 (1 - x) - 2 zeta omega x' from rest, damping below one:
// x = 1 - exp(-zeta omega t) (cos(w t) + zeta omega / w sin(w t)), w = omega sqrt(1 - zeta^2).
TEST(VirtualValve, SpoolRespondsAsASecondOrderSystem) {
    const VirtualValve valve(actuator(), step_s);
    const double omega = 2.0 * std::numbers::pi * 100.0;
    const double zeta = 0.8;
    const double damped = omega * std::sqrt(1.0 - zeta * zeta);
    using Spool = Eigen::Vector2d;
    constexpr double target_m = 4e-3;
    constexpr double fine_s = 1e-5;
    const auto rate = [&](double, const Spool& x) {
        return Spool(x[1], valve.spool_acceleration_m_s2(x[0], x[1], target_m));
    };
    Spool spool = Spool::Zero();
    for (int i = 1; i <= 2000; ++i) {
        spool = plant::runge_kutta_step(rate, 0.0, spool, fine_s);
        const double t_s = i * fine_s;
        const double response = 1.0 - std::exp(-zeta * omega * t_s) *
                                          (std::cos(damped * t_s) + zeta * omega / damped * std::sin(damped * t_s));
        ASSERT_NEAR(spool[0], target_m * response, 1e-9 * target_m) << t_s;
    }
}

}  // namespace
}  // namespace steadyboom::hil
