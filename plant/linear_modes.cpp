#include "plant/linear_modes.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace steadyboom::plant {

template <class Boom>
StateMatrixOf<Boom> state_matrix(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& state,
                                 double valve_opening_m) {
    constexpr double step = 1e-6;
    StateMatrixOf<Boom> A;
    for (int i = 0; i < state.size(); ++i) {
        StateOf<Boom> above = state;
        StateOf<Boom> below = state;
        above[i] += step;
        below[i] -= step;
        A.col(i) = (crane.derivative(above, valve_opening_m) - crane.derivative(below, valve_opening_m)) / (2.0 * step);
    }
    return A;
}

template <class Boom>
std::vector<LinearMode> linear_modes(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& equilibrium) {
    using Layout = typename CraneDynamicsOf<Boom>::Layout;
    const Eigen::EigenSolver<StateMatrixOf<Boom>> eigen(state_matrix(crane, equilibrium, 0.0));
    const typename Layout::MassMatrix mass = crane.mass_matrix(coordinates_of(equilibrium));
    std::vector<LinearMode> modes;
    for (int i = 0; i < Layout::state_count; ++i) {
        const std::complex<double> lambda = eigen.eigenvalues()[i];
        const double magnitude_1_s = std::abs(lambda);
        // The piston's eigenvalue is zero but for the differences' rounding; every physical mode is far above.
        constexpr double zero_1_s = 1e-4;
        if (lambda.imag() < 0.0 || magnitude_1_s < zero_1_s) {
            continue;
        }
        const Eigen::Matrix<std::complex<double>, Layout::coordinate_count, 1> shape =
            eigen.eigenvectors().col(i).template segment<Layout::coordinate_count>(Layout::velocity_offset);
        const auto energy = (shape.conjugate().array() * (mass * shape).array()).real().abs().eval();
        Eigen::Index dominant = 0;
        energy.maxCoeff(&dominant);
        modes.push_back({.frequency_Hz = magnitude_1_s / (2.0 * std::numbers::pi),
                         .damping_ratio = -lambda.real() / magnitude_1_s,
                         .dominant = static_cast<int>(dominant)});
    }
    std::ranges::sort(modes, {}, &LinearMode::frequency_Hz);
    return modes;
}

template <class Boom>
const char* coordinate_name(int coordinate) noexcept {
    using Layout = CraneLayout<Boom::coordinate_count>;
    switch (coordinate) {
        case R1_m:
            return "R1";
        case phi2_rad:
            return "phi2";
        case R9_m:
            return "R9";
        case Layout::phi6_index:
            return "phi6";
        case Layout::phi9_index:
            return "phi9";
        default:
            return coordinate >= Layout::boom_index && coordinate < Layout::phi6_index
                       ? Boom::coordinate_names[static_cast<std::size_t>(coordinate - Layout::boom_index)]
                       : "?";
    }
}

template StateMatrixOf<LinkBoom> state_matrix(const CraneDynamicsOf<LinkBoom>&, const StateOf<LinkBoom>&, double);
template std::vector<LinearMode> linear_modes(const CraneDynamicsOf<LinkBoom>&, const StateOf<LinkBoom>&);
template const char* coordinate_name<LinkBoom>(int) noexcept;
template StateMatrixOf<BeamBoom> state_matrix(const CraneDynamicsOf<BeamBoom>&, const StateOf<BeamBoom>&, double);
template std::vector<LinearMode> linear_modes(const CraneDynamicsOf<BeamBoom>&, const StateOf<BeamBoom>&);
template const char* coordinate_name<BeamBoom>(int) noexcept;

}  // namespace steadyboom::plant
