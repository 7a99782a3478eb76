#include "hil/benchmark/peers/eigen_solves.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace steadyboom::hil::benchmark {

plant::Coordinates solve_full_piv_lu(const plant::MassMatrix& M, const plant::Coordinates& b) {
    return M.fullPivLu().solve(b);
}

plant::Coordinates solve_partial_piv_lu(const plant::MassMatrix& M, const plant::Coordinates& b) {
    return M.partialPivLu().solve(b);
}

plant::Coordinates solve_llt(const plant::MassMatrix& M, const plant::Coordinates& b) {
    return M.llt().solve(b);
}

}  // namespace steadyboom::hil::benchmark
