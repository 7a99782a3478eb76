#include "hil/truth_sample.hpp"

namespace steadyboom::hil {

TruthSample sample_truth(const plant::CraneDynamics& crane, const plant::CraneState& state, double spool_m,
                         double equilibrium_tension_N, double t_s) noexcept {
    const plant::CraneOutputs outputs = crane.outputs(state);
    return {.t_s = t_s,
            .state = state,
            .spool_m = spool_m,
            .pendent_tension_N = outputs.pendent_tension_N,
            .load_line_tension_N = outputs.load_line_tension_N,
            .chord_m = outputs.chord_m,
            .contact_fraction = outputs.contact_fraction,
            .load_pressure_Pa = outputs.load_pressure_Pa,
            .hydraulic_power_W =
                crane.actuator().hydraulic_power_W(spool_m, outputs.pendent_tension_N, equilibrium_tension_N)};
}

}  // namespace steadyboom::hil
