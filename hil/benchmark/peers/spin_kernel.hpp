#pragma once

namespace steadyboom::hil::benchmark {

/// Arithmetic in registers alone: what a second thread brings on this machine when no memory is shared.
[[nodiscard]] double spin_kernel(int turns) noexcept;

}  // namespace steadyboom::hil::benchmark
