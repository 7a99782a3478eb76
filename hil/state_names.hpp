#pragma once

#include <array>
#include <string_view>

#include "plant/crane_measurement.hpp"
#include "plant/crane_state.hpp"

namespace steadyboom::hil {

/// Columns of plant::CraneState in files, each with its unit.
inline constexpr std::array<std::string_view, plant::state_count> state_names{
    "R1_m",      "phi2_rad",      "R9_m",      "q1_m",      "q2_m",      "phi6_rad",      "phi9_rad",       //
    "R1dot_m_s", "phi2dot_rad_s", "R9dot_m_s", "q1dot_m_s", "q2dot_m_s", "phi6dot_rad_s", "phi9dot_rad_s",  //
    "piston_m"};

/// Columns of plant::SensorVector in files, each with its unit.
inline constexpr std::array<std::string_view, plant::sensor_count> sensor_names{"strain_lower_microstrain",
                                                                                "strain_upper_microstrain",
                                                                                "boom_angle_rad",
                                                                                "line_tension_N",
                                                                                "line_angle_rad",
                                                                                "line_length_m",
                                                                                "piston_m",
                                                                                "spool_m",
                                                                                "load_pressure_Pa"};

}  // namespace steadyboom::hil
