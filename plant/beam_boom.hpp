#pragma once

#include <array>

#include "plant/boom_sums.hpp"
#include "plant/crane_parameters.hpp"

namespace steadyboom::plant {

/// Boom as a continuum with three bending modes and rotary inertia, from the same data as LinkBoom: the higher-order
/// boom against which the thesis checks its three links (chapter 5). s runs along the boom from butt to tip, the ends
/// are pinned, a_k is the amplitude of mode k in m, positive downwards as q.
///
///     w(s) = sum a_k sin(k pi s / R_B)                            k = 1, 2, 3
///     x(s) = s - 1/2 int_0^s w'^2,    R8 = R_B - sum (k pi)^2 a_k^2 / (4 R_B)
///     mu   = 3 m_B / R_B,             E I = K_B L_B / 3
///     V    = 1/2 E I int w''^2        bending energy, J
///     T    = 1/2 int mu (|velocity|^2 + r^2 (phi6' - dw'/dt)^2),  r = R_O
///     Qd_k = -tau E I int psi_k''^2 a_k',  tau = 2 zeta_1 / omega_1,  zeta_1 = 0.007 pi^2 / (8 sqrt 3)
///     eps  = -R_O w''                 strain of the outer chord
///
/// r: the four chords lie R_O from the neutral axis, I = A R_O^2. tau: the dashpots lie parallel to the bending springs
/// as the thesis's do, but everywhere; the first mode gets the damping ratio that C_B gives the three links' first.
class BeamBoom {
  public:
    static constexpr int coordinate_count = 3;
    static constexpr std::array coordinate_names{"a1", "a2", "a3"};
    using Vector = Eigen::Vector3d;
    using Sums = BoomSums<coordinate_count>;
    using BiasSums = BoomBiasSums<coordinate_count>;

    explicit BeamBoom(const StructureParameters& structure);

    [[nodiscard]] double chord_m(const Vector& a) const noexcept {
        return length_m_ - chord_loss_1_m_.dot(a.cwiseAbs2());
    }
    /// dR8/da, dimensionless.
    [[nodiscard]] Vector chord_slope(const Vector& a) const noexcept { return -2.0 * chord_loss_1_m_.cwiseProduct(a); }
    /// Part of R8'' that no acceleration causes, m/s^2.
    [[nodiscard]] double chord_bias_m_s2(const Vector& a_rate) const noexcept {
        return -2.0 * chord_loss_1_m_.dot(a_rate.cwiseAbs2());
    }
    [[nodiscard]] double bending_energy_J(const Vector& a) const noexcept {
        return 0.5 * stiffness_N_m_.dot(a.cwiseAbs2());
    }
    /// Generalized bending force, N.
    [[nodiscard]] Vector bending_force_N(const Vector& a) const noexcept { return -stiffness_N_m_.cwiseProduct(a); }
    /// Generalized damping force, N.
    [[nodiscard]] Vector damping_force_N(const Vector& a_rate) const noexcept {
        return -damping_N_s_m_.cwiseProduct(a_rate);
    }

    [[nodiscard]] double mass_kg() const noexcept { return mass_kg_; }

    /// Gauss-Legendre sums along the boom. Chord and slope as the links take them; the beam does not need them.
    [[nodiscard]] Sums sums(const Vector& a, double chord_m, const Vector& chord_slope) const noexcept;
    [[nodiscard]] BiasSums bias_sums(const Vector& a, const Vector& a_rate, double chord_m,
                                     const Vector& chord_slope) const noexcept;

    /// The points at s = R_B / 3 and 2 R_B / 3, where the links have their joints.
    [[nodiscard]] std::array<BoomPoint, 2> thirds(const Vector& a) const noexcept;
    /// w there, what stands for q1 and q2, m; the same of the rates.
    [[nodiscard]] Eigen::Vector2d thirds_deflection(const Vector& a) const noexcept {
        return {thirds_[0].deflection.dot(a), thirds_[1].deflection.dot(a)};
    }
    /// Bending strain of the outer chord there, positive where the boom bows downwards.
    [[nodiscard]] Eigen::Vector2d thirds_strain(const Vector& a) const noexcept { return thirds_strain_1_m_ * a; }

    /// Natural angular frequency of mode k = 1, 2, 3 of this boom alone, pinned at both ends (Rayleigh), rad/s:
    /// omega_k^2 = E I (k pi / R_B)^4 / (mu (1 + r^2 (k pi / R_B)^2)).
    [[nodiscard]] double pinned_frequency_rad_s(int mode) const noexcept;

  private:
    /// What one s contributes: w = deflection . a, x = s - 1/2 a . shortening a.
    struct Station {
        double mass_kg = 0.0;
        double s_m = 0.0;
        Vector deflection;
        Eigen::Matrix3d shortening_1_m;
    };
    [[nodiscard]] Station station(double s_m, double mass_kg) const noexcept;

    /// Exact to rounding for these integrands, whose fastest part is cos(12 pi s / R_B).
    static constexpr int stations = 24;

    double length_m_;
    double mass_kg_;
    Vector chord_loss_1_m_;
    Vector stiffness_N_m_;
    Vector damping_N_s_m_;
    Vector below_slope_kg_;
    double section_turn_kg_m2_;  ///< rotary inertia of all sections
    Vector section_flexible_kg_;
    std::array<Station, stations> stations_;
    std::array<Station, 2> thirds_;
    Eigen::Matrix<double, 2, 3> thirds_strain_1_m_;
};

}  // namespace steadyboom::plant
