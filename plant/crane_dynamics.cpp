#include "plant/crane_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace steadyboom::plant {

namespace {

// Sums over the three links of chord shares c = (1/6, 1/2, 5/6) and joint shares d1 = (1/2, 1/2, 0), d2 = (0, 1/2,
// 1/2): a link's centre lies at c R8 along the chord and d1 q1 + d2 q2 below it.
constexpr double links = 3.0;
constexpr double sum_c = 3.0 / 2.0;
constexpr double sum_cc = 35.0 / 36.0;
constexpr double sum_c_d1 = 1.0 / 3.0;
constexpr double sum_c_d2 = 2.0 / 3.0;
constexpr double sum_dd_same = 1.0 / 2.0;
constexpr double sum_dd_cross = 1.0 / 4.0;

struct Plane {
    double x, y;
};
constexpr double dot(Plane a, Plane b) noexcept {
    return a.x * b.x + a.y * b.y;
}
constexpr Plane operator+(Plane a, Plane b) noexcept {
    return {a.x + b.x, a.y + b.y};
}
constexpr Plane operator*(double s, Plane a) noexcept {
    return {s * a.x, s * a.y};
}

/// A rope's tension; std::max(0.0, NaN) would be 0 and hide a broken state, this order keeps it.
constexpr double pull_only_N(double force_N) noexcept {
    return std::max(force_N, 0.0);
}

}  // namespace

/// Directions, lever arms and chord derivatives of one configuration; the columns of the Jacobians are built from them.
struct CraneDynamics::Kinematics {
    double sin_phi2, cos_phi2;
    Plane e6, n6;                        ///< along the boom chord, perpendicular to it (positive downwards)
    Plane u9, w9;                        ///< along the load line, direction in which phi9 moves the load
    Plane track_arm, car_arm, butt_arm;  ///< dT/dphi2, dC/dphi2, dB0/dphi2, m
    double q1, q2, R8, R9;               ///< m
    double R8_1, R8_2;                   ///< dR8/dq1, dR8/dq2
};

struct CraneDynamics::Pendent {
    double length_m;      ///< L_p
    double slope_R8;      ///< dL_p/dR8
    double slope_phiB_m;  ///< dL_p/dphi_B
    double tension_N;
};

CraneDynamics::CraneDynamics(const CraneParameters& parameters)
    : parameters_(parameters),
      boom_(parameters.structure),
      soil_(parameters.soil),
      actuator_(parameters.actuator, parameters.ropes),
      total_mass_kg_(parameters.structure.track_mass_kg + parameters.structure.car_body_mass_kg +
                     links * parameters.structure.boom_link_mass_kg + parameters.structure.load_mass_kg),
      sin_phi3_(std::sin(parameters.structure.car_body_angle_rad)),
      cos_phi3_(std::cos(parameters.structure.car_body_angle_rad)),
      sin_pendent_anchor_(std::sin(parameters.structure.pendent_anchor_angle_rad + std::numbers::pi / 2.0)),
      cos_pendent_anchor_(std::cos(parameters.structure.pendent_anchor_angle_rad + std::numbers::pi / 2.0)),
      free_pendent_length_m_(0.0) {
    Coordinates unstretched = Coordinates::Zero();
    unstretched[R9_m] = parameters.ropes.load_line_length_m;
    unstretched[phi6_rad] = parameters.structure.boom_angle_rad;
    free_pendent_length_m_ = pendent(kinematics(unstretched), 0.0).length_m;
}

CraneCalibration CraneDynamics::calibration() const noexcept {
    return {.load_mass_kg = parameters_.structure.load_mass_kg,
            .free_pendent_length_m = free_pendent_length_m_,
            .pendent_stiffness_N_m = parameters_.ropes.pendent_stiffness_N_m,
            .load_line_length_m = parameters_.ropes.load_line_length_m,
            .load_line_stiffness_N_m = parameters_.ropes.load_line_stiffness_N_m,
            .soil_shear_modulus_Pa = parameters_.soil.shear_modulus_Pa};
}

