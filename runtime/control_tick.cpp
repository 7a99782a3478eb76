#include "runtime/control_tick.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/sensors.hpp"
#include "runtime/realtime_section.hpp"

namespace steadyboom::runtime {

using controllers::OperatorIntent;

namespace {

double period_s(const ControlTickConfig& config) {
    return 1e-9 * static_cast<double>(config.network.period_ns);
}

/// Sensor noise plus what the bus's resolution adds (a step's uniform error).
plant::SensorVector observed_sigma(const plant::CraneParameters& crane, const drivers::DeviceTable& table) {
    plant::SensorVector variance = plant::sensor_noise(crane.actuator.spool_travel_m).cwiseAbs2();
    for (const drivers::SignalRow& row : table.signals()) {
        if (row.sensor != plant::sensor_count) {
            const double step = row.scale_unit;
            variance[row.sensor] += step * step / 12.0;
        }
    }
    return variance.cwiseSqrt();
}

/// From a command to the middle of its effect: half a tick that it is held, the valve's dead time, and the delay of a
/// second-order spool at low frequency, 2 zeta / omega.
double actuation_lag_s(const ControlTickConfig& config) {
    const plant::ActuatorParameters& actuator = config.crane.actuator;
    return 0.5 * period_s(config) + actuator.spool_delay_s +
           actuator.spool_damping_ratio / (std::numbers::pi * actuator.spool_bandwidth_Hz);
}

/// The crane's fastest mode is at 70 Hz: Runge-Kutta 4 is stable up to 6 ms there, and accurate enough at 2.5 ms.
int observer_substeps(double tick_period_s) {
    constexpr double longest_step_s = 0.0025;
    return static_cast<int>(std::ceil(tick_period_s / longest_step_s - 1e-9));
}

OperatorIntent intent_of(OperatorCommand command) noexcept {
    switch (command) {
        case OperatorCommand::arm:
            return OperatorIntent::arm;
        case OperatorCommand::engage:
            return OperatorIntent::engage;
        case OperatorCommand::disengage:
            return OperatorIntent::disengage;
        case OperatorCommand::reset:
            return OperatorIntent::reset;
        case OperatorCommand::stop:
            return OperatorIntent::stop;
        case OperatorCommand::status:
            break;
    }
    return OperatorIntent::none;
}

}  // namespace

ControlTick::ControlTick(const ControlTickConfig& config, drivers::CanBus& bus, const Clock& clock,
                         OperatorMailbox& mailbox, TickRingWriter<TickRecord>& ring)
    : bus_(bus),
      clock_(clock),
      mailbox_(mailbox),
      ring_(ring),
      crane_(config.crane),
      equilibrium_(plant::find_equilibrium(crane_)),
      network_(config.network),
      observer_(crane_, equilibrium_.state,
                {.period_s = period_s(config),
                 .substeps = observer_substeps(period_s(config)),
                 .sensor_sigma = observed_sigma(config.crane, network_.table())}),
      interlock_({.period_s = period_s(config), .engage_ramp_s = config.engage_ramp_s}),
      law_(config.law, config.gains, equilibrium_.state),
      linearisation_(config.crane.actuator),
      actuation_lag_s_(actuation_lag_s(config)),
      limiter_(
          {.max_opening_m = config.max_opening_m, .max_slew_m_s = config.max_slew_m_s, .period_s = period_s(config)}),
      // The guard's limits stand apart from the limiter's: the travel itself, and a step a little above the slew limit,
      // so that rounding never trips it and a limiter that fails does.
      guard_(
          {.max_opening_m = config.crane.actuator.spool_travel_m,
           .max_step_m = std::min(1.1 * config.max_slew_m_s * period_s(config), config.crane.actuator.spool_travel_m)}),
      overruns_are_faults_(config.overruns_are_faults) {
    std::ranges::copy(law_.set_point(), record_.setpoint.begin());
}

std::int64_t ControlTick::lap_ns() noexcept {
    const std::int64_t now_ns = clock_.now_ns();
    const std::int64_t lap = now_ns - lap_start_ns_;
    lap_start_ns_ = now_ns;
    return lap;
}

OperatorIntent ControlTick::next_intent() noexcept {
    request_ = mailbox_.try_pop();
    if (stopping_) {
        return OperatorIntent::stop;
    }
    return request_ ? intent_of(request_->command) : OperatorIntent::none;
}

void ControlTick::answer_operator() noexcept {
    if (request_) {
        mailbox_.answer(*request_, interlock_.accepted() ? OperatorResult::done : OperatorResult::refused,
                        record_.permission_reasons);
    }
    mailbox_.publish({.tick = record_.tick,
                      .time_ns = record_.time_ns,
                      .state = record_.interlock_state,
                      .reasons = record_.permission_reasons,
                      .device_state = record_.device_state,
                      .emergency_code = record_.emergency_code});
}

void ControlTick::run(const TickStart& start) noexcept {
    const RealtimeSection section;
    lap_start_ns_ = clock_.now_ns();
    TickRecord& r = record_;
    r.tick = start.tick;
    r.time_ns = start.due_ns;
    r.wake_up_latency_ns = start.wake_up_latency_ns;
    r.skipped_ticks = static_cast<std::uint32_t>(start.skipped_ticks);
    health_.overran = overruns_.broken(start.skipped_ticks) && overruns_are_faults_;

    const std::size_t count = bus_.receive(frames_);
    health_.bus_reasons = bus_monitor_.reasons(bus_.status()) | link_reasons_.load(std::memory_order_relaxed);
    r.receive_duration_ns = lap_ns();

    const plant::CraneMeasurement measured = network_.decode({frames_.data(), count}, start.woke_ns);
    health_.device_missing = !network_.manager().all_required_operational();
    r.decode_duration_ns = lap_ns();

    observer_.correct(measured);
    r.observe_duration_ns = lap_ns();

    observer_.predict(applied_linear_m_);
    const controllers::CraneEstimate& estimate = observer_.estimate();
    r.predict_duration_ns = lap_ns();

    const plant::Permission permit = interlock_.evaluate(measured, estimate, health_, next_intent());
    r.interlock_duration_ns = lap_ns();

    const double load_pressure_Pa = crane_.outputs(estimate.state).load_pressure_Pa;
    const plant::ValveCommand linear = law_.command(observer_.ahead(applied_linear_m_, actuation_lag_s_));
    const plant::ValveCommand wanted = linearisation_.spool_command(linear, load_pressure_Pa);
    r.law_duration_ns = lap_ns();

    const plant::LimitedCommand limited = limiter_.apply(wanted, permit);
    const drivers::GuardedCommand applied = guard_.pass(limited, permit);
    r.limit_duration_ns = lap_ns();

    const std::span<const drivers::CanFrame> out = network_.encode(applied, start.woke_ns);
    const drivers::SendResult sent = bus_.send(out);
    health_.send_failed = sent.sent != out.size();
    health_.guard_violated = applied.violated();
    applied_linear_m_ = linearisation_.linear_opening_m(applied.opening_m(), load_pressure_Pa);
    r.send_duration_ns = lap_ns();

    const drivers::BusStatus bus = bus_.status();
    const drivers::NetworkStatus& network = network_.status();
    r.samples_stamp_ns = measured.stamp_ns;
    std::ranges::copy(measured.value, r.measured.begin());
    std::ranges::copy(measured.age_ticks, r.measured_age_ticks.begin());
    r.measured_valid_bits = 0;
    for (std::size_t i = 0; i < measured.valid.size(); ++i) {
        r.measured_valid_bits |= static_cast<std::uint32_t>(measured.valid[i]) << i;
    }
    r.safety_inputs_age_ticks = measured.safety_inputs_age_ticks;
    std::ranges::copy(estimate.state, r.estimate.begin());
    r.observer_nis = estimate.nis;
    r.wanted_opening_m = wanted.opening_m;
    r.limited_opening_m = limited.opening_m;
    r.applied_opening_m = applied.opening_m();
    r.authority = permit.authority;
    r.limit_reasons = limited.reasons;
    r.guard_reasons = applied.reasons();
    r.permission_reasons = permit.reasons;
    r.interlock_state = static_cast<std::uint8_t>(interlock_.state());
    r.valve_state = static_cast<std::uint8_t>(measured.valve_state);
    r.permitted_mode = static_cast<std::uint8_t>(permit.mode);
    r.applied_mode = static_cast<std::uint8_t>(applied.mode());
    r.cutoff_permitted = permit.cutoff_energised ? 1 : 0;
    r.cutoff_energised = applied.cutoff_energised() ? 1 : 0;
    r.cutoff_open = measured.cutoff_open ? 1 : 0;
    r.emergency_stop_healthy = measured.emergency_stop_healthy ? 1 : 0;
    r.received_frames = bus.received_frames;
    r.dropped_frames = bus.receive_overflow_frames + bus.malformed_frames + bus.spoofed_frames +
                       network.unknown_id_frames + network.wrong_length_frames + network.remote_or_extended_frames;
    r.send_errors = bus.send_errors;
    r.newest_frame_kernel_stamp_ns = bus.newest_kernel_stamp_ns;
    r.link_state = static_cast<std::uint8_t>(bus.link);
    r.transmit_error_count = bus.transmit_error_count;
    r.receive_error_count = bus.receive_error_count;
    record_network();
    answer_operator();
    ring_.push(r);
}

void ControlTick::record_network() noexcept {
    TickRecord& r = record_;
    for (std::size_t i = 1; i < drivers::device_count; ++i) {
        const drivers::NodeStatus& node = network_.node(static_cast<drivers::Device>(i));
        r.device_state[i] = static_cast<std::uint8_t>(node.managed);
        r.emergency_code[i] = node.emergency.code;
    }
    for (std::size_t i = 0; i < drivers::tpdo_count; ++i) {
        const auto pdo = static_cast<drivers::Pdo>(i);
        r.message_state[i] = static_cast<std::uint8_t>(network_.state(pdo));
        r.message_lag_ticks[i] = network_.lag_ticks(pdo);
    }
    r.valve_flag_bits = drivers::status_word(network_.valve()) & 0x0F00U;
    const drivers::NetworkStatus& network = network_.status();
    r.rejected_frames =
        network.rejected_frames + network.late_frames + network.unbelieved_frames + network.not_operational_frames;
    r.implausible_values = network.implausible_values;
}

}  // namespace steadyboom::runtime
