#include "controllers/interlock.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace steadyboom::controllers {

using plant::CraneMeasurement;
using plant::Permission;
using plant::ValveMode;
using plant::ValveState;

namespace {

constexpr std::array required_channels = {plant::strain_lower_microstrain,
                                          plant::strain_upper_microstrain,
                                          plant::boom_angle_rad,
                                          plant::line_tension_N,
                                          plant::line_angle_rad,
                                          plant::piston_m,
                                          plant::spool_m,
                                          plant::load_pressure_Pa};
constexpr std::uint32_t max_age_ticks = 3;
constexpr std::uint32_t max_mismatch_ticks = 5;
constexpr std::uint32_t max_send_failures = 2;
constexpr double settle_s = 1.0;  ///< how long all must be well before ready, and before a reset

enum class ReasonEffect : std::uint8_t {
    warn,
    limit,
    stop,
    immediate,
    lockout,  ///< immediate, and not to be reset
};

struct ReasonRow {
    InterlockReason reason;
    ReasonEffect effect;
    const char* text;
};
constexpr std::array reason_rows = {
    ReasonRow{reason_channel_missing, ReasonEffect::stop, "a required measurement is missing or bad"},
    ReasonRow{reason_estimate_not_finite, ReasonEffect::immediate, "the observer diverged"},
    ReasonRow{reason_emergency_stop, ReasonEffect::immediate, "emergency stop pressed or not heard"},
    ReasonRow{reason_valve_not_following, ReasonEffect::stop, "the valve is not in the commanded state"},
    ReasonRow{reason_bus_fault, ReasonEffect::stop, "frames cannot be sent"},
    ReasonRow{reason_overrun, ReasonEffect::stop, "the control tick was too late"},
    ReasonRow{reason_operator_stop, ReasonEffect::stop, "stopped by the operator"},
    ReasonRow{reason_guard, ReasonEffect::immediate, "the guard rejected a command"},
    ReasonRow{reason_not_armed, ReasonEffect::warn, "not armed or engaged"},
    ReasonRow{reason_interface_down, ReasonEffect::stop, "the CAN interface is down"},
    ReasonRow{reason_interface_gone, ReasonEffect::stop, "the CAN interface is gone"},
    ReasonRow{reason_bus_off, ReasonEffect::immediate, "the CAN controller is bus-off"},
    ReasonRow{reason_bus_off_lockout, ReasonEffect::lockout,
              "locked out: restarts did not cure bus-off; find the cause, then restart the controller"},
    ReasonRow{reason_error_passive, ReasonEffect::limit, "the CAN controller is error-passive"},
    ReasonRow{reason_error_warning, ReasonEffect::warn, "the CAN controller counts errors"},
    ReasonRow{reason_flood, ReasonEffect::stop, "the bus is flooded"},
    ReasonRow{reason_spoof, ReasonEffect::immediate, "a process on this machine sends as a device"},
    ReasonRow{reason_frames_lost, ReasonEffect::warn, "the CAN interface lost frames"},
    ReasonRow{reason_bus_setup, ReasonEffect::warn, "the CAN interface is not set up as configured, or not watched"},
    ReasonRow{reason_device_not_operational, ReasonEffect::stop, "a required device is not operational"},
};

constexpr std::uint32_t reasons_with(ReasonEffect effect) noexcept {
    std::uint32_t reasons = reason_none;
    for (const ReasonRow& row : reason_rows) {
        reasons |= row.effect == effect ? std::uint32_t{row.reason} : 0U;
    }
    return reasons;
}
constexpr std::uint32_t warning = reasons_with(ReasonEffect::warn);
constexpr std::uint32_t limiting = reasons_with(ReasonEffect::limit);
constexpr std::uint32_t lockout = reasons_with(ReasonEffect::lockout);
constexpr std::uint32_t immediate = reasons_with(ReasonEffect::immediate) | lockout;

/// The valve's own state that a commanded mode must lead to.
ValveState expected_state(ValveMode mode) noexcept {
    switch (mode) {
        case ValveMode::disabled:
            return ValveState::disabled;
        case ValveMode::hold:
            return ValveState::hold;
        case ValveMode::active:
            return ValveState::active;
    }
    return ValveState::not_ready;
}

bool is_fault(ValveState state) noexcept {
    return state == ValveState::fault_hold || state == ValveState::fault_reaction ||
           state == ValveState::fault_disabled;
}

double checked_s(double time_s, const char* name) {
    if (!(std::isfinite(time_s) && time_s > 0.0)) {
        std::ostringstream text;
        text << "interlock: " << name << " = " << time_s << " s: must be positive and finite";
        throw std::invalid_argument(text.str());
    }
    return time_s;
}

}  // namespace

bool moves(InterlockState state) noexcept {
    return state == InterlockState::engaging || state == InterlockState::active || state == InterlockState::limited ||
           state == InterlockState::stopping;
}

const char* name_of(InterlockState state) noexcept {
    constexpr std::array names = {"STANDBY", "READY",    "HOLD",       "ENGAGING",
                                  "ACTIVE",  "STOPPING", "FAULT_HOLD", "LIMITED"};
    const auto index = static_cast<std::size_t>(state);
    return index < names.size() ? names[index] : "?";
}

std::string reasons_in_words(std::uint32_t reasons) {
    std::string words;
    for (const ReasonRow& row : reason_rows) {
        if ((reasons & row.reason) != 0) {
            words += words.empty() ? "" : ", ";
            words += row.text;
        }
    }
    return words;
}

Interlock::Interlock(const InterlockConfig& config)
    : ready_ticks_(static_cast<std::uint32_t>(std::ceil(settle_s / checked_s(config.period_s, "period_s")))),
      ramp_up_per_tick_(config.period_s / checked_s(config.engage_ramp_s, "engage_ramp_s")),
      ramp_down_per_tick_(config.period_s / checked_s(config.stop_ramp_s, "stop_ramp_s")) {}

