#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "plant/crane_dynamics.hpp"
#include "random_states.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

constexpr int states = 10'000;

class MassMatrixOf : public testing::TestWithParam<char> {
  protected:
    /// Every configuration a crane of this kind could reach and many it could not.
    template <class Check>
    void over_the_state_range(const Check& check) {
        const CraneDynamics crane(test_support::thesis_crane(GetParam()));
        RandomStates random(crane, 77U + static_cast<unsigned char>(GetParam()));
        for (int i = 0; i < states; ++i) {
            SCOPED_TRACE(testing::Message() << "state " << i);
            Coordinates p;
            p[R1_m] = random.between(-1.0, 1.0);
            p[phi2_rad] = random.between(-0.8, 0.8);
            p[R9_m] = random.between(2.0, 80.0);
            p[q1_m] = random.between(-1.0, 1.0);
            p[q2_m] = random.between(-1.0, 1.0);
            p[phi6_rad] = random.between(-0.2, 1.8);
            p[phi9_rad] = random.between(-3.1, 3.1);
            check(crane.mass_matrix(p), random);
            if (HasFatalFailure()) {
                return;
            }
        }
    }
};

/// Rows and columns scaled to a unit diagonal, which takes the mix of m and rad out of the condition number.
MassMatrix scaled(const MassMatrix& M) {
    const Coordinates inverse_root = M.diagonal().cwiseSqrt().cwiseInverse();
    return inverse_root.asDiagonal() * M * inverse_root.asDiagonal();
}

TEST_P(MassMatrixOf, IsSymmetricPositiveDefiniteAndWellConditioned) {
    double worst = 0.0;
    over_the_state_range([&](const MassMatrix& M, RandomStates&) {
        ASSERT_EQ(M, MassMatrix(M.transpose()));
        const Eigen::SelfAdjointEigenSolver<MassMatrix> eigen(scaled(M), Eigen::EigenvaluesOnly);
        ASSERT_GT(eigen.eigenvalues().minCoeff(), 0.0);
        worst = std::max(worst, eigen.eigenvalues().maxCoeff() / eigen.eigenvalues().minCoeff());
    });
    RecordProperty("worst_condition", std::to_string(worst));
    EXPECT_LT(worst, 1e4);
}

TEST_P(MassMatrixOf, SolveAgreesWithPivotedLu) {
    over_the_state_range([&](const MassMatrix& M, RandomStates& random) {
        Coordinates force;
        for (int i = 0; i < coordinate_count; ++i) {
            force[i] = random.between(-1e7, 1e7);
        }
        const Coordinates x = solve_mass_matrix(M, force);
        const Coordinates expected = M.fullPivLu().solve(force);
        // Compared in the scaling in which the condition number is bounded.
        const Coordinates root = M.diagonal().cwiseSqrt();
        ASSERT_LT(root.cwiseProduct(x - expected).norm(), 1e-11 * root.cwiseProduct(expected).norm());
    });
}

TEST_P(MassMatrixOf, SolveReadsTheLowerTriangleOnly) {
    over_the_state_range([&](MassMatrix M, RandomStates& random) {
        const Coordinates force = Coordinates::Constant(random.between(1.0, 2.0));
        const Coordinates x = solve_mass_matrix(M, force);
        M.triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
        ASSERT_EQ(solve_mass_matrix(M, force), x);
    });
}

INSTANTIATE_TEST_SUITE_P(Thesis, MassMatrixOf, testing::Values('A', 'B', 'C'),
                         [](const auto& test) { return std::string("Case") + test.param; });

}  // namespace
}  // namespace steadyboom::plant
