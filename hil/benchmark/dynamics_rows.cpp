#include <array>
#include <cmath>

#include <fmt/format.h>

#include "hil/benchmark/falling_load.hpp"
#include "hil/benchmark/peers/eigen_solves.hpp"
#include "hil/benchmark/peers/floor_kernel.hpp"
#include "hil/benchmark/rounds.hpp"
#include "hil/benchmark/row.hpp"
#include "plant/mass_matrix_solver.hpp"
#include "plant/runge_kutta.hpp"

namespace steadyboom::hil::benchmark {

namespace {

constexpr int calls = 16384;
constexpr double step_s = 1e-3;

double derivative_block_ns(const FallingLoad& work) {
    return cpu_ns_per_call(calls, [&](int i) { return work.crane.derivative(work.state(i), 0.0).sum(); });
}

std::array<double, 7> angles(const plant::CraneState& state) {
    std::array<double, 7> result;
    for (std::size_t i = 0; i < result.size(); ++i) {
        result[i] = state[static_cast<int>(i)];
    }
    return result;
}

double sum(const std::array<double, 7>& values) {
    double total = 0.0;
    for (const double value : values) {
        total += value;
    }
    return total;
}

/// Largest residual of the system that the floor kernel says it solved.
double floor_kernel_residual(const std::array<double, 7>& angles_rad) {
    const std::array<double, 7> x = floor_kernel(angles_rad);
    double largest = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        double left = 0.0;
        for (std::size_t j = 0; j < x.size(); ++j) {
            left += (i == j ? 20.0 : std::cos(angles_rad[i] - angles_rad[j])) * x[j];
        }
        largest = std::max(largest, std::abs(left - std::sin(angles_rad[i])));
    }
    return largest;
}

Measurement measure_derivative(int rounds) {
    const FallingLoad work;
    for (const plant::CraneState& state : work.states) {
        const double residual = floor_kernel_residual(angles(state));
        if (!(residual < 1e-12)) {
            return Measurement::disagreement(fmt::format("the floor kernel's residual is {:.1e}", residual));
        }
    }
    const Candidate candidates[] = {
        {"right-hand side", [&] { return derivative_block_ns(work); }},
        {"floor kernel",
         [&] { return cpu_ns_per_call(calls, [&](int i) { return sum(floor_kernel(angles(work.state(i)))); }); }}};
    const Rounds timed(candidates, rounds);
    return {.value = timed.median_ratio(0, 1),
            .figures = {{"right-hand side", timed.median_ns(0), "ns"}, {"floor kernel", timed.median_ns(1), "ns"}},
            .remark = {}};
}

Measurement measure_step(int rounds) {
    const FallingLoad work;
    const auto rate = [&](double, const plant::CraneState& at) { return work.crane.derivative(at, 0.0); };
    const Candidate candidates[] = {{"step",
                                     [&] {
                                         return cpu_ns_per_call(calls / 4, [&](int i) {
                                             return plant::runge_kutta_step(rate, 0.0, work.state(i), step_s).sum();
                                         });
                                     }},
                                    {"right-hand side", [&] { return derivative_block_ns(work); }}};
    const Rounds timed(candidates, rounds);
    return {.value = timed.median_ratio(0, 1) / 4.0,
            .figures = {{"step", timed.median_ns(0), "ns"}, {"right-hand side", timed.median_ns(1), "ns"}},
            .remark = {}};
}

Measurement measure_solve(int rounds) {
    const FallingLoad work;
    struct System {
        plant::MassMatrix M;
        plant::Coordinates b;
    };
    std::array<System, FallingLoad::sample_count> systems;
    for (std::size_t i = 0; i < systems.size(); ++i) {
        const plant::CraneState& state = work.states[i];
        const plant::Coordinates p = plant::coordinates_of(state);
        systems[i] = {work.crane.mass_matrix(p),
                      work.crane.generalized_force(p, plant::velocities_of(state), state[plant::piston_index])};
    }
    struct Solver {
        const char* name;
        plant::Coordinates (*solve)(const plant::MassMatrix&, const plant::Coordinates&);
    };
    constexpr std::array<Solver, 3> peers{
        {{"FullPivLU", solve_full_piv_lu}, {"PartialPivLU", solve_partial_piv_lu}, {"LLT", solve_llt}}};
    for (const System& system : systems) {
        const plant::Coordinates ours = plant::solve_mass_matrix(system.M, system.b);
        for (const Solver& peer : peers) {
            const double off = (peer.solve(system.M, system.b) - ours).norm() / ours.norm();
            if (!(off < 1e-10)) {
                return Measurement::disagreement(fmt::format("{} is {:.1e} off, relatively", peer.name, off));
            }
        }
    }
    const auto block_ns = [&](const auto& solve) {
        return cpu_ns_per_call(calls, [&](int i) {
            const System& system = systems[static_cast<std::size_t>(i) % systems.size()];
            return solve(system.M, system.b).sum();
        });
    };
    std::vector<Candidate> candidates{{"ours", [&] {
                                           return block_ns([](const plant::MassMatrix& M, const plant::Coordinates& b) {
                                               return plant::solve_mass_matrix(M, b);
                                           });
                                       }}};
    for (const Solver& peer : peers) {
        candidates.push_back({peer.name, [&, peer] { return block_ns(peer.solve); }});
    }
    const Rounds timed(candidates, rounds);
    Measurement result{.value = timed.median_ratio(1, 0), .figures = {}, .remark = {}};
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        result.figures.push_back({candidates[i].name, timed.median_ns(i), "ns"});
    }
    return result;
}

}  // namespace

std::vector<Row> dynamics_rows() {
    return {{"right-hand-side",
             "right-hand side",
             "floor kernel: 7 sincos + one 7x7 LDLT",
             {.at_most = true, .must = 3.0, .aim = 2.0},
             measure_derivative},
            {"rk4-step", "RK4 step", "4 right-hand sides", {.at_most = true, .must = 1.25, .aim = 1.15}, measure_step},
            {"mass-matrix",
             "mass-matrix solve, times faster",
             "Eigen FullPivLU",
             {.at_most = false, .must = 1.6, .aim = 2.0},
             measure_solve}};
}

}  // namespace steadyboom::hil::benchmark
