#pragma once

#include <Eigen/Core>

namespace steadyboom::plant {

/// What the inertia of a boom is made of. A point of the boom lies x along the chord and w below it, seen from the
/// butt: B0 + x e(phi6) + w n(phi6); the boom's own coordinates a fix x and w. Sums run over the boom's mass.
template <int count>
struct BoomSums {
    using Vector = Eigen::Matrix<double, count, 1>;
    using Matrix = Eigen::Matrix<double, count, count>;

    double along_kg_m;           ///< x
    double below_kg_m;           ///< w
    Vector along_slope_kg;       ///< dx/da, per coordinate in its unit
    Vector below_slope_kg;       ///< dw/da
    double turn_turn_kg_m2;      ///< x^2 + w^2, and the sections' rotary inertia
    Vector flexible_turn_kg_m;   ///< w dx/da - x dw/da, and the sections' part
    Matrix flexible_flexible_kg; /**< dx/da_i dx/da_j + dw/da_i dw/da_j, and the sections' part; lower triangle */
};

/// The same for the part of the accelerations that no acceleration of the coordinates causes. `bias` is that part of
/// x''; w is linear in a and has none.
template <int count>
struct BoomBiasSums {
    using Vector = Eigen::Matrix<double, count, 1>;

    double along_N;           ///< bias
    Vector flexible_along_N;  ///< dx/da bias
    double turn_along_N_m;    ///< w bias
    Vector centrifugal_kg_m;  ///< x dx/da + w dw/da
    Vector coriolis_kg_m_s;   ///< w' dx/da - x' dw/da
};

/// A point of the boom, seen from the butt.
struct BoomPoint {
    double along_m, below_m;
};

}  // namespace steadyboom::plant
