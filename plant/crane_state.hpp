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

/// The same for a boom with `boom_count` coordinates of its own, which then stand where q1 and q2 do: R1, phi2, R9, the
/// boom's, phi6, phi9. With two it is the layout above.
template <int boom_count>
struct CraneLayout {
    static constexpr int boom_index = q1_m;  ///< of the boom's first
    static constexpr int phi6_index = boom_index + boom_count;
    static constexpr int phi9_index = phi6_index + 1;
    static constexpr int coordinate_count = phi9_index + 1;
    static constexpr int velocity_offset = coordinate_count;
    static constexpr int piston_index = 2 * coordinate_count;
    static constexpr int state_count = piston_index + 1;
    using Coordinates = Eigen::Matrix<double, coordinate_count, 1>;
    using MassMatrix = Eigen::Matrix<double, coordinate_count, coordinate_count>;
    using State = Eigen::Matrix<double, state_count, 1>;
};
static_assert(CraneLayout<2>::phi6_index == phi6_rad && CraneLayout<2>::phi9_index == phi9_rad);

template <int count>
[[nodiscard]] auto coordinates_of(const Eigen::Matrix<double, count, 1>& state) {
    return state.template head<count / 2>();
}
template <int count>
[[nodiscard]] auto coordinates_of(Eigen::Matrix<double, count, 1>& state) {
    return state.template head<count / 2>();
}
template <int count>
[[nodiscard]] auto velocities_of(const Eigen::Matrix<double, count, 1>& state) {
    return state.template segment<count / 2>(count / 2);
}
template <int count>
[[nodiscard]] auto velocities_of(Eigen::Matrix<double, count, 1>& state) {
    return state.template segment<count / 2>(count / 2);
}

}  // namespace steadyboom::plant
