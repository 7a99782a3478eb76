#pragma once

#include "plant/crane_state.hpp"

namespace steadyboom::hil {

/// The true crane at one instant, whatever its boom.
struct TruthSample {
    double t_s = 0.0;                                     ///< 0 at the brake event
    plant::CraneState state = plant::CraneState::Zero();  ///< CraneDynamicsOf::thesis_state
    double spool_m = 0.0;                                 ///< true opening, positive lengthens the piston
    double pendent_tension_N = 0.0;
    double load_line_tension_N = 0.0;
    double chord_m = 0.0;
    double contact_fraction = 0.0;
    double load_pressure_Pa = 0.0;
    double hydraulic_power_W = 0.0;  ///< (P_L - P_L0) K_q X_v, model page section 4
    double residual_energy_J = 0.0;  ///< plant::ResidualEnergyOf, of all the boom's own coordinates
    double boom_energy_J = 0.0;      ///< bending and motion of the boom's own coordinates, about the equilibrium
};

}  // namespace steadyboom::hil
