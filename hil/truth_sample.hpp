#pragma once

#include "plant/crane_dynamics.hpp"

namespace steadyboom::hil {

/// The true crane at one instant.
struct TruthSample {
    double t_s = 0.0;  ///< 0 at the brake event
    plant::CraneState state = plant::CraneState::Zero();
    double spool_m = 0.0;  ///< true opening, positive lengthens the piston
    double pendent_tension_N = 0.0;
    double load_line_tension_N = 0.0;
    double chord_m = 0.0;
    double contact_fraction = 0.0;
    double load_pressure_Pa = 0.0;
    double hydraulic_power_W = 0.0;  ///< (P_L - P_L0) K_q X_v, model page section 4
};

/// `equilibrium_tension_N` is the pendent tension at rest.
[[nodiscard]] TruthSample sample_truth(const plant::CraneDynamics& crane, const plant::CraneState& state,
                                       double spool_m, double equilibrium_tension_N, double t_s) noexcept;

}  // namespace steadyboom::hil
