#pragma once

#include "plant/crane_parameters.hpp"

namespace steadyboom::plant {

/// Three-link boom (thesis 3.1.1): chord shortening, bending stiffness and structural damping of the joints q1, q2.
///
///     R8  = R_B - (q1^2 + q2^2 - q1 q2) / L_B                    chord, butt to tip, m
///     V   = 3 K_B / L_B^2 (q1^2 + q2^2 - q1 q2)                  bending energy, J
///     Qd1 = -C_B / L_B^2 (5 q1' - 4 q2'),  Qd2 alike             damping, N
///     C_B = 0.007 pi^2 (3/8) R_B^2 sqrt(E I m_B / (3 R_B^3)),    E I = K_B L_B / 3
struct Boom {
    double length_m;
    double inverse_link_length_1_m;
    double bending_stiffness_N_m;  ///< 3 K_B / L_B^2
    double damping_N_s_m;          ///< C_B / L_B^2

    explicit Boom(const StructureParameters& structure);

    [[nodiscard]] double chord_m(double q1_m, double q2_m) const noexcept {
        return length_m - (q1_m * q1_m + q2_m * q2_m - q1_m * q2_m) * inverse_link_length_1_m;
    }
    /// dR8/dq of one joint, dimensionless; the other joint's displacement second.
    [[nodiscard]] double chord_slope(double q_m, double other_q_m) const noexcept {
        return (other_q_m - 2.0 * q_m) * inverse_link_length_1_m;
    }
    /// Part of R8'' that no acceleration causes, m/s^2.
    [[nodiscard]] double chord_bias_m_s2(double q1_m_s, double q2_m_s) const noexcept {
        return -2.0 * (q1_m_s * q1_m_s + q2_m_s * q2_m_s - q1_m_s * q2_m_s) * inverse_link_length_1_m;
    }
    [[nodiscard]] double bending_energy_J(double q1_m, double q2_m) const noexcept {
        return bending_stiffness_N_m * (q1_m * q1_m + q2_m * q2_m - q1_m * q2_m);
    }
    /// Generalized bending force on one joint, N, positive downwards as q.
    [[nodiscard]] double bending_force_N(double q_m, double other_q_m) const noexcept {
        return -bending_stiffness_N_m * (2.0 * q_m - other_q_m);
    }
    /// Generalized damping force on one joint, N.
    [[nodiscard]] double damping_force_N(double q_m_s, double other_q_m_s) const noexcept {
        return -damping_N_s_m * (5.0 * q_m_s - 4.0 * other_q_m_s);
    }
};

}  // namespace steadyboom::plant
