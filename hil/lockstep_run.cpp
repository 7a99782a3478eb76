#include "hil/lockstep_run.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "drivers/loopback_bus.hpp"
#include "hil/virtual_crane.hpp"

namespace steadyboom::hil {

namespace {

using controllers::InterlockState;
using runtime::OperatorCommand;

/// The operator of a lockstep run: arms when ready, engages when armed, and is never impatient.
class ScriptedOperator {
  public:
    explicit ScriptedOperator(runtime::OperatorMailbox& mailbox) : mailbox_(mailbox) {}

    void act(InterlockState state) noexcept {
        while (mailbox_.try_pop_answer()) {
            waiting_ = false;
        }
        if (waiting_) {
            return;
        }
        if (state == InterlockState::ready) {
            ask(OperatorCommand::arm);
        } else if (state == InterlockState::hold) {
            ask(OperatorCommand::engage);
        }
    }

  private:
    void ask(OperatorCommand command) noexcept {
        waiting_ = mailbox_.try_push({.serial = ++serial_, .command = command});
    }

    runtime::OperatorMailbox& mailbox_;
    std::uint64_t serial_ = 0;
    bool waiting_ = false;
};

}  // namespace

runtime::ControlTickConfig control_config(const RunOptions& options) {
    runtime::CraneFile controllers_copy = options.crane_case;
    for (const std::string& mismatch : options.mismatches) {
        runtime::apply_mismatch(controllers_copy, mismatch);
    }
    const plant::ActuatorParameters& actuator = controllers_copy.crane.actuator;
    // A spool crosses its travel in about a third of its natural period; asking for more is pointless. And the guard
    // knows no step larger than the travel.
    const double max_slew_m_s =
        std::min(3.0 * actuator.spool_bandwidth_Hz, 0.9 * options.rate_Hz) * actuator.spool_travel_m;
    return {.crane = controllers_copy.crane,
            .law = options.law,
            .gains = controllers_copy.gains,
            .network = {.spool_travel_m = actuator.spool_travel_m,
                        .period_ns = std::llround(1e9 / options.rate_Hz)},
            .max_opening_m = actuator.spool_travel_m,
            .max_slew_m_s = max_slew_m_s};
}

RunResult run_in_lockstep(const RunOptions& options) {
    const runtime::ControlTickConfig config = control_config(options);
    const std::int64_t period_ns = config.network.period_ns;
    const double period_s = 1e-9 * static_cast<double>(period_ns);

    constexpr double finest_step_s = 0.0005;
    const int steps = std::max(1, static_cast<int>(std::ceil(period_s / finest_step_s - 1e-9)));
    drivers::NetworkConfig crane_network = config.network;
    crane_network.spool_travel_m = options.crane_case.crane.actuator.spool_travel_m;
    VirtualCrane crane({.crane = options.crane_case.crane,
                        .network = crane_network,
                        .step_s = period_s / steps,
                        .seed = options.seed});

    drivers::LoopbackBus bus(2);
    drivers::CanBus& controller_end = bus.endpoint(0);
    drivers::CanBus& crane_end = bus.endpoint(1);
    runtime::SimulatedClock clock;
    runtime::OperatorMailbox mailbox;
    runtime::TickRingWriter<runtime::TickRecord> ring(runtime::TickRingOptions{.capacity_records = 2});
    const auto tick = std::make_unique<runtime::ControlTick>(config, controller_end, clock, mailbox, ring);
    ScriptedOperator scripted_operator(mailbox);

    const auto brake_tick = static_cast<std::int64_t>(std::ceil(RunResult::standing_s / period_s - 1e-9));
    const auto last_tick = brake_tick + static_cast<std::int64_t>(std::floor(options.duration_s / period_s + 1e-9));
    RunResult result{.options = options, .bus = "loopback"};
    result.ticks.reserve(static_cast<std::size_t>(last_tick) + 1);
    result.frames.reserve(static_cast<std::size_t>(last_tick + 1) * drivers::message_count);
    bus.set_tap([&](const drivers::CanFrame& frame) {
        // Never beyond what is reserved: the tap runs inside the tick, which must not allocate.
        if (result.frames.size() < result.frames.capacity()) {
            result.frames.push_back(frame);
            result.frames.back().stamp_ns = clock.now_ns();
        }
    });

    FigureAccumulator figures(crane.dynamics(), crane.equilibrium(), options.duration_s);
    std::array<drivers::CanFrame, 2 * drivers::message_count> arrived;
    bool engaged_throughout = true;
    std::uint32_t trouble = 0;
    for (std::int64_t k = 0; k <= last_tick; ++k) {
        const std::int64_t now_ns = k * period_ns;
        const double t_s = static_cast<double>(k - brake_tick) * period_s;
        clock.sleep_until(now_ns);
        if (k == brake_tick) {
            crane.brake(options.crane_case.manoeuvre.brake_rate_m_s());
        }
        const TruthSample truth = crane.truth(t_s);
        figures.add(truth);
        tick->run({.tick = static_cast<std::uint64_t>(k), .due_ns = now_ns, .woke_ns = now_ns});
        result.ticks.push_back({.record = tick->record(), .truth = truth});

        const auto state = static_cast<InterlockState>(tick->record().interlock_state);
        scripted_operator.act(state);
        if (k >= brake_tick && state != InterlockState::active) {
            engaged_throughout = false;
            trouble |= tick->record().permission_reasons;
        }

        const std::size_t count = crane_end.receive(arrived);
        crane.receive({arrived.data(), count}, now_ns);
        const auto answers = crane.frames_to_send(now_ns);
        crane_end.send(answers);
        for (int step = 0; step < steps; ++step) {
            crane.advance(now_ns + step * period_ns / steps);
            if (step + 1 < steps) {
                figures.add(crane.truth(t_s + (step + 1) * period_s / steps));
            }
        }
    }
    result.figures = figures.figures();
    result.stayed_engaged = engaged_throughout;
    result.trouble = controllers::reasons_in_words(trouble);
    return result;
}

}  // namespace steadyboom::hil
