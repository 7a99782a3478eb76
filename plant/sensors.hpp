#pragma once

#include "plant/crane_dynamics.hpp"
#include "plant/crane_measurement.hpp"

namespace steadyboom::plant {

/// What ideal sensors read (model page, section 8): no noise, no quantisation, no delay.
///
///     eps_i of the boom at its thirds,  phi6,  T_L,  phi9,  R9(t0),  X_p,  X_v,  P_L = T_P / A_p
///
/// `spool_opening_m` is the spool's true opening. Units are those of the Sensor enum.
template <class Boom>
[[nodiscard]] SensorVector ideal_sensors(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& state,
                                         double spool_opening_m) noexcept;

/// One sigma of realistic noise at 200 Hz, in the units of the Sensor enum (model page, section 8).
/// `spool_travel_m` is the largest opening.
[[nodiscard]] SensorVector sensor_noise(double spool_travel_m) noexcept;

}  // namespace steadyboom::plant
