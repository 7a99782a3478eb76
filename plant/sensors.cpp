#include "plant/sensors.hpp"

namespace steadyboom::plant {

template <class Boom>
SensorVector ideal_sensors(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& state,
                           double spool_opening_m) noexcept {
    using Layout = typename CraneDynamicsOf<Boom>::Layout;
    const CraneOutputs outputs = crane.outputs(state);
    const Eigen::Vector2d strain =
        crane.boom().thirds_strain(state.template segment<Boom::coordinate_count>(Layout::boom_index));
    SensorVector y;
    y[strain_lower_microstrain] = 1e6 * strain[0];
    y[strain_upper_microstrain] = 1e6 * strain[1];
    y[boom_angle_rad] = state[Layout::phi6_index];
    y[line_tension_N] = outputs.load_line_tension_N;
    y[line_angle_rad] = state[Layout::phi9_index];
    y[line_length_m] = crane.parameters().ropes.load_line_length_m;
    y[piston_m] = state[Layout::piston_index];
    y[spool_m] = spool_opening_m;
    y[load_pressure_Pa] = outputs.load_pressure_Pa;
    return y;
}

template SensorVector ideal_sensors(const CraneDynamicsOf<LinkBoom>&, const StateOf<LinkBoom>&, double) noexcept;
template SensorVector ideal_sensors(const CraneDynamicsOf<BeamBoom>&, const StateOf<BeamBoom>&, double) noexcept;

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
