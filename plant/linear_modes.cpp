#include "plant/linear_modes.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace steadyboom::plant {

StateMatrix state_matrix(const CraneDynamics& crane, const CraneState& state, double valve_opening_m) {
    constexpr double step = 1e-6;
    StateMatrix A;
    for (int i = 0; i < state_count; ++i) {
        CraneState above = state;
        CraneState below = state;
        above[i] += step;
        below[i] -= step;
        A.col(i) = (crane.derivative(above, valve_opening_m) - crane.derivative(below, valve_opening_m)) / (2.0 * step);
    }
    return A;
}

std::vector<LinearMode> linear_modes(const CraneDynamics& crane, const CraneState& equilibrium) {
    const Eigen::EigenSolver<StateMatrix> eigen(state_matrix(crane, equilibrium, 0.0));
    const MassMatrix mass = crane.mass_matrix(Coordinates(coordinates_of(equilibrium)));
    std::vector<LinearMode> modes;
    for (int i = 0; i < state_count; ++i) {
        const std::complex<double> lambda = eigen.eigenvalues()[i];
        const double magnitude_1_s = std::abs(lambda);
        // The piston's eigenvalue is zero but for the differences' rounding; every physical mode is far above.
        constexpr double zero_1_s = 1e-4;
        if (lambda.imag() < 0.0 || magnitude_1_s < zero_1_s) {
            continue;
        }
        const Eigen::Matrix<std::complex<double>, coordinate_count, 1> shape =
            eigen.eigenvectors().col(i).segment<coordinate_count>(velocity_offset);
        const auto energy = (shape.conjugate().array() * (mass * shape).array()).real().abs().eval();
        Eigen::Index dominant = 0;
        energy.maxCoeff(&dominant);
        modes.push_back({.frequency_Hz = magnitude_1_s / (2.0 * std::numbers::pi),
                         .damping_ratio = -lambda.real() / magnitude_1_s,
                         .dominant = static_cast<Coordinate>(dominant)});
    }
    std::ranges::sort(modes, {}, &LinearMode::frequency_Hz);
    return modes;
}

const char* coordinate_name(Coordinate coordinate) noexcept {
    constexpr const char* names[coordinate_count] = {"R1", "phi2", "R9", "q1", "q2", "phi6", "phi9"};
    return coordinate >= 0 && coordinate < coordinate_count ? names[coordinate] : "?";
}

}  // namespace steadyboom::plant
