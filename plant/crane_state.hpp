#pragma once

#include <Eigen/Core>

namespace steadyboom::plant {

/// Index and unit of each generalized coordinate, the order of every 7-vector and 7x7 matrix (model page, section 1).
/// The velocities use the same order, in the unit per second.
enum Coordinate : int {
    R1_m,      ///< vertical translation of the track plane's centre, positive up
    phi2_rad,  ///< rotation of tracks and car body, positive counter-clockwise
    R9_m,      ///< load-line length, boom tip to load
    q1_m,      ///< lower boom-joint displacement, perpendicular to the chord, positive downwards
    q2_m,      ///< upper boom-joint displacement, as q1
    phi6_rad,  ///< boom chord from the horizontal
    phi9_rad,  ///< load line from the vertical, positive when the load is forward of the tip
    coordinate_count
};

using Coordinates = Eigen::Matrix<double, coordinate_count, 1>;
using MassMatrix = Eigen::Matrix<double, coordinate_count, coordinate_count>;

/// Layout of the flat state that integrators and the observer use: coordinates, velocities, piston.
inline constexpr int velocity_offset = coordinate_count;
inline constexpr int piston_index = 2 * coordinate_count;  ///< X_p in m, positive lengthens the piston
inline constexpr int state_count = piston_index + 1;
using CraneState = Eigen::Matrix<double, state_count, 1>;

[[nodiscard]] inline auto coordinates_of(const CraneState& state) {
    return state.head<coordinate_count>();
}
[[nodiscard]] inline auto coordinates_of(CraneState& state) {
    return state.head<coordinate_count>();
}
[[nodiscard]] inline auto velocities_of(const CraneState& state) {
    return state.segment<coordinate_count>(velocity_offset);
}
[[nodiscard]] inline auto velocities_of(CraneState& state) {
    return state.segment<coordinate_count>(velocity_offset);
}

}  // namespace steadyboom::plant
