// The beam alone and on the crane, against what a textbook says of beams.

#include "plant/beam_boom.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "plant/equilibrium.hpp"
#include "plant/linear_modes.hpp"
#include "plant/pinned_boom.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

using std::numbers::pi;
using test_support::thesis_crane;

constexpr double length_m = 45.7;
constexpr double mass_per_m = 3.0 * 4730.0 / length_m;
constexpr double EI_N_m2 = 1.31e9 * length_m / 9.0;
constexpr double radius_m = 1.22;

/// Deflection of a pinned beam at `s_m` under a force F at a third, divided by F.
double flexibility_m_N(double s_m, double force_at_m) {
    const double a = std::min(s_m, force_at_m);
    const double b = length_m - std::max(s_m, force_at_m);
    return a * b * (length_m * length_m - a * a - b * b) / (6.0 * EI_N_m2 * length_m);
}

TEST(BeamBoom, PinnedBeamHasRayleighsFrequencies) {
    const BeamBoom boom(thesis_crane('A').structure);
    const Eigen::Vector3d straight = Eigen::Vector3d::Zero();
    const BeamBoom::Sums sums = boom.sums(straight, boom.chord_m(straight), boom.chord_slope(straight));
    Eigen::Matrix3d stiffness;
    for (int k = 0; k < 3; ++k) {
        stiffness.col(k) = -boom.bending_force_N(Eigen::Vector3d::Unit(k));
    }
    const Eigen::Matrix3d mass = sums.flexible_flexible_kg.selfadjointView<Eigen::Lower>();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> eigen(stiffness, mass);
    for (int k = 1; k <= 3; ++k) {
        const double wave_1_m = k * pi / length_m;
        const double expected_rad_s = std::sqrt(EI_N_m2 * std::pow(wave_1_m, 4) /
                                                (mass_per_m * (1.0 + radius_m * radius_m * wave_1_m * wave_1_m)));
        EXPECT_NEAR(std::sqrt(eigen.eigenvalues()[k - 1]), expected_rad_s, 1e-9 * expected_rad_s) << k;
        EXPECT_NEAR(boom.pinned_frequency_rad_s(k), expected_rad_s, 1e-12 * expected_rad_s) << k;
    }
}

// The boom's own rows of the crane's M and K at rest are the pinned beam's less what the thrust gives way,
// P (k pi)^2 / (2 R_B), the boom's own weight pressing with half of itself.
TEST(BeamBoom, OnTheCraneItsThrustSoftensItAsEulerSays) {
    const BeamCraneDynamics crane(thesis_crane('A'));
    const BeamCraneDynamics::State x = find_equilibrium(crane).state;
    const BeamCraneDynamics::Coordinates p = coordinates_of(x);
    const auto M = crane.mass_matrix(p);
    const auto K = stiffness_matrix(crane, p);
    const CraneOutputs outputs = crane.outputs(x);
    const double phi6 = x[BeamCraneDynamics::Layout::phi6_index];
    const double phi_B = 40.1 * pi / 180.0 + pi / 2.0 - (phi6 - x[phi2_rad]);
    const double pendent_m = std::sqrt(length_m * length_m + 10.67 * 10.67 - 2.0 * length_m * 10.67 * std::cos(phi_B));
    const double tip_thrust_N = 13600.0 * gravity_m_s2 * std::sin(phi6) +
                                outputs.pendent_tension_N * (length_m - 10.67 * std::cos(phi_B)) / pendent_m;
    for (int k = 1; k <= 3; ++k) {
        const int row = BeamCraneDynamics::Layout::boom_index + k - 1;
        const double wave_1_m = k * pi / length_m;
        const double thrust_N = tip_thrust_N + 0.5 * 3.0 * 4730.0 * gravity_m_s2 * std::sin(phi6);
        const double stiffness_N_m = 0.5 * length_m * wave_1_m * wave_1_m * (EI_N_m2 * wave_1_m * wave_1_m - thrust_N);
        const double mass_kg = 0.5 * length_m * mass_per_m * (1.0 + radius_m * radius_m * wave_1_m * wave_1_m);
        EXPECT_NEAR(K(row, row), stiffness_N_m, 1e-4 * stiffness_N_m) << k;
        EXPECT_NEAR(M(row, row), mass_kg, 2e-4 * mass_kg) << k;
    }
}

