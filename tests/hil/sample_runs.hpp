#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "controllers/interlock.hpp"
#include "hil/run_result.hpp"
#include "hil/true_crane.hpp"
#include "plant/valve_command.hpp"

namespace steadyboom::hil {

/// A short run whose numbers a test can know: R1 swings by `peak_R1_m`, samples come with every tick from the third on,
/// but for the boom angle, which is always one tick old, and the line angle, which the device calls bad.
inline RunResult sample_run(controllers::LawKind law, double peak_R1_m) {
    RunResult run;
    run.options.crane_case = load_case("case-a");
    run.options.law = law;
    run.options.duration_s = 1.0;
    run.options.seed = 7;
    run.bus = "loopback";
    run.stayed_engaged = true;
    run.epoch_ns = 1'000'000'000;
    run.figures.peak_R1_m = peak_R1_m;
    run.figures.residual_energy_J = 1e6 * peak_R1_m;
    run.figures.peak_power_W = law == controllers::LawKind::none ? 0.0 : 17'000.0;

    const TrueCrane<plant::LinkBoom> crane(run.options.crane_case.crane);
    for (int k = 0; k <= 1200; ++k) {
        RunTick tick;
        const double t_s = 0.005 * k - RunResult::standing_s;
        plant::CraneState state = crane.equilibrium().state;
        if (t_s > 0.0) {
            state[plant::R1_m] += peak_R1_m * std::sin(9.0 * t_s);
        }
        tick.truth = crane.sample(state, 1e-3 * std::sin(7.0 * t_s), t_s);
        tick.record.tick = static_cast<std::uint64_t>(k);
        for (std::size_t i = 0; i < plant::state_count; ++i) {
            tick.record.estimate[i] = state[static_cast<Eigen::Index>(i)] + 1e-5;
        }
        for (std::size_t sensor = 0; sensor < plant::sensor_count; ++sensor) {
            tick.record.measured[sensor] = 0.1 * static_cast<double>(sensor + 1);
            tick.record.measured_age_ticks[sensor] =
                k < 2 ? plant::CraneMeasurement::never : (sensor == plant::boom_angle_rad ? 1U : 0U);
        }
        tick.record.measured_valid_bits = 0x1FFU & ~(1U << plant::line_angle_rad);
        tick.record.samples_stamp_ns = k < 2 ? 0 : run.epoch_ns + (k - 1) * std::int64_t{5'000'000};
        tick.record.wanted_opening_m = 2e-3;
        tick.record.limited_opening_m = 1.5e-3;
        tick.record.applied_opening_m = 1.25e-3;
        tick.record.authority = 0.75;
        tick.record.limit_reasons = plant::limit_authority | plant::limit_slew;
        tick.record.permission_reasons = controllers::reason_not_armed;
        tick.record.observer_nis = 8.5;
        tick.record.interlock_state = static_cast<std::uint8_t>(controllers::InterlockState::engaging);
        run.ticks.push_back(tick);
    }
    run.frames.push_back({.id = 0x80, .stamp_ns = 1'500'000'000});
    run.frames.push_back({.id = 0x1A0, .length = 2, .data = {0xAB, 0x01}, .stamp_ns = 1'500'250'000});
    return run;
}

/// One run with each law, the joint deflection's the quietest.
inline std::vector<RunResult> sample_runs() {
    using enum controllers::LawKind;
    return {sample_run(none, 2e-3), sample_run(boom_angle, 3e-3), sample_run(joint_deflection, 0.5e-3),
            sample_run(swing_rate, 26.4e-3)};
}

}  // namespace steadyboom::hil
