#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "crane_run.hpp"
#include "plant/runge_kutta.hpp"
#include "plant/sensors.hpp"
#include "runtime/realtime_section.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Slope of log(error) over log(step) by least squares.
double order(const std::vector<double>& steps, const std::vector<double>& errors) {
    double sx = 0.0;
    double sy = 0.0;
    double sxx = 0.0;
    double sxy = 0.0;
    const auto n = static_cast<double>(steps.size());
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const double x = std::log(steps[i]);
        const double y = std::log(errors[i]);
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// Case A with its track bearing and its ropes taut all along: no kink within the stretch.
class SmoothStretch : public testing::Test {
  protected:
    SmoothStretch() : crane(test_support::thesis_crane('A')), start(find_equilibrium(crane).state) {
        velocities_of(start) << 0.004, 0.001, 0.15, -0.05, 0.04, 0.002, 0.05;
    }

    CraneState rate(const CraneState& x) const { return crane.derivative(x, 1e-3 * std::cos(40.0 * x[q1_m])); }

    CraneState adaptive(double tolerance) const {
        AdaptiveRungeKutta<CraneState>::Tolerances tolerances;
        tolerances.relative = tolerance;
        tolerances.absolute.setConstant(0.01 * tolerance);
        tolerances.max_step_s = 1.0;
        AdaptiveRungeKutta<CraneState> integrator(0.0, start, tolerances);
        while (integrator.time_s() < duration_s) {
            integrator.advance([this](double, const CraneState& x) { return rate(x); });
            const CraneOutputs outputs = crane.outputs(integrator.state());
            EXPECT_EQ(outputs.contact_fraction, 1.0);
            EXPECT_GT(outputs.pendent_tension_N, 0.0);
            EXPECT_GT(outputs.load_line_tension_N, 0.0);
        }
        return integrator.interpolate(duration_s);
    }

    static constexpr double duration_s = 0.2;
    CraneDynamics crane;
    CraneState start;
};

TEST_F(SmoothStretch, ClassicalRungeKuttaIsOfOrderFour) {
    const CraneState reference = adaptive(1e-13);
    std::vector<double> steps;
    std::vector<double> errors;
    for (const int count : {400, 800, 1600, 3200}) {
        const double h_s = duration_s / count;
        CraneState x = start;
        for (int i = 0; i < count; ++i) {
            x = runge_kutta_step([this](double, const CraneState& y) { return rate(y); }, i * h_s, x, h_s);
        }
        steps.push_back(h_s);
        errors.push_back((x - reference).norm());
    }
    EXPECT_GT(errors.back(), 1e-12) << "rounding would hide the order";
    EXPECT_GT(order(steps, errors), 3.9);
    EXPECT_LT(order(steps, errors), 4.1);
}

TEST_F(SmoothStretch, AdaptiveErrorFollowsTheTolerance) {
    const CraneState reference = adaptive(1e-13);
    std::vector<double> tolerances{1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10};
    std::vector<double> errors;
    for (const double tolerance : tolerances) {
        errors.push_back((adaptive(tolerance) - reference).norm());
        EXPECT_LT(errors.back(), 100.0 * tolerance);
    }
    EXPECT_NEAR(order(tolerances, errors), 1.0, 0.2);
}

TEST(ClassicalRungeKutta, HandsTheRateTheStagesTimes) {
    std::vector<double> times;
    using Scalar = Eigen::Matrix<double, 1, 1>;
    const Scalar end = runge_kutta_step(
        [&](double t_s, const Scalar&) {
            times.push_back(t_s);
            return Scalar(4.0 * t_s * t_s * t_s);
        },
        1.0, Scalar(0.0), 0.5);
    EXPECT_EQ(times, (std::vector<double>{1.0, 1.25, 1.25, 1.5}));
    EXPECT_NEAR(end[0], std::pow(1.5, 4) - 1.0, 1e-14);
}

using Pair = Eigen::Vector2d;

Pair forced(double t_s, const Pair& y) {
    return {y[1], -y[0] + 3.0 * std::sin(2.0 * t_s)};
}
// x'' = -x + 3 sin 2t, x(0) = 1, x'(0) = 0.
Pair forced_exactly(double t_s) {
    return {std::cos(t_s) + 2.0 * std::sin(t_s) - std::sin(2.0 * t_s),
            -std::sin(t_s) + 2.0 * std::cos(t_s) - 2.0 * std::cos(2.0 * t_s)};
}

TEST(AdaptiveRungeKuttaOnAKnownSolution, EndsAreOfOrderFiveAndTheDenseOutputOfOrderFour) {
    std::vector<double> steps;
    std::vector<double> end_errors;
    std::vector<double> dense_errors;
    for (const double h_s : {0.2, 0.1, 0.05, 0.025}) {
        // The tolerance is loose: max_step_s alone fixes the step.
        AdaptiveRungeKutta<Pair> integrator(0.0, forced_exactly(0.0),
                                            {.relative = 1.0, .absolute = Pair::Constant(1.0), .max_step_s = h_s}, h_s);
        double dense = 0.0;
        const auto count = std::lround(4.0 / h_s);
        for (long i = 0; i < count; ++i) {
            const double begin_s = integrator.time_s();
            integrator.advance(forced);
            for (const double share : {0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0}) {
                const double t_s = begin_s + share * (integrator.time_s() - begin_s);
                dense = std::max(dense, (integrator.interpolate(t_s) - forced_exactly(t_s)).norm());
            }
        }
        EXPECT_EQ(integrator.accepted_steps(), count);
        steps.push_back(h_s);
        end_errors.push_back((integrator.state() - forced_exactly(4.0)).norm());
        dense_errors.push_back(dense);
    }
    EXPECT_NEAR(order(steps, end_errors), 5.0, 0.3);
    EXPECT_GT(order(steps, dense_errors), 3.9);
}

TEST(AdaptiveRungeKuttaOnAKnownSolution, DenseOutputMeetsTheStepsAtBothEnds) {
    AdaptiveRungeKutta<Pair> integrator(0.0, forced_exactly(0.0), {.absolute = Pair::Constant(1e-9)});
    for (int i = 0; i < 20; ++i) {
        const double begin_s = integrator.time_s();
        const Pair begin = integrator.state();
        integrator.advance(forced);
        EXPECT_LT((integrator.interpolate(begin_s) - begin).norm(), 1e-14);
        EXPECT_LT((integrator.interpolate(integrator.time_s()) - integrator.state()).norm(), 1e-14);
    }
}

TEST(AdaptiveRungeKutta, RejectsStepsAcrossAJumpAndRecovers) {
    using Scalar = Eigen::Matrix<double, 1, 1>;
    AdaptiveRungeKutta<Scalar> integrator(0.0, Scalar(0.0), {.absolute = Scalar(1e-10), .max_step_s = 0.3}, 0.3);
    const auto rate = [](double t_s, const Scalar&) { return Scalar(t_s < 0.5 ? 0.1 : 1000.0); };
    while (integrator.time_s() < 1.0) {
        integrator.advance(rate);
    }
    EXPECT_GT(integrator.rejected_steps(), 5);
    EXPECT_LT(integrator.accepted_steps(), 200);
    EXPECT_NEAR(integrator.interpolate(1.0)[0], 0.05 + 500.0, 1e-6);
}

TEST(AdaptiveRungeKutta, NeverStepsFurtherThanAllowed) {
    AdaptiveRungeKutta<Pair> integrator(0.0, Pair::Zero(), {.absolute = Pair::Constant(1.0), .max_step_s = 0.02});
    double before_s = 0.0;
    for (int i = 0; i < 100; ++i) {
        integrator.advance([](double, const Pair&) { return Pair(Pair::Zero()); });
        EXPECT_LE(integrator.time_s() - before_s, 0.02 + 1e-15);
        before_s = integrator.time_s();
    }
}

TEST(AdaptiveRungeKutta, RestartForgetsTheRateOfTheOldState) {
    AdaptiveRungeKutta<Pair> integrator(0.0, Pair(1.0, 0.0), {.absolute = Pair::Constant(1e-10)});
    const auto growing = [](double, const Pair& y) { return Pair(y); };
    integrator.advance(growing);
    integrator.restart(Pair::Zero());
    integrator.advance(growing);
    EXPECT_EQ(integrator.state(), Pair(Pair::Zero()));
}

// One bad entry among good ones must not pass for a small error, wherever a vector register puts it.
TEST(AdaptiveRungeKutta, OneNonFiniteEntryThrowsAndLeavesTheLastGoodState) {
    for (int bad = 0; bad < state_count; ++bad) {
        for (const double value : {nan, std::numeric_limits<double>::infinity()}) {
            SCOPED_TRACE(testing::Message() << "entry " << bad << ", " << value);
            AdaptiveRungeKutta<CraneState>::Tolerances tolerances;
            tolerances.absolute.setConstant(1e-9);
            AdaptiveRungeKutta<CraneState> integrator(0.0, CraneState::Zero(), tolerances);
            const auto rate = [&](double t_s, const CraneState&) {
                CraneState r = CraneState::Ones();
                if (t_s > 0.3) {
                    r[bad] = value;
                }
                return r;
            };
            EXPECT_THROW(
                while (integrator.time_s() < 1.0) { integrator.advance(rate); }, IntegrationError);
            EXPECT_LE(integrator.time_s(), 0.3);
            EXPECT_TRUE(integrator.state().allFinite());
        }
    }
}

TEST(AdaptiveRungeKutta, NonFiniteStartThrows) {
    const CraneDynamics crane(test_support::thesis_crane('A'));
    const CraneState rest = find_equilibrium(crane).state;
    for (int bad = 0; bad < state_count; ++bad) {
        SCOPED_TRACE(testing::Message() << "entry " << bad);
        AdaptiveRungeKutta<CraneState>::Tolerances tolerances;
        tolerances.absolute.setConstant(1e-9);
        CraneState start = rest;
        start[bad] = nan;
        AdaptiveRungeKutta<CraneState> integrator(0.0, start, tolerances);
        EXPECT_THROW(integrator.advance([&](double, const CraneState& x) { return crane.derivative(x, 0.0); }),
                     IntegrationError);
    }
}

TEST(CraneDerivative, IsNotFiniteWhereTheStateIsNot) {
    const CraneDynamics crane(test_support::thesis_crane('A'));
    const CraneState rest = find_equilibrium(crane).state;
    for (int bad = 0; bad < state_count; ++bad) {
        CraneState x = rest;
        x[bad] = nan;
        EXPECT_FALSE(crane.derivative(x, 0.0).allFinite()) << "entry " << bad;
    }
    CraneState level = rest;
    level[phi2_rad] = 0.0;
    level[R1_m] = nan;
    EXPECT_FALSE(crane.derivative(level, 0.0).allFinite());
    EXPECT_FALSE(crane.derivative(rest, nan).allFinite());
}

TEST(CraneDerivative, AndEverythingATickTakesFromThePlantAllocateNothing) {
    const CraneDynamics crane(test_support::thesis_crane('A'));
    CraneState x = after_load_drop(crane, 0.076);
    SensorVector y;
    {
        const runtime::RealtimeSection section;
        x = runge_kutta_step([&](double, const CraneState& z) { return crane.derivative(z, 1e-3); }, 0.0, x, 5e-4);
        y = ideal_sensors(crane, x, 1e-3);
    }
    EXPECT_TRUE(x.allFinite());
    EXPECT_TRUE(y.allFinite());
}

}  // namespace
}  // namespace steadyboom::plant
