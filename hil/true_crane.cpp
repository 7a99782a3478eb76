#include "hil/true_crane.hpp"

namespace steadyboom::hil {

template <class Boom>
TrueCrane<Boom>::TrueCrane(const plant::CraneParameters& parameters)
    : dynamics_(parameters),
      equilibrium_(find_equilibrium(dynamics_)),
      energy_(dynamics_, equilibrium_.state),
      boom_mass_(dynamics_.mass_matrix(plant::coordinates_of(equilibrium_.state))
                     .template block<Boom::coordinate_count, Boom::coordinate_count>(Layout::boom_index,
                                                                                     Layout::boom_index)) {}

template <class Boom>
plant::Equilibrium TrueCrane<Boom>::thesis_equilibrium() const noexcept {
    return {.state = dynamics_.thesis_state(equilibrium_.state),
            .pendent_tension_N = equilibrium_.pendent_tension_N,
            .load_line_tension_N = equilibrium_.load_line_tension_N,
            .residual = equilibrium_.residual,
            .iterations = equilibrium_.iterations};
}

template <class Boom>
TruthSample TrueCrane<Boom>::sample(const plant::StateOf<Boom>& state, double spool_m, double t_s) const noexcept {
    const plant::CraneOutputs outputs = dynamics_.outputs(state);
    const typename Boom::Vector bending =
        (state - equilibrium_.state).template segment<Boom::coordinate_count>(Layout::boom_index);
    const typename Boom::Vector bending_rate =
        state.template segment<Boom::coordinate_count>(Layout::velocity_offset + Layout::boom_index);
    return {.t_s = t_s,
            .state = dynamics_.thesis_state(state),
            .spool_m = spool_m,
            .pendent_tension_N = outputs.pendent_tension_N,
            .load_line_tension_N = outputs.load_line_tension_N,
            .chord_m = outputs.chord_m,
            .contact_fraction = outputs.contact_fraction,
            .load_pressure_Pa = outputs.load_pressure_Pa,
            .hydraulic_power_W = dynamics_.actuator().hydraulic_power_W(spool_m, outputs.pendent_tension_N,
                                                                        equilibrium_.pendent_tension_N),
            .residual_energy_J = energy_.energy_J(state),
            .boom_energy_J =
                dynamics_.boom().bending_energy_J(bending) + 0.5 * bending_rate.dot(boom_mass_ * bending_rate)};
}

plant::Equilibrium rest_of(const Case& crane_case) {
    return with_boom(crane_case.boom, [&]<class Boom>(std::type_identity<Boom>) {
        return TrueCrane<Boom>(crane_case.crane).thesis_equilibrium();
    });
}

template class TrueCrane<plant::LinkBoom>;
template class TrueCrane<plant::BeamBoom>;

}  // namespace steadyboom::hil
