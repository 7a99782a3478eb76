#pragma once

#include "plant/crane_parameters.hpp"
#include "plant/valve_command.hpp"

namespace steadyboom::controllers {

/// Makes an orifice valve act like the linear valve that laws and observer think in: the same load flow.
///
///     K_q X_lin = C_d pi D_v X_v sqrt((P_s - sign(X_v) P_L) / sigma)          (6-11 with K_c = 0, and 6-22)
///
/// Without it the load pressure makes a piston run out faster one way than the other, and every oscillation of a law
/// pumps the piston away from its place. `load_pressure_Pa` is the estimate's; the pressure drop is taken as at least
/// 5 % of the supply's, so that a stalled valve does not ask for an endless opening.
class ValveLinearisation {
  public:
    explicit ValveLinearisation(const plant::ActuatorParameters& actuator);

    /// The spool opening that gives the flow that `linear` asks for.
    [[nodiscard]] plant::ValveCommand spool_command(const plant::ValveCommand& linear,
                                                    double load_pressure_Pa) const noexcept;

    /// The opening of the linear valve, m, that would give the flow of this spool opening.
    [[nodiscard]] double linear_opening_m(double spool_opening_m, double load_pressure_Pa) const noexcept;

  private:
    /// Flow per opening over K_q, dimensionless.
    [[nodiscard]] double gain(double opening_m, double load_pressure_Pa) const noexcept;

    double gain_at_1_Pa_;  ///< C_d pi D_v / (K_q sqrt(sigma)), per root of the pressure drop in Pa
    double supply_pressure_Pa_;
};

}  // namespace steadyboom::controllers
