#include "second_derivation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <vector>

#include <Eigen/LU>

#include "plant/crane_state.hpp"

namespace steadyboom::plant {

namespace {

using Real = long double;
using Point = std::complex<Real>;
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

LinkOracle::LinkOracle(const StructureParameters& structure)
    : structure_(structure), masses_(3, structure.boom_link_mass_kg) {}

Point LinkOracle::tip(const Own& q) const {
    // A link of length L_B whose ends differ by d across the chord covers about L_B - d^2 / (2 L_B) of it.
    const Real link_length = structure_.boom_length_m / 3.0L;
    const Real d1 = q[0];
    const Real d2 = q[1] - q[0];
    const Real d3 = -q[1];
    return 3.0L * link_length - (d1 * d1 + d2 * d2 + d3 * d3) / (2.0L * link_length);
}

std::array<Point, 2> LinkOracle::thirds(const Own& q) const {
    const Point end = tip(q);
    return {end / 3.0L - i_unit * q[0], end * 2.0L / 3.0L - i_unit * q[1]};
}

std::vector<Point> LinkOracle::stations(const Own& q) const {
    const auto [lower, upper] = thirds(q);
    return {lower / 2.0L, (lower + upper) / 2.0L, (upper + tip(q)) / 2.0L};
}

std::vector<Real> LinkOracle::section_angles(const Own&) const {
    return {};
}

Real LinkOracle::bending_energy(const Own& q) const {
    // Two joints whose kinks are the second differences of (0, q1, q2, 0), as a beam's moment diagram weighs them.
    const Real link_length = structure_.boom_length_m / 3.0L;
    return 1.5L * structure_.boom_joint_stiffness_N_m / (link_length * link_length) *
           (q[0] * q[0] + (q[1] - q[0]) * (q[1] - q[0]) + q[1] * q[1]);
}

LinkOracle::Own LinkOracle::damping_force(const Own& rate) const {
    const Real length = structure_.boom_length_m;
    const Real link_length = length / 3.0L;
    const Real flexural = structure_.boom_joint_stiffness_N_m * link_length / 3.0L;
    const Real damping = structure_.boom_damping_ratio * pi * pi * 0.375L * length * length *
                         std::sqrt(flexural * structure_.boom_link_mass_kg / (3.0L * length * length * length)) /
                         (link_length * link_length);
    return {-damping * (5.0L * rate[0] - 4.0L * rate[1]), -damping * (5.0L * rate[1] - 4.0L * rate[0])};
}

std::array<Real, 2> LinkOracle::strain(const Own& q) const {
    // M = 3 K_B q / L_B, eps = M R_O / (E I).
    const Real link_length = structure_.boom_length_m / 3.0L;
    const Real flexural = structure_.boom_joint_stiffness_N_m * link_length / 3.0L;
    const Real per_m =
        3.0L * structure_.boom_joint_stiffness_N_m / link_length * structure_.boom_outer_chord_m / flexural;
    return {per_m * q[0], per_m * q[1]};
}

namespace {

/// Calls add(s, weight) at the nodes of the five-point Gauss rule in each of `panels` equal parts of [0, to].
template <class Add>
void integrate(Real to, int panels, const Add& add) {
    const Real inner = std::sqrt(5.0L - 2.0L * std::sqrt(10.0L / 7.0L)) / 3.0L;
    const Real outer = std::sqrt(5.0L + 2.0L * std::sqrt(10.0L / 7.0L)) / 3.0L;
    const Real inner_weight = (322.0L + 13.0L * std::sqrt(70.0L)) / 900.0L;
    const Real outer_weight = (322.0L - 13.0L * std::sqrt(70.0L)) / 900.0L;
    const Real half = to / (2.0L * panels);
    for (int panel = 0; panel < panels; ++panel) {
        const Real middle = (2 * panel + 1) * half;
        add(middle, half * 128.0L / 225.0L);
        for (const Real side : {-1.0L, 1.0L}) {
            add(middle + side * inner * half, half * inner_weight);
            add(middle + side * outer * half, half * outer_weight);
        }
    }
}

}  // namespace

BeamOracle::BeamOracle(const StructureParameters& structure) : structure_(structure), length_(structure.boom_length_m) {
    const Real mass_per_m = 3.0L * structure.boom_link_mass_kg / length_;
    integrate(length_, 14, [&](Real s, Real weight) {
        s_.push_back(s);
        weights_.push_back(weight);
        masses_.push_back(mass_per_m * weight);
        section_inertias_.push_back(mass_per_m * weight * structure.boom_outer_chord_m * structure.boom_outer_chord_m);
        shapes_.push_back(shape(s, 0));
        slopes_.push_back(shape(s, 1));
        curvatures_.push_back(shape(s, 2));
        shortenings_.push_back(slope_integral(s));
    });
    tip_shortening_ = slope_integral(length_);
    third_shortenings_ = {slope_integral(length_ / 3.0L), slope_integral(2.0L * length_ / 3.0L)};
}

BeamOracle::Own BeamOracle::shape(Real s, int derivative) const {
    Own result;
    for (int k = 1; k <= count; ++k) {
        const Real wave = k * pi / length_;
        result[k - 1] = derivative == 0   ? std::sin(wave * s)
                        : derivative == 1 ? wave * std::cos(wave * s)
                                          : -wave * wave * std::sin(wave * s);
    }
    return result;
}

BeamOracle::Square BeamOracle::slope_integral(Real s) const {
    Square sum = Square::Zero();
    integrate(s, 14, [&](Real at_s, Real weight) {
        const Own slope_there = shape(at_s, 1);
        sum += weight * slope_there * slope_there.transpose();
    });
    return sum;
}

Point BeamOracle::at(Real s, const Own& shape, const Square& shortening, const Own& a) const {
    return s - a.dot(shortening * a) / 2.0L - i_unit * shape.dot(a);
}

Point BeamOracle::tip(const Own& a) const {
    return at(length_, Own::Zero(), tip_shortening_, a);
}

std::array<Point, 2> BeamOracle::thirds(const Own& a) const {
    const Real third = length_ / 3.0L;
    return {at(third, shape(third, 0), third_shortenings_[0], a),
            at(2.0L * third, shape(2.0L * third, 0), third_shortenings_[1], a)};
}

std::vector<Point> BeamOracle::stations(const Own& a) const {
    std::vector<Point> points;
    for (std::size_t i = 0; i < s_.size(); ++i) {
        points.push_back(at(s_[i], shapes_[i], shortenings_[i], a));
    }
    return points;
}

std::vector<Real> BeamOracle::section_angles(const Own& a) const {
    std::vector<Real> angles;
    for (const Own& slope_there : slopes_) {
        angles.push_back(-slope_there.dot(a));
    }
    return angles;
}

Real BeamOracle::bending_energy(const Own& a) const {
    const Real flexural = structure_.boom_joint_stiffness_N_m * length_ / 9.0L;
    Real energy = 0.0L;
    for (std::size_t i = 0; i < s_.size(); ++i) {
        const Real curvature = curvatures_[i].dot(a);
        energy += weights_[i] * flexural / 2.0L * curvature * curvature;
    }
    return energy;
}

BeamOracle::Own BeamOracle::damping_force(const Own& rate) const {
    // The three links bending as q1 = q2 = 1: mass, stiffness and damping of that mode, hence its ratio.
    const LinkOracle links(structure_);
    const LinkOracle::Own together(1.0L, 1.0L);
    const Real mass = 0.75L * structure_.boom_link_mass_kg * 2.0L;
    const Real stiffness = 2.0L * links.bending_energy(together);
    const Real damping = -links.damping_force(together).dot(together);
    const Real ratio = damping / (2.0L * std::sqrt(stiffness * mass));
    // The same ratio for the beam's first mode without rotary inertia; moments of damping proportional to curvature.
    const Real first_frequency =
        std::pow(pi / length_, 2.0L) * std::sqrt(structure_.boom_joint_stiffness_N_m * length_ / 9.0L /
                                                 (3.0L * structure_.boom_link_mass_kg / length_));
    const Real time = 2.0L * ratio / first_frequency;
    Own force;
    for (int k = 0; k < count; ++k) {
        force[k] = -time * slope([&](Real h) { return bending_energy(rate + h * Own::Unit(k)); }, wide);
    }
    return force;
}

std::array<Real, 2> BeamOracle::strain(const Own& a) const {
    const Real chord = structure_.boom_outer_chord_m;
    return {-chord * shape(length_ / 3.0L, 2).dot(a), -chord * shape(2.0L * length_ / 3.0L, 2).dot(a)};
}

template <class Boom>
SecondDerivation<Boom>::SecondDerivation(const CraneParameters& crane)
    : crane_(crane), boom_(crane.structure), free_pendent_length_(0.0L) {
    Vector straight = Vector::Zero();
    straight[R9_m] = crane.ropes.load_line_length_m;
    straight[phi6] = crane.structure.boom_angle_rad;
    free_pendent_length_ = pendent_length(straight);
}

template <class Boom>
typename SecondDerivation<Boom>::Points SecondDerivation<Boom>::points(const Vector& p) const {
    const StructureParameters& s = crane_.structure;
    const std::complex<Real> along = toward(p[phi6]);
    const std::complex<Real> body = toward(p[phi2_rad]);
    const std::complex<Real> ground = i_unit * p[R1_m];

    Points z;
    z.track = ground + i_unit * body * static_cast<Real>(s.track_centre_height_m);
    const std::complex<Real> axis = ground + i_unit * body * static_cast<Real>(s.car_body_height_m);
    z.car_body = axis + toward(p[phi2_rad] - s.car_body_angle_rad + pi) * static_cast<Real>(s.car_body_setback_m);
    z.butt = axis + body * static_cast<Real>(s.boom_butt_offset_m);
    z.anchor =
        z.butt + i_unit * body * toward(s.pendent_anchor_angle_rad) * static_cast<Real>(s.pendent_anchor_radius_m);
    const typename Boom::Own a = p.template segment<Boom::count>(own);
    const std::array<Point, 2> thirds = boom_.thirds(a);
    z.lower = z.butt + along * thirds[0];
    z.upper = z.butt + along * thirds[1];
    z.tip = z.butt + along * boom_.tip(a);
    z.load = z.tip - i_unit * toward(p[phi9]) * p[R9_m];
    for (const Point& station : boom_.stations(a)) {
        z.boom.push_back(z.butt + along * station);
    }
    return z;
}

template <class Boom>
Real SecondDerivation<Boom>::kinetic_energy(const Vector& p, const Vector& v) const {
    const StructureParameters& s = crane_.structure;
    // Every mass and, as a complex number of its own, every section's angle.
    const auto stacked = [&](Real time) {
        const Vector now = p + time * v;
        const Points z = points(now);
        const std::vector<Real> angles = boom_.section_angles(now.template segment<Boom::count>(own));
        Eigen::Matrix<Point, Eigen::Dynamic, 1> all(static_cast<Eigen::Index>(3 + z.boom.size() + angles.size()));
        all << z.track, z.car_body, z.load,
            Eigen::Map<const Eigen::Matrix<Point, Eigen::Dynamic, 1>>(z.boom.data(),
                                                                      static_cast<Eigen::Index>(z.boom.size())),
            Eigen::Matrix<Point, Eigen::Dynamic, 1>::Zero(static_cast<Eigen::Index>(angles.size()));
        for (std::size_t i = 0; i < angles.size(); ++i) {
            all[static_cast<Eigen::Index>(3 + z.boom.size() + i)] = now[phi6] + angles[i];
        }
        return all;
    };
    const Eigen::Matrix<Point, Eigen::Dynamic, 1> velocity =
        slope([&](Real time) -> Eigen::Matrix<Point, Eigen::Dynamic, 1> { return stacked(time); }, wide);
    std::vector<Real> mass = {s.track_mass_kg, s.car_body_mass_kg, s.load_mass_kg};
    mass.insert(mass.end(), boom_.masses().begin(), boom_.masses().end());
    mass.insert(mass.end(), boom_.section_inertias().begin(), boom_.section_inertias().end());
    Real twice = (static_cast<Real>(s.track_inertia_kg_m2) + s.car_body_inertia_kg_m2) * v[phi2_rad] * v[phi2_rad];
    for (std::size_t i = 0; i < mass.size(); ++i) {
        twice += mass[i] * std::norm(velocity[static_cast<Eigen::Index>(i)]);
    }
    return twice / 2.0L;
}

template <class Boom>
Real SecondDerivation<Boom>::pendent_length(const Vector& p) const {
    const Points z = points(p);
    return std::abs(z.tip - z.anchor);
}

template <class Boom>
Real SecondDerivation<Boom>::pendent_rate(const Vector& p, const Vector& v) const {
    return slope([&](Real time) { return pendent_length(p + time * v); }, wide);
}

template <class Boom>
Real SecondDerivation<Boom>::pendent_tension(const Vector& p, Real piston) const {
    const Real stretch = pendent_length(p) - free_pendent_length_ + piston;
    return stretch > 0.0L ? crane_.ropes.pendent_stiffness_N_m * stretch : 0.0L;
}

template <class Boom>
Real SecondDerivation<Boom>::load_line_tension(const Vector& p) const {
    const Real stretch = p[R9_m] - crane_.ropes.load_line_length_m;
    return stretch > 0.0L ? crane_.ropes.load_line_stiffness_N_m * stretch : 0.0L;
}

template <class Boom>
Real SecondDerivation<Boom>::potential_energy(const Vector& p, Real piston) const {
    const StructureParameters& s = crane_.structure;
    const Points z = points(p);
    Real moment =
        s.track_mass_kg * z.track.imag() + s.car_body_mass_kg * z.car_body.imag() + s.load_mass_kg * z.load.imag();
    for (std::size_t i = 0; i < z.boom.size(); ++i) {
        moment += boom_.masses()[i] * z.boom[i].imag();
    }
    const Real bending = boom_.bending_energy(p.template segment<Boom::count>(own));
    const Real pendent = pendent_tension(p, piston);
    const Real line = load_line_tension(p);
    return static_cast<Real>(gravity_m_s2) * moment + bending +
           pendent * pendent / (2.0L * crane_.ropes.pendent_stiffness_N_m) +
           line * line / (2.0L * crane_.ropes.load_line_stiffness_N_m);
}

template <class Boom>
typename SecondDerivation<Boom>::Matrix SecondDerivation<Boom>::mass_matrix(const Vector& p) const {
    Matrix M;
    std::array<Real, count> alone{};
    for (int i = 0; i < count; ++i) {
        alone[static_cast<std::size_t>(i)] = kinetic_energy(p, Vector::Unit(i));
        M(i, i) = 2.0L * alone[static_cast<std::size_t>(i)];
    }
    for (int i = 0; i < count; ++i) {
        for (int j = 0; j < i; ++j) {
            M(i, j) = kinetic_energy(p, Vector::Unit(i) + Vector::Unit(j)) - alone[static_cast<std::size_t>(i)] -
                      alone[static_cast<std::size_t>(j)];
            M(j, i) = M(i, j);
        }
    }
    return M;
}

template <class Boom>
Real SecondDerivation<Boom>::momentum(const Vector& p, const Vector& v, int i) const {
    // T is quadratic in v, so this difference is exact.
    return (kinetic_energy(p, v + Vector::Unit(i)) - kinetic_energy(p, v - Vector::Unit(i))) / 2.0L;
}

template <class Boom>
typename SecondDerivation<Boom>::Force SecondDerivation<Boom>::force(const Vector& p, const Vector& v,
                                                                     Real piston) const {
    Vector outside = Vector::Zero();
    outside.template segment<Boom::count>(own) = boom_.damping_force(v.template segment<Boom::count>(own));
    const auto [on_height, on_tilt] = soil_force(p[R1_m], p[phi2_rad], v[R1_m], v[phi2_rad]);
    outside[R1_m] = on_height;
    outside[phi2_rad] = on_tilt;

    Force result;
    for (int i = 0; i < count; ++i) {
        const Real momentum_rate = slope([&](Real time) { return momentum(p + time * v, v, i); }, wide);
        const Real kinetic = slope([&](Real step) { return kinetic_energy(p + step * Vector::Unit(i), v); }, wide);
        const Real potential =
            slope([&](Real step) { return potential_energy(p + step * Vector::Unit(i), piston); }, narrow);
        result.value[i] = outside[i] - momentum_rate + kinetic - potential;
        result.scale[i] = std::abs(outside[i]) + std::abs(momentum_rate) + std::abs(kinetic) + std::abs(potential);
    }
    return result;
}

template <class Boom>
typename SecondDerivation<Boom>::Vector SecondDerivation<Boom>::acceleration(const Vector& p, const Vector& v,
                                                                             Real piston) const {
    return mass_matrix(p).fullPivLu().solve(force(p, v, piston).value);
}

template <class Boom>
Real SecondDerivation<Boom>::piston_rate(const Vector& p, const Vector& v, Real piston, Real opening) const {
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

template <class Boom>
typename SecondDerivation<Boom>::Contact SecondDerivation<Boom>::contact(Real height, Real tilt) const {
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

template <class Boom>
std::array<Real, 2> SecondDerivation<Boom>::soil_force(Real height, Real tilt, Real height_rate, Real tilt_rate) const {
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

template class SecondDerivation<LinkOracle>;
template class SecondDerivation<BeamOracle>;

}  // namespace steadyboom::plant
