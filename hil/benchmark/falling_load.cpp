#include "hil/benchmark/falling_load.hpp"

#include "hil/case_file.hpp"
#include "plant/equilibrium.hpp"
#include "plant/runge_kutta.hpp"

namespace steadyboom::hil::benchmark {

namespace {

constexpr double sampling_step_s = 1e-3;
constexpr int steps_between_samples = 20;

}  // namespace

FallingLoad::FallingLoad() : crane(load_case("case-a").crane), start(plant::find_equilibrium(crane).state) {
    start[plant::velocity_offset + plant::R9_m] = load_case("case-a").manoeuvre.brake_rate_m_s();
    plant::CraneState state = start;
    for (plant::CraneState& sample : states) {
        sample = state;
        state = simulate(crane, state, sampling_step_s, steps_between_samples);
    }
}

plant::CraneState simulate(const plant::CraneDynamics& crane, plant::CraneState state, double step_s,
                           int steps) noexcept {
    const auto rate = [&crane](double, const plant::CraneState& at) { return crane.derivative(at, 0.0); };
    for (int step = 0; step < steps; ++step) {
        state = plant::runge_kutta_step(rate, step * step_s, state, step_s);
    }
    return state;
}

double distance(const plant::CraneState& a, const plant::CraneState& b) noexcept {
    return ((a - b).array().abs() / b.array().abs().max(1.0)).maxCoeff();
}

}  // namespace steadyboom::hil::benchmark
