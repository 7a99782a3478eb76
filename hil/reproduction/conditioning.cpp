#include "hil/reproduction/conditioning.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "plant/mass_matrix_solver.hpp"

namespace steadyboom::hil::reproduction {

using plant::Coordinates;
using plant::MassMatrix;

namespace {

/// Of a symmetric positive definite matrix, whose eigenvalues are its singular values.
double condition_of(const MassMatrix& M) {
    const Coordinates values = Eigen::SelfAdjointEigenSolver<MassMatrix>(M, Eigen::EigenvaluesOnly).eigenvalues();
    return values.maxCoeff() / values.minCoeff();
}

MassMatrix with_unit_diagonal(const MassMatrix& M) {
    const Coordinates inverse_root = M.diagonal().cwiseSqrt().cwiseInverse();
    return inverse_root.asDiagonal() * M * inverse_root.asDiagonal();
}

}  // namespace

Conditioning conditioning_of(const ThesisRun& run) {
    const plant::CraneDynamics crane(run.options().crane_case.crane);
    const MassMatrix at_rest = crane.mass_matrix(plant::coordinates_of(run.rest().state));
    Conditioning result{.run = run.name(),
                        .condition_at_rest = condition_of(at_rest),
                        .scaled_condition_at_rest = condition_of(with_unit_diagonal(at_rest))};
    for (int i = 0; i < plant::coordinate_count; ++i) {
        result.rows_without_dominant_diagonal +=
            at_rest.row(i).cwiseAbs().sum() - at_rest(i, i) >= at_rest(i, i) ? 1 : 0;
    }
    for (std::size_t sample = 0; sample < run.signal(Signal::R1_m).size(); ++sample) {
        const plant::CraneState state = run.state(sample);
        const MassMatrix M = crane.mass_matrix(plant::coordinates_of(state));
        result.worst_condition = std::max(result.worst_condition, condition_of(M));
        result.worst_scaled_condition = std::max(result.worst_scaled_condition, condition_of(with_unit_diagonal(M)));
        const Coordinates Q = crane.generalized_force(plant::coordinates_of(state), plant::velocities_of(state),
                                                      state[plant::piston_index]);
        const Coordinates pivoted = M.fullPivLu().solve(Q);
        const Coordinates difference = plant::solve_mass_matrix(M, Q) - pivoted;
        const Coordinates root = M.diagonal().cwiseSqrt();
        result.solver_difference = std::max(result.solver_difference,
                                            root.cwiseProduct(difference).norm() / root.cwiseProduct(pivoted).norm());
    }
    return result;
}

}  // namespace steadyboom::hil::reproduction
