#pragma once

#include "plant/crane_state.hpp"

namespace steadyboom::controllers {

/// What the observer believes of the crane at one instant.
struct CraneEstimate {
    plant::CraneState state = plant::CraneState::Zero();  ///< units and order of plant/crane_state.hpp
    double nis = 0.0;       ///< normalised innovation squared of the newest correction, dimensionless
    int used_channels = 0;  ///< sensor channels that the newest correction used; nis is chi-squared of that many
    bool finite = true;     ///< false once any entry is NaN or infinite; the interlock then refuses motion
};

}  // namespace steadyboom::controllers
