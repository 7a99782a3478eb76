#include "second_derivation.hpp"

#include <array>

#include <gtest/gtest.h>

#include "plant/energy.hpp"
#include "plant/equilibrium.hpp"
#include "plant/sensors.hpp"
#include "random_states.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

using Oracle = SecondDerivation;
using Real = Oracle::Real;
using Contact = RandomStates::Contact;
using test_support::thesis_crane;

constexpr int states = 100;
constexpr double relative = 1e-6;
/// What rounding of sums may add where terms cancel, as a share of the terms' magnitudes.
constexpr double rounding = 1e-12;

Oracle::Vector widened(const Coordinates& p) {
    return p.cast<Real>();
}

Contact contact_of(int i) {
    constexpr std::array kinds = {Contact::full, Contact::tilting, Contact::tilting, Contact::lifted, Contact::level};
    return kinds[static_cast<std::size_t>(i) % kinds.size()];
}

class SecondDerivationOf : public testing::TestWithParam<char> {
  protected:
    SecondDerivationOf() : parameters(with_leakage(thesis_crane(GetParam()))), crane(parameters), oracle(parameters) {}

    /// The thesis has no leakage; its term is proved all the same.
    static CraneParameters with_leakage(CraneParameters p) {
        p.actuator.leakage_m3_s_Pa = 3e-11;
        return p;
    }

    /// Calls `check(state, p, v)` at the seeded states and counts the branches they took.
    template <class Check>
    void at_random_states(const Check& check) {
        RandomStates random(crane, 1000U + static_cast<unsigned char>(GetParam()));
        int pendent_taut = 0;
        int line_taut = 0;
        int partial = 0;
        for (int i = 0; i < states; ++i) {
            SCOPED_TRACE(testing::Message() << "case " << GetParam() << ", state " << i);
            const CraneState x = random.state(contact_of(i));
            const CraneOutputs outputs = crane.outputs(x);
            pendent_taut += outputs.pendent_tension_N > 0.0 ? 1 : 0;
            line_taut += outputs.load_line_tension_N > 0.0 ? 1 : 0;
            partial += outputs.contact_fraction > 0.0 && outputs.contact_fraction < 1.0 ? 1 : 0;
            check(x, widened(coordinates_of(x)), widened(velocities_of(x)));
            if (HasFatalFailure()) {
                return;
            }
        }
        for (const int count : {pendent_taut, line_taut, partial}) {
            EXPECT_GE(count, states / 4);
            EXPECT_LE(count, states * 3 / 4);
        }
    }

    CraneParameters parameters;
    CraneDynamics crane;
    Oracle oracle;
};

TEST_P(SecondDerivationOf, KineticEnergyGivesTheMassMatrix) {
    at_random_states([&](const CraneState& x, const Oracle::Vector& p, const Oracle::Vector&) {
        const MassMatrix M = crane.mass_matrix(Coordinates(coordinates_of(x)));
        const MassMatrix expected = oracle.mass_matrix(p).cast<double>();
        for (int i = 0; i < coordinate_count; ++i) {
            for (int j = 0; j < coordinate_count; ++j) {
                ASSERT_NEAR(M(i, j), expected(i, j),
                            relative * std::abs(expected(i, j)) + rounding * std::sqrt(expected(i, i) * expected(j, j)))
                    << "entry " << i << "," << j;
            }
        }
    });
}

TEST_P(SecondDerivationOf, LagrangesEquationGivesTheForces) {
    at_random_states([&](const CraneState& x, const Oracle::Vector& p, const Oracle::Vector& v) {
        const Coordinates Q =
            crane.generalized_force(Coordinates(coordinates_of(x)), Coordinates(velocities_of(x)), x[piston_index]);
        const Oracle::Force expected = oracle.force(p, v, x[piston_index]);
        for (int i = 0; i < coordinate_count; ++i) {
            const auto wanted = static_cast<double>(expected.value[i]);
            ASSERT_NEAR(Q[i], wanted, relative * std::abs(wanted) + rounding * static_cast<double>(expected.scale[i]))
                << "coordinate " << i;
        }
    });
}

TEST_P(SecondDerivationOf, DerivativeIsTheMotionAndThePistonRate) {
    at_random_states([&](const CraneState& x, const Oracle::Vector& p, const Oracle::Vector& v) {
        constexpr double opening_m = 2.5e-3;
        const CraneState rate = crane.derivative(x, opening_m);
        const Oracle::Vector expected = oracle.acceleration(p, v, x[piston_index]);
        ASSERT_EQ(coordinates_of(rate), velocities_of(x));
        const auto largest = static_cast<double>(expected.cwiseAbs().maxCoeff());
        for (int i = 0; i < coordinate_count; ++i) {
            const auto wanted = static_cast<double>(expected[i]);
            ASSERT_NEAR(rate[velocity_offset + i], wanted, relative * std::abs(wanted) + 1e-10 * largest)
                << "coordinate " << i;
        }
        const auto piston = static_cast<double>(oracle.piston_rate(p, v, x[piston_index], opening_m));
        ASSERT_NEAR(rate[piston_index], piston, relative * std::abs(piston));
    });
}

