// Limits in which the crane is something a textbook solves. "Rigid" parts are stiff enough for their give to stay below
// the tolerance a test states.

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "crane_run.hpp"
#include "plant/energy.hpp"
#include "plant/linear_modes.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

using std::numbers::pi;
using test_support::thesis_crane;

constexpr double load_kg = 13600.0;
constexpr double link_kg = 4730.0;
constexpr double total_kg = 61300.0 + 87600.0 + 3.0 * link_kg + load_kg;

/// Case A with every spring stiff, twice as stiff at scale 2; a test then softens the one it is about. Stiffer still
/// and the differences of the linearisation would step across the ropes' kinks.
CraneParameters rigid(double scale) {
    CraneParameters parameters = thesis_crane('A');
    parameters.structure.boom_joint_stiffness_N_m = scale * 1e12;
    parameters.soil.shear_modulus_Pa = scale * 5e9;
    parameters.ropes.load_line_stiffness_N_m = scale * 5e8;
    parameters.ropes.pendent_stiffness_N_m = scale * 5e9;
    parameters.actuator.bulk_modulus_Pa = 1e20;  // else the oil is the softest of all
    return parameters;
}

/// `ratio(scale)` in the limit of rigid parts; what their give adds goes with 1/scale.
template <class Ratio>
double rigid_limit(const Ratio& ratio) {
    return 2.0 * ratio(2.0) - ratio(1.0);
}

/// Where it stands, by Newton alone: springs this stiff round too coarsely for find_equilibrium's proof of convergence.
CraneState rest(const CraneDynamics& crane) {
    Coordinates p = Coordinates::Zero();
    p[R1_m] = -total_kg * gravity_m_s2 / crane.soil().coefficients(1.0).vertical_stiffness_N_m;
    p[R9_m] = 12.2 + load_kg * gravity_m_s2 / crane.parameters().ropes.load_line_stiffness_N_m;
    p[phi6_rad] = crane.parameters().structure.boom_angle_rad - 1e-5;
    for (int i = 0; i < 30; ++i) {
        p += stiffness_matrix(crane, p).fullPivLu().solve(crane.generalized_force(p, Coordinates::Zero(), 0.0));
    }
    CraneState x = CraneState::Zero();
    coordinates_of(x) = p;
    const CraneOutputs outputs = crane.outputs(x);
    EXPECT_GT(outputs.pendent_tension_N, 0.0);
    EXPECT_GT(outputs.load_line_tension_N, 0.0);
    EXPECT_EQ(outputs.contact_fraction, 1.0);
    return x;
}

LinearMode mode_of(const CraneDynamics& crane, const CraneState& x, Coordinate coordinate) {
    LinearMode found{.frequency_Hz = 0.0, .damping_ratio = 0.0, .dominant = coordinate};
    int count = 0;
    for (const LinearMode& mode : linear_modes(crane, x)) {
        if (mode.dominant == coordinate && mode.frequency_Hz > 0.0) {
            found = count == 0 ? mode : found;
            ++count;
        }
    }
    EXPECT_GE(count, 1);
    return found;
}

TEST(RigidCrane, LoadSwingsAsAPendulum) {
    const double ratio = rigid_limit([](double scale) {
        const CraneDynamics crane(rigid(scale));
        const CraneState x = rest(crane);
        const LinearMode swing = mode_of(crane, x, phi9_rad);
        EXPECT_NEAR(swing.damping_ratio, 0.0, 1e-5);
        return swing.frequency_Hz / (std::sqrt(gravity_m_s2 / x[R9_m]) / (2.0 * pi));
    });
    EXPECT_NEAR(ratio, 1.0, 1e-5);
}

TEST(RigidCrane, LargeSwingHasThePendulumsPeriod) {
    const CraneDynamics crane(rigid(2.0));
    CraneState start = rest(crane);
    constexpr double amplitude_rad = 0.8;
    start[phi9_rad] = amplitude_rad;
    start[R9_m] = 12.2 + load_kg * gravity_m_s2 * std::cos(amplitude_rad) / 1e9;

    // From rest to the vertical is a quarter of a period, from there to the next passage a half.
    std::vector<double> crossings_s;
    double before_rad = amplitude_rad;
    constexpr double period_s = 1e-3;
    run_crane(
        crane, start, 7.0, period_s, 1e-9, [](double, const CraneState&) { return 0.0; },
        [&](double t_s, const CraneState& x, double) {
            if (before_rad * x[phi9_rad] < 0.0) {
                crossings_s.push_back(t_s - period_s * x[phi9_rad] / (x[phi9_rad] - before_rad));
            }
            before_rad = x[phi9_rad];
        });
    // T = 2 pi sqrt(R / g) / agm(1, cos(amplitude / 2)).
    double a = 1.0;
    double g = std::cos(amplitude_rad / 2.0);
    for (int i = 0; i < 6; ++i) {
        const double mean = 0.5 * (a + g);
        g = std::sqrt(a * g);
        a = mean;
    }
    const double expected_s = 2.0 * pi * std::sqrt(12.2 / gravity_m_s2) / a;
    ASSERT_EQ(crossings_s.size(), 2U);
    EXPECT_NEAR(2.0 * (crossings_s[1] - crossings_s[0]), expected_s, 1e-4 * expected_s);
    EXPECT_NEAR(4.0 * crossings_s[0], expected_s, 1e-4 * expected_s);
}

