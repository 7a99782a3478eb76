#include "plant/beam_boom.hpp"

#include <cmath>
#include <numbers>

namespace steadyboom::plant {

namespace {

using std::numbers::pi;

struct GaussPoint {
    double share;   ///< of the interval [0, 1]
    double weight;  ///< the weights add up to 1
};

/// Point i of the Gauss-Legendre rule with `count` points: Newton on the Legendre polynomial.
GaussPoint gauss_point(int i, int count) {
    double z = std::cos(pi * (i + 0.75) / (count + 0.5));
    double slope = 0.0;
    for (int iteration = 0; iteration < 20; ++iteration) {
        double before = 0.0;
        double now = 1.0;
        for (int n = 0; n < count; ++n) {
            const double next = ((2.0 * n + 1.0) * z * now - n * before) / (n + 1.0);
            before = now;
            now = next;
        }
        slope = count * (z * now - before) / (z * z - 1.0);
        z -= now / slope;
    }
    return {.share = 0.5 * (1.0 - z), .weight = 1.0 / ((1.0 - z * z) * slope * slope)};
}

}  // namespace

BeamBoom::BeamBoom(const StructureParameters& structure)
    : length_m_(structure.boom_length_m), mass_kg_(3.0 * structure.boom_link_mass_kg) {
    const double radius_m = structure.boom_outer_chord_m;
    const double EI_N_m2 = structure.bending_stiffness_N_m2();
    section_turn_kg_m2_ = mass_kg_ * radius_m * radius_m;
    for (int k = 1; k <= coordinate_count; ++k) {
        const double wave_1_m = k * pi / length_m_;
        chord_loss_1_m_[k - 1] = 0.25 * wave_1_m * wave_1_m * length_m_;
        stiffness_N_m_[k - 1] = 0.5 * EI_N_m2 * std::pow(wave_1_m, 4) * length_m_;
        section_flexible_kg_[k - 1] = 0.5 * section_turn_kg_m2_ * wave_1_m * wave_1_m;
        for (int third = 1; third <= 2; ++third) {
            thirds_strain_1_m_(third - 1, k - 1) = radius_m * wave_1_m * wave_1_m * std::sin(k * pi * third / 3.0);
        }
    }
    const double first_ratio = structure.boom_damping_ratio * pi * pi / (8.0 * std::sqrt(3.0));
    const double first_frequency_rad_s = std::sqrt(stiffness_N_m_[0] / (0.5 * mass_kg_));
    damping_N_s_m_ = 2.0 * first_ratio / first_frequency_rad_s * stiffness_N_m_;

    below_slope_kg_.setZero();
    for (int i = 0; i < stations; ++i) {
        const GaussPoint point = gauss_point(i, stations);
        Station& here = stations_[static_cast<std::size_t>(i)];
        here = station(point.share * length_m_, point.weight * mass_kg_);
        below_slope_kg_ += here.mass_kg * here.deflection;
    }
    thirds_ = {station(length_m_ / 3.0, 0.0), station(2.0 * length_m_ / 3.0, 0.0)};
}

BeamBoom::Station BeamBoom::station(double s_m, double mass_kg) const noexcept {
    // int_0^s cos(m pi s / R_B)
    const auto cosine_integral_m = [&](int m) {
        return m == 0 ? s_m : length_m_ / (m * pi) * std::sin(m * pi * s_m / length_m_);
    };
    Station here{.mass_kg = mass_kg, .s_m = s_m};
    for (int i = 1; i <= coordinate_count; ++i) {
        here.deflection[i - 1] = std::sin(i * pi * s_m / length_m_);
        for (int j = 1; j <= coordinate_count; ++j) {
            here.shortening_1_m(i - 1, j - 1) =
                0.5 * i * j * pi * pi / (length_m_ * length_m_) * (cosine_integral_m(i - j) + cosine_integral_m(i + j));
        }
    }
    return here;
}

BeamBoom::Sums BeamBoom::sums(const Vector& a, double, const Vector&) const noexcept {
    Sums s;
    s.along_kg_m = 0.0;
    s.below_kg_m = below_slope_kg_.dot(a);
    s.along_slope_kg.setZero();
    s.below_slope_kg = below_slope_kg_;
    // Pinned modes turn as many sections forwards as backwards, so phi6 and a do not meet in the rotary inertia.
    s.turn_turn_kg_m2 = section_turn_kg_m2_;
    s.flexible_turn_kg_m.setZero();
    s.flexible_flexible_kg = section_flexible_kg_.asDiagonal();
    for (const Station& here : stations_) {
        const Vector x_slope = -here.shortening_1_m * a;
        const Vector& w_slope = here.deflection;
        const double x = here.s_m + 0.5 * x_slope.dot(a);
        const double w = w_slope.dot(a);
        s.along_kg_m += here.mass_kg * x;
        s.along_slope_kg += here.mass_kg * x_slope;
        s.turn_turn_kg_m2 += here.mass_kg * (x * x + w * w);
        s.flexible_turn_kg_m += here.mass_kg * (w * x_slope - x * w_slope);
        s.flexible_flexible_kg += here.mass_kg * (x_slope * x_slope.transpose() + w_slope * w_slope.transpose());
    }
    return s;
}

BeamBoom::BiasSums BeamBoom::bias_sums(const Vector& a, const Vector& a_rate, double, const Vector&) const noexcept {
    BiasSums s;
    s.along_N = 0.0;
    s.flexible_along_N.setZero();
    s.turn_along_N_m = 0.0;
    s.centrifugal_kg_m.setZero();
    s.coriolis_kg_m_s.setZero();
    for (const Station& here : stations_) {
        const Vector x_slope = -here.shortening_1_m * a;
        const Vector& w_slope = here.deflection;
        const double x = here.s_m + 0.5 * x_slope.dot(a);
        const double w = w_slope.dot(a);
        const double bias_N = -here.mass_kg * a_rate.dot(here.shortening_1_m * a_rate);
        s.along_N += bias_N;
        s.flexible_along_N += bias_N * x_slope;
        s.turn_along_N_m += bias_N * w;
        s.centrifugal_kg_m += here.mass_kg * (x * x_slope + w * w_slope);
        s.coriolis_kg_m_s += here.mass_kg * (w_slope.dot(a_rate) * x_slope - x_slope.dot(a_rate) * w_slope);
    }
    return s;
}

std::array<BoomPoint, 2> BeamBoom::thirds(const Vector& a) const noexcept {
    std::array<BoomPoint, 2> points{};
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i] = {.along_m = thirds_[i].s_m - 0.5 * a.dot(thirds_[i].shortening_1_m * a),
                     .below_m = thirds_[i].deflection.dot(a)};
    }
    return points;
}

double BeamBoom::pinned_frequency_rad_s(int mode) const noexcept {
    const double modal_mass_kg = 0.5 * mass_kg_ + section_flexible_kg_[mode - 1];
    return std::sqrt(stiffness_N_m_[mode - 1] / modal_mass_kg);
}

}  // namespace steadyboom::plant
