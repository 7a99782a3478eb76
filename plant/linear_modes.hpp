#pragma once

#include <vector>

#include "plant/crane_dynamics.hpp"

namespace steadyboom::plant {

/// One linear mode about an equilibrium.
struct LinearMode {
    double frequency_Hz;   ///< |lambda| / (2 pi)
    double damping_ratio;  ///< -Re(lambda) / |lambda|; 1 for a mode that does not oscillate
    int dominant;          ///< index of the coordinate with the largest share of the mode's kinetic energy
};

/// d(derivative)/d(state) at `state`, valve at `valve_opening_m`; central differences.
template <class Boom>
using StateMatrixOf = Eigen::Matrix<double, CraneLayout<Boom::coordinate_count>::state_count,
                                    CraneLayout<Boom::coordinate_count>::state_count>;
template <class Boom>
[[nodiscard]] StateMatrixOf<Boom> state_matrix(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& state,
                                               double valve_opening_m);

/// Modes of the crane with its valve shut, ascending in frequency: one entry per conjugate pair and per real eigenvalue
/// but the piston's zero one (a shut valve holds any piston position).
template <class Boom>
[[nodiscard]] std::vector<LinearMode> linear_modes(const CraneDynamicsOf<Boom>& crane,
                                                   const StateOf<Boom>& equilibrium);

/// Name of a coordinate as the thesis prints it, for tables: "R1", "phi2", ...; the beam's own are "a1" to "a3".
template <class Boom = LinkBoom>
[[nodiscard]] const char* coordinate_name(int coordinate) noexcept;

}  // namespace steadyboom::plant
