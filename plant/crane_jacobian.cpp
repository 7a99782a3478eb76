#include "plant/crane_jacobian.hpp"

#include <array>
#include <cmath>
#include <numbers>

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
/// d/dangle of what turns with an angle.
constexpr Plane turned(Plane a) noexcept {
    return {-a.y, a.x};
}

constexpr int n = coordinate_count;
constexpr int padded = 8;  ///< rows of whole registers

/// One point mass: dr/dp, its first and second time derivative, along and below the boom chord.
struct Body {
    std::array<double, padded> x{}, y{}, x1{}, y1{}, x2{}, y2{};

    void set(int column, Plane J, Plane J1, Plane J2) noexcept {
        const auto i = static_cast<std::size_t>(column);
        x[i] = J.x;
        y[i] = J.y;
        x1[i] = J1.x;
        y1[i] = J1.y;
        x2[i] = J2.x;
        y2[i] = J2.y;
    }
};

/// Sums over the bodies: M, m J' J' and m J' J''.
struct Sums {
    double M[n][padded] = {};
    double G[n][padded] = {};
    double K[n][padded] = {};

    template <std::size_t Count>
    void add(double mass_kg, const Body& body, const std::array<int, Count>& rows) noexcept {
        for (const int row : rows) {
            const auto i = static_cast<std::size_t>(row);
            const double mx = mass_kg * body.x[i];
            const double my = mass_kg * body.y[i];
            for (std::size_t j = 0; j < padded; ++j) {
                M[i][j] += mx * body.x[j] + my * body.y[j];
                G[i][j] += mx * body.x1[j] + my * body.y1[j];
                K[i][j] += mx * body.x2[j] + my * body.y2[j];
            }
        }
    }

    void add_curvature(int i, int j, double value) noexcept {
        K[i][j] += value;
        if (i != j) {
            K[j][i] += value;
        }
    }
};

/// A value with its first and second time derivative.
struct Moving {
    double value, rate, acceleration;
};

/// dr/dp = (a, b) in a frame that turns clockwise from its first to its second axis at `turn`: in world terms its
/// first and second time derivative, in the same frame.
Plane first_derivative(Moving a, Moving b, Moving turn) noexcept {
    return {a.rate + turn.rate * b.value, b.rate - turn.rate * a.value};
}
Plane second_derivative(Moving a, Moving b, Moving turn) noexcept {
    const double w = turn.rate;
    return {a.acceleration + turn.acceleration * b.value + 2.0 * w * b.rate - w * w * a.value,
            b.acceleration - turn.acceleration * a.value - 2.0 * w * a.rate - w * w * b.value};
}

constexpr int solve_width = 18;  ///< columns solved for at once, a whole number of registers
using Columns = double[n][solve_width];

/// B := M^-1 B, as mass_matrix_solver.hpp for many columns.
void solve_columns(const double (&M)[n][padded], Columns& B) noexcept {
    double L[n][n];
    double inverse_d[n];
#pragma GCC unroll 7
    for (int j = 0; j < n; ++j) {
        double scaled[n];
        double d = M[j][j];
#pragma GCC unroll 7
        for (int k = 0; k < j; ++k) {
            scaled[k] = L[j][k];
            L[j][k] *= inverse_d[k];
            d -= scaled[k] * L[j][k];
        }
        inverse_d[j] = 1.0 / d;
#pragma GCC unroll 7
        for (int i = j + 1; i < n; ++i) {
            double sum = M[i][j];
#pragma GCC unroll 7
            for (int k = 0; k < j; ++k) {
                sum -= L[i][k] * L[j][k];
            }
            L[i][j] = sum;
        }
    }
    for (int i = 1; i < n; ++i) {
        for (int k = 0; k < i; ++k) {
            for (int c = 0; c < solve_width; ++c) {
                B[i][c] -= L[i][k] * B[k][c];
            }
        }
    }
    for (int i = n - 1; i >= 0; --i) {
        for (int c = 0; c < solve_width; ++c) {
            B[i][c] *= inverse_d[i];
        }
        for (int k = i + 1; k < n; ++k) {
            for (int c = 0; c < solve_width; ++c) {
                B[i][c] -= L[k][i] * B[k][c];
            }
        }
    }
}

