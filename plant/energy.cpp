#include "plant/energy.hpp"

#include <cmath>

#include "plant/equilibrium.hpp"

namespace steadyboom::plant {

template <class Boom>
double kinetic_energy_J(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& state) {
    const typename CraneDynamicsOf<Boom>::Coordinates v = velocities_of(state);
    return 0.5 * v.dot(crane.mass_matrix(coordinates_of(state)) * v);
}

template <class Boom>
double potential_energy_J(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& state) {
    const CraneParameters& parameters = crane.parameters();
    const StructureParameters& s = parameters.structure;
    const CranePoints points = crane.points(coordinates_of(state));
    const CraneOutputs outputs = crane.outputs(state);
    const double moment_kg_m = s.track_mass_kg * points.track_centre.y() +
                               s.car_body_mass_kg * points.car_body_centre.y() +
                               crane.boom().mass_kg() * points.boom_centre.y() + s.load_mass_kg * points.load.y();
    const auto spring_J = [](double tension_N, double stiffness_N_m) {
        return 0.5 * tension_N * tension_N / stiffness_N_m;
    };
    return gravity_m_s2 * moment_kg_m +
           crane.boom().bending_energy_J(
               state.template segment<Boom::coordinate_count>(CraneDynamicsOf<Boom>::Layout::boom_index)) +
           spring_J(outputs.load_line_tension_N, parameters.ropes.load_line_stiffness_N_m) +
           spring_J(outputs.pendent_tension_N, parameters.ropes.pendent_stiffness_N_m);
}

double full_contact_energy_J(const Soil& soil, double height_m, double tilt_rad) noexcept {
    const Soil::Coefficients full = soil.coefficients(1.0);
    return 0.5 * full.vertical_stiffness_N_m * height_m * height_m +
           0.5 * full.rocking_stiffness_N_m_rad * tilt_rad * tilt_rad;
}

double soil_power_W(const Soil& soil, double height_m, double tilt_rad, double height_rate_m_s,
                    double tilt_rate_rad_s) noexcept {
    const SoilReaction reaction =
        soil.reaction(height_m, tilt_rad, std::sin(tilt_rad), height_rate_m_s, tilt_rate_rad_s);
    return reaction.vertical_N * height_rate_m_s + reaction.rocking_N_m * tilt_rate_rad_s;
}

template <class Boom>
double oil_energy_J(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& state) {
    const ActuatorParameters& actuator = crane.parameters().actuator;
    const double pressure_Pa = crane.outputs(state).load_pressure_Pa;
    return actuator.oil_volume_m3 / (8.0 * actuator.bulk_modulus_Pa) * pressure_Pa * pressure_Pa;
}

template <class Boom>
NonConservativePower non_conservative_power(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& state,
                                            double valve_opening_m) {
    const typename CraneDynamicsOf<Boom>::Coordinates v = velocities_of(state);
    const CraneOutputs outputs = crane.outputs(state);
    const double piston_rate_m_s =
        crane.actuator().piston_rate_m_s(valve_opening_m, outputs.pendent_tension_N, outputs.pendent_rate_m_s,
                                         state[CraneDynamicsOf<Boom>::Layout::piston_index]);
    const typename Boom::Vector boom_rate =
        v.template segment<Boom::coordinate_count>(CraneDynamicsOf<Boom>::Layout::boom_index);
    return {.boom_damping_W = crane.boom().damping_force_N(boom_rate).dot(boom_rate),
            .soil_W = soil_power_W(crane.soil(), state[R1_m], state[phi2_rad], v[R1_m], v[phi2_rad]),
            .piston_W = outputs.pendent_tension_N * piston_rate_m_s};
}

template <class Boom>
ResidualEnergyOf<Boom>::ResidualEnergyOf(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& equilibrium)
    : reference_(coordinates_of(equilibrium)),
      mass_(crane.mass_matrix(reference_)),
      stiffness_(stiffness_matrix(crane, reference_)) {}

template <class Boom>
double ResidualEnergyOf<Boom>::energy_J(const StateOf<Boom>& state) const noexcept {
    const typename CraneDynamicsOf<Boom>::Coordinates d = coordinates_of(state) - reference_;
    const typename CraneDynamicsOf<Boom>::Coordinates v = velocities_of(state);
    return 0.5 * v.dot(mass_ * v) + 0.5 * d.dot(stiffness_ * d);
}

template double kinetic_energy_J(const CraneDynamicsOf<LinkBoom>&, const StateOf<LinkBoom>&);
template double potential_energy_J(const CraneDynamicsOf<LinkBoom>&, const StateOf<LinkBoom>&);
template double oil_energy_J(const CraneDynamicsOf<LinkBoom>&, const StateOf<LinkBoom>&);
template NonConservativePower non_conservative_power(const CraneDynamicsOf<LinkBoom>&, const StateOf<LinkBoom>&,
                                                     double);
template class ResidualEnergyOf<LinkBoom>;
template double kinetic_energy_J(const CraneDynamicsOf<BeamBoom>&, const StateOf<BeamBoom>&);
template double potential_energy_J(const CraneDynamicsOf<BeamBoom>&, const StateOf<BeamBoom>&);
template double oil_energy_J(const CraneDynamicsOf<BeamBoom>&, const StateOf<BeamBoom>&);
template NonConservativePower non_conservative_power(const CraneDynamicsOf<BeamBoom>&, const StateOf<BeamBoom>&,
                                                     double);
template class ResidualEnergyOf<BeamBoom>;

}  // namespace steadyboom::plant