TEST(BeamBoom, SagsAtRestAsAPinnedBeamUnderItsWeight) {
    CraneParameters parameters = thesis_crane('A');
    const BeamCraneDynamics crane(parameters);
    const Equilibrium links = find_equilibrium(CraneDynamics(parameters));
    const EquilibriumOf<BeamBoom> beam = find_equilibrium(crane);
    const CraneState rest = crane.thesis_state(beam.state);
    // 11 w L^4 / (972 E I) at a third, enlarged by the thrust: 1 / (1 - P / P_Euler) for a bow of one wave.
    const double across_N_m = mass_per_m * gravity_m_s2 * std::cos(rest[phi6_rad]);
    const double sag_m = 11.0 * across_N_m * std::pow(length_m, 4) / (972.0 * EI_N_m2);
    const double euler_N = EI_N_m2 * std::pow(pi / length_m, 2);
    const double own_N = 0.5 * 3.0 * 4730.0 * gravity_m_s2 * std::sin(rest[phi6_rad]);
    const double phi_B = 40.1 * pi / 180.0 + pi / 2.0 - (rest[phi6_rad] - rest[phi2_rad]);
    const double pendent_m = std::sqrt(length_m * length_m + 10.67 * 10.67 - 2.0 * length_m * 10.67 * std::cos(phi_B));
    const double thrust_N = 13600.0 * gravity_m_s2 * std::sin(rest[phi6_rad]) + own_N +
                            beam.pendent_tension_N * (length_m - 10.67 * std::cos(phi_B)) / pendent_m;
    EXPECT_NEAR(rest[q1_m], sag_m / (1.0 - thrust_N / euler_N), 1e-3 * sag_m);
    EXPECT_NEAR(rest[q2_m], rest[q1_m], 1e-3 * sag_m);
    // What holds the boom is statically determinate: both booms pull alike.
    EXPECT_NEAR(beam.pendent_tension_N, links.pendent_tension_N, 5e-4 * links.pendent_tension_N);
    EXPECT_NEAR(beam.load_line_tension_N, links.load_line_tension_N, 1e-4);
    EXPECT_NEAR(rest[phi6_rad], links.state[phi6_rad], 1e-4);
    EXPECT_NEAR(rest[R1_m], links.state[R1_m], 1e-8);
}

// The chord loses what a bow of the same shape loses, int w'^2 / 2 exactly and the arc's true excess to its order.
TEST(BeamBoom, ChordShortensByTheBowsExcessLength) {
    const BeamBoom boom(thesis_crane('A').structure);
    const Eigen::Vector3d a(0.3, -0.2, 0.1);
    double covered_m = 0.0;
    constexpr int pieces = 20000;
    for (int i = 0; i < pieces; ++i) {
        const double s_m = (i + 0.5) * length_m / pieces;
        double slope = 0.0;
        for (int k = 1; k <= 3; ++k) {
            slope += a[k - 1] * k * pi / length_m * std::cos(k * pi * s_m / length_m);
        }
        covered_m += std::sqrt(1.0 - slope * slope) * length_m / pieces;
    }
    EXPECT_EQ(boom.chord_m(Eigen::Vector3d::Zero()), length_m);
    EXPECT_NEAR(length_m - boom.chord_m(a), length_m - covered_m, 2e-3 * (length_m - covered_m));
}

// A force across the boom at a third: the three modes leave out the higher ones' share, which falls with k^-4.
TEST(BeamBoom, BendsUnderAForceAtAThirdAsAPinnedBeam) {
    const BeamBoom boom(thesis_crane('A').structure);
    constexpr double force_N = 1e4;
    Eigen::Vector3d a;
    for (int k = 1; k <= 3; ++k) {
        a[k - 1] = force_N * std::sin(k * pi / 3.0) / -boom.bending_force_N(Eigen::Vector3d::Unit(k - 1))[k - 1];
    }
    const Eigen::Vector2d q_m = boom.thirds_deflection(a);
    EXPECT_NEAR(q_m[0], force_N * flexibility_m_N(length_m / 3.0, length_m / 3.0), 7e-3 * q_m[0]);
    EXPECT_NEAR(q_m[1], force_N * flexibility_m_N(2.0 * length_m / 3.0, length_m / 3.0), 7e-3 * q_m[1]);
    EXPECT_GT(boom.thirds_strain(a)[0], 0.0) << "positive where the boom bows downwards, as q";
}

TEST(BeamBoom, FirstModeIsDampedAsTheThreeLinksFirst) {
    const StructureParameters structure = thesis_crane('A').structure;
    const BeamBoom beam(structure);
    const LinkBoom links(structure);
    const Eigen::Vector2d together(1.0, 1.0);
    const double links_ratio = -links.damping_force_N(together).dot(together) /
                               (2.0 * std::sqrt(2.0 * links.bending_energy_J(together) * 1.5 * 4730.0));
    EXPECT_NEAR(links_ratio, 0.007 * pi * pi / (8.0 * std::sqrt(3.0)), 1e-12);
    for (int k = 1; k <= 3; ++k) {
        const Eigen::Vector3d mode = Eigen::Vector3d::Unit(k - 1);
        const double ratio = -beam.damping_force_N(mode)[k - 1] /
                             (2.0 * std::sqrt(2.0 * beam.bending_energy_J(mode) * 0.5 * mass_per_m * length_m));
        EXPECT_NEAR(ratio, k * k * links_ratio, 1e-12) << k;
    }
}

