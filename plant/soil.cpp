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

SoilSlopes Soil::slopes(double height_m, double tilt_rad, double sin_phi2, double cos_phi2, double height_rate_m_s,
                        double tilt_rate_rad_s) const noexcept {
    const double beta = contact_fraction(height_m, tilt_rad, sin_phi2);
    const Coefficients soil = coefficients(beta);
    const double e_m = -std::copysign(track_half_length_m_ * (1.0 - beta), tilt_rad);
    const double sink_m = height_m + e_m * tilt_rad;
    const double sink_rate_m_s = height_rate_m_s + e_m * tilt_rate_rad_s;
    const double vertical_N = -soil.vertical_stiffness_N_m * sink_m - soil.vertical_damping_N_s_m * sink_rate_m_s;
    const bool pressed = vertical_N > 0.0;

    // beta moves only while the edge of the contact lies under the track.
    double beta_height = 0.0;
    double beta_tilt = 0.0;
    double K_V_beta = 0.0;
    if (beta > 0.0 && beta < 1.0) {
        const double lever_m = 2.0 * track_half_length_m_ * std::abs(sin_phi2);
        beta_height = -1.0 / lever_m;
        beta_tilt = height_m * cos_phi2 / (lever_m * sin_phi2);
        K_V_beta = 0.5 * soil.vertical_stiffness_N_m / beta;
    }
    const double C_V_beta = full_contact_.vertical_damping_N_s_m;
    const double e_beta = std::copysign(track_half_length_m_, tilt_rad);
    const double root = std::sqrt(beta);
    const double K_R_beta = 2.25 * full_contact_.rocking_stiffness_N_m_rad * beta * std::sqrt(root);
    const double C_R_beta = 3.0 * full_contact_.rocking_damping_N_m_s_rad * beta * beta;

    const double F_e = -soil.vertical_stiffness_N_m * tilt_rad - soil.vertical_damping_N_s_m * tilt_rate_rad_s;
    const double F_beta = -K_V_beta * sink_m - C_V_beta * sink_rate_m_s + F_e * e_beta;
    SoilSlopes result{};
    if (pressed) {
        result.vertical = {
            .height = -soil.vertical_stiffness_N_m + F_beta * beta_height,
            .tilt = -soil.vertical_stiffness_N_m * e_m + F_beta * beta_tilt,
            .height_rate = -soil.vertical_damping_N_s_m,
            .tilt_rate = -soil.vertical_damping_N_s_m * e_m,
            .log_modulus = -soil.vertical_stiffness_N_m * sink_m - 0.5 * soil.vertical_damping_N_s_m * sink_rate_m_s};
    }
    const double rocking_beta =
        (pressed ? vertical_N * e_beta : 0.0) - K_R_beta * tilt_rad - C_R_beta * tilt_rate_rad_s;
    result.rocking = {.height = result.vertical.height * e_m + rocking_beta * beta_height,
                      .tilt = result.vertical.tilt * e_m + rocking_beta * beta_tilt - soil.rocking_stiffness_N_m_rad,
                      .height_rate = result.vertical.height_rate * e_m,
                      .tilt_rate = result.vertical.tilt_rate * e_m - soil.rocking_damping_N_m_s_rad,
                      .log_modulus = result.vertical.log_modulus * e_m - soil.rocking_stiffness_N_m_rad * tilt_rad -
                                     0.5 * soil.rocking_damping_N_m_s_rad * tilt_rate_rad_s};
    return result;
}

}  // namespace steadyboom::plant
