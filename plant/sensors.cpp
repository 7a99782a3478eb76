#include "plant/sensors.hpp"

namespace steadyboom::plant {

SensorVector ideal_sensors(const CraneDynamics& crane, const CraneState& state, double spool_opening_m) noexcept {
    const StructureParameters& s = crane.parameters().structure;
    const CraneOutputs outputs = crane.outputs(state);
    const double strain_per_m = 9.0 * s.boom_outer_chord_m / (s.link_length_m() * s.link_length_m());
    SensorVector y;
    y[strain_lower_microstrain] = 1e6 * strain_per_m * state[q1_m];
    y[strain_upper_microstrain] = 1e6 * strain_per_m * state[q2_m];
    y[boom_angle_rad] = state[phi6_rad];
    y[line_tension_N] = outputs.load_line_tension_N;
    y[line_angle_rad] = state[phi9_rad];
    y[line_length_m] = crane.parameters().ropes.load_line_length_m;
    y[piston_m] = state[piston_index];
    y[spool_m] = spool_opening_m;
    y[load_pressure_Pa] = outputs.load_pressure_Pa;
    return y;
}

SensorVector sensor_noise(double spool_travel_m) noexcept {
    SensorVector sigma;
    sigma[strain_lower_microstrain] = 1.0;
    sigma[strain_upper_microstrain] = 1.0;
    sigma[boom_angle_rad] = 2e-5;
    sigma[line_tension_N] = 400.0;
    sigma[line_angle_rad] = 2e-4;
    sigma[line_length_m] = 1e-3;
    sigma[piston_m] = 2e-5;
    sigma[spool_m] = 1e-3 * spool_travel_m;
    sigma[load_pressure_Pa] = 5e3;
    return sigma;
}

}  // namespace steadyboom::plant
