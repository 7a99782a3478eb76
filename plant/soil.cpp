#include "plant/soil.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace steadyboom::plant {

Soil::Soil(const SoilParameters& soil) : track_half_length_m_(soil.track_half_length_m) {
    using std::numbers::pi;
    const double G = soil.shear_modulus_Pa;
    const double nu = soil.poisson_ratio;
    const double d_t = soil.track_half_length_m;
    const double w_t = soil.track_width_m;
    const double impedance = std::sqrt(soil.density_kg_m3 * G);
    const double R_ev = std::sqrt(4.0 / pi * d_t * w_t);
    const double R_ephi = std::pow(16.0 / (3.0 * pi) * d_t * d_t * d_t * w_t, 0.25);
    full_contact_ = {.vertical_stiffness_N_m = 4.0 * G * R_ev / (1.0 - nu),
                     .vertical_damping_N_s_m = 3.4 * R_ev * R_ev * impedance / (1.0 - nu),
                     .rocking_stiffness_N_m_rad = 2.52 * G * R_ephi * R_ephi * R_ephi / (1.0 - nu),
                     .rocking_damping_N_m_s_rad = 0.136 * R_ephi * R_ephi * R_ephi * R_ephi * impedance / (1.13 - nu)};
}

Soil::Coefficients Soil::coefficients(double contact_fraction) const noexcept {
    // R_ev goes with beta^(1/2) and R_ephi with beta^(3/4); the powers below follow from the header's formulas.
    const double beta = contact_fraction;
    const double root = std::sqrt(beta);
    const double fourth_root = std::sqrt(root);
    return {.vertical_stiffness_N_m = full_contact_.vertical_stiffness_N_m * root,
            .vertical_damping_N_s_m = full_contact_.vertical_damping_N_s_m * beta,
            .rocking_stiffness_N_m_rad = full_contact_.rocking_stiffness_N_m_rad * beta * beta * fourth_root,
            .rocking_damping_N_m_s_rad = full_contact_.rocking_damping_N_m_s_rad * beta * beta * beta};
}

double Soil::contact_fraction(double height_m, double tilt_rad, double sin_phi2) const noexcept {
    // Below this tilt the ratio R1 / sin|phi2| carries no information (model page, section 3).
    constexpr double level_rad = 1e-12;
    if (std::abs(tilt_rad) < level_rad) {
        return height_m < 0.0 ? 1.0 : 0.0;
    }
    const double f_m = std::clamp(-height_m / std::abs(sin_phi2), -track_half_length_m_, track_half_length_m_);
    return 0.5 * (1.0 + f_m / track_half_length_m_);
}

SoilReaction Soil::reaction(double height_m, double tilt_rad, double sin_phi2, double height_rate_m_s,
                            double tilt_rate_rad_s) const noexcept {
    const double beta = contact_fraction(height_m, tilt_rad, sin_phi2);
    const Coefficients soil = beta == 1.0 ? full_contact_ : coefficients(beta);
    const double e_m = -std::copysign(track_half_length_m_ * (1.0 - beta), tilt_rad);
    const double sink_m = height_m + e_m * tilt_rad;
    const double sink_rate_m_s = height_rate_m_s + e_m * tilt_rate_rad_s;
    const double vertical_N =
        std::max(-soil.vertical_stiffness_N_m * sink_m - soil.vertical_damping_N_s_m * sink_rate_m_s, 0.0);
    return {.contact_fraction = beta,
            .contact_offset_m = e_m,
            .vertical_N = vertical_N,
            .rocking_N_m = vertical_N * e_m - soil.rocking_stiffness_N_m_rad * tilt_rad -
                           soil.rocking_damping_N_m_s_rad * tilt_rate_rad_s};
}

}  // namespace steadyboom::plant