void CraneDynamics::calibrate(const CraneCalibration& calibration) noexcept {
    total_mass_kg_ += calibration.load_mass_kg - parameters_.structure.load_mass_kg;
    parameters_.structure.load_mass_kg = calibration.load_mass_kg;
    free_pendent_length_m_ = calibration.free_pendent_length_m;
    parameters_.ropes = {.load_line_length_m = calibration.load_line_length_m,
                         .load_line_stiffness_N_m = calibration.load_line_stiffness_N_m,
                         .pendent_stiffness_N_m = calibration.pendent_stiffness_N_m};
    parameters_.soil.shear_modulus_Pa = calibration.soil_shear_modulus_Pa;
    soil_ = Soil(parameters_.soil);
    actuator_ = Actuator(parameters_.actuator, parameters_.ropes);
}

CraneDynamics::Kinematics CraneDynamics::kinematics(const Coordinates& p) const noexcept {
    const StructureParameters& s = parameters_.structure;
    const double s2 = std::sin(p[phi2_rad]);
    const double c2 = std::cos(p[phi2_rad]);
    const double s6 = std::sin(p[phi6_rad]);
    const double c6 = std::cos(p[phi6_rad]);
    const double s9 = std::sin(p[phi9_rad]);
    const double c9 = std::cos(p[phi9_rad]);
    const double s23 = s2 * cos_phi3_ - c2 * sin_phi3_;
    const double c23 = c2 * cos_phi3_ + s2 * sin_phi3_;
    const double R3 = s.car_body_height_m;
    return {.sin_phi2 = s2,
            .cos_phi2 = c2,
            .e6 = {c6, s6},
            .n6 = {s6, -c6},
            .u9 = {s9, -c9},
            .w9 = {c9, s9},
            .track_arm = {-s.track_centre_height_m * c2, -s.track_centre_height_m * s2},
            .car_arm = {-R3 * c2 + s.car_body_setback_m * s23, -R3 * s2 - s.car_body_setback_m * c23},
            .butt_arm = {-R3 * c2 - s.boom_butt_offset_m * s2, -R3 * s2 + s.boom_butt_offset_m * c2},
            .q1 = p[q1_m],
            .q2 = p[q2_m],
            .R8 = boom_.chord_m(p[q1_m], p[q2_m]),
            .R9 = p[R9_m],
            .R8_1 = boom_.chord_slope(p[q1_m], p[q2_m]),
            .R8_2 = boom_.chord_slope(p[q2_m], p[q1_m])};
}

CraneDynamics::Pendent CraneDynamics::pendent(const Kinematics& k, double piston_m) const noexcept {
    // phi_B = phi_A + pi/2 - (phi6 - phi2); L_p closes the triangle butt, tip, anchor.
    const double R_d = parameters_.structure.pendent_anchor_radius_m;
    const double sin_62 = k.e6.y * k.cos_phi2 - k.e6.x * k.sin_phi2;
    const double cos_62 = k.e6.x * k.cos_phi2 + k.e6.y * k.sin_phi2;
    const double sin_B = sin_pendent_anchor_ * cos_62 - cos_pendent_anchor_ * sin_62;
    const double cos_B = cos_pendent_anchor_ * cos_62 + sin_pendent_anchor_ * sin_62;
    const double length_m = std::sqrt(k.R8 * k.R8 + R_d * R_d - 2.0 * k.R8 * R_d * cos_B);
    const double inverse_length_1_m = 1.0 / length_m;
    return {.length_m = length_m,
            .slope_R8 = (k.R8 - R_d * cos_B) * inverse_length_1_m,
            .slope_phiB_m = k.R8 * R_d * sin_B * inverse_length_1_m,
            .tension_N =
                pull_only_N(parameters_.ropes.pendent_stiffness_N_m * (length_m - free_pendent_length_m_ + piston_m))};
}

double CraneDynamics::pendent_rate_m_s(const Kinematics& k, const Pendent& pendent,
                                       const Coordinates& v) const noexcept {
    return pendent.slope_R8 * (k.R8_1 * v[q1_m] + k.R8_2 * v[q2_m]) +
           pendent.slope_phiB_m * (v[phi2_rad] - v[phi6_rad]);
}

