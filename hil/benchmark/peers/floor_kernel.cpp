#include "hil/benchmark/peers/floor_kernel.hpp"

#include <cmath>

namespace steadyboom::hil::benchmark {

std::array<double, 7> floor_kernel(const std::array<double, 7>& angles_rad) noexcept {
    constexpr int n = 7;
    double s[n];
    double c[n];
    for (int i = 0; i < n; ++i) {
        s[i] = std::sin(angles_rad[static_cast<std::size_t>(i)]);
        c[i] = std::cos(angles_rad[static_cast<std::size_t>(i)]);
    }
    double L[n][n];
    double inverse_d[n];
#pragma GCC unroll 7
    for (int j = 0; j < n; ++j) {
        double d = 20.0;
#pragma GCC unroll 7
        for (int k = 0; k < j; ++k) {
            const double unscaled = L[j][k];
            L[j][k] = unscaled * inverse_d[k];
            d -= unscaled * L[j][k];
        }
        inverse_d[j] = 1.0 / d;
#pragma GCC unroll 7
        for (int i = j + 1; i < n; ++i) {
            L[i][j] = c[i] * c[j] + s[i] * s[j];
#pragma GCC unroll 7
            for (int k = 0; k < j; ++k) {
                L[i][j] -= L[i][k] * L[j][k];
            }
        }
    }
    std::array<double, n> x;
#pragma GCC unroll 7
    for (int i = 0; i < n; ++i) {
        double sum = s[i];
#pragma GCC unroll 7
        for (int k = 0; k < i; ++k) {
            sum -= L[i][k] * x[static_cast<std::size_t>(k)];
        }
        x[static_cast<std::size_t>(i)] = sum;
    }
#pragma GCC unroll 7
    for (int i = n - 1; i >= 0; --i) {
        double sum = x[static_cast<std::size_t>(i)] * inverse_d[i];
#pragma GCC unroll 7
        for (int k = i + 1; k < n; ++k) {
            sum -= L[k][i] * x[static_cast<std::size_t>(k)];
        }
        x[static_cast<std::size_t>(i)] = sum;
    }
    return x;
}

}  // namespace steadyboom::hil::benchmark
