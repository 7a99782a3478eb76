#pragma once

#include <array>

#include "plant/boom_sums.hpp"
#include "plant/crane_parameters.hpp"

namespace steadyboom::plant {

/// Three-link boom (thesis 3.1.1): chord shortening, bending stiffness, structural damping and inertia of the joints
/// q1, q2. The links are point masses m_B half-way between butt, joints and tip.
///
///     R8  = R_B - (q1^2 + q2^2 - q1 q2) / L_B                    chord, butt to tip, m
///     V   = 3 K_B / L_B^2 (q1^2 + q2^2 - q1 q2)                  bending energy, J
///     Qd1 = -C_B / L_B^2 (5 q1' - 4 q2'),  Qd2 alike             damping, N
///     C_B = 0.007 pi^2 (3/8) R_B^2 sqrt(E I m_B / (3 R_B^3)),    E I = K_B L_B / 3
///     eps = 9 R_O q / L_B^2                                      strain of the outer chord at a joint
class LinkBoom {
  public:
    static constexpr int coordinate_count = 2;
    static constexpr std::array coordinate_names{"q1", "q2"};
    using Vector = Eigen::Vector2d;
    using Sums = BoomSums<coordinate_count>;
    using BiasSums = BoomBiasSums<coordinate_count>;

    explicit LinkBoom(const StructureParameters& structure);

    [[nodiscard]] double chord_m(const Vector& q) const noexcept {
        return length_m_ - quadratic(q) * inverse_link_length_1_m_;
    }
    /// dR8/dq, dimensionless.
    [[nodiscard]] Vector chord_slope(const Vector& q) const noexcept {
        return {(q[1] - 2.0 * q[0]) * inverse_link_length_1_m_, (q[0] - 2.0 * q[1]) * inverse_link_length_1_m_};
    }
    /// Part of R8'' that no acceleration causes, m/s^2.
    [[nodiscard]] double chord_bias_m_s2(const Vector& q_rate) const noexcept {
        return -2.0 * quadratic(q_rate) * inverse_link_length_1_m_;
    }
    [[nodiscard]] double bending_energy_J(const Vector& q) const noexcept {
        return bending_stiffness_N_m_ * quadratic(q);
    }
    /// Generalized bending force, N, positive downwards as q.
    [[nodiscard]] Vector bending_force_N(const Vector& q) const noexcept {
        return {-bending_stiffness_N_m_ * (2.0 * q[0] - q[1]), -bending_stiffness_N_m_ * (2.0 * q[1] - q[0])};
    }
    /// Generalized damping force, N.
    [[nodiscard]] Vector damping_force_N(const Vector& q_rate) const noexcept {
        return {-damping_N_s_m_ * (5.0 * q_rate[0] - 4.0 * q_rate[1]),
                -damping_N_s_m_ * (5.0 * q_rate[1] - 4.0 * q_rate[0])};
    }

    [[nodiscard]] double mass_kg() const noexcept { return 3.0 * link_mass_kg_; }

    /// `chord_slope` is dR8/dq; it is passed because the caller has it, as is the chord.
    [[nodiscard]] Sums sums(const Vector& q, double chord_m, const Vector& chord_slope) const noexcept {
        const double chord_below_kg_m = sum_c_d1_kg_ * q[0] + sum_c_d2_kg_ * q[1];
        const double below_kg_m = link_mass_kg_ * (q[0] + q[1]);
        const double cc_1_kg = sum_cc_kg_ * chord_slope[0];
        const double cc_2_kg = sum_cc_kg_ * chord_slope[1];
        Sums s;
        s.along_kg_m = sum_c_kg_ * chord_m;
        s.below_kg_m = below_kg_m;
        s.along_slope_kg = {sum_c_kg_ * chord_slope[0], sum_c_kg_ * chord_slope[1]};
        s.below_slope_kg = {link_mass_kg_, link_mass_kg_};
        s.turn_turn_kg_m2 =
            sum_cc_kg_ * chord_m * chord_m + sum_dd_same_kg_ * (q[0] * q[0] + q[1] * q[1] + q[0] * q[1]);
        s.flexible_turn_kg_m = {chord_slope[0] * chord_below_kg_m - sum_c_d1_kg_ * chord_m,
                                chord_slope[1] * chord_below_kg_m - sum_c_d2_kg_ * chord_m};
        s.flexible_flexible_kg(0, 0) = cc_1_kg * chord_slope[0] + sum_dd_same_kg_;
        s.flexible_flexible_kg(1, 0) = cc_1_kg * chord_slope[1] + sum_dd_cross_kg_;
        s.flexible_flexible_kg(1, 1) = cc_2_kg * chord_slope[1] + sum_dd_same_kg_;
        return s;
    }