// Columns of the system that is solved: coordinates, velocities, then one unit of pendent tension, of load-line tension
// and of ln G.
constexpr int pendent_column = 2 * n;
constexpr int line_column = 2 * n + 1;
constexpr int soil_column = 2 * n + 2;
static_assert(soil_column < solve_width);

}  // namespace

void crane_jacobian(const CraneDynamics& crane, const CraneState& state, double valve_opening_m,
                    const RestTensions& rest, CraneJacobian& result) noexcept {
    result.derivative = crane.derivative(state, valve_opening_m);
    const StructureParameters& s = crane.parameters().structure;
    const RopeParameters& ropes = crane.parameters().ropes;
    const LinkBoom& boom = crane.boom();
    const auto chord_slope = [&](double q, double other) { return boom.chord_slope({q, other})[0]; };
    const double m_B = s.boom_link_mass_kg;
    const double m_L = s.load_mass_kg;
    const auto moving = [&](Coordinate c) {
        return Moving{state[c], state[velocity_offset + c], result.derivative[velocity_offset + c]};
    };
    const Moving phi2 = moving(phi2_rad);
    const Moving R9 = moving(R9_m);
    const Moving q1 = moving(q1_m);
    const Moving q2 = moving(q2_m);
    const Moving phi6 = moving(phi6_rad);
    const Moving phi9 = moving(phi9_rad);
    const Moving R8{boom.chord_m({q1.value, q2.value}),
                    chord_slope(q1.value, q2.value) * q1.rate + chord_slope(q2.value, q1.value) * q2.rate,
                    chord_slope(q1.value, q2.value) * q1.acceleration +
                        chord_slope(q2.value, q1.value) * q2.acceleration + boom.chord_bias_m_s2({q1.rate, q2.rate})};
    // dR8/dq is linear in q, so its time derivatives are the same function of q' and q''.
    const auto slope = [&](const Moving& q, const Moving& other) {
        return Moving{chord_slope(q.value, other.value), chord_slope(q.rate, other.rate),
                      chord_slope(q.acceleration, other.acceleration)};
    };
    const Moving R8_1 = slope(q1, q2);
    const Moving R8_2 = slope(q2, q1);
    const double R8_same = chord_slope(1.0, 0.0);   // d2R8/dq1^2 = d2R8/dq2^2
    const double R8_cross = chord_slope(0.0, 1.0);  // d2R8/dq1dq2

    const double s2 = std::sin(phi2.value);
    const double c2 = std::cos(phi2.value);
    const Plane e6{std::cos(phi6.value), std::sin(phi6.value)};
    const Plane n6{e6.y, -e6.x};
    const Plane u9{std::sin(phi9.value), -std::cos(phi9.value)};
    const Plane w9{-u9.y, u9.x};
    const auto in_boom_frame = [&](Plane a) { return Plane{dot(a, e6), dot(a, n6)}; };

    // What turns with the car body: dr/dphi2, and the acceleration that its body shares with the track plane.
    const auto second_of_arm = [&](Plane arm) {
        return phi2.acceleration * turned(arm) + (-phi2.rate * phi2.rate) * arm;
    };
    const Plane up{0.0, 1.0};
    const Plane lift{0.0, result.derivative[velocity_offset + R1_m] + gravity_m_s2};
    const auto acceleration_of_arm = [&](Plane arm) {
        return lift + phi2.acceleration * arm + (phi2.rate * phi2.rate) * turned(arm);
    };

    Sums sums;
    sums.M[phi2_rad][phi2_rad] = s.track_inertia_kg_m2 + s.car_body_inertia_kg_m2;
    const auto add_turning = [&](double mass_kg, Plane arm) {
        const Plane J2 = second_of_arm(arm);
        sums.M[R1_m][R1_m] += mass_kg;
        sums.M[phi2_rad][R1_m] += mass_kg * arm.y;
        sums.M[phi2_rad][phi2_rad] += mass_kg * dot(arm, arm);
        sums.G[R1_m][phi2_rad] += mass_kg * phi2.rate * turned(arm).y;
        sums.K[R1_m][phi2_rad] += mass_kg * J2.y;
        sums.K[phi2_rad][phi2_rad] += mass_kg * (dot(arm, J2) + dot(turned(arm), acceleration_of_arm(arm)));
    };
    const double sin_3 = std::sin(s.car_body_angle_rad);
    const double cos_3 = std::cos(s.car_body_angle_rad);
    const double s23 = s2 * cos_3 - c2 * sin_3;
    const double c23 = c2 * cos_3 + s2 * sin_3;
    const double R3 = s.car_body_height_m;
    add_turning(s.track_mass_kg, {-s.track_centre_height_m * c2, -s.track_centre_height_m * s2});
    add_turning(s.car_body_mass_kg, {-R3 * c2 + s.car_body_setback_m * s23, -R3 * s2 - s.car_body_setback_m * c23});

    const Plane butt_arm{-R3 * c2 - s.boom_butt_offset_m * s2, -R3 * s2 + s.boom_butt_offset_m * c2};
    const Plane butt_acceleration = in_boom_frame(acceleration_of_arm(butt_arm));
    Body body;
    body.set(R1_m, in_boom_frame(up), {0.0, 0.0}, {0.0, 0.0});
    body.set(phi2_rad, in_boom_frame(butt_arm), in_boom_frame(phi2.rate * turned(butt_arm)),
             in_boom_frame(second_of_arm(butt_arm)));
    const Plane butt_turned = in_boom_frame(turned(butt_arm));

    // A point at share c of the chord and d1 q1 + d2 q2 below it, with the mass `mass_kg`.
    const auto place_on_boom = [&](double c, double d1, double d2) {
        const Moving along_1{c * R8_1.value, c * R8_1.rate, c * R8_1.acceleration};
        const Moving along_2{c * R8_2.value, c * R8_2.rate, c * R8_2.acceleration};
        const Moving below_1{d1, 0.0, 0.0};
        const Moving below_2{d2, 0.0, 0.0};
        const Moving b{d1 * q1.value + d2 * q2.value, d1 * q1.rate + d2 * q2.rate,
                       d1 * q1.acceleration + d2 * q2.acceleration};
        const Moving minus_along{-c * R8.value, -c * R8.rate, -c * R8.acceleration};
        const Moving along{c * R8.value, c * R8.rate, c * R8.acceleration};
        body.set(q1_m, {along_1.value, d1}, first_derivative(along_1, below_1, phi6),
                 second_derivative(along_1, below_1, phi6));
        body.set(q2_m, {along_2.value, d2}, first_derivative(along_2, below_2, phi6),
                 second_derivative(along_2, below_2, phi6));
        body.set(phi6_rad, {b.value, minus_along.value}, first_derivative(b, minus_along, phi6),
                 second_derivative(b, minus_along, phi6));
        return butt_acceleration + second_derivative(along, b, phi6);
    };
    // H : r'' of the same point, force = mass_kg r''.
    const auto add_boom_curvature = [&](double c, double d1, double d2, Plane force) {
        sums.K[phi2_rad][phi2_rad] += dot(butt_turned, force);
        sums.K[q1_m][q1_m] += c * R8_same * force.x;
        sums.K[q2_m][q2_m] += c * R8_same * force.x;
        sums.add_curvature(q1_m, q2_m, c * R8_cross * force.x);
        sums.add_curvature(q1_m, phi6_rad, d1 * force.x - c * R8_1.value * force.y);
        sums.add_curvature(q2_m, phi6_rad, d2 * force.x - c * R8_2.value * force.y);
        sums.K[phi6_rad][phi6_rad] -= c * R8.value * force.x + (d1 * q1.value + d2 * q2.value) * force.y;
    };
    struct Link {
        double c, d1, d2;
    };
    for (const Link& link : {Link{1.0 / 6.0, 0.5, 0.0}, Link{0.5, 0.5, 0.5}, Link{5.0 / 6.0, 0.0, 0.5}}) {
        const Plane acceleration = place_on_boom(link.c, link.d1, link.d2);
        sums.add(m_B, body, std::array<int, 5>{R1_m, phi2_rad, q1_m, q2_m, phi6_rad});
        add_boom_curvature(link.c, link.d1, link.d2, m_B * acceleration);
    }

    const Plane u = in_boom_frame(u9);
    const Plane w = in_boom_frame(w9);
    const double w9w9 = phi9.rate * phi9.rate;
    const Plane tip_acceleration = place_on_boom(1.0, 0.0, 0.0);
    body.set(R9_m, u, phi9.rate * w, phi9.acceleration * w + (-w9w9) * u);
    body.set(
        phi9_rad, R9.value * w, R9.rate * w + (-phi9.rate * R9.value) * u,
        (R9.acceleration - w9w9 * R9.value) * w + (-(phi9.acceleration * R9.value + 2.0 * phi9.rate * R9.rate)) * u);
    const Plane load_force = m_L * (tip_acceleration + (R9.acceleration - w9w9 * R9.value) * u +
                                    (phi9.acceleration * R9.value + 2.0 * phi9.rate * R9.rate) * w);
    sums.add(m_L, body, std::array<int, 7>{R1_m, phi2_rad, R9_m, q1_m, q2_m, phi6_rad, phi9_rad});
    add_boom_curvature(1.0, 0.0, 0.0, load_force);
    sums.add_curvature(R9_m, phi9_rad, dot(w, load_force));
    sums.K[phi9_rad][phi9_rad] -= R9.value * dot(u, load_force);

    // Pendent: L_p's gradient and curvature over (R8, phi_B), then over the coordinates.
    const double R_d = s.pendent_anchor_radius_m;
    const double phi_B = s.pendent_anchor_angle_rad + std::numbers::pi / 2.0 - (phi6.value - phi2.value);
    const double sin_B = std::sin(phi_B);
    const double cos_B = std::cos(phi_B);
    const double piston = crane.actuator().clamp_piston_m(state[piston_index]);
    const double length = std::sqrt(R8.value * R8.value + R_d * R_d - 2.0 * R8.value * R_d * cos_B);
    const double inverse_length = 1.0 / length;
    const double L_R = (R8.value - R_d * cos_B) * inverse_length;
    const double L_B = R8.value * R_d * sin_B * inverse_length;
    const double L_RR = (1.0 - L_R * L_R) * inverse_length;
    const double L_RB = (R_d * sin_B - L_R * L_B) * inverse_length;
    const double L_BB = (R8.value * R_d * cos_B - L_B * L_B) * inverse_length;
    const double K_P = ropes.pendent_stiffness_N_m;
    const double stretch_N = K_P * (length - crane.free_pendent_length_m() + piston);
    const bool taut = stretch_N > 0.0;
    const double T_P = taut ? stretch_N : 0.0;
    constexpr std::array<int, 4> pendent_rows{phi2_rad, q1_m, q2_m, phi6_rad};
    const std::array<double, 4> gradient{L_B, L_R * R8_1.value, L_R * R8_2.value, -L_B};
    double curvature[4][4];
    const std::array<double, 4> R8_slope{0.0, R8_1.value, R8_2.value, 0.0};
    const std::array<double, 4> phi_B_slope{1.0, 0.0, 0.0, -1.0};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            curvature[i][j] = L_RR * R8_slope[i] * R8_slope[j] +
                              L_RB * (R8_slope[i] * phi_B_slope[j] + phi_B_slope[i] * R8_slope[j]) +
                              L_BB * phi_B_slope[i] * phi_B_slope[j];
        }
    }
    curvature[1][1] += L_R * R8_same;
    curvature[2][2] += L_R * R8_same;
    curvature[1][2] += L_R * R8_cross;
    curvature[2][1] += L_R * R8_cross;

    Columns B = {};
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            B[i][j] = -sums.K[i][j];
            B[i][n + j] = -2.0 * sums.G[i][j];
        }
    }
    if (taut) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                B[pendent_rows[i]][pendent_rows[j]] -= K_P * gradient[i] * gradient[j] + T_P * curvature[i][j];
            }
            B[pendent_rows[i]][pendent_column] = -gradient[i];
        }
    }
    const double line_stretch_m = R9.value - ropes.load_line_length_m;
    const double K_L = line_stretch_m > 0.0 ? ropes.load_line_stiffness_N_m : 0.0;
    B[R9_m][R9_m] -= K_L;
    B[R9_m][line_column] = K_L > 0.0 ? -1.0 : 0.0;

    for (int j = 0; j < 2; ++j) {
        const Eigen::Vector2d bending = boom.bending_force_N(Eigen::Vector2d::Unit(j));
        const Eigen::Vector2d damping = boom.damping_force_N(Eigen::Vector2d::Unit(j));
        for (int i = 0; i < 2; ++i) {
            B[q1_m + i][q1_m + j] += bending[i];
            B[q1_m + i][n + q1_m + j] += damping[i];
        }
    }

    const SoilSlopes soil =
        crane.soil().slopes(state[R1_m], phi2.value, s2, c2, state[velocity_offset + R1_m], phi2.rate);
    B[R1_m][R1_m] += soil.vertical.height;
    B[R1_m][phi2_rad] += soil.vertical.tilt;
    B[R1_m][n + R1_m] += soil.vertical.height_rate;
    B[R1_m][n + phi2_rad] += soil.vertical.tilt_rate;
    B[R1_m][soil_column] = soil.vertical.log_modulus;
    B[phi2_rad][R1_m] += soil.rocking.height;
    B[phi2_rad][phi2_rad] += soil.rocking.tilt;
    B[phi2_rad][n + R1_m] += soil.rocking.height_rate;
    B[phi2_rad][n + phi2_rad] += soil.rocking.tilt_rate;
    B[phi2_rad][soil_column] = soil.rocking.log_modulus;

    solve_columns(sums.M, B);

    auto& A = result.columns;
    A.setZero();
    constexpr int pendent_parameter = state_count + pendent_log_stiffness;
    constexpr int line_parameter = state_count + load_line_log_stiffness;
    constexpr int soil_parameter = state_count + soil_log_modulus;
    const double travel = crane.parameters().actuator.piston_travel_m;
    const bool piston_counts = taut && std::abs(state[piston_index]) <= travel;
    const double piston_scale = piston_counts ? K_P : 0.0;
    const double pendent_scale = taut ? T_P - rest.pendent_N : 0.0;
    const double line_scale = K_L > 0.0 ? K_L * line_stretch_m - rest.load_line_N : 0.0;
    for (int i = 0; i < n; ++i) {
        const int row = velocity_offset + i;
        A(i, row) = 1.0;
        for (int j = 0; j < 2 * n; ++j) {
            A(row, j) = B[i][j];
        }
        A(row, piston_index) = piston_scale * B[i][pendent_column];
        A(row, soil_parameter) = B[i][soil_column];
        A(row, pendent_parameter) = pendent_scale * B[i][pendent_column];
        A(row, line_parameter) = line_scale * B[i][line_column];
    }

    const PistonRateSlopes piston_rate =
        crane.actuator().piston_rate_slopes(valve_opening_m, T_P, result.derivative[piston_index], state[piston_index]);
    const double velocity_of[4] = {phi2.rate, q1.rate, q2.rate, phi6.rate};
    double pendent_rate = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        double gradient_rate = 0.0;
        for (std::size_t j = 0; j < 4; ++j) {
            gradient_rate += curvature[i][j] * velocity_of[j];
        }
        pendent_rate += gradient[i] * velocity_of[i];
        A(piston_index, pendent_rows[i]) =
            piston_rate.pendent_rate * gradient_rate + piston_rate.pendent_tension * (taut ? K_P * gradient[i] : 0.0);
        A(piston_index, velocity_offset + pendent_rows[i]) = piston_rate.pendent_rate * gradient[i];
    }
    A(piston_index, piston_index) = piston_rate.pendent_tension * piston_scale;
    // The oil's compliance is reckoned in pendent stretch, so it goes with the rope's stiffness.
    A(piston_index, pendent_parameter) = piston_rate.pendent_tension * pendent_scale +
                                         piston_rate.pendent_rate * (pendent_rate + result.derivative[piston_index]);
}

}  // namespace steadyboom::plant
