#include "controllers/valve_linearisation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace steadyboom::controllers {

namespace {

constexpr double smallest_drop_share = 0.05;

}  // namespace

ValveLinearisation::ValveLinearisation(const plant::ActuatorParameters& actuator)
    : gain_at_1_Pa_(actuator.discharge_coefficient * std::numbers::pi * actuator.spool_diameter_m /
                    (actuator.flow_gain_m2_s * std::sqrt(actuator.oil_density_kg_m3))),
      supply_pressure_Pa_(actuator.supply_pressure_Pa) {}

double ValveLinearisation::gain(double opening_m, double load_pressure_Pa) const noexcept {
    const double drop_Pa = supply_pressure_Pa_ - std::copysign(load_pressure_Pa, opening_m);
    return gain_at_1_Pa_ * std::sqrt(std::max(smallest_drop_share * supply_pressure_Pa_, drop_Pa));
}

plant::ValveCommand ValveLinearisation::spool_command(const plant::ValveCommand& linear,
                                                      double load_pressure_Pa) const noexcept {
    return {linear.opening_m / gain(linear.opening_m, load_pressure_Pa)};
}

double ValveLinearisation::linear_opening_m(double spool_opening_m, double load_pressure_Pa) const noexcept {
    return spool_opening_m * gain(spool_opening_m, load_pressure_Pa);
}

}  // namespace steadyboom::controllers
