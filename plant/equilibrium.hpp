#pragma once

#include <stdexcept>
#include <string>

#include "plant/crane_dynamics.hpp"

namespace steadyboom::plant {

/// The static equilibrium and how well it was met.
template <class Boom>
struct EquilibriumOf {
    StateOf<Boom> state;  ///< velocities and piston are zero
    double pendent_tension_N;
    double load_line_tension_N;
    double residual;  ///< largest |Q_i| over the weight (times 1 m for the angles), dimensionless
    int iterations;
};
using Equilibrium = EquilibriumOf<LinkBoom>;

/// The crane cannot stand: Newton did not converge, or it did at a pendent or load line that is slack or a track that
/// lifted. The message says which and how large the residual is.
struct EquilibriumError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Damped Newton on Q(p, 0, X_p = 0) = 0 (thesis 4-3), started from the unstretched geometry.
/// Converged means that the residual is at most 1e-12, or that no step lowers it any more and it is at most 1e-9 (what
/// rounding leaves with stiff ropes). Throws EquilibriumError otherwise; never returns an unconverged state.
template <class Boom>
[[nodiscard]] EquilibriumOf<Boom> find_equilibrium(const CraneDynamicsOf<Boom>& crane);

/// -dQ/dp at rest with the piston fixed at X_p = 0, central differences, symmetrised; N/m, N, N m as the coordinates
/// ask. The contact with the soil is what it is at `coordinates`.
template <class Boom>
[[nodiscard]] typename CraneDynamicsOf<Boom>::MassMatrix stiffness_matrix(
    const CraneDynamicsOf<Boom>& crane, const typename CraneDynamicsOf<Boom>::Coordinates& coordinates);

}  // namespace steadyboom::plant
