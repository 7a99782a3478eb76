#pragma once

#include <vector>

#include "plant/crane_dynamics.hpp"

namespace steadyboom::plant {

/// One linear mode about an equilibrium.
struct LinearMode {
    double frequency_Hz;   ///< |lambda| / (2 pi)
    double damping_ratio;  ///< -Re(lambda) / |lambda|; 1 for a mode that does not oscillate
    Coordinate dominant;   ///< coordinate with the largest share of the mode's kinetic energy
};

/// d(derivative)/d(state) at `state`, valve at `valve_opening_m`; central differences, 15x15.
using StateMatrix = Eigen::Matrix<double, state_count, state_count>;
[[nodiscard]] StateMatrix state_matrix(const CraneDynamics& crane, const CraneState& state, double valve_opening_m);

/// Modes of the crane with its valve shut, ascending in frequency: one entry per conjugate pair and per real eigenvalue
/// but the piston's zero one (a shut valve holds any piston position).
[[nodiscard]] std::vector<LinearMode> linear_modes(const CraneDynamics& crane, const CraneState& equilibrium);

/// Name of a coordinate as the thesis prints it, for tables: "R1", "phi2", ...
[[nodiscard]] const char* coordinate_name(Coordinate coordinate) noexcept;

}  // namespace steadyboom::plant
