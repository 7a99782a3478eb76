#pragma once

#include <Eigen/Core>

namespace steadyboom::plant {

/// Solves M x = b for a symmetric positive definite M by an LDL' factorisation without pivoting, unrolled at
/// compile time. `M` is read in its lower triangle only. Where M is not positive definite the result is not finite or
/// wrong; the mass matrix of any crane with positive masses is (tests/plant/mass_matrix_test.cpp).
template <int n>
[[nodiscard]] inline Eigen::Matrix<double, n, 1> solve_mass_matrix(const Eigen::Matrix<double, n, n>& M,
                                                                   const Eigen::Matrix<double, n, 1>& b) noexcept {
    double L[n][n];
    double inverse_d[n];
    double x[n];
#pragma GCC unroll 8
    for (int j = 0; j < n; ++j) {
        double scaled[n];
        double d = M(j, j);
#pragma GCC unroll 8
        for (int k = 0; k < j; ++k) {
            // L[j][k] still holds the unscaled entry L d; dividing here saves one pass over the column.
            scaled[k] = L[j][k];
            L[j][k] *= inverse_d[k];
            d -= scaled[k] * L[j][k];
        }
        inverse_d[j] = 1.0 / d;
#pragma GCC unroll 8
        for (int i = j + 1; i < n; ++i) {
            double sum = M(i, j);
#pragma GCC unroll 8
            for (int k = 0; k < j; ++k) {
                sum -= L[i][k] * L[j][k];
            }
            L[i][j] = sum;
        }
    }
#pragma GCC unroll 8
    for (int i = 0; i < n; ++i) {
        double sum = b[i];
#pragma GCC unroll 8
        for (int k = 0; k < i; ++k) {
            sum -= L[i][k] * x[k];
        }
        x[i] = sum;
    }
    Eigen::Matrix<double, n, 1> result;
#pragma GCC unroll 8
    for (int i = n - 1; i >= 0; --i) {
        double sum = x[i] * inverse_d[i];
#pragma GCC unroll 8
        for (int k = i + 1; k < n; ++k) {
            sum -= L[k][i] * x[k];
        }
        x[i] = sum;
        result[i] = sum;
    }
    return result;
}

}  // namespace steadyboom::plant
