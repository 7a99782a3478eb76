#include "plant/pinned_boom.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "plant/beam_boom.hpp"
#include "plant/link_boom.hpp"

namespace steadyboom::plant {

namespace {

constexpr int nodes = 4;

/// Three elements of 3.1.1-9 in a row: deflections of the four nodes, then their rotations.
Eigen::Matrix<double, 2 * nodes, 2 * nodes> assembled(double EI_N_m2, double element_m) {
    const double L = element_m;
    Eigen::Matrix4d element;
    element << 6.0, -6.0, 3.0 * L, 3.0 * L,     //
        -6.0, 6.0, -3.0 * L, -3.0 * L,          //
        3.0 * L, -3.0 * L, 2.0 * L * L, L * L,  //
        3.0 * L, -3.0 * L, L * L, 2.0 * L * L;
    element *= 2.0 * EI_N_m2 / (L * L * L);
    Eigen::Matrix<double, 2 * nodes, 2 * nodes> K = Eigen::Matrix<double, 2 * nodes, 2 * nodes>::Zero();
    for (int first = 0; first + 1 < nodes; ++first) {
        const std::array<int, 4> rows{first, first + 1, nodes + first, nodes + first + 1};
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 4; ++j) {
                K(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]) += element(i, j);
            }
        }
    }
    return K;
}

/// Stiffness against `kept` with no force on `eliminated` and everything else held at zero (3.1.1-12).
template <std::size_t gone>
Eigen::Matrix2d condensed(const Eigen::Matrix<double, 2 * nodes, 2 * nodes>& K, const std::array<int, 2>& kept,
                          const std::array<int, gone>& eliminated) {
    const auto kk = K(kept, kept);
    const auto ke = K(kept, eliminated);
    const auto ee = K(eliminated, eliminated).eval();
    return kk - ke * ee.inverse() * ke.transpose();
}

std::array<double, 2> frequencies_Hz(const Eigen::Matrix2d& stiffness, const Eigen::Matrix2d& mass) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> eigen(stiffness, mass, Eigen::EigenvaluesOnly);
    const Eigen::Vector2d omega = eigen.eigenvalues().cwiseSqrt();
    return {omega[0] / (2.0 * std::numbers::pi), omega[1] / (2.0 * std::numbers::pi)};
}

}  // namespace

PinnedBoom pinned_boom(const StructureParameters& structure) {
    const LinkBoom links(structure);
    const BeamBoom beam(structure);
    const auto K = assembled(structure.bending_stiffness_N_m2(), structure.link_length_m());
    PinnedBoom result;
    result.condensed_to_rotations_N_m = condensed(K, {nodes + 1, nodes + 2}, std::array{1, 2});
    result.condensed_to_deflections_N_m = condensed(K, {1, 2}, std::array{nodes, nodes + 1, nodes + 2, nodes + 3});
    for (int j = 0; j < 2; ++j) {
        result.links_stiffness_N_m.col(j) = -links.bending_force_N(Eigen::Vector2d::Unit(j));
    }
    const Eigen::Vector2d straight = Eigen::Vector2d::Zero();
    const Eigen::Matrix2d mass = links.sums(straight, links.chord_m(straight), links.chord_slope(straight))
                                     .flexible_flexible_kg.selfadjointView<Eigen::Lower>();
    result.links_Hz = frequencies_Hz(result.links_stiffness_N_m, mass);
    result.condensed_links_Hz = frequencies_Hz(result.condensed_to_deflections_N_m, mass);
    for (int k = 1; k <= 3; ++k) {
        result.beam_Hz[static_cast<std::size_t>(k - 1)] = beam.pinned_frequency_rad_s(k) / (2.0 * std::numbers::pi);
    }
    return result;
}

}  // namespace steadyboom::plant
