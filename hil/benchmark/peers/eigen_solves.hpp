#pragma once

#include "plant/crane_state.hpp"

namespace steadyboom::hil::benchmark {

/// Eigen's dense solvers on the mass matrix. Full pivoting is what the thesis's Gauss elimination does.
[[nodiscard]] plant::Coordinates solve_full_piv_lu(const plant::MassMatrix& M, const plant::Coordinates& b);
[[nodiscard]] plant::Coordinates solve_partial_piv_lu(const plant::MassMatrix& M, const plant::Coordinates& b);
[[nodiscard]] plant::Coordinates solve_llt(const plant::MassMatrix& M, const plant::Coordinates& b);

}  // namespace steadyboom::hil::benchmark
