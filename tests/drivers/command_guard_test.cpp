#include "drivers/command_guard.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace steadyboom::drivers {
namespace {

constexpr double max_opening_m = 7.6e-3;
constexpr double max_step_m = 0.4e-3;
constexpr double nm = 1.0e-9;

constexpr plant::Permission engaged{.mode = plant::ValveMode::active, .cutoff_energised = true, .authority = 1.0};

CommandGuard make_guard() {
    return CommandGuard({.max_opening_m = max_opening_m, .max_step_m = max_step_m});
}

/// Brings the guard's last command to `opening_m` by allowed steps.
CommandGuard guard_at(double opening_m) {
    auto guard = make_guard();
    const int steps = static_cast<int>(std::ceil(std::abs(opening_m) / max_step_m));
    for (int i = 1; i <= steps; ++i) {
        EXPECT_FALSE(guard.pass({opening_m * i / steps}, engaged).violated());
    }
    return guard;
}

void expect_refused(const GuardedCommand& command) {
    EXPECT_TRUE(command.violated());
    EXPECT_EQ(command.opening_m(), 0.0);
    EXPECT_EQ(command.mode(), plant::ValveMode::disabled);
    EXPECT_FALSE(command.cutoff_energised());
    EXPECT_NE(command.reasons() & plant::limit_guard, 0U);
}

void expect_passed(const GuardedCommand& command, double opening_m) {
    EXPECT_FALSE(command.violated());
    EXPECT_NEAR(command.opening_m(), opening_m, 0.5001 * nm);
    EXPECT_EQ(command.mode(), plant::ValveMode::active);
    EXPECT_TRUE(command.cutoff_energised());
}

static_assert(!std::is_default_constructible_v<GuardedCommand>, "only the guard makes a guarded command");
static_assert(!std::is_constructible_v<GuardedCommand, double>);

TEST(CommandGuard, CommandInsideTheLimitsPassesUntouchedWithItsReasons) {
    auto guard = make_guard();
    const auto passed = guard.pass({.opening_m = -0.3e-3, .reasons = plant::limit_slew}, engaged);
    expect_passed(passed, -0.3e-3);
    EXPECT_EQ(passed.reasons(), plant::limit_slew);
    EXPECT_EQ(guard.violations(), 0U);
}

TEST(CommandGuard, LargestOpeningPassesAndOneNanometreMoreIsRefused) {
    for (const double sign : {1.0, -1.0}) {
        auto inside = guard_at(sign * (max_opening_m - 0.1e-3));
        expect_passed(inside.pass({sign * max_opening_m}, engaged), sign * max_opening_m);
        auto outside = guard_at(sign * (max_opening_m - 0.1e-3));
        expect_refused(outside.pass({sign * (max_opening_m + nm)}, engaged));
        EXPECT_EQ(outside.violations(), 1U);
    }
}

TEST(CommandGuard, LargestStepPassesAndALargerOneIsRefused) {
    for (const double sign : {1.0, -1.0}) {
        auto inside = guard_at(sign * 1.0e-3);
        expect_passed(inside.pass({sign * (1.0e-3 + max_step_m)}, engaged), sign * (1.0e-3 + max_step_m));
        auto outside = guard_at(sign * 1.0e-3);
        expect_refused(outside.pass({sign * (1.0e-3 + max_step_m + 2.0 * nm)}, engaged));
    }
}

TEST(CommandGuard, AnyStepTowardsZeroPassesButNotAcrossIt) {
    for (const double sign : {1.0, -1.0}) {
        auto to_zero = guard_at(sign * 7.0e-3);
        expect_passed(to_zero.pass({0.0}, engaged), 0.0);
        auto half_way = guard_at(sign * 7.0e-3);
        expect_passed(half_way.pass({sign * 3.0e-3}, engaged), sign * 3.0e-3);
        auto across = guard_at(sign * 7.0e-3);
        expect_refused(across.pass({-sign * 0.01e-3}, engaged));
    }
}

TEST(CommandGuard, WhatIsNotFiniteIsRefusedAndSaysSo) {
    using Limits = std::numeric_limits<double>;
    for (const double bad : {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()}) {
        auto guard = guard_at(0.2e-3);
        const auto refused = guard.pass({bad}, engaged);
        expect_refused(refused);
        EXPECT_NE(refused.reasons() & plant::limit_not_finite, 0U);
    }
    for (const double large : {Limits::max(), -Limits::max(), 3.0, -3.0}) {
        auto guard = make_guard();
        const auto refused = guard.pass({large}, engaged);
        expect_refused(refused);
        EXPECT_EQ(refused.reasons() & plant::limit_not_finite, 0U);
    }
    auto guard = make_guard();
    expect_passed(guard.pass({Limits::denorm_min()}, engaged), 0.0);
}

TEST(CommandGuard, OpeningWithoutPermissionIsRefusedAndZeroPasses) {
    for (auto permit : {plant::Permission{.mode = plant::ValveMode::disabled, .authority = 1.0},
                        plant::Permission{.mode = plant::ValveMode::hold, .authority = 1.0},
                        plant::Permission{.mode = plant::ValveMode::active, .authority = 0.0},
                        plant::Permission{.mode = plant::ValveMode::active, .authority = std::nan("")}}) {
        auto guard = make_guard();
        expect_refused(guard.pass({nm}, permit));
        const auto neutral = guard.pass({0.0}, permit);
        EXPECT_FALSE(neutral.violated());
        EXPECT_EQ(neutral.mode(), permit.mode);
    }
}

TEST(CommandGuard, ModeThatIsNoneIsRefused) {
    auto guard = make_guard();
    expect_refused(guard.pass({0.0}, {.mode = static_cast<plant::ValveMode>(0x0D), .cutoff_energised = true}));
}

TEST(CommandGuard, ViolationsAreCountedForEverAndTheNextStepCountsFromZero) {
    auto guard = guard_at(2.0e-3);
    expect_refused(guard.pass({std::nan("")}, engaged));
    expect_refused(guard.pass({2.0e-3}, engaged));
    EXPECT_EQ(guard.violations(), 2U);
    expect_passed(guard.pass({max_step_m}, engaged), max_step_m);
    EXPECT_EQ(guard.violations(), 2U);
}

TEST(CommandGuard, NeutralIsNeutralAndRestartsTheStep) {
    auto guard = guard_at(2.0e-3);
    const auto neutral = guard.neutral();
    EXPECT_EQ(neutral.opening_m(), 0.0);
    EXPECT_EQ(neutral.mode(), plant::ValveMode::disabled);
    EXPECT_FALSE(neutral.cutoff_energised());
    EXPECT_FALSE(neutral.violated());
    expect_refused(guard.pass({2.0e-3}, engaged));
}

TEST(CommandGuard, LimitsThatMakeNoSenseAreRejected) {
    for (const GuardLimits bad :
         {GuardLimits{}, GuardLimits{1.0e-3, 2.0e-3}, GuardLimits{-1.0, -1.0}, GuardLimits{std::nan(""), 1.0e-3},
          GuardLimits{1.0e-3, std::nan("")}, GuardLimits{2.0, 1.0e-3}, GuardLimits{1.0e-3, 0.0}}) {
        EXPECT_THROW(CommandGuard{bad}, std::invalid_argument);
    }
}

TEST(CommandGuard, WhateverTheLawSaysTheValveNeverSeesMoreThanTheLimits) {
    EXPECT_TRUE(rc::check("guarded openings keep both limits", [] {
        auto guard = make_guard();
        double last_m = 0.0;
        const auto wanted_um = *rc::gen::container<std::vector<int>>(rc::gen::inRange(-9000, 9000));
        const auto modes = *rc::gen::container<std::vector<int>>(wanted_um.size(), rc::gen::inRange(0, 16));
        for (std::size_t i = 0; i < wanted_um.size(); ++i) {
            const plant::Permission permit{.mode = static_cast<plant::ValveMode>(modes[i] < 10 ? 0x0F : modes[i]),
                                           .cutoff_energised = true,
                                           .authority = 1.0};
            // Every other command is near the last one, so that many pass.
            const double wanted_m = i % 2 == 0 ? 1.0e-6 * wanted_um[i] : last_m + 0.05e-6 * wanted_um[i];
            const auto command = guard.pass({wanted_m}, permit);
            const double opening_m = command.opening_m();
            RC_ASSERT(std::abs(opening_m) <= max_opening_m + 0.5 * nm);
            RC_ASSERT(std::abs(opening_m) <= std::abs(last_m) + max_step_m + 2.0 * nm);
            RC_ASSERT(std::abs(opening_m - last_m) <= max_step_m + 2.0 * nm || opening_m * last_m >= 0.0);
            RC_ASSERT(opening_m == 0.0 || command.mode() == plant::ValveMode::active);
            RC_ASSERT(!command.violated() || (opening_m == 0.0 && !command.cutoff_energised()));
            last_m = opening_m;
        }
    }));
}

TEST(CommandGuard, LimiterThatSlewsByExactlyTheLargestStepIsNeverRefused) {
    for (const double step_m : {max_step_m / 3.0, 1.234567891e-4, 1.0e-4 / 7.0}) {
        CommandGuard guard({.max_opening_m = max_opening_m, .max_step_m = step_m});
        for (double opening_m = 0.0; opening_m < max_opening_m; opening_m += step_m) {
            ASSERT_FALSE(guard.pass({opening_m}, engaged).violated()) << opening_m;
        }
    }
}

}  // namespace
}  // namespace steadyboom::drivers