// 3.1.1-13 follows from the elements only with clamped ends; read as kinks it makes the first mode 7.5 times as stiff
// as a beam is against deflections at its thirds, and the second 1.5 times.
TEST(PinnedBoom, StaticCondensationMakesTheLinksMuchStifferThanTheBeam) {
    const PinnedBoom boom = pinned_boom(thesis_crane('A').structure);
    const double L_B = length_m / 3.0;
    const double K_B = 1.31e9;
    Eigen::Matrix2d printed;
    printed << 2.0, 1.0, 1.0, 2.0;
    EXPECT_LT((boom.condensed_to_rotations_N_m - K_B * printed).cwiseAbs().maxCoeff(), 1e-9 * K_B);
    Eigen::Matrix2d kink;
    kink << 2.0, -1.0, -1.0, 2.0;
    kink /= L_B;
    const Eigen::Matrix2d read_as_kinks = kink.transpose() * boom.condensed_to_rotations_N_m * kink;
    EXPECT_LT((boom.links_stiffness_N_m - read_as_kinks).cwiseAbs().maxCoeff(), 1e-9 * boom.links_stiffness_N_m(0, 0));
    // Against the textbook's flexibility of a pinned beam.
    Eigen::Matrix2d flexibility;
    for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) {
            flexibility(i, j) = flexibility_m_N((i + 1) * L_B, (j + 1) * L_B);
        }
    }
    EXPECT_LT((boom.condensed_to_deflections_N_m * flexibility - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff(),
              1e-9);
    const Eigen::Vector2d together(1.0, 1.0);
    const Eigen::Vector2d apart(1.0, -1.0);
    const auto stiffer = [&](const Eigen::Vector2d& shape) {
        return shape.dot(boom.links_stiffness_N_m * shape) / shape.dot(boom.condensed_to_deflections_N_m * shape);
    };
    EXPECT_NEAR(stiffer(together), 7.5, 1e-9);
    EXPECT_NEAR(stiffer(apart), 1.5, 1e-9);

    EXPECT_NEAR(boom.links_Hz[0], 11.0, 0.05);
    EXPECT_NEAR(boom.links_Hz[1], 33.0, 0.05);
    EXPECT_NEAR(boom.condensed_links_Hz[0], 4.02, 0.01);
    EXPECT_NEAR(boom.beam_Hz[0], 3.47, 0.01);
    EXPECT_NEAR(boom.beam_Hz[1], 13.7, 0.05);
    EXPECT_NEAR(boom.links_Hz[0] / boom.beam_Hz[0], 3.17, 0.01);
    EXPECT_NEAR(boom.links_Hz[1] / boom.beam_Hz[1], 2.40, 0.01);
}

TEST(FreeCrane, EveryMassOfTheBeamFallsWithGravityToo) {
    const BeamCraneDynamics crane(thesis_crane('A'));
    using Layout = BeamCraneDynamics::Layout;
    BeamCraneDynamics::State x = BeamCraneDynamics::State::Zero();
    x[R1_m] = 1.0;
    x[R9_m] = 12.0;
    x[Layout::phi6_index] = 1.2;
    ASSERT_EQ(crane.outputs(x).pendent_tension_N, 0.0);
    const BeamCraneDynamics::State rate = crane.derivative(x, 0.0);
    EXPECT_NEAR(rate[Layout::velocity_offset + R1_m], -gravity_m_s2, 1e-10);
    for (int i = 1; i < Layout::coordinate_count; ++i) {
        EXPECT_NEAR(rate[Layout::velocity_offset + i], 0.0, 1e-10) << i;
    }
}

// A boom that cannot bend is the same boom, links or beam, but for the sections' rotary inertia and the links' lumped
// mass: with next to no mass both cranes are one.
TEST(StiffLightBoom, IsOneCraneWithEitherModel) {
    CraneParameters parameters = thesis_crane('A');
    parameters.structure.boom_joint_stiffness_N_m = 1e10;
    parameters.structure.boom_link_mass_kg = 1.0;
    const CraneDynamics links(parameters);
    const BeamCraneDynamics beam(parameters);
    const CraneState links_rest = find_equilibrium(links).state;
    const BeamCraneDynamics::State beam_rest = find_equilibrium(beam).state;
    const auto links_modes = linear_modes(links, links_rest);
    const auto beam_modes = linear_modes(beam, beam_rest);
    EXPECT_LT((beam.thesis_state(beam_rest) - links_rest).cwiseAbs().maxCoeff(), 1e-6);
    for (std::size_t i = 0; i < 4; ++i) {  // all that the boom's own mass and bending have no part in
        EXPECT_NEAR(beam_modes[i].frequency_Hz, links_modes[i].frequency_Hz, 1e-5 * links_modes[i].frequency_Hz) << i;
    }
}

TEST(LinearModes, NamesTheBeamsCoordinates) {
    EXPECT_STREQ(coordinate_name<BeamBoom>(R9_m), "R9");
    EXPECT_STREQ(coordinate_name<BeamBoom>(3), "a1");
    EXPECT_STREQ(coordinate_name<BeamBoom>(5), "a3");
    EXPECT_STREQ(coordinate_name<BeamBoom>(6), "phi6");
    EXPECT_STREQ(coordinate_name<BeamBoom>(7), "phi9");
    EXPECT_STREQ(coordinate_name<BeamBoom>(8), "?");
}

}  // namespace
}  // namespace steadyboom::plant