MassMatrix CraneDynamics::mass_matrix(const Kinematics& k) const noexcept {
    const StructureParameters& s = parameters_.structure;
    const double m_B = s.boom_link_mass_kg;
    const double m_L = s.load_mass_kg;
    const double hung = m_L + links * m_B;
    const double sum_c_b = sum_c_d1 * k.q1 + sum_c_d2 * k.q2;

    // Sums over the links and the load of each column, along the chord and below it.
    const double along_1 = (sum_c * m_B + m_L) * k.R8_1;
    const double along_2 = (sum_c * m_B + m_L) * k.R8_2;
    const Plane q1_sum = along_1 * k.e6 + m_B * k.n6;
    const Plane q2_sum = along_2 * k.e6 + m_B * k.n6;
    const Plane phi6_sum = (m_B * (k.q1 + k.q2)) * k.e6 + (-(sum_c * m_B + m_L) * k.R8) * k.n6;
    const Plane line = m_L * k.u9;
    const Plane swing = (m_L * k.R9) * k.w9;
    const double along_along = sum_cc * m_B + m_L;
    const double e_line = dot(k.e6, line);
    const double n_line = dot(k.n6, line);
    const double e_swing = dot(k.e6, swing);
    const double n_swing = dot(k.n6, swing);

    MassMatrix M;
    M(R1_m, R1_m) = total_mass_kg_;
    M(phi2_rad, R1_m) = s.track_mass_kg * k.track_arm.y + s.car_body_mass_kg * k.car_arm.y + hung * k.butt_arm.y;
    M(R9_m, R1_m) = line.y;
    M(q1_m, R1_m) = q1_sum.y;
    M(q2_m, R1_m) = q2_sum.y;
    M(phi6_rad, R1_m) = phi6_sum.y;
    M(phi9_rad, R1_m) = swing.y;

    M(phi2_rad, phi2_rad) = s.track_inertia_kg_m2 + s.car_body_inertia_kg_m2 +
                            s.track_mass_kg * dot(k.track_arm, k.track_arm) +
                            s.car_body_mass_kg * dot(k.car_arm, k.car_arm) + hung * dot(k.butt_arm, k.butt_arm);
    M(R9_m, phi2_rad) = dot(k.butt_arm, line);
    M(q1_m, phi2_rad) = dot(k.butt_arm, q1_sum);
    M(q2_m, phi2_rad) = dot(k.butt_arm, q2_sum);
    M(phi6_rad, phi2_rad) = dot(k.butt_arm, phi6_sum);
    M(phi9_rad, phi2_rad) = dot(k.butt_arm, swing);

    M(R9_m, R9_m) = m_L;
    M(q1_m, R9_m) = k.R8_1 * e_line;
    M(q2_m, R9_m) = k.R8_2 * e_line;
    M(phi6_rad, R9_m) = -k.R8 * n_line;
    M(phi9_rad, R9_m) = 0.0;

    M(q1_m, q1_m) = along_along * k.R8_1 * k.R8_1 + sum_dd_same * m_B;
    M(q2_m, q1_m) = along_along * k.R8_1 * k.R8_2 + sum_dd_cross * m_B;
    M(phi6_rad, q1_m) = m_B * (k.R8_1 * sum_c_b - sum_c_d1 * k.R8);
    M(phi9_rad, q1_m) = k.R8_1 * e_swing;

    M(q2_m, q2_m) = along_along * k.R8_2 * k.R8_2 + sum_dd_same * m_B;
    M(phi6_rad, q2_m) = m_B * (k.R8_2 * sum_c_b - sum_c_d2 * k.R8);
    M(phi9_rad, q2_m) = k.R8_2 * e_swing;

    M(phi6_rad, phi6_rad) = along_along * k.R8 * k.R8 + sum_dd_same * m_B * (k.q1 * k.q1 + k.q2 * k.q2 + k.q1 * k.q2);
    M(phi9_rad, phi6_rad) = -k.R8 * n_swing;

    M(phi9_rad, phi9_rad) = m_L * k.R9 * k.R9;
    return M;
}

