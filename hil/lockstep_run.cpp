#include "hil/lockstep_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

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
    drivers::NetworkConfig network = options.network;
    network.spool_travel_m = actuator.spool_travel_m;
    network.period_ns = std::llround(1e9 / options.rate_Hz);
    return {.crane = controllers_copy.crane,
            .law = options.law,
            .gains = controllers_copy.gains,
            .network = network,
            .max_opening_m = actuator.spool_travel_m,
            .max_slew_m_s = max_slew_m_s};
}

namespace {

constexpr double finest_step_s = 0.0005;

int steps_per_tick(std::int64_t period_ns) {
    return std::max(1, static_cast<int>(std::ceil(1e-9 * static_cast<double>(period_ns) / finest_step_s - 1e-9)));
}

VirtualCraneConfig crane_config(const RunOptions& options, const runtime::ControlTickConfig& config) {
    drivers::NetworkConfig network = config.network;
    network.spool_travel_m = options.crane_case.crane.actuator.spool_travel_m;
    return {.crane = options.crane_case.crane,
            .boom = options.crane_case.boom,
            .network = network,
            .step_s = 1e-9 * static_cast<double>(network.period_ns) / steps_per_tick(network.period_ns),
            .seed = options.seed};
}

}  // namespace

struct LockstepBench::Parts {
    explicit Parts(const RunOptions& options)
        : config(control_config(options)),
          period_ns(config.network.period_ns),
          period_s(1e-9 * static_cast<double>(period_ns)),
          steps(steps_per_tick(period_ns)),
          brake_tick(static_cast<std::int64_t>(std::ceil(RunResult::standing_s / period_s - 1e-9))),
          last_tick(brake_tick + static_cast<std::int64_t>(std::floor(options.duration_s / period_s + 1e-9))),
          crane(crane_config(options, config)),
          tick(config, bus.endpoint(0), clock, mailbox, ring),
          scripted_operator(mailbox),
          figures(crane.equilibrium().state, options.duration_s),
          result{.options = options, .bus = "loopback", .stayed_engaged = true} {
        result.ticks.reserve(static_cast<std::size_t>(last_tick) + 1);
        result.frames.reserve(static_cast<std::size_t>(last_tick + 1) * drivers::message_count);
        bus.set_tap([this](const drivers::CanFrame& frame) {
            // Never beyond what is reserved: the tap runs inside the tick, which must not allocate.
            if (result.frames.size() < result.frames.capacity()) {
                result.frames.push_back(frame);
                result.frames.back().stamp_ns = clock.now_ns();
            }
        });
    }

    runtime::ControlTickConfig config;
    std::int64_t period_ns;
    double period_s;
    int steps;
    std::int64_t brake_tick;
    std::int64_t last_tick;
    std::int64_t k = 0;

    drivers::LoopbackBus bus{2};
    runtime::SimulatedClock clock;
    runtime::OperatorMailbox mailbox;
    runtime::TickRingWriter<runtime::TickRecord> ring{runtime::TickRingOptions{.capacity_records = 2}};
    VirtualCrane crane;
    runtime::ControlTick tick;
    ScriptedOperator scripted_operator;
    FigureAccumulator figures;
    std::uint32_t trouble = 0;
    std::array<drivers::CanFrame, 2 * drivers::message_count> arrived;
    RunResult result;
};

LockstepBench::LockstepBench(const RunOptions& options) : parts_(std::make_unique<Parts>(options)) {}
LockstepBench::~LockstepBench() = default;

bool LockstepBench::finished() const noexcept {
    return parts_->k > parts_->last_tick;
}

double LockstepBench::next_t_s() const noexcept {
    return static_cast<double>(parts_->k - parts_->brake_tick) * parts_->period_s;
}

VirtualCrane& LockstepBench::crane() noexcept {
    return parts_->crane;
}
runtime::OperatorMailbox& LockstepBench::mailbox() noexcept {
    return parts_->mailbox;
}
drivers::LoopbackBus& LockstepBench::bus() noexcept {
    return parts_->bus;
}
const runtime::ControlTick& LockstepBench::tick() const noexcept {
    return parts_->tick;
}
const std::vector<RunTick>& LockstepBench::ticks() const noexcept {
    return parts_->result.ticks;
}

void LockstepBench::step() {
    Parts& p = *parts_;
    const std::int64_t now_ns = p.k * p.period_ns;
    const double t_s = next_t_s();
    p.clock.sleep_until(now_ns);
    if (p.k == p.brake_tick) {
        p.crane.brake(p.result.options.crane_case.manoeuvre.brake_rate_m_s());
    }
    const TruthSample truth = p.crane.truth(t_s);
    p.figures.add(truth);
    p.tick.run({.tick = static_cast<std::uint64_t>(p.k), .due_ns = now_ns, .woke_ns = now_ns});
    const runtime::TickRecord& record = p.tick.record();
    p.result.ticks.push_back({.record = record, .truth = truth});

    const auto state = static_cast<InterlockState>(record.interlock_state);
    p.scripted_operator.act(state);
    if (p.k >= p.brake_tick && state != InterlockState::active) {
        p.result.stayed_engaged = false;
        p.trouble |= record.permission_reasons;
    }

    drivers::CanBus& crane_end = p.bus.endpoint(1);
    const std::size_t count = crane_end.receive(p.arrived);
    p.crane.receive({p.arrived.data(), count}, now_ns);
    crane_end.send(p.crane.frames_to_send(now_ns));
    for (int step = 0; step < p.steps; ++step) {
        p.crane.advance(now_ns + step * p.period_ns / p.steps);
        if (step + 1 < p.steps) {
            p.figures.add(p.crane.truth(t_s + (step + 1) * p.period_s / p.steps));
        }
    }
    ++p.k;
}

RunResult LockstepBench::take_result() {
    parts_->result.figures = parts_->figures.figures();
    parts_->result.trouble = controllers::reasons_in_words(parts_->trouble);
    return std::move(parts_->result);
}

RunResult run_in_lockstep(const RunOptions& options) {
    LockstepBench bench(options);
    while (!bench.finished()) {
        bench.step();
    }
    return bench.take_result();
}

}  // namespace steadyboom::hil
