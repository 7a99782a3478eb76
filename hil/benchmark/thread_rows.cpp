#include <barrier>
#include <chrono>
#include <thread>

#include "hil/benchmark/falling_load.hpp"
#include "hil/benchmark/peers/spin_kernel.hpp"
#include "hil/benchmark/rounds.hpp"
#include "hil/benchmark/row.hpp"

namespace steadyboom::hil::benchmark {

namespace {

// Both slices take about a millisecond: shorter than what a scheduler gives one program before it gives way to another,
// so that on a busy machine the median slice is still one that was not interrupted.
constexpr int slices = 16;
constexpr int simulated_steps = 1000;
constexpr int spin_turns = 200'000;

/// The median slice of each kind on one thread, by the clock on the wall, the two kinds taking turns.
struct Slices {
    double sweep_ns;
    double spin_ns;
};

template <class Work>
double wall_ns(const Work& work) {
    const auto begin = std::chrono::steady_clock::now();
    volatile double kept = work();
    static_cast<void>(kept);
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count();
}

Slices time_slices(const FallingLoad& work) {
    // Each thread has a crane of its own, as the runs of a sweep have.
    const plant::CraneDynamics crane(work.crane.parameters());
    std::vector<double> sweep_ns, spin_ns;
    for (int slice = 0; slice < slices; ++slice) {
        sweep_ns.push_back(wall_ns([&] { return simulate(crane, work.start, 1e-3, simulated_steps).sum(); }));
        spin_ns.push_back(wall_ns([] { return spin_kernel(spin_turns); }));
    }
    return {median(std::move(sweep_ns)), median(std::move(spin_ns))};
}

Measurement measure_sweep(int rounds) {
    if (std::thread::hardware_concurrency() < 2) {
        return Measurement::absence("one CPU only");
    }
    const FallingLoad work;
    std::vector<double> sweep, spin, ratios;
    for (int round = 0; round < rounds; ++round) {
        const Slices alone = time_slices(work);
        std::barrier<> both_there(2);
        Slices there{};
        std::thread other([&] {
            both_there.arrive_and_wait();
            there = time_slices(work);
        });
        both_there.arrive_and_wait();
        const Slices here = time_slices(work);
        other.join();
        sweep.push_back(alone.sweep_ns / here.sweep_ns + alone.sweep_ns / there.sweep_ns);
        spin.push_back(alone.spin_ns / here.spin_ns + alone.spin_ns / there.spin_ns);
        ratios.push_back(sweep.back() / spin.back());
    }
    return {.value = median(ratios),
            .figures = {{"speed-up of the cranes", median(sweep), ""}, {"of the spin kernel", median(spin), ""}},
            .remark = "2 is perfect"};
}

}  // namespace

std::vector<Row> thread_rows() {
    return {{"two-threads",
             "speed-up of cranes simulated on two threads",
             "spin kernel on two threads",
             {.at_most = false, .must = 0.9, .aim = 0.97},
             measure_sweep}};
}

}  // namespace steadyboom::hil::benchmark