Coordinates CraneDynamics::force(const Kinematics& k, const Pendent& pendent, const Coordinates& p,
                                 const Coordinates& v) const noexcept {
    const StructureParameters& s = parameters_.structure;
    const double m_B = s.boom_link_mass_kg;
    const double m_L = s.load_mass_kg;
    const double w2 = v[phi2_rad];
    const double w6 = v[phi6_rad];
    const double w9 = v[phi9_rad];
    const double v1 = v[q1_m];
    const double v2 = v[q2_m];
    const double R8_rate = k.R8_1 * v1 + k.R8_2 * v2;
    const double R8_bias = boom_.chord_bias_m_s2(v1, v2);

    // J' p' of each body plus gravity; a body turning about the track centre accelerates by its arm turned a quarter.
    const Plane up{0.0, gravity_m_s2};
    const auto turning = [w2](Plane arm) { return Plane{-w2 * w2 * arm.y, w2 * w2 * arm.x}; };
    const Plane track = turning(k.track_arm) + up;
    const Plane car = turning(k.car_arm) + up;
    const Plane butt = turning(k.butt_arm) + up;

    // Links relative to the butt, summed: along the chord c (R8'' - R8 w6^2) + 2 b' w6, below it -2 c R8' w6 - b w6^2.
    const double stretch = R8_bias - k.R8 * w6 * w6;
    const double turn = -2.0 * R8_rate * w6;
    const double w6w6 = w6 * w6;
    const double sum_c_b_rate = sum_c_d1 * v1 + sum_c_d2 * v2;
    const Plane links_bias =
        (sum_c * stretch + 2.0 * w6 * (v1 + v2)) * k.e6 + (sum_c * turn - (k.q1 + k.q2) * w6w6) * k.n6;
    const double along_bias = sum_cc * stretch + 2.0 * w6 * sum_c_b_rate;
    const double below_1_bias = sum_c_d1 * turn - w6w6 * (sum_dd_same * k.q1 + sum_dd_cross * k.q2);
    const double below_2_bias = sum_c_d2 * turn - w6w6 * (sum_dd_cross * k.q1 + sum_dd_same * k.q2);
    const double phi6_bias =
        (sum_c_d1 * k.q1 + sum_c_d2 * k.q2) * R8_bias +
        2.0 * w6 *
            (sum_dd_same * (k.q1 * v1 + k.q2 * v2) + sum_dd_cross * (k.q1 * v2 + k.q2 * v1) + sum_cc * k.R8 * R8_rate);

    const Plane load = butt + stretch * k.e6 + turn * k.n6 + (2.0 * v[R9_m] * w9) * k.w9 + (-k.R9 * w9 * w9) * k.u9;
    const double load_e = m_L * dot(load, k.e6);
    const double load_n = m_L * dot(load, k.n6);
    const double butt_e = m_B * dot(butt, k.e6);
    const double butt_n = m_B * dot(butt, k.n6);

    const SoilReaction soil = soil_.reaction(p[R1_m], p[phi2_rad], k.sin_phi2, v[R1_m], w2);
    const double line_tension_N =
        pull_only_N(parameters_.ropes.load_line_stiffness_N_m * (k.R9 - parameters_.ropes.load_line_length_m));
    const double pull_R8 = pendent.tension_N * pendent.slope_R8;
    const double pull_phiB = pendent.tension_N * pendent.slope_phiB_m;
    const Plane hung = m_L * load + m_B * (links * butt + links_bias);

    Coordinates Q;
    Q[R1_m] = soil.vertical_N - s.track_mass_kg * track.y - s.car_body_mass_kg * car.y - hung.y;
    Q[phi2_rad] = soil.rocking_N_m - pull_phiB - s.track_mass_kg * dot(track, k.track_arm) -
                  s.car_body_mass_kg * dot(car, k.car_arm) - dot(hung, k.butt_arm);
    Q[R9_m] = -line_tension_N - m_L * dot(load, k.u9);
    Q[q1_m] = boom_.bending_force_N(k.q1, k.q2) + boom_.damping_force_N(v1, v2) -
              k.R8_1 * (pull_R8 + load_e + sum_c * butt_e + m_B * along_bias) - butt_n - m_B * below_1_bias;
    Q[q2_m] = boom_.bending_force_N(k.q2, k.q1) + boom_.damping_force_N(v2, v1) -
              k.R8_2 * (pull_R8 + load_e + sum_c * butt_e + m_B * along_bias) - butt_n - m_B * below_2_bias;
    Q[phi6_rad] = pull_phiB + k.R8 * (load_n + sum_c * butt_n) - (k.q1 + k.q2) * butt_e - m_B * phi6_bias;
    Q[phi9_rad] = -m_L * k.R9 * dot(load, k.w9);
    return Q;
}

