#include <chrono>

#include <fmt/format.h>

#include "hil/benchmark/rounds.hpp"
#include "hil/benchmark/row.hpp"
#include "hil/lockstep_run.hpp"

namespace steadyboom::hil::benchmark {

namespace {

Measurement measure_lockstep(int rounds) {
    const RunOptions options{.crane_case = load_case("case-a"), .law = controllers::LawKind::joint_deflection};
    const RunResult first = run_in_lockstep(options);
    if (!first.stayed_engaged) {
        return Measurement::disagreement("the run did not stay in command: " + first.trouble);
    }
    const double simulated_s = options.duration_s + RunResult::standing_s;
    std::vector<double> speeds, cpu_speeds;
    bool repeatable = true;
    for (int round = 0; round < rounds; ++round) {
        const std::int64_t cpu_begin_ns = thread_cpu_ns();
        const auto begin = std::chrono::steady_clock::now();
        const RunResult run = run_in_lockstep(options);
        const std::chrono::duration<double> wall_s = std::chrono::steady_clock::now() - begin;
        speeds.push_back(simulated_s / wall_s.count());
        cpu_speeds.push_back(simulated_s * 1e9 / static_cast<double>(thread_cpu_ns() - cpu_begin_ns));
        repeatable = repeatable && run.ticks.size() == first.ticks.size() &&
                     run.ticks.back().record.estimate == first.ticks.back().record.estimate &&
                     run.frames.size() == first.frames.size();
    }
    if (!repeatable) {
        return Measurement::disagreement("two runs with the same options ended differently");
    }
    return {.value = median(speeds),
            .figures = {{"one run of case A", simulated_s, "simulated s"},
                        {"by CPU time", median(cpu_speeds), "simulated s/s"}},
            .remark = "law joint-deflection at 200 Hz, by the clock on the wall: what else the machine does is in it"};
}

}  // namespace

std::vector<Row> lockstep_rows() {
    return {{"lockstep",
             "lockstep closed loop, simulated s per wall s",
             "real time",
             {.at_most = false, .must = 100.0, .aim = 500.0},
             measure_lockstep}};
}

}  // namespace steadyboom::hil::benchmark
