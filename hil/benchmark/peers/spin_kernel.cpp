#include "hil/benchmark/peers/spin_kernel.hpp"

namespace steadyboom::hil::benchmark {

double spin_kernel(int turns) noexcept {
    double x = 0.5;
    for (int turn = 0; turn < turns; ++turn) {
        x = 3.9 * x * (1.0 - x);
    }
    return x;
}

}  // namespace steadyboom::hil::benchmark