TEST_P(SecondDerivationOf, PointsAndOutputsAreWhereTheGeometryPutsThem) {
    at_random_states([&](const CraneState& x, const Oracle::Vector& p, const Oracle::Vector& v) {
        const CranePoints points = crane.points(Coordinates(coordinates_of(x)));
        const Oracle::Points expected = oracle.points(p);
        const auto same = [](const Eigen::Vector2d& a, const Oracle::Point& b) {
            EXPECT_NEAR(a.x(), static_cast<double>(b.real()), 1e-12);
            EXPECT_NEAR(a.y(), static_cast<double>(b.imag()), 1e-12);
        };
        same(points.track_centre, expected.track);
        same(points.car_body_centre, expected.car_body);
        same(points.boom_butt, expected.butt);
        same(points.lower_joint, expected.lower);
        same(points.upper_joint, expected.upper);
        same(points.boom_tip, expected.tip);
        same(points.load, expected.load);
        for (std::size_t i = 0; i < 3; ++i) {
            same(points.link_centres[i], expected.links[i]);
        }

        const CraneOutputs outputs = crane.outputs(x);
        const auto tension_N = static_cast<double>(oracle.pendent_tension(p, x[piston_index]));
        EXPECT_NEAR(outputs.pendent_length_m, static_cast<double>(oracle.pendent_length(p)), 1e-11);
        EXPECT_NEAR(outputs.pendent_rate_m_s, static_cast<double>(oracle.pendent_rate(p, v)), 1e-11);
        EXPECT_NEAR(outputs.pendent_tension_N, tension_N, relative * tension_N);
        EXPECT_NEAR(outputs.load_pressure_Pa, tension_N / 0.0645, relative * tension_N / 0.0645);
        EXPECT_NEAR(outputs.load_line_tension_N, static_cast<double>(oracle.load_line_tension(p)), 1e-6);
        EXPECT_NEAR(outputs.chord_m, static_cast<double>(std::abs(expected.tip - expected.butt)), 1e-12);
        EXPECT_NEAR(outputs.contact_fraction, static_cast<double>(oracle.contact(p[R1_m], p[phi2_rad]).share), 1e-12);
    });
    EXPECT_NEAR(crane.free_pendent_length_m(), static_cast<double>(oracle.free_pendent_length()), 1e-12);
}

TEST_P(SecondDerivationOf, SensorsReadStrainAnglesTensionLengthAndPressure) {
    const double L_B = parameters.structure.boom_length_m / 3.0;
    const double EI_N_m2 = parameters.structure.boom_joint_stiffness_N_m * L_B / 3.0;
    at_random_states([&](const CraneState& x, const Oracle::Vector& p, const Oracle::Vector&) {
        const SensorVector y = ideal_sensors(crane, x, 1.25e-3);
        const auto strain = [&](double q_m) {
            const double moment_N_m = 3.0 * parameters.structure.boom_joint_stiffness_N_m * q_m / L_B;
            return 1e6 * moment_N_m * 1.22 / EI_N_m2;
        };
        EXPECT_NEAR(y[strain_lower_microstrain], strain(x[q1_m]), 1e-9 * 1e4);
        EXPECT_NEAR(y[strain_upper_microstrain], strain(x[q2_m]), 1e-9 * 1e4);
        EXPECT_EQ(y[boom_angle_rad], x[phi6_rad]);
        EXPECT_EQ(y[line_angle_rad], x[phi9_rad]);
        EXPECT_NEAR(y[line_tension_N], static_cast<double>(oracle.load_line_tension(p)), 1e-6);
        EXPECT_EQ(y[line_length_m], 12.2);
        EXPECT_EQ(y[piston_m], x[piston_index]);
        EXPECT_EQ(y[spool_m], 1.25e-3);
        const auto pressure_Pa = static_cast<double>(oracle.pendent_tension(p, x[piston_index])) / 0.0645;
        EXPECT_NEAR(y[load_pressure_Pa], pressure_Pa, relative * pressure_Pa);
    });
}

TEST_P(SecondDerivationOf, EnergiesAreTheSame) {
    at_random_states([&](const CraneState& x, const Oracle::Vector& p, const Oracle::Vector& v) {
        const auto kinetic_J = static_cast<double>(oracle.kinetic_energy(p, v));
        const auto potential_J = static_cast<double>(oracle.potential_energy(p, x[piston_index]));
        EXPECT_NEAR(kinetic_energy_J(crane, x), kinetic_J, 1e-12 * kinetic_J);
        EXPECT_NEAR(potential_energy_J(crane, x), potential_J, 1e-12 * std::abs(potential_J) + 1e-6);
        EXPECT_NEAR(oil_energy_J(crane, x),
                    std::pow(static_cast<double>(oracle.pendent_tension(p, x[piston_index])) / 0.0645, 2) * 1.31e-2 /
                        (8.0 * 700e6),
                    1e-6);
    });
}

// The stiffness of the residual energy, a second time: -dQ/dp by differences of the other derivation.
TEST_P(SecondDerivationOf, StiffnessAtEquilibriumIsTheForcesGradient) {
    const Equilibrium rest = find_equilibrium(crane);
    const MassMatrix K = stiffness_matrix(crane, Coordinates(coordinates_of(rest.state)));
    const Oracle::Vector p = widened(coordinates_of(rest.state));
    Oracle::Matrix gradient;
    for (int j = 0; j < coordinate_count; ++j) {
        constexpr Real h = 1e-6L;
        const Oracle::Vector step = h * Oracle::Vector::Unit(j);
        gradient.col(j) = (oracle.force(p + step, Oracle::Vector::Zero(), 0.0L).value -
                           oracle.force(p - step, Oracle::Vector::Zero(), 0.0L).value) /
                          (2.0L * h);
    }
    const MassMatrix expected = (-0.5L * (gradient + gradient.transpose())).cast<double>();
    for (int i = 0; i < coordinate_count; ++i) {
        for (int j = 0; j < coordinate_count; ++j) {
            EXPECT_NEAR(K(i, j), expected(i, j), 1e-6 * std::sqrt(std::abs(expected(i, i) * expected(j, j))))
                << i << "," << j;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Thesis, SecondDerivationOf, testing::Values('A', 'B', 'C'),
                         [](const auto& test) { return std::string("Case") + test.param; });

}  // namespace
}  // namespace steadyboom::plant
