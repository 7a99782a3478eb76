#include "second_derivation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include <Eigen/LU>

#include "plant/crane_state.hpp"

namespace steadyboom::plant {

namespace {

using Real = SecondDerivation::Real;
constexpr Real pi = std::numbers::pi_v<Real>;
constexpr std::complex<Real> i_unit{0.0L, 1.0L};

/// d f(s) / ds at s = 0, sixth order.
template <class F>
std::invoke_result_t<F, Real> slope(const F& f, Real h) {
    return (45.0L * (f(h) - f(-h)) - 9.0L * (f(2 * h) - f(-2 * h)) + (f(3 * h) - f(-3 * h))) / (60.0L * h);
}

// Kinematic functions turn over on the scale of a radian; the forces' kinks lie a millimetre of rope away or more.
constexpr Real wide = 1e-3L;
constexpr Real narrow = 1e-5L;

std::complex<Real> toward(Real angle) {
    return std::exp(i_unit * angle);
}

}  // namespace

SecondDerivation::SecondDerivation(const CraneParameters& crane) : crane_(crane), free_pendent_length_(0.0L) {
    Vector straight = Vector::Zero();
    straight[R9_m] = crane.ropes.load_line_length_m;
    straight[phi6_rad] = crane.structure.boom_angle_rad;
    free_pendent_length_ = pendent_length(straight);
}

SecondDerivation::Points SecondDerivation::points(const Vector& p) const {
    const StructureParameters& s = crane_.structure;
    // A link of length L_B whose ends differ by d across the chord covers about L_B - d^2 / (2 L_B) of it.
    const Real link_length = s.boom_length_m / 3.0L;
    const Real d1 = p[q1_m];
    const Real d2 = p[q2_m] - p[q1_m];
    const Real d3 = -p[q2_m];
    const Real chord = 3.0L * link_length - (d1 * d1 + d2 * d2 + d3 * d3) / (2.0L * link_length);
    const std::complex<Real> along = toward(p[phi6_rad]);
    const std::complex<Real> below = -i_unit * along;
    const std::complex<Real> body = toward(p[phi2_rad]);
    const std::complex<Real> ground = i_unit * p[R1_m];

    Points z;
    z.track = ground + i_unit * body * static_cast<Real>(s.track_centre_height_m);
    const std::complex<Real> axis = ground + i_unit * body * static_cast<Real>(s.car_body_height_m);
    z.car_body = axis + toward(p[phi2_rad] - s.car_body_angle_rad + pi) * static_cast<Real>(s.car_body_setback_m);
    z.butt = axis + body * static_cast<Real>(s.boom_butt_offset_m);
    z.anchor =
        z.butt + i_unit * body * toward(s.pendent_anchor_angle_rad) * static_cast<Real>(s.pendent_anchor_radius_m);
    z.lower = z.butt + along * (chord / 3.0L) + below * p[q1_m];
    z.upper = z.butt + along * (chord * 2.0L / 3.0L) + below * p[q2_m];
    z.tip = z.butt + along * chord;
    z.load = z.tip - i_unit * toward(p[phi9_rad]) * p[R9_m];
    z.links = {(z.butt + z.lower) / 2.0L, (z.lower + z.upper) / 2.0L, (z.upper + z.tip) / 2.0L};
    return z;
}

Real SecondDerivation::kinetic_energy(const Vector& p, const Vector& v) const {
    const StructureParameters& s = crane_.structure;
    using Six = Eigen::Matrix<std::complex<Real>, 6, 1>;
    const auto stacked = [&](Real time) {
        const Points z = points(p + time * v);
        return Six{{z.track, z.car_body, z.links[0], z.links[1], z.links[2], z.load}};
    };
    const Six velocity = slope([&](Real time) -> Six { return stacked(time); }, wide);
    const std::array<Real, 6> mass = {s.track_mass_kg,     s.car_body_mass_kg,  s.boom_link_mass_kg,
                                      s.boom_link_mass_kg, s.boom_link_mass_kg, s.load_mass_kg};
    Real twice = (static_cast<Real>(s.track_inertia_kg_m2) + s.car_body_inertia_kg_m2) * v[phi2_rad] * v[phi2_rad];
    for (int body = 0; body < 6; ++body) {
        twice += mass[static_cast<std::size_t>(body)] * std::norm(velocity[body]);
    }
    return twice / 2.0L;
}

Real SecondDerivation::pendent_length(const Vector& p) const {
    const Points z = points(p);
    return std::abs(z.tip - z.anchor);
}

Real SecondDerivation::pendent_rate(const Vector& p, const Vector& v) const {
    return slope([&](Real time) { return pendent_length(p + time * v); }, wide);
}

Real SecondDerivation::pendent_tension(const Vector& p, Real piston) const {
    const Real stretch = pendent_length(p) - free_pendent_length_ + piston;
    return stretch > 0.0L ? crane_.ropes.pendent_stiffness_N_m * stretch : 0.0L;
}

Real SecondDerivation::load_line_tension(const Vector& p) const {
    const Real stretch = p[R9_m] - crane_.ropes.load_line_length_m;
    return stretch > 0.0L ? crane_.ropes.load_line_stiffness_N_m * stretch : 0.0L;
}

Real SecondDerivation::potential_energy(const Vector& p, Real piston) const {
    const StructureParameters& s = crane_.structure;
    const Points z = points(p);
    const Real moment = s.track_mass_kg * z.track.imag() + s.car_body_mass_kg * z.car_body.imag() +
                        s.boom_link_mass_kg * (z.links[0].imag() + z.links[1].imag() + z.links[2].imag()) +
                        s.load_mass_kg * z.load.imag();
    // Two joints whose kinks are the second differences of (0, q1, q2, 0), as a beam's moment diagram weighs them.
    const Real link_length = s.boom_length_m / 3.0L;
    const Real q1 = p[q1_m];
    const Real q2 = p[q2_m];
    const Real bending =
        1.5L * s.boom_joint_stiffness_N_m / (link_length * link_length) * (q1 * q1 + (q2 - q1) * (q2 - q1) + q2 * q2);
    const Real pendent = pendent_tension(p, piston);
    const Real line = load_line_tension(p);
    return static_cast<Real>(gravity_m_s2) * moment + bending +
           pendent * pendent / (2.0L * crane_.ropes.pendent_stiffness_N_m) +
           line * line / (2.0L * crane_.ropes.load_line_stiffness_N_m);
}

SecondDerivation::Matrix SecondDerivation::mass_matrix(const Vector& p) const {
    Matrix M;
    std::array<Real, 7> alone{};
    for (int i = 0; i < 7; ++i) {
        alone[static_cast<std::size_t>(i)] = kinetic_energy(p, Vector::Unit(i));
        M(i, i) = 2.0L * alone[static_cast<std::size_t>(i)];
    }
    for (int i = 0; i < 7; ++i) {
        for (int j = 0; j < i; ++j) {
            M(i, j) = kinetic_energy(p, Vector::Unit(i) + Vector::Unit(j)) - alone[static_cast<std::size_t>(i)] -
                      alone[static_cast<std::size_t>(j)];
            M(j, i) = M(i, j);
        }
    }
    return M;
}

Real SecondDerivation::momentum(const Vector& p, const Vector& v, int i) const {
    // T is quadratic in v, so this difference is exact.
    return (kinetic_energy(p, v + Vector::Unit(i)) - kinetic_energy(p, v - Vector::Unit(i))) / 2.0L;
}

SecondDerivation::Force SecondDerivation::force(const Vector& p, const Vector& v, Real piston) const {
    const StructureParameters& s = crane_.structure;
    const Real link_length = s.boom_length_m / 3.0L;
    const Real flexural = s.boom_joint_stiffness_N_m * link_length / 3.0L;
    const Real length = s.boom_length_m;
    const Real damping = s.boom_damping_ratio * pi * pi * 0.375L * length * length *
                         std::sqrt(flexural * s.boom_link_mass_kg / (3.0L * length * length * length)) /
                         (link_length * link_length);
    Vector outside = Vector::Zero();
    outside[q1_m] = -damping * (5.0L * v[q1_m] - 4.0L * v[q2_m]);
    outside[q2_m] = -damping * (5.0L * v[q2_m] - 4.0L * v[q1_m]);
    const auto [on_height, on_tilt] = soil_force(p[R1_m], p[phi2_rad], v[R1_m], v[phi2_rad]);
    outside[R1_m] = on_height;
    outside[phi2_rad] = on_tilt;

    Force result;
    for (int i = 0; i < 7; ++i) {
        const Real momentum_rate = slope([&](Real time) { return momentum(p + time * v, v, i); }, wide);
        const Real kinetic = slope([&](Real step) { return kinetic_energy(p + step * Vector::Unit(i), v); }, wide);
        const Real potential =
            slope([&](Real step) { return potential_energy(p + step * Vector::Unit(i), piston); }, narrow);
        result.value[i] = outside[i] - momentum_rate + kinetic - potential;
        result.scale[i] = std::abs(outside[i]) + std::abs(momentum_rate) + std::abs(kinetic) + std::abs(potential);
    }
    return result;
}

SecondDerivation::Vector SecondDerivation::acceleration(const Vector& p, const Vector& v, Real piston) const {
    return mass_matrix(p).fullPivLu().solve(force(p, v, piston).value);
}

Real SecondDerivation::piston_rate(const Vector& p, const Vector& v, Real piston, Real opening) const {
    const ActuatorParameters& a = crane_.actuator;
    const Real tension = pendent_tension(p, piston);
    const Real pressure = tension / a.piston_area_m2;
    // Unknowns X_p' and P_L'.
    Eigen::Matrix<Real, 2, 2> left;
    Eigen::Matrix<Real, 2, 1> right;
    const Real stiffness = tension > 0.0L ? crane_.ropes.pendent_stiffness_N_m : 0.0L;
    left << a.piston_area_m2, a.oil_volume_m3 / (4.0L * a.bulk_modulus_Pa),  //
        -stiffness, a.piston_area_m2;
    right << a.flow_gain_m2_s * opening - a.leakage_m3_s_Pa * pressure, stiffness * pendent_rate(p, v);
    return left.fullPivLu().solve(right)[0];
}

SecondDerivation::Contact SecondDerivation::contact(Real height, Real tilt) const {
    const Real half = crane_.soil.track_half_length_m;
    if (std::abs(tilt) < 1e-12L) {
        return {height < 0.0L ? 1.0L : 0.0L, 0.0L};
    }
    // Track points lie at height + x sin(tilt); those below zero bear.
    const Real waterline = std::clamp(-height / std::sin(tilt), -half, half);
    const Real from = tilt > 0.0L ? -half : waterline;
    const Real to = tilt > 0.0L ? waterline : half;
    return {(to - from) / (2.0L * half), (to + from) / 2.0L};
}

std::array<Real, 2> SecondDerivation::soil_force(Real height, Real tilt, Real height_rate, Real tilt_rate) const {
    const SoilParameters& soil = crane_.soil;
    const Contact bearing = contact(height, tilt);
    if (bearing.share == 0.0L) {
        return {0.0L, 0.0L};
    }
    const Real G = soil.shear_modulus_Pa;
    const Real nu = soil.poisson_ratio;
    const Real length = bearing.share * soil.track_half_length_m;
    const Real vertical_radius = std::sqrt(4.0L / pi * length * soil.track_width_m);
    const Real rocking_radius = std::pow(16.0L / (3.0L * pi) * length * length * length * soil.track_width_m, 0.25L);
    const Real root = std::sqrt(static_cast<Real>(soil.density_kg_m3) * G);
    const Real K_V = 4.0L * G * vertical_radius / (1.0L - nu);
    const Real C_V = 3.4L * vertical_radius * vertical_radius * root / (1.0L - nu);
    const Real K_R = 2.52L * G * std::pow(rocking_radius, 3.0L) / (1.0L - nu);
    const Real C_R = 0.136L * std::pow(rocking_radius, 4.0L) * root / (1.13L - nu);
    const Real sink = height + bearing.centre * tilt;
    const Real sink_rate = height_rate + bearing.centre * tilt_rate;
    const Real up = std::max(0.0L, -K_V * sink - C_V * sink_rate);
    return {up, up * bearing.centre - K_R * tilt - C_R * tilt_rate};
}

}  // namespace steadyboom::plant
