#include "plant/actuator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace steadyboom::plant {

Actuator::Actuator(const ActuatorParameters& actuator, const RopeParameters& ropes)
    : valve_model_(actuator.valve_model),
      piston_area_m2_(actuator.piston_area_m2),
      inverse_piston_area_1_m2_(1.0 / actuator.piston_area_m2),
      oil_compliance_m2_(actuator.oil_volume_m3 * ropes.pendent_stiffness_N_m /
                         (4.0 * actuator.piston_area_m2 * actuator.bulk_modulus_Pa)),
      flow_gain_m2_s_(actuator.flow_gain_m2_s),
      leakage_m3_s_Pa_(actuator.leakage_m3_s_Pa),
      spool_travel_m_(actuator.spool_travel_m),
      piston_travel_m_(actuator.piston_travel_m),
      supply_pressure_Pa_(actuator.supply_pressure_Pa),
      orifice_gain_(actuator.discharge_coefficient * std::numbers::pi * actuator.spool_diameter_m /
                    std::sqrt(actuator.oil_density_kg_m3)) {}

double Actuator::load_flow_m3_s(double valve_opening_m, double load_pressure_Pa) const noexcept {
    if (valve_model_ == ValveModel::linear) {
        return flow_gain_m2_s_ * valve_opening_m;
    }
    const double drop_Pa = supply_pressure_Pa_ - std::copysign(load_pressure_Pa, valve_opening_m);
    return orifice_gain_ * valve_opening_m * std::sqrt(std::max(0.0, drop_Pa));
}

double Actuator::piston_rate_m_s(double valve_opening_m, double pendent_tension_N, double pendent_rate_m_s,
                                 double piston_m) const noexcept {
    const double load_pressure = load_pressure_Pa(pendent_tension_N);
    const double c_m2 = pendent_tension_N > 0.0 ? oil_compliance_m2_ : 0.0;
    const double rate_m_s =
        (load_flow_m3_s(valve_opening_m, load_pressure) - leakage_m3_s_Pa_ * load_pressure - c_m2 * pendent_rate_m_s) /
        (piston_area_m2_ + c_m2);
    const bool at_stop = std::abs(piston_m) >= piston_travel_m_ && piston_m * rate_m_s > 0.0;
    return at_stop ? 0.0 : rate_m_s;
}

PistonRateSlopes Actuator::piston_rate_slopes(double valve_opening_m, double pendent_tension_N, double rate_m_s,
                                              double piston_m) const noexcept {
    if (std::abs(piston_m) >= piston_travel_m_ && rate_m_s == 0.0) {
        return {0.0, 0.0};
    }
    const double load_pressure = load_pressure_Pa(pendent_tension_N);
    const bool taut = pendent_tension_N > 0.0;
    const double c_m2 = taut ? oil_compliance_m2_ : 0.0;
    const double drop_Pa = supply_pressure_Pa_ - std::copysign(load_pressure, valve_opening_m);
    const double flow_slope = valve_model_ == ValveModel::nonlinear && drop_Pa > 0.0
                                  ? -orifice_gain_ * std::abs(valve_opening_m) * 0.5 / std::sqrt(drop_Pa)
                                  : 0.0;
    const double pressure_slope = taut ? (flow_slope - leakage_m3_s_Pa_) * inverse_piston_area_1_m2_ : 0.0;
    return {.pendent_tension = pressure_slope / (piston_area_m2_ + c_m2),
            .pendent_rate = -c_m2 / (piston_area_m2_ + c_m2)};
}

double Actuator::hydraulic_power_W(double valve_opening_m, double pendent_tension_N,
                                   double equilibrium_tension_N) const noexcept {
    return load_pressure_Pa(pendent_tension_N - equilibrium_tension_N) * flow_gain_m2_s_ * valve_opening_m;
}

double Actuator::clamp_opening_m(double valve_opening_m) const noexcept {
    return std::clamp(valve_opening_m, -spool_travel_m_, spool_travel_m_);
}

double Actuator::clamp_piston_m(double piston_m) const noexcept {
    return std::clamp(piston_m, -piston_travel_m_, piston_travel_m_);
}

}  // namespace steadyboom::plant
