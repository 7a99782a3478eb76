#pragma once

#include "plant/crane_parameters.hpp"

namespace steadyboom::plant {

/// What the soil does to the tracks at one instant.
struct SoilReaction {
    double contact_fraction;  ///< beta, 1 while the whole track bears, 0 when lifted off
    double contact_offset_m;  ///< e, centre of the remaining contact, positive forward
    double vertical_N;        ///< F_V >= 0, upwards on R1
    double rocking_N_m;       ///< generalized force on phi2, counter-clockwise
};

/// How one component of the soil's reaction changes, N or N m per unit of each.
struct SoilSlope {
    double height;       ///< R1
    double tilt;         ///< phi2
    double height_rate;  ///< R1'
    double tilt_rate;    ///< phi2'
    double log_modulus;  ///< ln G: stiffness goes with G, damping with its root
};
struct SoilSlopes {
    SoilSlope vertical;  ///< of F_V
    SoilSlope rocking;   ///< of the generalized force on phi2
};

/// Elastic half-space under a track that may tilt and lift (thesis 3.1.3, misprints decided on the model page):
///
///     f    = -R1 / sin|phi2| within [-d_t, d_t],   beta = (1 + f/d_t) / 2,   e = -sign(phi2) d_t (1 - beta)
///     R_ev = sqrt(4/pi beta d_t w_t),              R_ephi = (16/(3 pi) (beta d_t)^3 w_t)^(1/4)
///     K_V  = 4 G R_ev / (1 - nu),                  C_V = 3.4 R_ev^2 sqrt(rho G) / (1 - nu)
///     K_R  = 2.52 G R_ephi^3 / (1 - nu),           C_R = 0.136 R_ephi^4 sqrt(rho G) / (1.13 - nu)
///     F_V  = max(0, -K_V (R1 + e phi2) - C_V (R1' + e phi2')),   Q_phi2 = F_V e - K_R phi2 - C_R phi2'
class Soil {
  public:
    explicit Soil(const SoilParameters& soil);

    /// `sin_phi2` is sin(phi2); it is passed because the caller has it.
    [[nodiscard]] SoilReaction reaction(double height_m, double tilt_rad, double sin_phi2, double height_rate_m_s,
                                        double tilt_rate_rad_s) const noexcept;

    /// Derivatives of reaction(), within the mode that it is in.
    [[nodiscard]] SoilSlopes slopes(double height_m, double tilt_rad, double sin_phi2, double cos_phi2,
                                    double height_rate_m_s, double tilt_rate_rad_s) const noexcept;

    /// beta for a track plane at `height_m` (R1) and sin(phi2).
    [[nodiscard]] double contact_fraction(double height_m, double tilt_rad, double sin_phi2) const noexcept;

    struct Coefficients {
        double vertical_stiffness_N_m;
        double vertical_damping_N_s_m;
        double rocking_stiffness_N_m_rad;
        double rocking_damping_N_m_s_rad;
    };
    /// K_V, C_V, K_R, C_R at a contact fraction in [0, 1].
    [[nodiscard]] Coefficients coefficients(double contact_fraction) const noexcept;

  private:
    double track_half_length_m_;
    Coefficients full_contact_;
};

}  // namespace steadyboom::plant
