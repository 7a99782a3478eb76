#include "plant/energy.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "boom_cases.hpp"
#include "crane_run.hpp"
#include "random_states.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

using test_support::thesis_case;
using test_support::thesis_crane;

/// Neither boom nor soil takes energy out; a shut valve only stores it in the oil.
CraneParameters undamped(CraneParameters parameters) {
    parameters.structure.boom_damping_ratio = 0.0;
    parameters.soil.density_kg_m3 = 0.0;
    return parameters;
}

/// Case C's track lifts an end at rest already; with the counterweight much further back it bears whole.
CraneParameters bearing_whole(char name) {
    CraneParameters parameters = thesis_crane(name);
    if (name == 'C') {
        parameters.structure.car_body_setback_m = 13.2;
    }
    return parameters;
}

template <class Case>
class EnergyOf : public testing::Test {};
TYPED_TEST_SUITE(EnergyOf, BoomCases, BoomCaseName);

TYPED_TEST(EnergyOf, UndampedCraneConservesItWhileTheTrackBearsAndTheRopesStayTaut) {
    constexpr double injected_J = 150.0;
    const typename TypeParam::Crane crane(undamped(bearing_whole(TypeParam::name)));
    const typename TypeParam::State rest = find_equilibrium(crane).state;
    const Eigen::LLT<typename TypeParam::MassMatrix> factor(crane.mass_matrix(coordinates_of(rest)));
    RandomStates random(crane, 5);
    for (int start = 0; start < 3; ++start) {
        SCOPED_TRACE(testing::Message() << "start " << start);
        // Energy spread at random over the coordinates.
        typename TypeParam::Coordinates direction;
        for (int i = 0; i < TypeParam::Layout::coordinate_count; ++i) {
            direction[i] = random.between(-1.0, 1.0);
        }
        typename TypeParam::State x = rest;
        velocities_of(x) = factor.matrixU().solve(direction.normalized()) * std::sqrt(2.0 * injected_J);
        ASSERT_NEAR(kinetic_energy_J(crane, x), injected_J, 1e-9 * injected_J);

        const auto energy_J = [&](const typename TypeParam::State& y) {
            return kinetic_energy_J(crane, y) + potential_energy_J(crane, y) +
                   full_contact_energy_J(crane.soil(), y[R1_m], y[phi2_rad]) + oil_energy_J(crane, y);
        };
        const auto rate = [&](double, const typename TypeParam::State& y) { return crane.derivative(y, 0.0); };
        typename AdaptiveRungeKutta<typename TypeParam::State>::Tolerances tolerances;
        tolerances.relative = 1e-13;
        tolerances.absolute.setConstant(1e-14);
        AdaptiveRungeKutta<typename TypeParam::State> integrator(0.0, x, tolerances);
        const double before_J = energy_J(x);
        double least_kinetic_J = injected_J;
        double worst_J = 0.0;
        while (integrator.time_s() < 1.5) {
            integrator.advance(rate);
            const typename TypeParam::State& y = integrator.state();
            const CraneOutputs outputs = crane.outputs(y);
            ASSERT_EQ(outputs.contact_fraction, 1.0);
            ASSERT_GT(outputs.pendent_tension_N, 0.0);
            ASSERT_GT(outputs.load_line_tension_N, 0.0);
            worst_J = std::max(worst_J, std::abs(energy_J(y) - before_J));
            least_kinetic_J = std::min(least_kinetic_J, kinetic_energy_J(crane, y));
        }
        EXPECT_LT(worst_J, 1e-9 * injected_J);
        EXPECT_LT(least_kinetic_J, 0.7 * injected_J);
    }
}

// dE/dt against every power that E does not hold, as an extra state of the same integration: no kink may lose a joule.
template <class Boom>
class PowerBalance {
  public:
    using Layout = typename CraneDynamicsOf<Boom>::Layout;
    using State = StateOf<Boom>;
    static constexpr int work_index = Layout::state_count;
    using Extended = Eigen::Matrix<double, work_index + 1, 1>;

    explicit PowerBalance(const CraneDynamicsOf<Boom>& crane) : crane_(crane) {}