TEST(RigidCrane, LoadBouncesOnItsLineAsAMassOnASpring) {
    const double ratio = rigid_limit([](double scale) {
        CraneParameters parameters = rigid(scale);
        parameters.ropes.load_line_stiffness_N_m = 3.83e6;
        const CraneDynamics crane(parameters);
        const CraneState x = rest(crane);
        EXPECT_NEAR(x[R9_m] - 12.2, load_kg * gravity_m_s2 / 3.83e6, 1e-9);
        const LinearMode bounce = mode_of(crane, x, R9_m);
        EXPECT_NEAR(bounce.damping_ratio, 0.0, 1e-4);
        return bounce.frequency_Hz / (std::sqrt(3.83e6 / load_kg) / (2.0 * pi));
    });
    EXPECT_NEAR(ratio, 1.0, 2e-5);
}

TEST(RigidCrane, BouncesOnTheGroundAsADampedMassOnASpring) {
    static constexpr double soft_Pa = 82.7e4;
    const double radius_m = std::sqrt(4.0 / pi * 4.11 * 1.22);
    const double stiffness_N_m = 4.0 * soft_Pa * radius_m / 0.7;
    const double damping_N_s_m = 3.4 * radius_m * radius_m * std::sqrt(1780.0 * soft_Pa) / 0.7;
    const auto bounce = [](double scale) {
        CraneParameters parameters = rigid(scale);
        parameters.soil.shear_modulus_Pa = soft_Pa;
        parameters.structure.track_inertia_kg_m2 = 1e13;  // keeps rocking out of it
        const CraneDynamics crane(parameters);
        const CraneState x = rest(crane);
        EXPECT_NEAR(x[R1_m], -total_kg * gravity_m_s2 / crane.soil().coefficients(1.0).vertical_stiffness_N_m, 1e-9);
        return mode_of(crane, x, R1_m);
    };
    const double frequency_Hz = rigid_limit([&](double scale) { return bounce(scale).frequency_Hz; });
    const double damping = rigid_limit([&](double scale) { return bounce(scale).damping_ratio; });
    EXPECT_NEAR(frequency_Hz, std::sqrt(stiffness_N_m / total_kg) / (2.0 * pi), 1e-4 * frequency_Hz);
    EXPECT_NEAR(damping, damping_N_s_m / (2.0 * std::sqrt(stiffness_N_m * total_kg)), 1e-4);
}