    [[nodiscard]] BiasSums bias_sums(const Vector& q, const Vector& q_rate, double chord_m,
                                     const Vector& chord_slope) const noexcept {
        const double chord_rate_m_s = chord_slope[0] * q_rate[0] + chord_slope[1] * q_rate[1];
        const double bias_m_s2 = chord_bias_m_s2(q_rate);
        const double below_rate_kg_m_s = sum_c_d1_kg_ * q_rate[0] + sum_c_d2_kg_ * q_rate[1];
        const double cc_bias_N = sum_cc_kg_ * bias_m_s2;
        const double cc_chord_kg_m = sum_cc_kg_ * chord_m;
        BiasSums s;
        s.along_N = sum_c_kg_ * bias_m_s2;
        s.flexible_along_N = {cc_bias_N * chord_slope[0], cc_bias_N * chord_slope[1]};
        s.turn_along_N_m = (sum_c_d1_kg_ * q[0] + sum_c_d2_kg_ * q[1]) * bias_m_s2;
        s.centrifugal_kg_m = {cc_chord_kg_m * chord_slope[0] + sum_dd_same_kg_ * q[0] + sum_dd_cross_kg_ * q[1],
                              cc_chord_kg_m * chord_slope[1] + sum_dd_cross_kg_ * q[0] + sum_dd_same_kg_ * q[1]};
        s.coriolis_kg_m_s = {chord_slope[0] * below_rate_kg_m_s - sum_c_d1_kg_ * chord_rate_m_s,
                             chord_slope[1] * below_rate_kg_m_s - sum_c_d2_kg_ * chord_rate_m_s};
        return s;
    }

    /// The joints.
    [[nodiscard]] std::array<BoomPoint, 2> thirds(const Vector& q) const noexcept {
        const double chord = chord_m(q);
        return {{{chord / 3.0, q[0]}, {2.0 * chord / 3.0, q[1]}}};
    }
    /// What the thesis calls q1 and q2, m; the same of the rates.
    [[nodiscard]] Eigen::Vector2d thirds_deflection(const Vector& q) const noexcept { return q; }
    /// Bending strain of the outer chord at the joints, positive where q is.
    [[nodiscard]] Eigen::Vector2d thirds_strain(const Vector& q) const noexcept { return strain_per_m_ * q; }

  private:
    static double quadratic(const Vector& q) noexcept { return q[0] * q[0] + q[1] * q[1] - q[0] * q[1]; }

    double length_m_;
    double inverse_link_length_1_m_;
    double link_mass_kg_;
    // Sums over the three links of chord shares c = (1/6, 1/2, 5/6) and joint shares d1 = (1/2, 1/2, 0), d2 = (0, 1/2,
    // 1/2), times m_B: a link's centre lies at c R8 along the chord and d1 q1 + d2 q2 below it.
    double sum_c_kg_ = 3.0 / 2.0 * link_mass_kg_;
    double sum_cc_kg_ = 35.0 / 36.0 * link_mass_kg_;
    double sum_c_d1_kg_ = 1.0 / 3.0 * link_mass_kg_;
    double sum_c_d2_kg_ = 2.0 / 3.0 * link_mass_kg_;
    double sum_dd_same_kg_ = 1.0 / 2.0 * link_mass_kg_;
    double sum_dd_cross_kg_ = 1.0 / 4.0 * link_mass_kg_;
    double bending_stiffness_N_m_;  ///< 3 K_B / L_B^2
    double damping_N_s_m_;          ///< C_B / L_B^2
    double strain_per_m_;
};

}  // namespace steadyboom::plant
