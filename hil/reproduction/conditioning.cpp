#include "hil/reproduction/conditioning.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "hil/true_crane.hpp"
#include "plant/adaptive_runge_kutta.hpp"
#include "plant/mass_matrix_solver.hpp"

namespace steadyboom::hil::reproduction {

namespace {

/// Of a symmetric positive definite matrix, whose eigenvalues are its singular values.
template <class Matrix>
double condition_of(const Matrix& M) {
    const auto values = Eigen::SelfAdjointEigenSolver<Matrix>(M, Eigen::EigenvaluesOnly).eigenvalues().eval();
    return values.maxCoeff() / values.minCoeff();
}

template <class Matrix>
Matrix with_unit_diagonal(const Matrix& M) {
    const auto inverse_root = M.diagonal().cwiseSqrt().cwiseInverse().eval();
    return inverse_root.asDiagonal() * M * inverse_root.asDiagonal();
}

template <class Boom>
Conditioning along(const std::string& name, const SimulationOptions& options) {
    using Crane = plant::CraneDynamicsOf<Boom>;
    using State = typename Crane::State;
    using Coordinates = typename Crane::Coordinates;
    using MassMatrix = typename Crane::MassMatrix;
    const TrueCrane<Boom> true_crane(options.crane_case.crane);
    const Crane& crane = true_crane.dynamics();
    State start = true_crane.equilibrium().state;
    const MassMatrix at_rest = crane.mass_matrix(plant::coordinates_of(start));
    Conditioning result{.run = name,
                        .condition_at_rest = condition_of(at_rest),
                        .scaled_condition_at_rest = condition_of(with_unit_diagonal(at_rest)),
                        .rows = Crane::Layout::coordinate_count};
    for (int i = 0; i < result.rows; ++i) {
        result.rows_without_dominant_diagonal +=
            at_rest.row(i).cwiseAbs().sum() - at_rest(i, i) >= at_rest(i, i) ? 1 : 0;
    }
    start[Crane::Layout::velocity_offset + plant::R9_m] = options.crane_case.manoeuvre.brake_rate_m_s();
    plant::AdaptiveRungeKutta<State> integrator(
        0.0, start, {.relative = options.tolerance, .absolute = State::Constant(0.1 * options.tolerance)});
    while (integrator.time_s() < options.duration_s) {
        integrator.advance([&](double, const State& x) { return crane.derivative(x, 0.0); });
        const State& state = integrator.state();
        const Coordinates p = plant::coordinates_of(state);
        const MassMatrix M = crane.mass_matrix(p);
        result.worst_condition = std::max(result.worst_condition, condition_of(M));
        result.worst_scaled_condition = std::max(result.worst_scaled_condition, condition_of(with_unit_diagonal(M)));
        const Coordinates Q =
            crane.generalized_force(p, plant::velocities_of(state), state[Crane::Layout::piston_index]);
        const Coordinates pivoted = M.fullPivLu().solve(Q);
        const Coordinates difference = plant::solve_mass_matrix(M, Q) - pivoted;
        const Coordinates root = M.diagonal().cwiseSqrt();
        result.solver_difference = std::max(result.solver_difference,
                                            root.cwiseProduct(difference).norm() / root.cwiseProduct(pivoted).norm());
    }
    return result;
}

}  // namespace

Conditioning conditioning_of(const ThesisRun& run) {
    return with_boom(run.options().crane_case.boom,
                     [&]<class Boom>(std::type_identity<Boom>) { return along<Boom>(run.name(), run.options()); });
}

}  // namespace steadyboom::hil::reproduction
