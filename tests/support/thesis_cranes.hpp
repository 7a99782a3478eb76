#pragma once

#include "plant/crane_parameters.hpp"

namespace steadyboom::test_support {

/// One of the thesis's three cases as Table 1 gives it, with the misprints the plant's README names decided.
/// Written out here on its own, so that the shipped case files can be held against it.
struct ThesisCase {
    plant::CraneParameters crane;
    double load_drop_m;         ///< free fall before the load line's brake catches the load
    double joint_gain;          ///< K3 of law 2, m of spool per m of joint displacement
    double angle_gain_m_rad;    ///< K1 of law 1
    double rate_gain_m_s_rad;   ///< K2 of law 1
    double swing_gain_m_s_rad;  ///< K4 of law 3
};

/// `name` is 'A', 'B' or 'C'; anything else throws std::invalid_argument.
[[nodiscard]] ThesisCase thesis_case(char name);

[[nodiscard]] inline plant::CraneParameters thesis_crane(char name) {
    return thesis_case(name).crane;
}

}  // namespace steadyboom::test_support
