#pragma once

#include <array>

#include "plant/crane_dynamics.hpp"

namespace steadyboom::hil::benchmark {

/// Case A just after the brake: the work that every row about the plant does.
struct FallingLoad {
    FallingLoad();

    plant::CraneDynamics crane;
    plant::CraneState start;  ///< equilibrium with the load falling

    /// States 20 ms apart of the motion that follows: ropes taut and slack, tracks down and tilted. A power of two,
    /// known to the compiler, so that taking one in turn costs next to nothing.
    static constexpr std::size_t sample_count = 64;
    std::array<plant::CraneState, sample_count> states;

    [[nodiscard]] const plant::CraneState& state(int index) const {
        return states[static_cast<std::size_t>(index) % sample_count];
    }
};

/// Uncontrolled motion over `steps` Runge-Kutta steps.
[[nodiscard]] plant::CraneState simulate(const plant::CraneDynamics& crane, plant::CraneState state, double step_s,
                                         int steps) noexcept;

/// Largest difference of two states, each entry over the larger of 1 (m, rad, m/s, rad/s) and its own size.
[[nodiscard]] double distance(const plant::CraneState& a, const plant::CraneState& b) noexcept;

}  // namespace steadyboom::hil::benchmark
