#include "plant/crane_jacobian.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "plant/equilibrium.hpp"
#include "random_states.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

using test_support::thesis_crane;

constexpr int states = 100;

/// Sixth-order central difference of `f` about 0.
template <class Function>
CraneState slope(const Function& f, double h) {
    return (45.0 * (f(h) - f(-h)) - 9.0 * (f(2.0 * h) - f(-2.0 * h)) + (f(3.0 * h) - f(-3.0 * h))) / (60.0 * h);
}

/// The crane with one uncertain parameter moved by `x`, the rest tensions kept where they were.
CraneDynamics moved(const CraneDynamics& crane, int parameter, double x, const RestTensions& rest) {
    CraneCalibration c = crane.calibration();
    switch (parameter) {
        case soil_log_modulus:
            c.soil_shear_modulus_Pa *= std::exp(x);
            break;
        case pendent_log_stiffness:
            c.free_pendent_length_m += rest.pendent_N / c.pendent_stiffness_N_m * (1.0 - std::exp(-x));
            c.pendent_stiffness_N_m *= std::exp(x);
            break;
        case load_line_log_stiffness:
            c.load_line_length_m += rest.load_line_N / c.load_line_stiffness_N_m * (1.0 - std::exp(-x));
            c.load_line_stiffness_N_m *= std::exp(x);
            break;
        default:
            break;
    }
    CraneDynamics result = crane;
    result.calibrate(c);
    return result;
}

struct ModeCount {
    int taut = 0, slack = 0, line_taut = 0, line_slack = 0, full = 0, partial = 0, lifted = 0, pushed_off = 0;
};

class JacobianOf : public testing::TestWithParam<char> {};

TEST_P(JacobianOf, IsTheSlopeOfTheRightHandSideInEveryMode) {
    for (const ValveModel valve : {ValveModel::linear, ValveModel::nonlinear}) {
        CraneParameters parameters = thesis_crane(GetParam());
        parameters.actuator.valve_model = valve;
        parameters.actuator.leakage_m3_s_Pa = 3e-11;
        const CraneDynamics crane(parameters);
        const Equilibrium equilibrium = find_equilibrium(crane);
        const RestTensions rest{equilibrium.pendent_tension_N, equilibrium.load_line_tension_N};
        RandomStates random(crane, 77U + static_cast<unsigned char>(GetParam()));
        ModeCount modes;
        double worst = 0.0;
        for (int i = 0; i < states; ++i) {
            constexpr std::array kinds = {Contact::full, Contact::tilting, Contact::tilting, Contact::lifted,
                                          Contact::level};
            CraneState x = random.state(kinds[static_cast<std::size_t>(i) % kinds.size()]);
            if (i % 5 == 1) {
                x[velocity_offset + R1_m] = random.between(8.0, 9.0);  // thrown up faster than the soil follows
            }
            const double opening_m = random.between(-7e-3, 7e-3);
            CraneJacobian jacobian;
            crane_jacobian(crane, x, opening_m, rest, jacobian);
            EXPECT_EQ(jacobian.derivative, crane.derivative(x, opening_m));

            const CraneOutputs outputs = crane.outputs(x);
            const double beta = outputs.contact_fraction;
            ++(outputs.pendent_tension_N > 0.0 ? modes.taut : modes.slack);
            ++(outputs.load_line_tension_N > 0.0 ? modes.line_taut : modes.line_slack);
            ++(beta == 1.0 ? modes.full : beta == 0.0 ? modes.lifted : modes.partial);
            const SoilReaction soil = crane.soil().reaction(x[R1_m], x[phi2_rad], std::sin(x[phi2_rad]),
                                                            x[velocity_offset + R1_m], x[velocity_offset + phi2_rad]);
            modes.pushed_off += beta > 0.0 && soil.vertical_N == 0.0 ? 1 : 0;

            CraneJacobian::Columns numeric;
            double step[CraneJacobian::column_count];
            for (int j = 0; j < CraneJacobian::column_count; ++j) {
                const double h = j == R1_m || j == phi2_rad ? 2e-6 : j == phi6_rad ? 2e-5 : 1e-4;
                step[j] = h;
                numeric.col(j) = slope(
                    [&](double d) {
                        if (j >= state_count) {
                            return moved(crane, j - state_count, d, rest).derivative(x, opening_m);
                        }
                        CraneState at = x;
                        at[j] += d;
                        return crane.derivative(at, opening_m);
                    },
                    h);
            }
            const double size = jacobian.derivative.cwiseAbs().maxCoeff();
            for (int j = 0; j < CraneJacobian::column_count; ++j) {
                const double column = numeric.col(j).cwiseAbs().maxCoeff();
                // What the differences lose by rounding: of the right-hand side, and of the terms that cancel in it.
                const double lost = 3e-14 * size / step[j] + 1e-9 * column;
                for (int row = 0; row < state_count; ++row) {
                    const double off =
                        (std::abs(jacobian.columns(row, j) - numeric(row, j)) - lost) / std::abs(numeric(row, j));
                    worst = std::max(worst, off);
                    EXPECT_LE(off, 1e-6) << "case " << GetParam() << ", state " << i << ", row " << row << ", column "
                                         << j << ": " << jacobian.columns(row, j) << " against " << numeric(row, j);
                }
            }
        }
        RecordProperty("worst", std::to_string(worst));
        for (const int count : {modes.taut, modes.slack, modes.line_taut, modes.line_slack, modes.full, modes.partial,
                                modes.lifted, modes.pushed_off}) {
            EXPECT_GE(count, 5) << "every mode is among the states";
        }
    }
}

TEST_P(JacobianOf, PistonAtItsStopMovesNothingFurther) {
    const CraneDynamics crane(thesis_crane(GetParam()));
    CraneState x = find_equilibrium(crane).state;
    x[piston_index] = crane.parameters().actuator.piston_travel_m;
    CraneJacobian jacobian;
    crane_jacobian(crane, x, 5e-3, {}, jacobian);
    EXPECT_EQ(jacobian.derivative[piston_index], 0.0);
    EXPECT_EQ(jacobian.columns.row(piston_index).cwiseAbs().maxCoeff(), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Cases, JacobianOf, testing::Values('A', 'B', 'C'));

}  // namespace
}  // namespace steadyboom::plant