std::uint32_t Interlock::present_faults(const CraneMeasurement& measured, const CraneEstimate& estimate,
                                        const Health& health) noexcept {
    std::uint32_t faults = health.bus_reasons;
    const bool channels_good = std::ranges::all_of(required_channels, [&](plant::Sensor sensor) {
        const auto i = static_cast<std::size_t>(sensor);
        return measured.valid[i] && measured.age_ticks[i] <= max_age_ticks;
    });
    if (!channels_good) {
        faults |= reason_channel_missing;
    }
    if (!estimate.finite) {
        faults |= reason_estimate_not_finite;
    }
    if (!measured.emergency_stop_healthy || measured.safety_inputs_age_ticks > max_age_ticks) {
        faults |= reason_emergency_stop;
    }
    mismatch_ticks_ = measured.valve_state == expected_state(last_mode_) ? 0 : mismatch_ticks_ + 1;
    if (mismatch_ticks_ > max_mismatch_ticks) {
        faults |= reason_valve_not_following;
    }
    send_failures_ = health.send_failed ? send_failures_ + 1 : 0;
    if (send_failures_ >= max_send_failures) {
        faults |= reason_bus_fault;
    }
    if (health.overran) {
        faults |= reason_overrun;
    }
    if (health.guard_violated) {
        faults |= reason_guard;
    }
    if (health.device_missing) {
        faults |= reason_device_not_operational;
    }
    return faults;
}

bool Interlock::obey(OperatorIntent intent, std::uint32_t faults) noexcept {
    switch (intent) {
        case OperatorIntent::none:
            return accepted_;
        case OperatorIntent::arm:
            if (state_ == InterlockState::ready && faults == reason_none) {
                state_ = InterlockState::hold;
                return true;
            }
            return false;
        case OperatorIntent::engage:
            if (state_ == InterlockState::hold && faults == reason_none) {
                state_ = InterlockState::engaging;
                authority_ = 0.0;
                return true;
            }
            return false;
        case OperatorIntent::disengage:
            if (moves(state_) && state_ != InterlockState::stopping) {
                state_ = InterlockState::stopping;
                after_stop_ = InterlockState::hold;
                return true;
            }
            return false;
        case OperatorIntent::reset:
            if (state_ == InterlockState::fault_hold && clear_ticks_ >= ready_ticks_ && (latched_ & lockout) == 0) {
                state_ = InterlockState::standby;
                latched_ = reason_none;
                clear_ticks_ = 0;
                return true;
            }
            return false;
        case OperatorIntent::stop:
            latched_ |= reason_operator_stop;
            return true;
    }
    return false;
}

Permission Interlock::evaluate(const CraneMeasurement& measured, const CraneEstimate& estimate, const Health& health,
                               OperatorIntent intent) noexcept {
    const std::uint32_t present = present_faults(measured, estimate, health);
    const std::uint32_t faults = present & ~warning;
    // A valve that waits in a fault for its reset does not hinder the operator's, which lets it be reset.
    const bool valve_awaits_reset = state_ == InterlockState::fault_hold && is_fault(measured.valve_state);
    const std::uint32_t in_the_way = faults & ~(valve_awaits_reset ? std::uint32_t{reason_valve_not_following} : 0U);
    clear_ticks_ = in_the_way == reason_none ? std::min(clear_ticks_ + 1, ready_ticks_) : 0;
    accepted_ = obey(intent, faults);

    const bool armed = state_ == InterlockState::hold || moves(state_);
    latched_ |= faults & (armed ? ~limiting : lockout);
    if ((latched_ & immediate) != 0) {
        state_ = InterlockState::fault_hold;
    } else if (latched_ != reason_none && state_ != InterlockState::fault_hold) {
        if (!moves(state_)) {
            state_ = InterlockState::fault_hold;
        } else {
            state_ = InterlockState::stopping;
            after_stop_ = InterlockState::fault_hold;
        }
    }

    switch (state_) {
        case InterlockState::standby:
            if (clear_ticks_ >= ready_ticks_) {
                state_ = InterlockState::ready;
            }
            break;
        case InterlockState::ready:
            if (faults != reason_none) {
                state_ = InterlockState::standby;
            }
            break;
        case InterlockState::engaging:
        case InterlockState::active:
        case InterlockState::limited:
            if ((faults & limiting) != 0) {
                state_ = InterlockState::limited;
                authority_ = std::max(std::min(authority_, limited_authority), authority_ - ramp_down_per_tick_);
            } else {
                authority_ = std::min(1.0, authority_ + ramp_up_per_tick_);
                state_ = authority_ < 1.0 ? InterlockState::engaging : InterlockState::active;
            }
            break;
        case InterlockState::stopping:
            authority_ = std::max(0.0, authority_ - ramp_down_per_tick_);
            if (authority_ <= 0.0) {
                state_ = after_stop_;
            }
            break;
        case InterlockState::hold:
        case InterlockState::fault_hold:
            break;
    }

    Permission permit;
    permit.reasons = latched_ | (present & (armed ? warning | limiting : ~0U));
    if (moves(state_)) {
        permit.mode = ValveMode::active;
        permit.authority = authority_;
        permit.cutoff_energised = true;
    } else {
        authority_ = 0.0;
        permit.mode = state_ == InterlockState::hold ? ValveMode::hold : ValveMode::disabled;
        permit.cutoff_energised = state_ == InterlockState::hold;
        permit.reasons |= reason_not_armed;
    }
    permit.valve_reset = state_ == InterlockState::standby;
    last_mode_ = permit.mode;
    return permit;
}

}  // namespace steadyboom::controllers
