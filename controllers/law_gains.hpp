#pragma once

namespace steadyboom::controllers {

/// Gains of the thesis's three laws, spool opening per error (6-29 to 6-31). An error is equilibrium minus estimate;
/// a positive opening lengthens the piston and lifts the boom. Zero switches a term off.
struct ThesisGains {
    double boom_angle_gain_m_rad = 0.0;    ///< K1, m of spool per rad of phi6 (6-29)
    double boom_rate_gain_m_s_rad = 0.0;   ///< K2, m of spool per rad/s of phi6' (6-29)
    double joint_gain_m_m = 0.0;           ///< K3, m of spool per m of q1 (6-30)
    double swing_rate_gain_m_s_rad = 0.0;  ///< K4, m of spool per rad/s of phi9' (6-31)
};

}  // namespace steadyboom::controllers
