#include "hil/reproduction/misprints.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "hil/case_file.hpp"
#include "hil/simulation.hpp"
#include "plant/equilibrium.hpp"
#include "plant/linear_modes.hpp"
#include "plant/mass_matrix_solver.hpp"

namespace steadyboom::hil {

using namespace plant;
using std::numbers::pi;

namespace {

constexpr double degree_rad = pi / 180.0;

// As the thesis prints them: Table 1 and chapter 6.
constexpr double printed_ground_stiffness_N_m = 1.19e7;
constexpr double printed_rocking_stiffness_N_m_rad = 1.92e13;
constexpr double pendent_rope_a_m = 6.04e-2;  // D_wrp
constexpr double pendent_rope_bc_m = 4.76e-2;
constexpr double printed_oil_volume_m3 = 1.31;
constexpr double printed_spool_diameter_m = 3.64e-2;
constexpr double printed_largest_flow_m3_s = 0.0164;
constexpr double printed_largest_load_pressure_Pa = 21e6;
constexpr double printed_flow_gain_m2_s = 4.12;
constexpr double printed_load_pressure_at_rest_Pa = 1.6e6;
constexpr double printed_piston_travel_m = 0.10;
constexpr double printed_power_divisor = 2298.0;

/// A shipped case with what most rows ask of it.
struct StandingCrane {
    explicit StandingCrane(std::string_view name)
        : loaded(load_case(name)),
          dynamics(loaded.crane),
          rest(find_equilibrium(dynamics)),
          mass(dynamics.mass_matrix(Coordinates(coordinates_of(rest.state)))),
          stiffness(stiffness_matrix(dynamics, coordinates_of(rest.state))),
          soil(dynamics.soil().coefficients(1.0)),
          weight_N(mass(R1_m, R1_m) * gravity_m_s2) {}

    [[nodiscard]] double rest_pressure_Pa() const {
        return dynamics.actuator().load_pressure_Pa(rest.pendent_tension_N);
    }
    [[nodiscard]] double boom_angle_deg() const { return rest.state[phi6_rad] / degree_rad; }

    Case loaded;
    CraneDynamics dynamics;
    Equilibrium rest;
    MassMatrix mass;
    MassMatrix stiffness;
    Soil::Coefficients soil;
    double weight_N;
};

double keep(MisprintRow& row, std::string key, double value) {
    row.numbers.push_back({std::move(key), value});
    return value;
}

/// Undamped frequency of the mode whose kinetic energy is most in `coordinate`.
double undamped_frequency_Hz(const MassMatrix& mass, const MassMatrix& stiffness, Coordinate coordinate) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<MassMatrix> modes(stiffness, mass);
    const MassMatrix shares = modes.eigenvectors().cwiseProduct(mass * modes.eigenvectors());
    Eigen::Index mode = 0;
    shares.row(coordinate).maxCoeff(&mode);
    return std::sqrt(std::max(0.0, modes.eigenvalues()[mode])) / (2.0 * pi);
}

/// Damping ratio of the mode in which `coordinate` dominates; the most damped where there are several.
double damping_ratio(const CraneDynamics& crane, const CraneState& rest, Coordinate coordinate) {
    double ratio = 0.0;
    for (const LinearMode& mode : linear_modes(crane, rest)) {
        if (mode.dominant == coordinate) {
            ratio = std::max(ratio, mode.damping_ratio);
        }
    }
    return ratio;
}

// ---- The printed equations of motion ----

/// One instant, not a motion: an equation of motion must balance for any accelerations.
struct Instant {
    Coordinates p, v, a;
};

/// About the equilibrium, ropes taut and the whole track bearing, so that no term of Figs. 13, 19 and 20 is zero.
Instant lively_instant(const StandingCrane& crane) {
    Instant now{.p = coordinates_of(crane.rest.state), .v = Coordinates::Zero(), .a = Coordinates::Zero()};
    now.p[R1_m] = -0.01;
    now.p[phi2_rad] = 0.002;  // f = R1 / sin(phi2) is 5 m, beyond d_t: full contact
    now.p[q1_m] += 0.3;
    now.p[q2_m] -= 0.2;
    now.p[phi9_rad] = 0.1;
    now.v << 0.02, 0.3, 0.4, 1.1, -0.7, 0.13, 0.2;
    now.a << 0.5, -0.3, 1.0, 2.0, -1.5, 0.4, 0.6;
    return now;
}

/// What the model leaves over in one equation of motion, M p'' - Q; a left-hand side of Figs. 13 to 23 must equal it.
double model_left_side(const CraneDynamics& crane, const Instant& now, Coordinate equation) {
    return crane.mass_matrix(now.p).row(equation).dot(now.a) - crane.generalized_force(now.p, now.v, 0.0)[equation];
}

/// What Figs. 13, 19 and 20 abbreviate.
struct Abbreviations {
    Abbreviations(const CraneDynamics& crane, const Instant& now)
        : s(crane.parameters().structure),
          R8_m(crane.boom().chord_m(now.p.segment<2>(q1_m))),
          R8_rate_m_s(crane.boom().chord_slope(now.p.segment<2>(q1_m)).dot(now.v.segment<2>(q1_m))),
          R8_acceleration_m_s2(crane.boom().chord_slope(now.p.segment<2>(q1_m)).dot(now.a.segment<2>(q1_m)) +
                               crane.boom().chord_bias_m_s2(now.v.segment<2>(q1_m))),
          soil(crane.soil().coefficients(1.0)) {}

