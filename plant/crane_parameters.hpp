#pragma once

#include <numbers>

namespace steadyboom::plant {

/// Standard gravity as the thesis uses it.
inline constexpr double gravity_m_s2 = 9.81;

/// Masses, lengths and angles of tracks, car body, boom and load (thesis Table 1 and Figs. 2-4).
/// Angles are positive counter-clockwise.
struct StructureParameters {
    double boom_length_m = 0.0;             ///< R_B, butt to tip of the straight boom
    double boom_link_mass_kg = 0.0;         ///< m_B, mass of ONE of the three links
    double boom_joint_stiffness_N_m = 0.0;  ///< K_B = 3 E I / L_B
    double boom_damping_ratio = 0.0;        ///< the 0.007 of C_B (3.1.1), share of critical damping
    double boom_outer_chord_m = 0.0;        ///< R_O, neutral axis to outer chord, what the strain link sees
    double boom_angle_rad = 0.0;            ///< phi6(t0), chord angle at which the pendent is unstretched
    double load_mass_kg = 0.0;              ///< m_L
    double track_mass_kg = 0.0;             ///< m_T
    double car_body_mass_kg = 0.0;          ///< m_C
    double track_inertia_kg_m2 = 0.0;       ///< I_T
    double car_body_inertia_kg_m2 = 0.0;    ///< I_C
    double track_centre_height_m = 0.0;     ///< R2, track plane to track centre of mass
    double car_body_height_m = 0.0;         ///< R3, track plane to car body centre and boom butt
    double car_body_setback_m = 0.0;        ///< R4, car body's centre of mass behind the slew axis
    double boom_butt_offset_m = 0.0;        ///< R5, boom butt ahead of the slew axis
    double car_body_angle_rad = 0.0;        ///< phi3, direction of R4 below the track plane
    double pendent_anchor_radius_m = 0.0;   ///< R_d, boom butt to pendent anchor
    double pendent_anchor_angle_rad = 0.0;  ///< phi_A, direction of R_d from the car body's vertical

    /// L_B, length of one of the three links.
    [[nodiscard]] double link_length_m() const noexcept { return boom_length_m / 3.0; }
    /// E I = K_B L_B / 3, N m^2.
    [[nodiscard]] double bending_stiffness_N_m2() const noexcept {
        return boom_joint_stiffness_N_m * link_length_m() / 3.0;
    }
};

/// Elastic half-space under the tracks (thesis 3.1.3).
struct SoilParameters {
    double shear_modulus_Pa = 0.0;     ///< G
    double poisson_ratio = 0.0;        ///< nu
    double density_kg_m3 = 0.0;        ///< rho, a mass density
    double track_half_length_m = 0.0;  ///< d_t
    double track_width_m = 0.0;        ///< w_t
};

/// Load line and pendent: linear springs that can only pull (thesis 3.1.2).
struct RopeParameters {
    double load_line_length_m = 0.0;       ///< R9(t0), unstretched
    double load_line_stiffness_N_m = 0.0;  ///< K_WRL
    double pendent_stiffness_N_m = 0.0;    ///< K_WRP
};

enum class ValveModel { linear, nonlinear };

/// Valve-controlled piston in the pendent line (thesis chapter 6).
/// A positive spool opening lengthens the piston, raises the pendent tension and lifts the boom.
struct ActuatorParameters {
    ValveModel valve_model = ValveModel::linear;
    double piston_area_m2 = 0.0;           ///< A_p
    double flow_gain_m2_s = 0.0;           ///< K_q, m^3/s of load flow per m of spool
    double oil_volume_m3 = 0.0;            ///< V_t
    double bulk_modulus_Pa = 0.0;          ///< beta_e
    double leakage_m3_s_Pa = 0.0;          ///< C_tp
    double spool_travel_m = 0.0;           ///< largest |X_v|
    double piston_travel_m = 0.0;          ///< largest |X_p|, hard end stops
    double supply_pressure_Pa = 0.0;       ///< P_s
    double load_pressure_report_Pa = 0.0;  ///< load pressure above which a run reports it; never enforced
    double discharge_coefficient = 0.0;    ///< C_d
    double oil_density_kg_m3 = 0.0;        ///< sigma
    double spool_diameter_m = 0.0;         ///< D_v
    double spool_bandwidth_Hz = 0.0;       ///< natural frequency of the second-order spool (virtual valve)
    double spool_damping_ratio = 0.0;      ///< damping ratio of the second-order spool (virtual valve)
    double spool_delay_s = 0.0;            ///< dead time from command to spool (virtual valve)
};

/// Everything that fixes one crane. Loaded from a case file; validated there, taken as given here.
struct CraneParameters {
    StructureParameters structure;
    SoilParameters soil;
    RopeParameters ropes;
    ActuatorParameters actuator;
};

}  // namespace steadyboom::plant
