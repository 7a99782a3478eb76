#pragma once

#include <array>

#include <Eigen/Core>

#include "plant/crane_parameters.hpp"

namespace steadyboom::plant {

/// The boom alone, its ends pinned and its chord straight: how stiff each model of it is and how fast it bends. Shows
/// what the static condensation of 3.1.1-12 does to the three links, from the same finite elements (3.1.1-9).
///
/// The thesis clamps the outer nodes, eliminates the deflections q and keeps the nodes' rotations, then reads these as
/// the kinks (2 q1 - q2) / L_B between rigid links. Eliminating the rotations instead, with pinned ends, gives the
/// stiffness that a beam has against deflections at its thirds.
struct PinnedBoom {
    Eigen::Matrix2d condensed_to_rotations_N_m;    ///< K_theta of 3.1.1-13
    Eigen::Matrix2d links_stiffness_N_m;           ///< that, read as kinks: -dQ/dq of LinkBoom
    Eigen::Matrix2d condensed_to_deflections_N_m;  ///< the rotations eliminated, ends pinned
    std::array<double, 2> links_Hz;                ///< LinkBoom: both joints alike, then against each other
    std::array<double, 2> condensed_links_Hz;      ///< the links' masses on the stiffness condensed to deflections
    std::array<double, 3> beam_Hz;                 ///< BeamBoom, the closed form with rotary inertia
};

[[nodiscard]] PinnedBoom pinned_boom(const StructureParameters& structure);

}  // namespace steadyboom::plant