// With the chord held, the links move as q1 = q2 (mass 3/4 m_B, stiffness 3 K) or q1 = -q2 (1/4 m_B, 9 K), K being
// K_B / L_B^2 less a third of the thrust over L_B, which bows the boom; damping takes C and 9 C.
TEST(HeldBoom, BendsInTwoModesUnderItsThrust) {
    const CraneDynamics crane(thesis_crane('A'));
    const CraneState x = find_equilibrium(crane).state;

    const double L_B = 45.7 / 3.0;
    const double phi6 = x[phi6_rad];
    const double phi_B = 40.1 * pi / 180.0 + pi / 2.0 - (phi6 - x[phi2_rad]);
    const double pendent_m = std::sqrt(45.7 * 45.7 + 10.67 * 10.67 - 2.0 * 45.7 * 10.67 * std::cos(phi_B));
    const double hung_N = (load_kg + 1.5 * link_kg) * gravity_m_s2;
    const double tension_N = hung_N * 45.7 * std::cos(phi6) / (45.7 * 10.67 * std::sin(phi_B) / pendent_m);
    const double thrust_N = hung_N * std::sin(phi6) + tension_N * (45.7 - 10.67 * std::cos(phi_B)) / pendent_m;
    // The links sag by millimetres, which the moment balance above leaves out.
    EXPECT_NEAR(crane.outputs(x).pendent_tension_N, tension_N, 1e-4 * tension_N);

    const double K_N_m = 1.31e9 / (L_B * L_B) - thrust_N / (3.0 * L_B);
    const double EI_N_m2 = 1.31e9 * L_B / 3.0;
    const double C_N_s_m =
        0.007 * pi * pi * 0.375 * 45.7 * 45.7 * std::sqrt(EI_N_m2 * link_kg / (3.0 * 45.7 * 45.7 * 45.7)) / (L_B * L_B);

    const Coordinates p = coordinates_of(x);
    const MassMatrix M = crane.mass_matrix(p);
    const MassMatrix K = stiffness_matrix(crane, p);
    const auto held = [&](double q2_over_q1, double mass_kg, double stiffness_N_m, double damping_N_s_m) {
        SCOPED_TRACE(q2_over_q1);
        Coordinates shape = Coordinates::Zero();
        shape[q1_m] = 1.0;
        shape[q2_m] = q2_over_q1;
        const double m_kg = 0.5 * shape.dot(M * shape);
        const double k_N_m = 0.5 * shape.dot(K * shape);
        // Even in the velocities but for the damping.
        const double c_N_s_m = -0.25 * shape.dot(crane.generalized_force(p, shape, 0.0) -
                                                 crane.generalized_force(p, Coordinates(-shape), 0.0));
        EXPECT_NEAR(m_kg, mass_kg, 1e-5 * mass_kg);
        EXPECT_NEAR(k_N_m, stiffness_N_m, 1e-5 * stiffness_N_m);
        EXPECT_NEAR(c_N_s_m, damping_N_s_m, 1e-6 * damping_N_s_m);
    };
    held(1.0, 0.75 * link_kg, 3.0 * K_N_m, C_N_s_m);
    held(-1.0, 0.25 * link_kg, 9.0 * K_N_m, 9.0 * C_N_s_m);
}

TEST(LinkBoom, ChordShortensAsThreeLinksOfFixedLength) {
    const LinkBoom boom(thesis_crane('A').structure);
    const double L_B = 45.7 / 3.0;
    const double q1 = 0.3;
    const double q2 = -0.2;
    const double exact_m =
        std::sqrt(L_B * L_B - q1 * q1) + std::sqrt(L_B * L_B - (q2 - q1) * (q2 - q1)) + std::sqrt(L_B * L_B - q2 * q2);
    EXPECT_EQ(boom.chord_m({0.0, 0.0}), 45.7);
    EXPECT_NEAR(45.7 - boom.chord_m({q1, q2}), 45.7 - exact_m, 1e-3 * (45.7 - exact_m));
}

TEST(FreeCrane, EveryMassFallsWithGravityWhenNothingHolds) {
    const CraneDynamics crane(thesis_crane('A'));
    CraneState x = CraneState::Zero();
    x[R1_m] = 1.0;
    x[R9_m] = 12.0;
    x[phi6_rad] = 1.2;  // above phi6(t0): the pendent is slack
    ASSERT_EQ(crane.outputs(x).pendent_tension_N, 0.0);
    const CraneState rate = crane.derivative(x, 0.0);
    EXPECT_NEAR(rate[velocity_offset + R1_m], -gravity_m_s2, 1e-10);
    for (const int i : {phi2_rad, R9_m, q1_m, q2_m, phi6_rad, phi9_rad}) {
        EXPECT_NEAR(rate[velocity_offset + i], 0.0, 1e-10) << i;
    }
}

TEST(LinearModes, AnOverdampedBounceIsTwoEntriesOfDampingOne) {
    CraneParameters parameters = thesis_crane('A');
    parameters.soil.density_kg_m3 *= 30.0;
    const CraneDynamics crane(parameters);
    int overdamped = 0;
    const std::vector<LinearMode> modes = linear_modes(crane, find_equilibrium(crane).state);
    for (const LinearMode& mode : modes) {
        EXPECT_LE(mode.damping_ratio, 1.0);
        overdamped += mode.damping_ratio == 1.0 ? 1 : 0;
    }
    EXPECT_EQ(overdamped, 2);
    EXPECT_EQ(modes.size(), 8U);
}

TEST(LinearModes, NamesEveryCoordinate) {
    EXPECT_STREQ(coordinate_name(R1_m), "R1");
    EXPECT_STREQ(coordinate_name(phi2_rad), "phi2");
    EXPECT_STREQ(coordinate_name(R9_m), "R9");
    EXPECT_STREQ(coordinate_name(q1_m), "q1");
    EXPECT_STREQ(coordinate_name(q2_m), "q2");
    EXPECT_STREQ(coordinate_name(phi6_rad), "phi6");
    EXPECT_STREQ(coordinate_name(phi9_rad), "phi9");
    EXPECT_STREQ(coordinate_name(coordinate_count), "?");
}

}  // namespace
}  // namespace steadyboom::plant
