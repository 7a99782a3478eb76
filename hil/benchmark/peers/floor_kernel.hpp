#pragma once

#include <array>

namespace steadyboom::hil::benchmark {

/// The least that any right-hand side of seven coordinates costs: the sine and cosine of each coordinate, and one
/// symmetric 7x7 system factored (LDL') and solved. The matrix is 20 on the diagonal and the products c_i c_j + s_i s_j
/// off it, the right-hand side the sines.
[[nodiscard]] std::array<double, 7> floor_kernel(const std::array<double, 7>& angles_rad) noexcept;

}  // namespace steadyboom::hil::benchmark