    template <class Law>
    void run(const State& start, double duration_s, const Law& law) {
        const auto opening_m = [&](double t_s, const State& x) {
            return crane_.actuator().clamp_opening_m(law(t_s, x));
        };
        const auto rate = [&](double t_s, const Extended& y) {
            const State x = y.template head<work_index>();
            const double X_v = opening_m(t_s, x);
            Extended dy;
            dy << crane_.derivative(x, X_v), non_conservative_power(crane_, x, X_v).total_W();
            return dy;
        };
        typename AdaptiveRungeKutta<Extended>::Tolerances tolerances;
        tolerances.relative = 1e-11;
        tolerances.absolute.setConstant(1e-12);
        tolerances.absolute[work_index] = 1e-7;
        tolerances.max_step_s = 1e-3;
        Extended y;
        y << start, 0.0;
        AdaptiveRungeKutta<Extended> integrator(0.0, y, tolerances);
        const double before_J = energy_J(start);
        const double travel_m = crane_.parameters().actuator.piston_travel_m;
        while (integrator.time_s() < duration_s) {
            integrator.advance(rate);
            y = integrator.state();
            const State x = y.template head<work_index>();
            worst_J = std::max(worst_J, std::abs(energy_J(x) - before_J - y[work_index]));
            most_work_J = std::max(most_work_J, std::abs(y[work_index]));
            const CraneOutputs outputs = crane_.outputs(x);
            pendent_slack += outputs.pendent_tension_N <= 0.0 ? 1 : 0;
            line_slack += outputs.load_line_tension_N <= 0.0 ? 1 : 0;
            tilting += outputs.contact_fraction < 1.0 ? 1 : 0;
            if (std::abs(x[Layout::piston_index]) > travel_m) {
                (x[Layout::piston_index] > 0.0 ? upper_stops : lower_stops) += 1;
                y[Layout::piston_index] = crane_.actuator().clamp_piston_m(x[Layout::piston_index]);
                integrator.restart(y);
            }
        }
    }

    double worst_J = 0.0;
    double most_work_J = 0.0;
    long pendent_slack = 0, line_slack = 0, tilting = 0, upper_stops = 0, lower_stops = 0;

  private:
    [[nodiscard]] double energy_J(const State& x) const {
        return kinetic_energy_J(crane_, x) + potential_energy_J(crane_, x);
    }

    const CraneDynamicsOf<Boom>& crane_;
};

TYPED_TEST(EnergyOf, LawTwoRunBalancesItsPowers) {
    const test_support::ThesisCase thesis = thesis_case(TypeParam::name);
    const typename TypeParam::Crane crane(thesis.crane);
    const typename TypeParam::State start = after_load_drop(crane, thesis.load_drop_m);
    const double injected_J = kinetic_energy_J(crane, start);
    const double desired_q1_m = crane.thesis_state(start)[q1_m];
    PowerBalance balance(crane);
    balance.run(start, 4.0, [&](double, const typename TypeParam::State& x) {
        return thesis.joint_gain * (desired_q1_m - crane.thesis_state(x)[q1_m]);
    });
    EXPECT_LT(balance.worst_J, 1e-6 * injected_J);
    EXPECT_GT(balance.most_work_J, 0.1 * injected_J);
    EXPECT_GT(balance.line_slack, 0);
    // The beam's q1 is about eight times the links', and so is what the law asks for.
    EXPECT_EQ(balance.pendent_slack > 0, TypeParam::name == 'B' || (TypeParam::is_beam && TypeParam::name == 'A'));
    EXPECT_GT(balance.tilting, 0);
}

// A valve driven from stop to stop throws the crane through every branch at once.
TYPED_TEST(EnergyOf, ValveDrivenIntoBothEndStopsBalancesItsPowers) {
    const test_support::ThesisCase thesis = thesis_case(TypeParam::name);
    const typename TypeParam::Crane crane(thesis.crane);
    const typename TypeParam::State start = after_load_drop(crane, thesis.load_drop_m);
    const double injected_J = kinetic_energy_J(crane, start);
    PowerBalance balance(crane);
    balance.run(start, 3.0, [](double t_s, const typename TypeParam::State&) {
        return 9e-3 * std::sin(2.0 * std::numbers::pi * 0.7 * t_s);
    });
    EXPECT_LT(balance.worst_J, 1e-6 * injected_J);
    // Case C's pendent is stretched by more than the piston's travel.
    EXPECT_EQ(balance.pendent_slack > 0, TypeParam::name != 'C');
    EXPECT_GT(balance.line_slack, 0);
    EXPECT_GT(balance.tilting, 0);
    EXPECT_GT(balance.upper_stops, 0);
    EXPECT_GT(balance.lower_stops, 0);
}

