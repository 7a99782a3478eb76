// steadyboom-plant: the virtual crane as a real-time process of its own on a SocketCAN interface.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include <spdlog/spdlog.h>

#include "drivers/socketcan_bus.hpp"
#include "hil/plant_config.hpp"
#include "hil/plant_record.hpp"
#include "hil/virtual_crane.hpp"
#include "runtime/bus_tender.hpp"
#include "runtime/periodic_loop.hpp"
#include "runtime/realtime_thread.hpp"
#include "runtime/service_program.hpp"
#include "runtime/tick_ring.hpp"

using namespace steadyboom;

namespace {

constexpr int exit_done = 0;
constexpr int exit_failed = 1;

/// The crane moves in steps of step_ns and looks at the bus every wake_ns; a SYNC waits no longer than that.
constexpr std::int64_t step_ns = 500'000;
constexpr std::int64_t wake_ns = 1'000'000;
/// Time that may be caught up with at once after a late wake-up. Beyond it the crane has lost real time.
constexpr std::uint64_t most_wakes_behind = 200;

hil::PlantRecord record_of(const hil::TruthSample& truth, std::uint64_t step, std::int64_t time_ns,
                           std::uint64_t valve_timeouts) {
    hil::PlantRecord record{.step = step,
                            .time_ns = time_ns,
                            .t_s = truth.t_s,
                            .spool_m = truth.spool_m,
                            .pendent_tension_N = truth.pendent_tension_N,
                            .load_line_tension_N = truth.load_line_tension_N,
                            .chord_m = truth.chord_m,
                            .contact_fraction = truth.contact_fraction,
                            .load_pressure_Pa = truth.load_pressure_Pa,
                            .hydraulic_power_W = truth.hydraulic_power_W,
                            .residual_energy_J = truth.residual_energy_J,
                            .boom_energy_J = truth.boom_energy_J,
                            .valve_timeouts = valve_timeouts};
    std::copy(truth.state.begin(), truth.state.end(), record.state.begin());
    return record;
}

int stand_in_for_the_crane(const hil::PlantConfig& config) {
    hil::VirtualCrane crane({.crane = config.crane_case.crane,
                             .boom = config.crane_case.boom,
                             .network = config.network,
                             .step_s = 1e-9 * static_cast<double>(step_ns),
                             .seed = static_cast<std::uint64_t>(config.seed)});
    drivers::SocketCanBus bus(config.interface, {.filters = crane.network().filters(), .expect_remote = false});
    const runtime::BusTender tender(bus);
    runtime::TickRingWriter<hil::PlantRecord> ring(config.ring_path,
                                                   {.capacity_records = 1 << 15, .period_ns = step_ns});

    const auto standing_steps = std::llround(config.standing_s * 1e9 / static_cast<double>(step_ns));
    const auto last_step = standing_steps + std::llround(config.duration_s * 1e9 / static_cast<double>(step_ns));
    const auto t_s = [&](std::int64_t step) { return 1e-9 * static_cast<double>((step - standing_steps) * step_ns); };

    const runtime::RealtimeGrant grant = runtime::become_realtime(
        {.policy = config.realtime_priority > 0 ? runtime::SchedulingPolicy::fifo : runtime::SchedulingPolicy::other,
         .priority = config.realtime_priority,
         .cpu = config.realtime_cpu >= 0 ? std::optional(config.realtime_cpu) : std::nullopt});
    for (const runtime::RealtimeRefusal& refusal : grant.refusals) {
        spdlog::warn("not real-time: {}", refusal.message());
    }

    runtime::MonotonicClock clock;
    const std::int64_t epoch_ns = clock.now_ns() + wake_ns;
    runtime::PeriodicLoop loop(clock, wake_ns, epoch_ns);
    spdlog::info("{} with boom {} on {}: brake event {} s from now, end {} s after it; {}", config.crane_case.name,
                 hil::name_of(config.crane_case.boom), config.interface, config.standing_s, config.duration_s,
                 grant.summary());
    std::array<drivers::CanFrame, 512> frames;
    std::int64_t step = 0;
    ring.push(record_of(crane.truth(t_s(0)), 0, epoch_ns, 0));
    while (step < last_step && !runtime::stop_requested().load(std::memory_order_relaxed)) {
        const runtime::TickStart start = loop.wait();
        if (start.skipped_ticks > most_wakes_behind) {
            spdlog::error("lost real time: the machine gave this process no time for {} ms",
                          static_cast<double>(start.skipped_ticks) * 1e-6 * static_cast<double>(wake_ns));
            return exit_failed;
        }
        // Orders first: they came before this instant, and after a late wake-up they have waited longest.
        const std::size_t count = bus.receive(frames);
        crane.receive({frames.data(), count}, start.woke_ns);
        for (; step < last_step && epoch_ns + (step + 1) * step_ns <= start.due_ns; ++step) {
            if (step == standing_steps) {
                crane.brake(config.crane_case.manoeuvre.brake_rate_m_s());
            }
            crane.advance(epoch_ns + step * step_ns);
            ring.push(record_of(crane.truth(t_s(step + 1)), static_cast<std::uint64_t>(step + 1),
                                epoch_ns + (step + 1) * step_ns, crane.valve().timeouts()));
        }
        bus.send(crane.frames_to_send(start.woke_ns));
        loop.finish();
    }
    const drivers::BusStatus status = bus.status();
    spdlog::info("ended at t = {} s; {} frames received, {} sent, {} lost; valve timed out {} times; {} late wake-ups",
                 t_s(step), status.received_frames, status.sent_frames,
                 status.send_dropped_frames + status.receive_overflow_frames, crane.valve().timeouts(),
                 loop.statistics().overruns.load());
    return exit_done;
}

}  // namespace

int main(int argc, char** argv) {
    return runtime::run_service(
        {.name = "steadyboom-plant",
         .purpose = "The virtual crane on a CAN interface: devices, sensors, valve and the true crane behind them.",
         .config_form = "hil/plant.toml",
         .work =
             [](const std::filesystem::path& config) {
                 return stand_in_for_the_crane(hil::load_plant_config(config));
             }},
        argc, argv);
}
