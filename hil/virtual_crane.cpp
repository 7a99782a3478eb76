#include "hil/virtual_crane.hpp"

#include <algorithm>
#include <cmath>

#include "plant/runge_kutta.hpp"
#include "plant/sensors.hpp"

namespace steadyboom::hil {

using namespace plant;

namespace {

CraneParameters with_nonlinear_valve(CraneParameters crane) {
    crane.actuator.valve_model = ValveModel::nonlinear;
    return crane;
}

}  // namespace

VirtualCrane::VirtualCrane(const VirtualCraneConfig& config)
    : crane_(with_nonlinear_valve(config.crane)),
      equilibrium_(find_equilibrium(crane_)),
      network_(config.network),
      valve_(config.crane.actuator, config.step_s),
      noise_sigma_(sensor_noise(config.crane.actuator.spool_travel_m)),
      step_s_(config.step_s),
      travel_m_(config.crane.actuator.spool_travel_m),
      random_(config.seed) {
    state_.head<state_count>() = equilibrium_.state;
    outbox_.reserve(2 * drivers::message_count);
}

void VirtualCrane::receive(std::span<const drivers::CanFrame> frames, std::int64_t now_ns) noexcept {
    network_.receive(frames, now_ns);
}

SensorVector VirtualCrane::noisy_sensors() noexcept {
    SensorVector sensors = ideal_sensors(crane_, state_.head<state_count>(), state_[spool_index]);
    for (int i = 0; i < sensor_count; ++i) {
        sensors[i] += noise_sigma_[i] * normal_(random_);
    }
    // Load pin and pressure transducer read zero on a slack rope, not less than nothing.
    sensors[line_tension_N] = std::max(0.0, sensors[line_tension_N]);
    sensors[load_pressure_Pa] = std::max(0.0, sensors[load_pressure_Pa]);
    return sensors;
}

std::span<const drivers::CanFrame> VirtualCrane::frames_to_send(std::int64_t now_ns) noexcept {
    outbox_.clear();
    const auto append = [&](std::span<const drivers::CanFrame> frames) {
        outbox_.insert(outbox_.end(), frames.begin(), frames.end());
    };
    network_.set_fault(drivers::Device::servo_valve, drivers::emergency_rpdo_timeout, valve_.timed_out());
    append(network_.housekeeping(now_ns));
    if (network_.sync_pending() || network_.timer_due(now_ns)) {
        append(network_.answer_sync(noisy_sensors(),
                                    {.status = valve_.status(state_[spool_index]),
                                     .cutoff_open = valve_.cutoff_open(),
                                     .emergency_stop_healthy = true},
                                    now_ns));
    }
    return outbox_;
}

void VirtualCrane::advance(std::int64_t now_ns) noexcept {
    valve_.obey(network_.valve_order(), now_ns);
    const double target_m = valve_.next_target_m();
    const bool flows = valve_.cutoff_open();
    const auto rate = [&](double, const State& x) {
        State derivative;
        derivative.head<state_count>() =
            crane_.derivative(x.head<state_count>(), flows ? crane_.actuator().clamp_opening_m(x[spool_index]) : 0.0);
        derivative[spool_index] = x[spool_rate_index];
        derivative[spool_rate_index] = valve_.spool_acceleration_m_s2(x[spool_index], x[spool_rate_index], target_m);
        return derivative;
    };
    state_ = runge_kutta_step(rate, 0.0, state_, step_s_);
    state_[piston_index] = crane_.actuator().clamp_piston_m(state_[piston_index]);
    if (std::abs(state_[spool_index]) > travel_m_) {
        state_[spool_index] = std::copysign(travel_m_, state_[spool_index]);
        state_[spool_rate_index] = 0.0;
    }
}

void VirtualCrane::brake(double rate_m_s) noexcept {
    state_[velocity_offset + R9_m] = rate_m_s;
}

TruthSample VirtualCrane::truth(double t_s) const noexcept {
    return sample_truth(crane_, state_.head<state_count>(), state_[spool_index], equilibrium_.pendent_tension_N, t_s);
}

}  // namespace steadyboom::hil