// The same at single states, without an integrator: the slope of E along the flow is the power.
TYPED_TEST(EnergyOf, SlopeAlongTheMotionIsThePower) {
    const typename TypeParam::Crane crane(thesis_crane(TypeParam::name));
    RandomStates random(crane, 9);
    for (int i = 0; i < 200; ++i) {
        SCOPED_TRACE(testing::Message() << "state " << i);
        const typename TypeParam::State x = random.state(i % 3 == 0   ? Contact::full
                                                         : i % 3 == 1 ? Contact::tilting
                                                                      : Contact::lifted);
        const double opening_m = random.between(-7e-3, 7e-3);
        const typename TypeParam::State flow = crane.derivative(x, opening_m);
        const auto energy_J = [&](double time_s) {
            const typename TypeParam::State y = x + time_s * flow;
            return kinetic_energy_J(crane, y) + potential_energy_J(crane, y);
        };
        constexpr double h = 2e-6;
        const double slope_W =
            (8.0 * (energy_J(h) - energy_J(-h)) - (energy_J(2.0 * h) - energy_J(-2.0 * h))) / (12.0 * h);
        const NonConservativePower power = non_conservative_power(crane, x, opening_m);
        const double kinetic_turnover_W =
            std::abs(velocities_of(x).dot(crane.mass_matrix(coordinates_of(x)) * velocities_of(flow)));
        ASSERT_NEAR(slope_W, power.total_W(),
                    1e-6 * (std::abs(power.boom_damping_W) + std::abs(power.soil_W) + std::abs(power.piston_W) +
                            kinetic_turnover_W));
        ASSERT_LE(power.boom_damping_W, 0.0);
    }
}

TYPED_TEST(EnergyOf, ResidualEnergyIsZeroAtRestAndBlindToThePiston) {
    const typename TypeParam::Crane crane(thesis_crane(TypeParam::name));
    const typename TypeParam::State rest = find_equilibrium(crane).state;
    const ResidualEnergyOf<typename TypeParam::Boom> residual(crane, rest);
    EXPECT_EQ(residual.energy_J(rest), 0.0);
    RandomStates random(crane, 3);
    typename TypeParam::State x = rest;
    for (int i = 0; i < TypeParam::Layout::piston_index; ++i) {
        x[i] += random.between(-1e-3, 1e-3);
    }
    const double energy_J = residual.energy_J(x);
    EXPECT_GT(energy_J, 0.0);
    x[TypeParam::Layout::piston_index] = 0.07;
    EXPECT_EQ(residual.energy_J(x), energy_J);
    typename TypeParam::State twice = rest + 2.0 * (x - rest);
    EXPECT_NEAR(residual.energy_J(twice), 4.0 * energy_J, 1e-9 * energy_J);
}

// Near its equilibrium the crane's own energy is the quadratic form (shut valve aside, whose oil the form leaves out).
TYPED_TEST(EnergyOf, ResidualEnergyIsTheCranesOwnForSmallDeviationsOnWholeTracks) {
    const typename TypeParam::Crane crane(bearing_whole(TypeParam::name));
    const typename TypeParam::State rest = find_equilibrium(crane).state;
    const ResidualEnergyOf<typename TypeParam::Boom> residual(crane, rest);
    const auto energy_J = [&](const typename TypeParam::State& y) {
        return kinetic_energy_J(crane, y) + potential_energy_J(crane, y) +
               full_contact_energy_J(crane.soil(), y[R1_m], y[phi2_rad]);
    };
    RandomStates random(crane, 4);
    for (int i = 0; i < 20; ++i) {
        typename TypeParam::State x = rest;
        for (int j = 0; j < TypeParam::Layout::piston_index; ++j) {
            x[j] += random.between(-1e-4, 1e-4);
        }
        ASSERT_NEAR(residual.energy_J(x), energy_J(x) - energy_J(rest), 2e-3 * residual.energy_J(x));
    }
}

}  // namespace
}  // namespace steadyboom::plant
