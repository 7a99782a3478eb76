#pragma once

#include "plant/crane_parameters.hpp"

namespace steadyboom::plant {

/// How the piston's rate changes.
struct PistonRateSlopes {
    double pendent_tension;  ///< with T_P, m/s/N
    double pendent_rate;     ///< with L_p', dimensionless
};

/// Valve-controlled piston in the pendent line (thesis chapter 6).
///
///     A_p X_p' + (V_t / 4 beta_e) P_L' + C_tp P_L = Q_L,   A_p P_L = T_P                                  (6-20, 6-5)
///     => X_p' = (Q_L - C_tp T_P / A_p - c L_p') / (A_p + c)                                               (6-21)
///        c = V_t K_WRP / (4 A_p beta_e) while the pendent is taut, 0 while it is slack
///     linear valve:     Q_L = K_q X_v                                              (6-11 with K_c = Q_L0 = 0)
///     nonlinear valve:  Q_L = C_d pi D_v X_v sqrt(max(0, P_s - sign(X_v) P_L) / sigma)                    (6-22)
class Actuator {
  public:
    Actuator(const ActuatorParameters& actuator, const RopeParameters& ropes);

    /// Load flow in m^3/s at spool opening X_v and load pressure P_L >= 0; positive lengthens the piston.
    [[nodiscard]] double load_flow_m3_s(double valve_opening_m, double load_pressure_Pa) const noexcept;

    /// X_p' in m/s. `pendent_rate_m_s` is L_p', the geometric pendent's rate, without the piston. At an end stop the
    /// piston does not move outwards.
    [[nodiscard]] double piston_rate_m_s(double valve_opening_m, double pendent_tension_N, double pendent_rate_m_s,
                                         double piston_m) const noexcept;

    /// Derivatives of piston_rate_m_s(); `rate_m_s` is what it returned, 0 at an end stop.
    [[nodiscard]] PistonRateSlopes piston_rate_slopes(double valve_opening_m, double pendent_tension_N, double rate_m_s,
                                                      double piston_m) const noexcept;

    [[nodiscard]] double load_pressure_Pa(double pendent_tension_N) const noexcept {
        return pendent_tension_N * inverse_piston_area_1_m2_;
    }

    /// (P_L - P_L0) K_q X_v in W (6-32 in SI), for both valve models. Positive when the supply works on the crane.
    [[nodiscard]] double hydraulic_power_W(double valve_opening_m, double pendent_tension_N,
                                           double equilibrium_tension_N) const noexcept;

    /// X_v and X_p held to their travel.
    [[nodiscard]] double clamp_opening_m(double valve_opening_m) const noexcept;
    [[nodiscard]] double clamp_piston_m(double piston_m) const noexcept;

    /// c as share of the piston area while taut: how much of a pendent stretch the oil's compression gives back.
    [[nodiscard]] double oil_compliance_share() const noexcept {
        return oil_compliance_m2_ / (piston_area_m2_ + oil_compliance_m2_);
    }

  private:
    ValveModel valve_model_;
    double piston_area_m2_;
    double inverse_piston_area_1_m2_;
    double oil_compliance_m2_;  ///< c while taut
    double flow_gain_m2_s_;
    double leakage_m3_s_Pa_;
    double spool_travel_m_;
    double piston_travel_m_;
    double supply_pressure_Pa_;
    double orifice_gain_;  ///< C_d pi D_v / sqrt(sigma); times X_v in m and a root of Pa it is m^3/s
};

}  // namespace steadyboom::plant
