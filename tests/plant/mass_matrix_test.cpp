#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "boom_cases.hpp"
#include "plant/mass_matrix_solver.hpp"
#include "random_states.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

constexpr int states = 10'000;

template <class Case>
class MassMatrixOf : public testing::Test {
  protected:
    /// Every configuration a crane of this kind could reach and many it could not.
    template <class Check>
    void over_the_state_range(const Check& check) {
        const typename Case::Crane crane(test_support::thesis_crane(Case::name));
        RandomStates random(crane, 77U + static_cast<unsigned char>(Case::name));
        for (int i = 0; i < states; ++i) {
            SCOPED_TRACE(testing::Message() << "state " << i);
            typename Case::Coordinates p;
            p[R1_m] = random.between(-1.0, 1.0);
            p[phi2_rad] = random.between(-0.8, 0.8);
            p[R9_m] = random.between(2.0, 80.0);
            for (int j = Case::Layout::boom_index; j < Case::Layout::phi6_index; ++j) {
                p[j] = random.between(-1.0, 1.0);
            }
            p[Case::Layout::phi6_index] = random.between(-0.2, 1.8);
            p[Case::Layout::phi9_index] = random.between(-3.1, 3.1);
            check(crane.mass_matrix(p), random);
            if (testing::Test::HasFatalFailure()) {
                return;
            }
        }
    }
};

TYPED_TEST_SUITE(MassMatrixOf, BoomCases, BoomCaseName);

/// Rows and columns scaled to a unit diagonal, which takes the mix of m and rad out of the condition number.
template <class Matrix>
Matrix scaled(const Matrix& M) {
    const auto inverse_root = M.diagonal().cwiseSqrt().cwiseInverse().eval();
    return inverse_root.asDiagonal() * M * inverse_root.asDiagonal();
}

TYPED_TEST(MassMatrixOf, IsSymmetricPositiveDefiniteAndWellConditioned) {
    double worst = 0.0;
    this->over_the_state_range([&](const typename TypeParam::MassMatrix& M, RandomStates<typename TypeParam::Boom>&) {
        ASSERT_EQ(M, M.transpose().eval());
        const Eigen::SelfAdjointEigenSolver<typename TypeParam::MassMatrix> eigen(scaled(M), Eigen::EigenvaluesOnly);
        ASSERT_GT(eigen.eigenvalues().minCoeff(), 0.0);
        worst = std::max(worst, eigen.eigenvalues().maxCoeff() / eigen.eigenvalues().minCoeff());
    });
    this->RecordProperty("worst_condition", std::to_string(worst));
    EXPECT_LT(worst, 1e4);
}

TYPED_TEST(MassMatrixOf, SolveAgreesWithPivotedLu) {
    this->over_the_state_range(
        [&](const typename TypeParam::MassMatrix& M, RandomStates<typename TypeParam::Boom>& random) {
            typename TypeParam::Coordinates force;
            for (int i = 0; i < TypeParam::Layout::coordinate_count; ++i) {
                force[i] = random.between(-1e7, 1e7);
            }
            const typename TypeParam::Coordinates x = solve_mass_matrix(M, force);
            const typename TypeParam::Coordinates expected = M.fullPivLu().solve(force);
            // Compared in the scaling in which the condition number is bounded.
            const typename TypeParam::Coordinates root = M.diagonal().cwiseSqrt();
            ASSERT_LT(root.cwiseProduct(x - expected).norm(), 1e-11 * root.cwiseProduct(expected).norm());
        });
}

TYPED_TEST(MassMatrixOf, SolveReadsTheLowerTriangleOnly) {
    this->over_the_state_range([&](typename TypeParam::MassMatrix M, RandomStates<typename TypeParam::Boom>& random) {
        const typename TypeParam::Coordinates force = TypeParam::Coordinates::Constant(random.between(1.0, 2.0));
        const typename TypeParam::Coordinates x = solve_mass_matrix(M, force);
        M.template triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
        ASSERT_EQ(solve_mass_matrix(M, force), x);
    });
}

}  // namespace
}  // namespace steadyboom::plant
