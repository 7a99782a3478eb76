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

/// Faults that leave no time for a ramp.
constexpr std::uint32_t immediate = reason_estimate_not_finite | reason_emergency_stop | reason_guard;

struct ReasonText {
    InterlockReason reason;
    const char* text;
};
constexpr std::array reason_texts = {
    ReasonText{reason_channel_missing, "a required measurement is missing or bad"},
    ReasonText{reason_estimate_not_finite, "the observer diverged"},
    ReasonText{reason_emergency_stop, "emergency stop pressed or not heard"},
    ReasonText{reason_valve_not_following, "the valve is not in the commanded state"},
    ReasonText{reason_bus_fault, "frames cannot be sent"},
    ReasonText{reason_overrun, "the control tick was too late"},
    ReasonText{reason_operator_stop, "stopped by the operator"},
    ReasonText{reason_guard, "the guard rejected a command"},
    ReasonText{reason_not_armed, "not armed or engaged"},
};

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

double checked_s(double time_s, const char* name) {
    if (!(std::isfinite(time_s) && time_s > 0.0)) {
        std::ostringstream text;
        text << "interlock: " << name << " = " << time_s << " s: must be positive and finite";
        throw std::invalid_argument(text.str());
    }
    return time_s;
}

bool moves(InterlockState state) noexcept {
    return state == InterlockState::engaging || state == InterlockState::active || state == InterlockState::stopping;
}

}  // namespace

const char* name_of(InterlockState state) noexcept {
    constexpr std::array names = {"STANDBY", "READY", "HOLD", "ENGAGING", "ACTIVE", "STOPPING", "FAULT_HOLD"};
    const auto index = static_cast<std::size_t>(state);
    return index < names.size() ? names[index] : "?";
}

std::string reasons_in_words(std::uint32_t reasons) {
    std::string words;
    for (const ReasonText& row : reason_texts) {
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
    std::uint32_t faults = reason_none;
    const bool channels_good = std::ranges::all_of(required_channels, [&](plant::Sensor sensor) {
        const auto i = static_cast<std::size_t>(sensor);
        return measured.age_ticks[i] <= max_age_ticks && (measured.valid[i] || measured.age_ticks[i] > 0);
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
            if (state_ == InterlockState::engaging || state_ == InterlockState::active) {
                state_ = InterlockState::stopping;
                after_stop_ = InterlockState::hold;
                return true;
            }
            return false;
        case OperatorIntent::reset:
            if (state_ == InterlockState::fault_hold && clear_ticks_ >= ready_ticks_) {
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
    const std::uint32_t faults = present_faults(measured, estimate, health);
    clear_ticks_ = faults == reason_none ? std::min(clear_ticks_ + 1, ready_ticks_) : 0;
    accepted_ = obey(intent, faults);

    const bool armed = state_ == InterlockState::hold || moves(state_);
    if (armed) {
        latched_ |= faults;
    }
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
            authority_ = std::min(1.0, authority_ + ramp_up_per_tick_);
            if (authority_ >= 1.0) {
                state_ = InterlockState::active;
            }
            break;
        case InterlockState::stopping:
            authority_ = std::max(0.0, authority_ - ramp_down_per_tick_);
            if (authority_ <= 0.0) {
                state_ = after_stop_;
            }
            break;
        case InterlockState::hold:
        case InterlockState::active:
        case InterlockState::fault_hold:
            break;
    }

    Permission permit;
    permit.reasons = latched_ | (armed ? 0U : faults);
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
    last_mode_ = permit.mode;
    return permit;
}

}  // namespace steadyboom::controllers
