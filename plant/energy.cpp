#include "plant/energy.hpp"

#include <cmath>

#include "plant/equilibrium.hpp"

namespace steadyboom::plant {

double kinetic_energy_J(const CraneDynamics& crane, const CraneState& state) {
    const Coordinates v = velocities_of(state);
    return 0.5 * v.dot(crane.mass_matrix(Coordinates(coordinates_of(state))) * v);
}

double potential_energy_J(const CraneDynamics& crane, const CraneState& state) {
    const CraneParameters& parameters = crane.parameters();
    const StructureParameters& s = parameters.structure;
    const CranePoints points = crane.points(Coordinates(coordinates_of(state)));
    const CraneOutputs outputs = crane.outputs(state);
    double weight_J = s.track_mass_kg * points.track_centre.y() + s.car_body_mass_kg * points.car_body_centre.y() +
                      s.load_mass_kg * points.load.y();
    for (const Eigen::Vector2d& link : points.link_centres) {
        weight_J += s.boom_link_mass_kg * link.y();
    }
    const auto spring_J = [](double tension_N, double stiffness_N_m) {
        return 0.5 * tension_N * tension_N / stiffness_N_m;
    };
    return gravity_m_s2 * weight_J + crane.boom().bending_energy_J(state[q1_m], state[q2_m]) +
           spring_J(outputs.load_line_tension_N, parameters.ropes.load_line_stiffness_N_m) +
           spring_J(outputs.pendent_tension_N, parameters.ropes.pendent_stiffness_N_m);
}

double full_contact_energy_J(const CraneDynamics& crane, const CraneState& state) {
    const Soil::Coefficients soil = crane.soil().coefficients(1.0);
    return 0.5 * soil.vertical_stiffness_N_m * state[R1_m] * state[R1_m] +
           0.5 * soil.rocking_stiffness_N_m_rad * state[phi2_rad] * state[phi2_rad];
}

double oil_energy_J(const CraneDynamics& crane, const CraneState& state) {
    const ActuatorParameters& actuator = crane.parameters().actuator;
    const double pressure_Pa = crane.outputs(state).load_pressure_Pa;
    return actuator.oil_volume_m3 / (8.0 * actuator.bulk_modulus_Pa) * pressure_Pa * pressure_Pa;
}

NonConservativePower non_conservative_power(const CraneDynamics& crane, const CraneState& state,
                                            double valve_opening_m) {
    const Coordinates v = velocities_of(state);
    const CraneOutputs outputs = crane.outputs(state);
    const SoilReaction soil =
        crane.soil().reaction(state[R1_m], state[phi2_rad], std::sin(state[phi2_rad]), v[R1_m], v[phi2_rad]);
    const double piston_rate_m_s = crane.actuator().piston_rate_m_s(valve_opening_m, outputs.pendent_tension_N,
                                                                    outputs.pendent_rate_m_s, state[piston_index]);
    return {.boom_damping_W = crane.boom().damping_force_N(v[q1_m], v[q2_m]) * v[q1_m] +
                              crane.boom().damping_force_N(v[q2_m], v[q1_m]) * v[q2_m],
            .soil_W = soil.vertical_N * v[R1_m] + soil.rocking_N_m * v[phi2_rad],
            .piston_W = outputs.pendent_tension_N * piston_rate_m_s};
}

ResidualEnergy::ResidualEnergy(const CraneDynamics& crane, const CraneState& equilibrium)
    : reference_(coordinates_of(equilibrium)),
      mass_(crane.mass_matrix(reference_)),
      stiffness_(stiffness_matrix(crane, reference_)) {}

double ResidualEnergy::energy_J(const CraneState& state) const noexcept {
    const Coordinates d = coordinates_of(state) - reference_;
    const Coordinates v = velocities_of(state);
    return 0.5 * v.dot(mass_ * v) + 0.5 * d.dot(stiffness_ * d);
}

}  // namespace steadyboom::plant