    const StructureParameters& s;
    double R8_m, R8_rate_m_s, R8_acceleration_m_s2;
    Soil::Coefficients soil;
};

/// The signs and factors of Fig. 13 in question.
struct Fig13Terms {
    double boom_butt_sign = -1.0;  ///< of 3 m_B R3 cos(phi2) phi2'^2
    double tip_factor = 2.0;       ///< of m_L cos(phi6) R8' phi6'
};
constexpr Fig13Terms printed_boom_butt{.boom_butt_sign = 1.0};
constexpr Fig13Terms printed_tip{.tip_factor = 1.0};

/// Left-hand side of Fig. 13, term by term in its order, N.
double fig13_N(const CraneDynamics& crane, const Instant& now, const Fig13Terms& terms) {
    const Abbreviations f(crane, now);
    const StructureParameters& s = f.s;
    const Coordinates &p = now.p, &v = now.v, &a = now.a;
    const double m_T = s.track_mass_kg, m_C = s.car_body_mass_kg, m_L = s.load_mass_kg, m_B = s.boom_link_mass_kg;
    const double R2 = s.track_centre_height_m, R3 = s.car_body_height_m, R4 = s.car_body_setback_m,
                 R5 = s.boom_butt_offset_m;
    const double s2 = std::sin(p[phi2_rad]), c2 = std::cos(p[phi2_rad]);
    const double s23 = std::sin(p[phi2_rad] - s.car_body_angle_rad), c23 = std::cos(p[phi2_rad] - s.car_body_angle_rad);
    const double s6 = std::sin(p[phi6_rad]), c6 = std::cos(p[phi6_rad]);
    const double s9 = std::sin(p[phi9_rad]), c9 = std::cos(p[phi9_rad]);
    const double w2 = v[phi2_rad], w6 = v[phi6_rad], w9 = v[phi9_rad];
    return (m_T + m_C + m_L + 3.0 * m_B) * a[R1_m] + (m_L + 1.5 * m_B) * s6 * f.R8_acceleration_m_s2 -
           m_L * c9 * a[R9_m] - m_B * c6 * (a[q1_m] + a[q2_m]) +
           (-m_T * R2 * s2 - m_C * R3 * s2 - m_C * R4 * c23 - m_L * R3 * s2 + m_L * R5 * c2 - 3.0 * m_B * R3 * s2 +
            3.0 * m_B * R5 * c2) *
               a[phi2_rad] +
           (m_L * f.R8_m * c6 + 1.5 * m_B * f.R8_m * c6 + m_B * (p[q1_m] + p[q2_m]) * s6) * a[phi6_rad] +
           m_L * p[R9_m] * s9 * a[phi9_rad] +
           (-m_T * R2 * c2 - m_C * R3 * c2 + m_C * R4 * s23 - m_L * R3 * c2 - m_L * R5 * s2 +
            terms.boom_butt_sign * 3.0 * m_B * R3 * c2 - 3.0 * m_B * R5 * s2) *
               w2 * w2 +
           (-m_L * f.R8_m * s6 - 1.5 * m_B * f.R8_m * s6 + m_B * (p[q1_m] + p[q2_m]) * c6) * w6 * w6 +
           m_L * p[R9_m] * c9 * w9 * w9 + 3.0 * m_B * c6 * f.R8_rate_m_s * w6 + 2.0 * m_L * s9 * v[R9_m] * w9 +
           2.0 * m_B * s6 * (v[q1_m] + v[q2_m]) * w6 + terms.tip_factor * m_L * c6 * f.R8_rate_m_s * w6 +
           gravity_m_s2 * (m_T + m_C + m_L + 3.0 * m_B) + f.soil.vertical_stiffness_N_m * p[R1_m] +
           f.soil.vertical_damping_N_s_m * v[R1_m];
}

/// The four terms of Figs. 19 and 20 in question.
struct Fig20Terms {
    bool chord_for_setback = false;   ///< Fig. 19: R6 = R8 / 3 (Fig. 12) where the car body's R4 belongs
    bool tilt_for_rate = false;       ///< C_r phi2
    bool setback_for_anchor = false;  ///< R8 R4 sin(phi_B)
    bool car_body_for_load = false;   ///< m_C R3 sin(phi2) twice
};

/// Left-hand side of Figs. 19 and 20, term by term in their order, N m.
double fig20_N_m(const CraneDynamics& crane, const Instant& now, const Fig20Terms& terms) {
    const Abbreviations f(crane, now);
    const StructureParameters& s = f.s;
    const Coordinates &p = now.p, &v = now.v, &a = now.a;
    const double m_T = s.track_mass_kg, m_C = s.car_body_mass_kg, m_L = s.load_mass_kg, m_B = s.boom_link_mass_kg;
    const double R2 = s.track_centre_height_m, R3 = s.car_body_height_m, R4 = s.car_body_setback_m,
                 R5 = s.boom_butt_offset_m, R8 = f.R8_m, R9 = p[R9_m];
    const double phi_B = s.pendent_anchor_angle_rad + pi / 2.0 - (p[phi6_rad] - p[phi2_rad]);
    const double s2 = std::sin(p[phi2_rad]), c2 = std::cos(p[phi2_rad]);
    const double c23 = std::cos(p[phi2_rad] - s.car_body_angle_rad);
    const double s62 = std::sin(p[phi6_rad] - p[phi2_rad]), c62 = std::cos(p[phi6_rad] - p[phi2_rad]);
    const double s29 = std::sin(p[phi2_rad] - p[phi9_rad]), c29 = std::cos(p[phi2_rad] - p[phi9_rad]);
    const double w6 = v[phi6_rad], w9 = v[phi9_rad], q = p[q1_m] + p[q2_m];
    CraneState state = CraneState::Zero();
    coordinates_of(state) = p;
    const CraneOutputs outputs = crane.outputs(state);
    const double car_body_arm_m = terms.chord_for_setback ? R8 / 3.0 : R4;
    const double pendent_arm_m = terms.setback_for_anchor ? R4 : s.pendent_anchor_radius_m;
    return (-m_T * R2 * s2 - m_C * R3 * s2 - m_C * R4 * c23 - m_L * R3 * s2 + m_L * R5 * c2 - 3.0 * m_B * R3 * s2 +
            3.0 * m_B * R5 * c2) *
               a[R1_m] +
           (m_L + 1.5 * m_B) * (-R3 * c62 + R5 * s62) * f.R8_acceleration_m_s2 + m_L * (R3 * s29 - R5 * c29) * a[R9_m] -
           m_B * (R3 * s62 + R5 * c62) * (a[q1_m] + a[q2_m]) +
           (m_T * R2 * R2 + s.track_inertia_kg_m2 + m_C * (R3 * R3 + R4 * R4) +
            2.0 * m_C * R3 * car_body_arm_m * std::sin(s.car_body_angle_rad) + s.car_body_inertia_kg_m2 +
            (m_L + 3.0 * m_B) * (R3 * R3 + R5 * R5)) *
               a[phi2_rad] +
           ((m_L + 1.5 * m_B) * R8 * (R3 * s62 + R5 * c62) + m_B * q * (-R3 * c62 + R5 * s62)) * a[phi6_rad] -
           m_L * R9 * (R3 * c29 + R5 * s29) * a[phi9_rad] +
           ((m_L + 1.5 * m_B) * R8 * (R3 * c62 - R5 * s62) + m_B * q * (R3 * s62 + R5 * c62)) * w6 * w6 +
           m_L * R9 * (-R3 * s29 + R5 * c29) * w9 * w9 +
           (2.0 * m_L + 3.0 * m_B) * (R3 * s62 + R5 * c62) * f.R8_rate_m_s * w6 +
           2.0 * m_B * (-R3 * c62 + R5 * s62) * (v[q1_m] + v[q2_m]) * w6 -
           2.0 * m_L * (R3 * c29 + R5 * s29) * v[R9_m] * w9 +
           gravity_m_s2 * ((m_L + 3.0 * m_B) * R5 * c2 - 3.0 * m_B * R3 * s2 - m_T * R2 * s2 - m_C * R3 * s2 -
                           m_C * R4 * c23 - (terms.car_body_for_load ? m_C : m_L) * R3 * s2) +
           outputs.pendent_tension_N * R8 * pendent_arm_m * std::sin(phi_B) / outputs.pendent_length_m +
           f.soil.rocking_stiffness_N_m_rad * p[phi2_rad] +
           f.soil.rocking_damping_N_m_s_rad * (terms.tilt_for_rate ? p[phi2_rad] : v[phi2_rad]);
}

/// How far a printed left-hand side is from the model's, with and without the misprint in question.
struct Imbalance {
    double used = 0.0;
    double printed = 0.0;
};

Imbalance fig13_imbalance_N(const StandingCrane& crane, const Fig13Terms& printed) {
    const Instant now = lively_instant(crane);
    const double model = model_left_side(crane.dynamics, now, R1_m);
    return {.used = fig13_N(crane.dynamics, now, {}) - model, .printed = fig13_N(crane.dynamics, now, printed) - model};
}

Imbalance fig20_imbalance_N_m(const StandingCrane& crane, const Fig20Terms& printed) {
    const Instant now = lively_instant(crane);
    const double model = model_left_side(crane.dynamics, now, phi2_rad);
    return {.used = fig20_N_m(crane.dynamics, now, {}) - model,
            .printed = fig20_N_m(crane.dynamics, now, printed) - model};
}

std::string imbalance_text(MisprintRow& row, const char* figures, const char* unit, const Imbalance& imbalance) {
    const std::string suffix = std::string(unit) == "N" ? "_N" : "_N_m";
    return fmt::format(
        "{}, all terms, at one instant of case A in which every coordinate moves and accelerates, less M p'' - Q from "
        "the kinematics: {:.2g} {} as used, {:.4g} {} as printed.",
        figures, keep(row, "used_imbalance" + suffix, std::abs(imbalance.used)), unit,
        keep(row, "printed_imbalance" + suffix, imbalance.printed), unit);
}

// ---- The rows, in the order of the thesis ----

MisprintRow contact_length_row(const StandingCrane& a) {
    MisprintRow row{.id = "contact-length",
                    .where = "3.1.3-6",
                    .printed = "f = R1 / |sin phi2|",
                    .used = "f = -R1 / |sin phi2|",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    const double sink_m = a.rest.state[R1_m];
    const double tilt_rad = a.rest.state[phi2_rad];
    const double half_m = a.loaded.crane.soil.track_half_length_m;
    const double printed_f_m = std::clamp(sink_m / std::abs(std::sin(tilt_rad)), -half_m, half_m);
    const double printed_beta = keep(row, "printed_contact_fraction", 0.5 * (1.0 + printed_f_m / half_m));
    const double used_beta =
        keep(row, "used_contact_fraction", a.dynamics.soil().contact_fraction(sink_m, tilt_rad, std::sin(tilt_rad)));
    const double edge_m = keep(row, "raised_edge_m", sink_m + half_m * std::abs(std::sin(tilt_rad)));
    row.calculation = fmt::format(
        "Case A at rest: R1 = {:.3f} mm, phi2 = {:.3f} mrad, the higher edge of the track stands at {:.3f} mm, below "
        "the "
        "soil's surface, so the whole track bears. beta is {:.3g} as used, {:.3g} with the printed sign.",
        1e3 * sink_m, 1e3 * tilt_rad, 1e3 * edge_m, used_beta, printed_beta);
    row.consequence = fmt::format(
        "K_V at rest is {:.3g} N/m under a weight of {:.3g} N: the crane would stand on nothing, and bear fully once "
        "lifted off.",
        keep(row, "printed_vertical_stiffness_N_m",
             a.dynamics.soil().coefficients(printed_beta).vertical_stiffness_N_m),
        a.weight_N);
    return row;
}

MisprintRow contact_fraction_row(const StandingCrane& a) {
    MisprintRow row{.id = "contact-fraction",
                    .where = "3.1.3-7",
                    .printed = "beta = (1 + 1/d_t) / 2",
                    .used = "beta = (1 + f/d_t) / 2",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    const double half_m = a.loaded.crane.soil.track_half_length_m;
    const double printed_beta = keep(row, "printed_contact_fraction", 0.5 * (1.0 + 1.0 / half_m));
    row.calculation = fmt::format(
        "Full contact, f = d_t, must give beta = 1 and lift-off, f = -d_t, beta = 0 (3.1.3-10). The printed form gives "
        "{:.3f} whatever the crane does, and adds a length's reciprocal to a number.",
        printed_beta);
    const double share =
        keep(row, "printed_vertical_stiffness_share",
             a.dynamics.soil().coefficients(printed_beta).vertical_stiffness_N_m / a.soil.vertical_stiffness_N_m);
    row.consequence = fmt::format(
        "The tracks never lift: no tilting. K_V is {:.2f} of its value, the level crane's soil force stands {:.2f} m "
        "off "
        "centre.",
        share, keep(row, "printed_offset_m", half_m * (1.0 - printed_beta)));
    return row;
}

MisprintRow sink_row(const StandingCrane& a) {
    MisprintRow row{.id = "sink",
                    .where = "3.1.3-13",
                    .printed = "y = eta (d_t - f)/2 + R1",
                    .used = "y = R1 + e phi2 = R1 - eta (d_t - f)/2",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    constexpr double sink_m = -0.5e-3;
    constexpr double tilt_rad = 0.5e-3;
    const double half_m = a.loaded.crane.soil.track_half_length_m;
    const SoilReaction soil = a.dynamics.soil().reaction(sink_m, tilt_rad, std::sin(tilt_rad), 0.0, 0.0);
    const double used_m = keep(row, "used_y_m", sink_m + soil.contact_offset_m * tilt_rad);
    const double f_m = -sink_m / std::sin(tilt_rad);
    const double printed_m = keep(row, "printed_y_m", 0.5 * tilt_rad * (half_m - f_m) + sink_m);
    // The plane under the track is straight: the mean over the bearing length is half its deepest point's depth.
    const double mean_m = keep(row, "mean_sink_m", 0.5 * (sink_m - half_m * std::sin(tilt_rad)));
    row.calculation = fmt::format(
        "y is the sink of the contact's centre. At R1 = {:.1f} mm, phi2 = {:.1f} mrad (contact fraction {:.2f}) the "
        "bearing length's mean sink, from the track's plane itself, is {:.4f} mm; used {:.4f} mm, printed {:.4f} mm. "
        "The printed rate, 3.1.3-14, is that of the form used.",
        1e3 * sink_m, 1e3 * tilt_rad, soil.contact_fraction, 1e3 * mean_m, 1e3 * used_m, 1e3 * printed_m);
    const double stiffness_N_m = a.dynamics.soil().coefficients(soil.contact_fraction).vertical_stiffness_N_m;
    row.consequence = fmt::format(
        "There the soil bears {:.3g} N as used and {:.3g} N as printed: it would let go of a track that presses into "
        "it.",
        keep(row, "used_force_N", soil.vertical_N),
        keep(row, "printed_force_N", std::max(0.0, -stiffness_N_m * printed_m)));
    return row;
}

MisprintRow soil_density_row(const StandingCrane& a) {
    MisprintRow row{.id = "soil-density",
                    .where = "3.1.3-16, 3.1.3-18",
                    .printed = "rho is the specific weight of the soil",
                    .used = "rho is its mass density",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    const SoilParameters& soil = a.loaded.crane.soil;
    const double wave_m_s = keep(row, "shear_wave_m_s", std::sqrt(soil.shear_modulus_Pa / soil.density_kg_m3));
    SoilParameters heavy = soil;
    heavy.density_kg_m3 *= gravity_m_s2;
    const double printed_damping = Soil(heavy).coefficients(1.0).vertical_damping_N_s_m;
    const double ratio = keep(row, "damping_ratio_printed_over_used", printed_damping / a.soil.vertical_damping_N_s_m);
    row.calculation = fmt::format(
        "sqrt(rho G) is rho times the shear wave's speed, {:.0f} m/s, so that C_V is in N s/m; with a specific weight "
        "it is {:.2f} times as large and its unit is off by the root of an acceleration.",
        wave_m_s, ratio);
    CraneParameters damped = a.loaded.crane;
    damped.soil = heavy;
    row.consequence =
        fmt::format("The ground mode's damping ratio in case A becomes {:.2f} instead of {:.2f}.",
                    keep(row, "printed_ground_damping", damping_ratio(CraneDynamics(damped), a.rest.state, R1_m)),
                    keep(row, "used_ground_damping", damping_ratio(a.dynamics, a.rest.state, R1_m)));
    return row;
}

MisprintRow ground_stiffness_row(const StandingCrane& a, const StandingCrane& b, const StandingCrane& c) {
    MisprintRow row{.id = "ground-stiffness",
                    .where = "Table 1, K_V",
                    .printed = fmt::format("{:.3g} N/m in cases A, B and C", printed_ground_stiffness_N_m),
                    .used = "3.1.3-2 with each case's G",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    row.calculation = fmt::format(
        "4 G R_ev / (1 - nu) with the thesis's G, d_t and w_t and full contact: {:.3g}, {:.3g} and {:.3g} N/m in A, B "
        "and C. A constant contradicts the three G; A's mantissa is the printed one.",
        keep(row, "case_a_N_m", a.soil.vertical_stiffness_N_m), keep(row, "case_b_N_m", b.soil.vertical_stiffness_N_m),
        keep(row, "case_c_N_m", c.soil.vertical_stiffness_N_m));
    MassMatrix soft = a.stiffness;
    soft(R1_m, R1_m) += printed_ground_stiffness_N_m - a.soil.vertical_stiffness_N_m;
    row.consequence = fmt::format(
        "Case A would settle {:.0f} mm instead of {:.2f} mm and bounce at {:.2f} Hz instead of {:.1f} Hz (undamped).",
        1e3 * keep(row, "printed_settlement_m", a.weight_N / printed_ground_stiffness_N_m),
        1e3 * keep(row, "used_settlement_m", -a.rest.state[R1_m]),
        keep(row, "printed_ground_mode_Hz", undamped_frequency_Hz(a.mass, soft, R1_m)),
        keep(row, "used_ground_mode_Hz", undamped_frequency_Hz(a.mass, a.stiffness, R1_m)));
    return row;
}

MisprintRow rocking_stiffness_row(const StandingCrane& a, const StandingCrane& b, const StandingCrane& c) {
    MisprintRow row{.id = "rocking-stiffness",
                    .where = "Table 1, K_R",
                    .printed = fmt::format("{:.3g} N/m in cases A, B and C", printed_rocking_stiffness_N_m_rad),
                    .used = "3.1.3-4 with each case's G",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    row.calculation = fmt::format(
        "2.52 G R_ephi^3 / (1 - nu), full contact: {:.3g}, {:.3g} and {:.3g} N m/rad in A, B and C; the printed value "
        "is "
        "{:.0f} times case A's, and its unit is a force's.",
        keep(row, "case_a_N_m_rad", a.soil.rocking_stiffness_N_m_rad),
        keep(row, "case_b_N_m_rad", b.soil.rocking_stiffness_N_m_rad),
        keep(row, "case_c_N_m_rad", c.soil.rocking_stiffness_N_m_rad),
        printed_rocking_stiffness_N_m_rad / a.soil.rocking_stiffness_N_m_rad);
    MassMatrix stiff = a.stiffness;
    stiff(phi2_rad, phi2_rad) += printed_rocking_stiffness_N_m_rad - a.soil.rocking_stiffness_N_m_rad;
    row.consequence = fmt::format(
        "The tracks of case A would rock at {:.0f} Hz instead of {:.1f} Hz (undamped): they would not rock at all.",
        keep(row, "printed_rocking_mode_Hz", undamped_frequency_Hz(a.mass, stiff, phi2_rad)),
        keep(row, "used_rocking_mode_Hz", undamped_frequency_Hz(a.mass, a.stiffness, phi2_rad)));
    return row;
}

MisprintRow pendent_stiffness_row(const StandingCrane& a, const StandingCrane& crane, char name,
                                  double printed_stiffness_N_m) {
    const double used_N_m = crane.loaded.crane.ropes.pendent_stiffness_N_m;
    MisprintRow row{.id = std::string("pendent-stiffness-") + static_cast<char>(name - 'A' + 'a'),
                    .where = fmt::format("Table 1, K_WRP of case {}", name),
                    .printed = fmt::format("{:.3g} N/m", printed_stiffness_N_m),
                    .used = fmt::format("{:.4g} N/m", used_N_m),
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    const double area_ratio = std::pow(pendent_rope_bc_m / pendent_rope_a_m, 2);
    const double length_ratio = a.dynamics.free_pendent_length_m() / crane.dynamics.free_pendent_length_m();
    const double rope_law_N_m =
        keep(row, "rope_law_N_m", a.loaded.crane.ropes.pendent_stiffness_N_m * area_ratio * length_ratio);
    row.calculation = fmt::format(
        "A E / L (3.1.2-1) from case A's {:.3g} N/m, the ropes' diameters {:.2f} and {:.2f} cm and the unstretched "
        "lengths {:.2f} and {:.2f} m: {:.4g} N/m.",
        a.loaded.crane.ropes.pendent_stiffness_N_m, 1e2 * pendent_rope_a_m, 1e2 * pendent_rope_bc_m,
        a.dynamics.free_pendent_length_m(), crane.dynamics.free_pendent_length_m(), rope_law_N_m);
    const double start_deg = crane.loaded.crane.structure.boom_angle_rad / degree_rad;
    CraneParameters soft = crane.loaded.crane;
    soft.ropes.pendent_stiffness_N_m = printed_stiffness_N_m;
    keep(row, "used_boom_angle_deg", crane.boom_angle_deg());
    try {
        const double sagged_deg =
            keep(row, "printed_boom_angle_deg", find_equilibrium(CraneDynamics(soft)).state[phi6_rad] / degree_rad);
        row.consequence = fmt::format("At rest the boom sags from {:.0f} deg to {:.1f} deg; used: {:.2f} deg.",
                                      start_deg, sagged_deg, crane.boom_angle_deg());
    } catch (const EquilibriumError& error) {
        row.consequence = fmt::format("Newton on 4-3 ends with: {}. With the value used the boom rests at {:.2f} deg.",
                                      error.what(), crane.boom_angle_deg());
    }
    return row;
}

MisprintRow boom_butt_row(const StandingCrane& a, double largest_wrong_N) {
    MisprintRow row{.id = "fig13-boom-butt",
                    .where = "Fig. 13",
                    .printed = "+3 m_B R3 cos(phi2) phi2'^2",
                    .used = "-3 m_B R3 cos(phi2) phi2'^2",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    row.calculation = imbalance_text(row, "Fig. 13", "N", fig13_imbalance_N(a, printed_boom_butt));
    row.consequence = fmt::format(
        "Uncontrolled case A: a vertical force of up to {:.2g} N that no body exerts, {:.1g} of the weight. Wrong, but "
        "not seen.",
        keep(row, "largest_wrong_N", largest_wrong_N), largest_wrong_N / a.weight_N);
    return row;
}

MisprintRow tip_coriolis_row(const StandingCrane& a, double largest_wrong_N) {
    MisprintRow row{.id = "fig13-tip",
                    .where = "Fig. 13",
                    .printed = "m_L cos(phi6) R8' phi6'",
                    .used = "2 m_L cos(phi6) R8' phi6'",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    row.calculation = imbalance_text(row, "Fig. 13", "N", fig13_imbalance_N(a, printed_tip));
    row.consequence =
        fmt::format("Uncontrolled case A: up to {:.2g} N of the load's Coriolis force are lost, {:.1g} of the weight.",
                    keep(row, "largest_wrong_N", largest_wrong_N), largest_wrong_N / a.weight_N);
    return row;
}

MisprintRow bending_row(const StandingCrane& a) {
    MisprintRow row{.id = "fig18-bending",
                    .where = "Fig. 18",
                    .printed = "6 K_B/L_B q2 - 3 K_B/L_B q1",
                    .used = "6 K_B/L_B^2 q2 - 3 K_B/L_B^2 q1",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    constexpr double q1 = 0.02, q2 = 0.05, difference_m = 1e-4;
    const StructureParameters& s = a.loaded.crane.structure;
    const double link_m = s.link_length_m();
    const LinkBoom& boom = a.dynamics.boom();
    const double slope_N =
        keep(row, "energy_slope_N",
             (boom.bending_energy_J({q1, q2 + difference_m}) - boom.bending_energy_J({q1, q2 - difference_m})) /
                 (2.0 * difference_m));
    const double joint_N_m = s.boom_joint_stiffness_N_m * (6.0 * q2 - 3.0 * q1);
    row.calculation = fmt::format(
        "At q1 = {:.0f} mm, q2 = {:.0f} mm in case A the bending energy (3.1.1) rises with q2 by {:.4g} N; used "
        "{:.4g} N, printed {:.4g} with the unit of a moment. Fig. 16 has the square for q1.",
        1e3 * q1, 1e3 * q2, slope_N, keep(row, "used_N", joint_N_m / (link_m * link_m)),
        keep(row, "printed_N_m", joint_N_m / link_m));
    const auto lowest_Hz = [&](double second_row_factor) {
        Eigen::Matrix2d mass;
        mass << 0.5, 0.25, 0.25, 0.5;
        mass *= s.boom_link_mass_kg;
        Eigen::Matrix2d stiffness;
        stiffness << 2.0, -1.0, -second_row_factor, 2.0 * second_row_factor;
        stiffness *= 3.0 * s.boom_joint_stiffness_N_m / (link_m * link_m);
        const Eigen::Vector2cd values = (mass.inverse() * stiffness).eval().eigenvalues();
        return std::sqrt(values.real().minCoeff()) / (2.0 * pi);
    };
    row.consequence = fmt::format(
        "Joint 2 becomes {:.1f} times as stiff but joint 1 does not feel it: no potential energy has such forces. With "
        "the chord held, the boom's first bending frequency is {:.1f} Hz instead of {:.1f} Hz.",
        link_m, keep(row, "printed_first_mode_Hz", lowest_Hz(link_m)), keep(row, "used_first_mode_Hz", lowest_Hz(1.0)));
    return row;
}

MisprintRow car_body_arm_row(const StandingCrane& a) {
    MisprintRow row{.id = "fig19-car-body-arm",
                    .where = "Fig. 19",
                    .printed = "2 m_C R3 R6 sin(phi3) phi2''",
                    .used = "2 m_C R3 R4 sin(phi3) phi2''",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    row.calculation =
        imbalance_text(row, "Figs. 19 and 20", "N m", fig20_imbalance_N_m(a, {.chord_for_setback = true})) +
        " R6 is the chord to the first joint (Fig. 12) and does not move with the car body; Fig. 10 has R4.";
    const StructureParameters& s = a.loaded.crane.structure;
    const double extra_kg_m2 = 2.0 * s.car_body_mass_kg * s.car_body_height_m * std::sin(s.car_body_angle_rad) *
                               (s.boom_length_m / 3.0 - s.car_body_setback_m);
    row.consequence = fmt::format("The inertia about phi2 is {:.1f} % too large.",
                                  100.0 * keep(row, "extra_inertia_share", extra_kg_m2 / a.mass(phi2_rad, phi2_rad)));
    return row;
}

MisprintRow rocking_damping_row(const StandingCrane& a) {
    MisprintRow row{.id = "fig20-rocking-damping",
                    .where = "Fig. 20",
                    .printed = "C_r phi2",
                    .used = "C_r phi2'",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    row.calculation = imbalance_text(row, "Figs. 19 and 20", "N m", fig20_imbalance_N_m(a, {.tilt_for_rate = true})) +
                      " 3.1.3-17 has the rate.";
    row.consequence = fmt::format(
        "Rocking would not be damped by the soil but stiffened by {:.2f} %; C_R gives it a damping ratio of {:.3f}, "
        "C_R / (2 sqrt(K_R M22)), in case A.",
        100.0 * keep(row, "stiffness_share", a.soil.rocking_damping_N_m_s_rad / a.soil.rocking_stiffness_N_m_rad),
        keep(row, "used_damping_ratio",
             a.soil.rocking_damping_N_m_s_rad /
                 (2.0 * std::sqrt(a.soil.rocking_stiffness_N_m_rad * a.mass(phi2_rad, phi2_rad)))));
    return row;
}

MisprintRow pendent_arm_row(const StandingCrane& a) {
    MisprintRow row{.id = "fig20-pendent-arm",
                    .where = "Fig. 20",
                    .printed = "R8 R4 sin(phi_B) / L_p",
                    .used = "R8 R_d sin(phi_B) / L_p",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    row.calculation =
        imbalance_text(row, "Figs. 19 and 20", "N m", fig20_imbalance_N_m(a, {.setback_for_anchor = true})) +
        " Fig. 22 has R_d, and a rope between two parts of the crane cannot turn the whole.";
    const Instant rest{.p = coordinates_of(a.rest.state), .v = Coordinates::Zero(), .a = Coordinates::Zero()};
    const double moment_N_m =
        keep(row, "moment_from_nothing_N_m",
             fig20_N_m(a.dynamics, rest, {}) - fig20_N_m(a.dynamics, rest, {.setback_for_anchor = true}));
    row.consequence = fmt::format(
        "Case A at rest: a moment of {:.3g} N m from nothing, {:.2g} mrad of tilt on K_R, where the equilibrium's own "
        "tilt is {:.2g} mrad.",
        moment_N_m, 1e3 * keep(row, "tilt_from_nothing_rad", moment_N_m / a.soil.rocking_stiffness_N_m_rad),
        1e3 * a.rest.state[phi2_rad]);
    return row;
}

MisprintRow load_weight_row(const StandingCrane& a) {
    MisprintRow row{.id = "fig20-load-weight",
                    .where = "Fig. 20",
                    .printed = "g m_C R3 sin(phi2) twice",
                    .used = "once with m_C, once with m_L",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    row.calculation =
        imbalance_text(row, "Figs. 19 and 20", "N m", fig20_imbalance_N_m(a, {.car_body_for_load = true})) +
        " Fig. 12 has one such term for each body.";
    const StructureParameters& s = a.loaded.crane.structure;
    row.consequence = fmt::format(
        "Gravity's negative stiffness on phi2 is {:.3g} N m/rad too large, {:.2g} of K_R in case A.",
        keep(row, "wrong_stiffness_N_m_rad",
             (s.car_body_mass_kg - s.load_mass_kg) * gravity_m_s2 * s.car_body_height_m),
        (s.car_body_mass_kg - s.load_mass_kg) * gravity_m_s2 * s.car_body_height_m / a.soil.rocking_stiffness_N_m_rad);
    return row;
}

MisprintRow flow_reversal_row(const StandingCrane& c) {
    MisprintRow row{.id = "flow-reversal",
                    .where = "6-22",
                    .printed = "P_s - |X_v/X_v1| P_L",
                    .used = "P_s - sign(X_v) P_L",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    ActuatorParameters parameters = c.loaded.crane.actuator;
    parameters.valve_model = ValveModel::nonlinear;
    const Actuator valve(parameters, c.loaded.crane.ropes);
    const double opening_m = -parameters.spool_travel_m;
    const double load_Pa = c.rest_pressure_Pa();
    // Critical centre, symmetric: P1 + P2 = P_s and P1 - P2 = P_L; at a negative opening the supply feeds chamber 2.
    const double fed_Pa = 0.5 * (parameters.supply_pressure_Pa - load_Pa);
    const double edge_m2 = parameters.discharge_coefficient * pi * parameters.spool_diameter_m * opening_m;
    const double orifice_m3_s =
        keep(row, "two_edges_m3_s",
             edge_m2 * std::sqrt(2.0 / parameters.oil_density_kg_m3 * (parameters.supply_pressure_Pa - fed_Pa)));
    const double used_m3_s = keep(row, "used_m3_s", valve.load_flow_m3_s(opening_m, load_Pa));
    const double printed_m3_s =
        keep(row, "printed_m3_s",
             edge_m2 * std::sqrt((parameters.supply_pressure_Pa - load_Pa) / parameters.oil_density_kg_m3));
    row.calculation = fmt::format(
        "X_v = {:.1f} mm at case C's load pressure at rest, {:.1f} MPa: the supply edge feeds the chamber at {:.1f} "
        "MPa "
        "and passes {:.5f} m^3/s; used {:.5f}, printed {:.5f}.",
        1e3 * opening_m, 1e-6 * load_Pa, 1e-6 * fed_Pa, orifice_m3_s, used_m3_s, printed_m3_s);
    row.consequence = fmt::format(
        "Lowering, the load would hold the oil back instead of pushing it out: {:.0f} % of the flow in case C. The "
        "linear "
        "valve of the thesis's cases does not see it.",
        100.0 * keep(row, "printed_share", printed_m3_s / used_m3_s));
    return row;
}

MisprintRow spool_diameter_row(const StandingCrane& a) {
    MisprintRow row{.id = "spool-diameter",
                    .where = "chapter 6, after 6-22",
                    .printed = fmt::format("D_v = {:.2f} cm", 1e2 * printed_spool_diameter_m),
                    .used = fmt::format("D_v = {:.2f} cm", 1e2 * a.loaded.crane.actuator.spool_diameter_m),
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    ActuatorParameters parameters = a.loaded.crane.actuator;
    parameters.valve_model = ValveModel::nonlinear;
    const auto flow_m3_s = [&](double diameter_m) {
        ActuatorParameters changed = parameters;
        changed.spool_diameter_m = diameter_m;
        return Actuator(changed, a.loaded.crane.ropes)
            .load_flow_m3_s(parameters.spool_travel_m, printed_largest_load_pressure_Pa);
    };
    const auto gain_m2_s = [&](double diameter_m) {
        return parameters.discharge_coefficient * pi * diameter_m *
               std::sqrt((parameters.supply_pressure_Pa - printed_load_pressure_at_rest_Pa) /
                         parameters.oil_density_kg_m3);
    };
    const double used_m = parameters.spool_diameter_m;
    row.calculation = fmt::format(
        "6-22 at {:.1f} mm and {:.0f} MPa, for {} m^3/s, solves to {:.2f} cm. The flow is {:.4f} m^3/s with {:.2f} cm "
        "and {:.4f} m^3/s with the printed {:.2f} cm.",
        1e3 * parameters.spool_travel_m, 1e-6 * printed_largest_load_pressure_Pa, printed_largest_flow_m3_s,
        1e2 * keep(row, "solved_diameter_m", used_m * printed_largest_flow_m3_s / flow_m3_s(used_m)),
        keep(row, "used_flow_m3_s", flow_m3_s(used_m)), 1e2 * used_m,
        keep(row, "printed_flow_m3_s", flow_m3_s(printed_spool_diameter_m)), 1e2 * printed_spool_diameter_m);
    row.consequence =
        fmt::format("6-23 at the thesis's P_L0 would give K_q = {:.1f} m^3/s/m; the thesis prints {:.2f}, used {:.2f}.",
                    keep(row, "printed_flow_gain_m2_s", gain_m2_s(printed_spool_diameter_m)), printed_flow_gain_m2_s,
                    keep(row, "used_flow_gain_m2_s", gain_m2_s(used_m)));
    return row;
}

MisprintRow flow_pressure_row(const StandingCrane& a) {
    MisprintRow row{.id = "flow-pressure",
                    .where = "6-24",
                    .printed = "K_c = C_d pi D_v X_v0 [(P_s - P_L0)/sigma] / (2 (P_s - P_L0))",
                    .used = "K_c = C_d pi D_v X_v0 sqrt((P_s - P_L0)/sigma) / (2 (P_s - P_L0))",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    ActuatorParameters parameters = a.loaded.crane.actuator;
    parameters.valve_model = ValveModel::nonlinear;
    const Actuator valve(parameters, a.loaded.crane.ropes);
    constexpr double opening_m = 1e-3, difference_Pa = 1e4;
    const double load_Pa = a.rest_pressure_Pa();
    const double drop_Pa = parameters.supply_pressure_Pa - load_Pa;
    const double slope = keep(row, "slope_m3_s_Pa",
                              -(valve.load_flow_m3_s(opening_m, load_Pa + difference_Pa) -
                                valve.load_flow_m3_s(opening_m, load_Pa - difference_Pa)) /
                                  (2.0 * difference_Pa));
    const double edge_m2 = parameters.discharge_coefficient * pi * parameters.spool_diameter_m * opening_m;
    row.calculation = fmt::format(
        "-dQ_L/dP_L of 6-22 at X_v0 = {:.0f} mm and case A's {:.2f} MPa, by differences: {:.4g} m^3/s/Pa. With the "
        "root "
        "{:.4g}, without {:.4g} and the unit of an area times a velocity squared over a pressure.",
        1e3 * opening_m, 1e-6 * load_Pa, slope,
        keep(row, "used_m3_s_Pa", edge_m2 * std::sqrt(drop_Pa / parameters.oil_density_kg_m3) / (2.0 * drop_Pa)),
        keep(row, "printed_m3_s_Pa", edge_m2 * drop_Pa / parameters.oil_density_kg_m3 / (2.0 * drop_Pa)));
    row.consequence = "None in the thesis's cases: X_v0 = 0 makes both zero.";
    return row;
}

MisprintRow oil_volume_row(const StandingCrane& a) {
    MisprintRow row{.id = "oil-volume",
                    .where = "chapter 6, after 6-24",
                    .printed = fmt::format("V_t = {:.2f} m^3", printed_oil_volume_m3),
                    .used = fmt::format("V_t = {:.3g} m^3", a.loaded.crane.actuator.oil_volume_m3),
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    constexpr double four_inches_m = 4.0 * 0.0254;
    const double area_m2 = a.loaded.crane.actuator.piston_area_m2;
    row.calculation = fmt::format(
        "2 A_p times the piston's travel: {:.3g} m^3 with the printed {:.2f} m, {:.3g} m^3 with the 4 in that it "
        "rounds.",
        keep(row, "swept_m3", 2.0 * area_m2 * printed_piston_travel_m), printed_piston_travel_m,
        keep(row, "swept_four_inches_m3", 2.0 * area_m2 * four_inches_m));
    Case flooded = a.loaded;
    flooded.crane.actuator.oil_volume_m3 = printed_oil_volume_m3;
    const auto law2 = [](const Case& crane_case) {
        return simulate({.crane_case = crane_case, .law = controllers::LawKind::joint_deflection, .step_s = {}},
                        [](const TruthSample&) {});
    };
    const double used_share = keep(row, "used_compliance_share", a.dynamics.actuator().oil_compliance_share());
    const double printed_share =
        keep(row, "printed_compliance_share", CraneDynamics(flooded.crane).actuator().oil_compliance_share());
    row.consequence = fmt::format(
        "The oil would give back {:.0f} % of every pendent stretch instead of {:.1f} %, and law 2 would leave {:.0f} J "
        "in "
        "case A instead of {:.0f} J.",
        100.0 * printed_share, 100.0 * used_share, keep(row, "printed_residual_J", law2(flooded).residual_energy_J),
        keep(row, "used_residual_J", law2(a.loaded).residual_energy_J));
    return row;
}

MisprintRow rest_pressure_row(const StandingCrane& a, const StandingCrane& b, const StandingCrane& c) {
    MisprintRow row{.id = "rest-pressure",
                    .where = "chapter 6, after 6-24",
                    .printed = fmt::format("P_L0 = {:.1f} MPa", 1e-6 * printed_load_pressure_at_rest_Pa),
                    .used = "T_P / A_p at each case's equilibrium",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    row.calculation = fmt::format("6-5 at rest: {:.1f}, {:.1f} and {:.1f} MPa in A, B and C.",
                                  1e-6 * keep(row, "case_a_Pa", a.rest_pressure_Pa()),
                                  1e-6 * keep(row, "case_b_Pa", b.rest_pressure_Pa()),
                                  1e-6 * keep(row, "case_c_Pa", c.rest_pressure_Pa()));
    const auto gain_share = [&](double load_Pa) {
        const double supply_Pa = a.loaded.crane.actuator.supply_pressure_Pa;
        return std::sqrt((supply_Pa - load_Pa) / (supply_Pa - printed_load_pressure_at_rest_Pa));
    };
    row.consequence = fmt::format(
        "The flow gain of 6-23 is {:.2f}, {:.2f} and {:.2f} of the printed one in A, B and C. The linear valve keeps "
        "the "
        "printed gain, as the thesis did; the nonlinear valve does not.",
        keep(row, "case_a_gain_share", gain_share(a.rest_pressure_Pa())),
        keep(row, "case_b_gain_share", gain_share(b.rest_pressure_Pa())),
        keep(row, "case_c_gain_share", gain_share(c.rest_pressure_Pa())));
    return row;
}

MisprintRow pendent_work_row(const StandingCrane& a) {
    MisprintRow row{.id = "pendent-work",
                    .where = "6-25, 6-28",
                    .printed = "dW = +F dL_p; 6-28: - on q1, + on q2, + on phi2, - R8 R_d sin(phi_B)/L_p on phi6",
                    .used = "dW = -F dL_p in all four",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    const Coordinates p = coordinates_of(a.rest.state);
    constexpr double difference = 1e-6;
    Coordinates length_slope = Coordinates::Zero();
    for (const Coordinate i : {q1_m, q2_m, phi2_rad, phi6_rad}) {
        const auto length_m = [&](double step) {
            CraneState state = a.rest.state;
            state[i] += step;
            return a.dynamics.outputs(state).pendent_length_m;
        };
        length_slope[i] = (length_m(difference) - length_m(-difference)) / (2.0 * difference);
    }
    const Coordinates force = -a.rest.pendent_tension_N * length_slope;
    // 6-28 keeps the right sign for q1 alone.
    Coordinates printed_force = -force;
    printed_force[q1_m] = force[q1_m];
    const Coordinates without = a.dynamics.generalized_force(p, Coordinates::Zero(), 0.0) - force;
    const Coordinates printed_balance = without + printed_force;
    const double used_N_m = keep(row, "used_phi6_balance_N_m", (without + force)[phi6_rad]);
    const double printed_N_m = keep(row, "printed_phi6_balance_N_m", printed_balance[phi6_rad]);
    row.calculation = fmt::format(
        "A stretched rope's energy is 1/2 K dL^2, so its force on phi6 in case A at rest is -T_P dL_p/dphi6 = {:.4g} N "
        "m, "
        "with which phi6 balances to {:.1g} N m (Fig. 22 agrees); 6-28 leaves {:.4g} N m.",
        keep(row, "pendent_moment_N_m", force[phi6_rad]), std::abs(used_N_m), printed_N_m);
    const Coordinates acceleration = solve_mass_matrix(a.mass, printed_balance);
    row.consequence = fmt::format("The pendents would push: the boom starts to fall at {:.2f} rad/s^2 from its rest.",
                                  keep(row, "printed_phi6_acceleration_rad_s2", acceleration[phi6_rad]));
    return row;
}

MisprintRow power_divisor_row() {
    MisprintRow row{.id = "power-divisor",
                    .where = "6-32",
                    .printed = fmt::format("kW = P_L Q_L / {:.0f}", printed_power_divisor),
                    .used = "W = (P_L - P_L0) K_q X_v in SI",
                    .calculation = {},
                    .consequence = {},
                    .numbers = {}};
    constexpr double psi_Pa = 6894.757;
    constexpr double us_gallon_per_minute_m3_s = 3.785412e-3 / 60.0;
    row.calculation =
        fmt::format("1 psi times 1 US gal/min is {:.4f} W, so the divisor from psi and gal/min to kW is {:.0f}.",
                    psi_Pa * us_gallon_per_minute_m3_s,
                    keep(row, "divisor_for_psi_and_gallons", 1e3 / (psi_Pa * us_gallon_per_minute_m3_s)));
    row.consequence = fmt::format("With Pa and m^3/s, as the chapter has them, 6-32 shows {:.3f} of the kilowatts.",
                                  keep(row, "printed_share", 1e3 / printed_power_divisor));
    return row;
}

}  // namespace

double MisprintRow::number(std::string_view key) const {
    const auto found = std::find_if(numbers.begin(), numbers.end(), [&](const auto& n) { return n.key == key; });
    if (found == numbers.end()) {
        throw std::out_of_range(fmt::format("misprint {} has no number {}", id, key));
    }
    return found->value;
}

const MisprintRow& misprint_row(const std::vector<MisprintRow>& rows, std::string_view id) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const MisprintRow& row) { return row.id == id; });
    if (found == rows.end()) {
        throw std::out_of_range(fmt::format("no misprint {}", id));
    }
    return *found;
}

std::vector<MisprintRow> misprint_rows() {
    const StandingCrane a("case-a");
    const StandingCrane b("case-b");
    const StandingCrane c("case-c");

    // How much Fig. 13's wrong terms are in the thesis's own first run.
    double boom_butt_N = 0.0;
    double tip_N = 0.0;
    (void)simulate({.crane_case = a.loaded, .step_s = {}}, [&](const TruthSample& sample) {
        const Instant now{
            .p = coordinates_of(sample.state), .v = velocities_of(sample.state), .a = Coordinates::Zero()};
        const double used_N = fig13_N(a.dynamics, now, {});
        boom_butt_N = std::max(boom_butt_N, std::abs(fig13_N(a.dynamics, now, printed_boom_butt) - used_N));
        tip_N = std::max(tip_N, std::abs(fig13_N(a.dynamics, now, printed_tip) - used_N));
    });

    return {contact_length_row(a),
            contact_fraction_row(a),
            sink_row(a),
            soil_density_row(a),
            boom_butt_row(a, boom_butt_N),
            tip_coriolis_row(a, tip_N),
            bending_row(a),
            car_body_arm_row(a),
            rocking_damping_row(a),
            pendent_arm_row(a),
            load_weight_row(a),
            ground_stiffness_row(a, b, c),
            rocking_stiffness_row(a, b, c),
            pendent_stiffness_row(a, b, 'B', printed_pendent_stiffness_b_N_m),
            pendent_stiffness_row(a, c, 'C', printed_pendent_stiffness_c_N_m),
            flow_reversal_row(c),
            spool_diameter_row(a),
            flow_pressure_row(a),
            rest_pressure_row(a, b, c),
            oil_volume_row(a),
            pendent_work_row(a),
            power_divisor_row()};
}

}  // namespace steadyboom::hil