CraneState CraneDynamics::derivative(const CraneState& state, double valve_opening_m) const noexcept {
    const Coordinates p = coordinates_of(state);
    const Coordinates v = velocities_of(state);
    const double piston = actuator_.clamp_piston_m(state[piston_index]);
    const Kinematics k = kinematics(p);
    const Pendent line = pendent(k, piston);
    CraneState rate;
    coordinates_of(rate) = v;
    velocities_of(rate) = solve_mass_matrix(mass_matrix(k), force(k, line, p, v));
    rate[piston_index] =
        actuator_.piston_rate_m_s(valve_opening_m, line.tension_N, pendent_rate_m_s(k, line, v), state[piston_index]);
    return rate;
}

MassMatrix CraneDynamics::mass_matrix(const Coordinates& coordinates) const noexcept {
    MassMatrix M = mass_matrix(kinematics(coordinates));
    M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
    return M;
}

Coordinates CraneDynamics::generalized_force(const Coordinates& coordinates, const Coordinates& velocities,
                                             double piston_m) const noexcept {
    const Kinematics k = kinematics(coordinates);
    return force(k, pendent(k, piston_m), coordinates, velocities);
}

CraneOutputs CraneDynamics::outputs(const CraneState& state) const noexcept {
    const Kinematics k = kinematics(coordinates_of(state));
    const Pendent line = pendent(k, actuator_.clamp_piston_m(state[piston_index]));
    return {.pendent_tension_N = line.tension_N,
            .load_line_tension_N =
                pull_only_N(parameters_.ropes.load_line_stiffness_N_m * (k.R9 - parameters_.ropes.load_line_length_m)),
            .pendent_length_m = line.length_m,
            .pendent_rate_m_s = pendent_rate_m_s(k, line, velocities_of(state)),
            .chord_m = k.R8,
            .contact_fraction = soil_.contact_fraction(state[R1_m], state[phi2_rad], k.sin_phi2),
            .load_pressure_Pa = actuator_.load_pressure_Pa(line.tension_N)};
}

CranePoints CraneDynamics::points(const Coordinates& coordinates) const noexcept {
    const StructureParameters& s = parameters_.structure;
    const Kinematics k = kinematics(coordinates);
    const double height_m = coordinates[R1_m];
    const auto at = [](Plane a) { return Eigen::Vector2d(a.x, a.y); };
    const Plane up2{-k.sin_phi2, k.cos_phi2};
    const Plane ahead2{k.cos_phi2, k.sin_phi2};
    const Plane setback{k.cos_phi2 * cos_phi3_ + k.sin_phi2 * sin_phi3_,
                        k.sin_phi2 * cos_phi3_ - k.cos_phi2 * sin_phi3_};
    const Plane origin{0.0, height_m};
    const Plane axis = origin + s.car_body_height_m * up2;
    const Plane butt = axis + s.boom_butt_offset_m * ahead2;
    const Plane lower = butt + (k.R8 / 3.0) * k.e6 + k.q1 * k.n6;
    const Plane upper = butt + (2.0 * k.R8 / 3.0) * k.e6 + k.q2 * k.n6;
    const Plane tip = butt + k.R8 * k.e6;
    return {.track_centre = at(origin + s.track_centre_height_m * up2),
            .car_body_centre = at(axis + (-s.car_body_setback_m) * setback),
            .boom_butt = at(butt),
            .lower_joint = at(lower),
            .upper_joint = at(upper),
            .boom_tip = at(tip),
            .load = at(tip + k.R9 * k.u9),
            .link_centres = {at(0.5 * (butt + lower)), at(0.5 * (lower + upper)), at(0.5 * (upper + tip))}};
}

}  // namespace steadyboom::plant
