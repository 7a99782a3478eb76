#include "plant/crane_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/mass_matrix_solver.hpp"

namespace steadyboom::plant {

namespace {

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
template <class BoomModel>
struct CraneDynamicsOf<BoomModel>::Kinematics {
    double sin_phi2, cos_phi2;
    Plane e6, n6;                        ///< along the boom chord, perpendicular to it (positive downwards)
    Plane u9, w9;                        ///< along the load line, direction in which phi9 moves the load
    Plane track_arm, car_arm, butt_arm;  ///< dT/dphi2, dC/dphi2, dB0/dphi2, m
    BoomVector a;                        ///< the boom's own coordinates
    double R8, R9;                       ///< m
    BoomVector R8_slope;                 ///< dR8/da
};

template <class BoomModel>
struct CraneDynamicsOf<BoomModel>::Pendent {
    double length_m;      ///< L_p
    double slope_R8;      ///< dL_p/dR8
    double slope_phiB_m;  ///< dL_p/dphi_B
    double tension_N;
};

template <class BoomModel>
CraneDynamicsOf<BoomModel>::CraneDynamicsOf(const CraneParameters& parameters)
    : parameters_(parameters),
      boom_(parameters.structure),
      soil_(parameters.soil),
      actuator_(parameters.actuator, parameters.ropes),
      total_mass_kg_(parameters.structure.track_mass_kg + parameters.structure.car_body_mass_kg + boom_.mass_kg() +
                     parameters.structure.load_mass_kg),
      sin_phi3_(std::sin(parameters.structure.car_body_angle_rad)),
      cos_phi3_(std::cos(parameters.structure.car_body_angle_rad)),
      sin_pendent_anchor_(std::sin(parameters.structure.pendent_anchor_angle_rad + std::numbers::pi / 2.0)),
      cos_pendent_anchor_(std::cos(parameters.structure.pendent_anchor_angle_rad + std::numbers::pi / 2.0)),
      free_pendent_length_m_(0.0) {
    Coordinates unstretched = Coordinates::Zero();
    unstretched[R9_m] = parameters.ropes.load_line_length_m;
    unstretched[Layout::phi6_index] = parameters.structure.boom_angle_rad;
    free_pendent_length_m_ = pendent(kinematics(unstretched), 0.0).length_m;
}

template <class BoomModel>
CraneCalibration CraneDynamicsOf<BoomModel>::calibration() const noexcept {
    return {.load_mass_kg = parameters_.structure.load_mass_kg,
            .free_pendent_length_m = free_pendent_length_m_,
            .pendent_stiffness_N_m = parameters_.ropes.pendent_stiffness_N_m,
            .load_line_length_m = parameters_.ropes.load_line_length_m,
            .load_line_stiffness_N_m = parameters_.ropes.load_line_stiffness_N_m,
            .soil_shear_modulus_Pa = parameters_.soil.shear_modulus_Pa};
}

template <class BoomModel>
void CraneDynamicsOf<BoomModel>::calibrate(const CraneCalibration& calibration) noexcept {
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

template <class BoomModel>
typename CraneDynamicsOf<BoomModel>::Kinematics CraneDynamicsOf<BoomModel>::kinematics(
    const Coordinates& p) const noexcept {
    const StructureParameters& s = parameters_.structure;
    const BoomVector a = p.template segment<Boom::coordinate_count>(Layout::boom_index);
    const double s2 = std::sin(p[phi2_rad]);
    const double c2 = std::cos(p[phi2_rad]);
    const double s6 = std::sin(p[Layout::phi6_index]);
    const double c6 = std::cos(p[Layout::phi6_index]);
    const double s9 = std::sin(p[Layout::phi9_index]);
    const double c9 = std::cos(p[Layout::phi9_index]);
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
            .a = a,
            .R8 = boom_.chord_m(a),
            .R9 = p[R9_m],
            .R8_slope = boom_.chord_slope(a)};
}

template <class BoomModel>
typename CraneDynamicsOf<BoomModel>::Pendent CraneDynamicsOf<BoomModel>::pendent(const Kinematics& k,
                                                                                 double piston_m) const noexcept {
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

template <class BoomModel>
double CraneDynamicsOf<BoomModel>::pendent_rate_m_s(const Kinematics& k, const Pendent& pendent,
                                                    const Coordinates& v) const noexcept {
    return pendent.slope_R8 * k.R8_slope.dot(v.template segment<Boom::coordinate_count>(Layout::boom_index)) +
           pendent.slope_phiB_m * (v[phi2_rad] - v[Layout::phi6_index]);
}

template <class BoomModel>
typename BoomModel::Sums CraneDynamicsOf<BoomModel>::boom_sums(const Kinematics& k) const noexcept {
    return boom_.sums(k.a, k.R8, k.R8_slope);
}

template <class BoomModel>
typename CraneDynamicsOf<BoomModel>::MassMatrix CraneDynamicsOf<BoomModel>::mass_matrix(
    const Kinematics& k, const typename Boom::Sums& boom) const noexcept {
    constexpr int phi6 = Layout::phi6_index;
    constexpr int phi9 = Layout::phi9_index;
    const StructureParameters& s = parameters_.structure;
    const double m_L = s.load_mass_kg;
    const double hung = m_L + boom_.mass_kg();

    // Sums over boom and load of each column: the boom's own and phi6 along the chord and below it.
    const Plane phi6_sum = boom.below_kg_m * k.e6 + (-(boom.along_kg_m + m_L * k.R8)) * k.n6;
    const Plane line = m_L * k.u9;
    const Plane swing = (m_L * k.R9) * k.w9;
    const double e_line = dot(k.e6, line);
    const double n_line = dot(k.n6, line);
    const double e_swing = dot(k.e6, swing);
    const double n_swing = dot(k.n6, swing);

    MassMatrix M;
    M(R1_m, R1_m) = total_mass_kg_;
    M(phi2_rad, R1_m) = s.track_mass_kg * k.track_arm.y + s.car_body_mass_kg * k.car_arm.y + hung * k.butt_arm.y;
    M(R9_m, R1_m) = line.y;
    M(phi6, R1_m) = phi6_sum.y;
    M(phi9, R1_m) = swing.y;

    M(phi2_rad, phi2_rad) = s.track_inertia_kg_m2 + s.car_body_inertia_kg_m2 +
                            s.track_mass_kg * dot(k.track_arm, k.track_arm) +
                            s.car_body_mass_kg * dot(k.car_arm, k.car_arm) + hung * dot(k.butt_arm, k.butt_arm);
    M(R9_m, phi2_rad) = dot(k.butt_arm, line);
    M(phi6, phi2_rad) = dot(k.butt_arm, phi6_sum);
    M(phi9, phi2_rad) = dot(k.butt_arm, swing);

    M(R9_m, R9_m) = m_L;
    M(phi6, R9_m) = -k.R8 * n_line;
    M(phi9, R9_m) = 0.0;

#pragma GCC unroll 3
    for (int i = 0; i < Boom::coordinate_count; ++i) {
        const int row = Layout::boom_index + i;
        const Plane sum = (boom.along_slope_kg[i] + m_L * k.R8_slope[i]) * k.e6 + boom.below_slope_kg[i] * k.n6;
        M(row, R1_m) = sum.y;
        M(row, phi2_rad) = dot(k.butt_arm, sum);
        M(row, R9_m) = k.R8_slope[i] * e_line;
#pragma GCC unroll 3
        for (int j = 0; j <= i; ++j) {
            M(row, Layout::boom_index + j) = boom.flexible_flexible_kg(i, j) + m_L * k.R8_slope[i] * k.R8_slope[j];
        }
        M(phi6, row) = boom.flexible_turn_kg_m[i];
        M(phi9, row) = k.R8_slope[i] * e_swing;
    }

    M(phi6, phi6) = boom.turn_turn_kg_m2 + m_L * k.R8 * k.R8;
    M(phi9, phi6) = -k.R8 * n_swing;

    M(phi9, phi9) = m_L * k.R9 * k.R9;
    return M;
}

template <class BoomModel>
typename CraneDynamicsOf<BoomModel>::Coordinates CraneDynamicsOf<BoomModel>::force(
    const Kinematics& k, const typename Boom::Sums& boom, const Pendent& pendent, const Coordinates& p,
    const Coordinates& v) const noexcept {
    const StructureParameters& s = parameters_.structure;
    const double m_L = s.load_mass_kg;
    const double w2 = v[phi2_rad];
    const double w6 = v[Layout::phi6_index];
    const double w9 = v[Layout::phi9_index];
    const BoomVector a_rate = v.template segment<Boom::coordinate_count>(Layout::boom_index);
    const typename Boom::BiasSums bias = boom_.bias_sums(k.a, a_rate, k.R8, k.R8_slope);

    // J' p' of each body plus gravity; a body turning about the track centre accelerates by its arm turned a quarter.
    const Plane up{0.0, gravity_m_s2};
    const auto turning = [w2](Plane arm) { return Plane{-w2 * w2 * arm.y, w2 * w2 * arm.x}; };
    const Plane track = turning(k.track_arm) + up;
    const Plane car = turning(k.car_arm) + up;
    const Plane butt = turning(k.butt_arm) + up;

    // Boom relative to the butt, summed: along the chord x'' - x w6^2 + 2 w' w6, below it -2 x' w6 - w w6^2.
    const double w6w6 = w6 * w6;
    const Plane boom_bias =
        (bias.along_N + 2.0 * w6 * boom.below_slope_kg.dot(a_rate) - w6w6 * boom.along_kg_m) * k.e6 +
        (-2.0 * w6 * boom.along_slope_kg.dot(a_rate) - w6w6 * boom.below_kg_m) * k.n6;
    const double phi6_bias = bias.turn_along_N_m + 2.0 * w6 * bias.centrifugal_kg_m.dot(a_rate);

    const double stretch = boom_.chord_bias_m_s2(a_rate) - k.R8 * w6w6;
    const double turn = -2.0 * k.R8_slope.dot(a_rate) * w6;
    const Plane load = butt + stretch * k.e6 + turn * k.n6 + (2.0 * v[R9_m] * w9) * k.w9 + (-k.R9 * w9 * w9) * k.u9;
    const double load_e = m_L * dot(load, k.e6);
    const double load_n = m_L * dot(load, k.n6);
    const double butt_e = dot(butt, k.e6);
    const double butt_n = dot(butt, k.n6);

    const SoilReaction soil = soil_.reaction(p[R1_m], p[phi2_rad], k.sin_phi2, v[R1_m], w2);
    const double line_tension_N =
        pull_only_N(parameters_.ropes.load_line_stiffness_N_m * (k.R9 - parameters_.ropes.load_line_length_m));
    const double pull_R8 = pendent.tension_N * pendent.slope_R8;
    const double pull_phiB = pendent.tension_N * pendent.slope_phiB_m;
    const Plane hung = m_L * load + boom_.mass_kg() * butt + boom_bias;

    Coordinates Q;
    Q[R1_m] = soil.vertical_N - s.track_mass_kg * track.y - s.car_body_mass_kg * car.y - hung.y;
    Q[phi2_rad] = soil.rocking_N_m - pull_phiB - s.track_mass_kg * dot(track, k.track_arm) -
                  s.car_body_mass_kg * dot(car, k.car_arm) - dot(hung, k.butt_arm);
    Q[R9_m] = -line_tension_N - m_L * dot(load, k.u9);
    Q.template segment<Boom::coordinate_count>(Layout::boom_index) =
        boom_.bending_force_N(k.a) + boom_.damping_force_N(a_rate) - (pull_R8 + load_e) * k.R8_slope -
        butt_e * boom.along_slope_kg - butt_n * boom.below_slope_kg - bias.flexible_along_N -
        2.0 * w6 * bias.coriolis_kg_m_s + w6w6 * bias.centrifugal_kg_m;
    Q[Layout::phi6_index] = pull_phiB + k.R8 * load_n + boom.along_kg_m * butt_n - boom.below_kg_m * butt_e - phi6_bias;
    Q[Layout::phi9_index] = -m_L * k.R9 * dot(load, k.w9);
    return Q;
}

template <class BoomModel>
typename CraneDynamicsOf<BoomModel>::State CraneDynamicsOf<BoomModel>::derivative(
    const State& state, double valve_opening_m) const noexcept {
    const Coordinates p = coordinates_of(state);
    const Coordinates v = velocities_of(state);
    const double piston = actuator_.clamp_piston_m(state[Layout::piston_index]);
    const Kinematics k = kinematics(p);
    const typename Boom::Sums boom = boom_sums(k);
    const Pendent line = pendent(k, piston);
    State rate;
    coordinates_of(rate) = v;
    velocities_of(rate) = solve_mass_matrix(mass_matrix(k, boom), force(k, boom, line, p, v));
    rate[Layout::piston_index] = actuator_.piston_rate_m_s(valve_opening_m, line.tension_N,
                                                           pendent_rate_m_s(k, line, v), state[Layout::piston_index]);
    return rate;
}

template <class BoomModel>
typename CraneDynamicsOf<BoomModel>::MassMatrix CraneDynamicsOf<BoomModel>::mass_matrix(
    const Coordinates& coordinates) const noexcept {
    const Kinematics k = kinematics(coordinates);
    MassMatrix M = mass_matrix(k, boom_sums(k));
    M.template triangularView<Eigen::StrictlyUpper>() = M.transpose();
    return M;
}

template <class BoomModel>
typename CraneDynamicsOf<BoomModel>::Coordinates CraneDynamicsOf<BoomModel>::generalized_force(
    const Coordinates& coordinates, const Coordinates& velocities, double piston_m) const noexcept {
    const Kinematics k = kinematics(coordinates);
    return force(k, boom_sums(k), pendent(k, piston_m), coordinates, velocities);
}

template <class BoomModel>
CraneOutputs CraneDynamicsOf<BoomModel>::outputs(const State& state) const noexcept {
    const Kinematics k = kinematics(coordinates_of(state));
    const Pendent line = pendent(k, actuator_.clamp_piston_m(state[Layout::piston_index]));
    return {.pendent_tension_N = line.tension_N,
            .load_line_tension_N =
                pull_only_N(parameters_.ropes.load_line_stiffness_N_m * (k.R9 - parameters_.ropes.load_line_length_m)),
            .pendent_length_m = line.length_m,
            .pendent_rate_m_s = pendent_rate_m_s(k, line, velocities_of(state)),
            .chord_m = k.R8,
            .contact_fraction = soil_.contact_fraction(state[R1_m], state[phi2_rad], k.sin_phi2),
            .load_pressure_Pa = actuator_.load_pressure_Pa(line.tension_N)};
}

template <class BoomModel>
CranePoints CraneDynamicsOf<BoomModel>::points(const Coordinates& coordinates) const noexcept {
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
    const std::array<BoomPoint, 2> thirds = boom_.thirds(k.a);
    const Plane lower = butt + thirds[0].along_m * k.e6 + thirds[0].below_m * k.n6;
    const Plane upper = butt + thirds[1].along_m * k.e6 + thirds[1].below_m * k.n6;
    const typename Boom::Sums boom = boom_sums(k);
    const double inverse_mass_1_kg = 1.0 / boom_.mass_kg();
    const Plane centre =
        butt + (boom.along_kg_m * inverse_mass_1_kg) * k.e6 + (boom.below_kg_m * inverse_mass_1_kg) * k.n6;
    const Plane tip = butt + k.R8 * k.e6;
    return {.track_centre = at(origin + s.track_centre_height_m * up2),
            .car_body_centre = at(axis + (-s.car_body_setback_m) * setback),
            .boom_butt = at(butt),
            .lower_joint = at(lower),
            .upper_joint = at(upper),
            .boom_tip = at(tip),
            .load = at(tip + k.R9 * k.u9),
            .boom_centre = at(centre)};
}

template <class BoomModel>
CraneState CraneDynamicsOf<BoomModel>::thesis_state(const State& state) const noexcept {
    constexpr int boom = Layout::boom_index;
    constexpr int rates = Layout::velocity_offset;
    CraneState thesis;
    thesis.head<boom>() = state.template head<boom>();
    thesis.segment<2>(q1_m) = boom_.thirds_deflection(state.template segment<Boom::coordinate_count>(boom));
    thesis[phi6_rad] = state[Layout::phi6_index];
    thesis[phi9_rad] = state[Layout::phi9_index];
    thesis.segment<boom>(velocity_offset) = state.template segment<boom>(rates);
    thesis.segment<2>(velocity_offset + q1_m) =
        boom_.thirds_deflection(state.template segment<Boom::coordinate_count>(rates + boom));
    thesis[velocity_offset + phi6_rad] = state[rates + Layout::phi6_index];
    thesis[velocity_offset + phi9_rad] = state[rates + Layout::phi9_index];
    thesis[piston_index] = state[Layout::piston_index];
    return thesis;
}

template class CraneDynamicsOf<LinkBoom>;
template class CraneDynamicsOf<BeamBoom>;

}  // namespace steadyboom::plant
