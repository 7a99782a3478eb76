#include "drivers/cia408.hpp"

#include <algorithm>
#include <array>

namespace steadyboom::drivers {
namespace {

using plant::ValveMode;
using plant::ValveState;
using enum plant::ValveState;

constexpr std::uint16_t pressure_control_bit = 1U << 8;
constexpr std::uint16_t ramp_running_bit = 1U << 9;
constexpr std::uint16_t limit_touched_bit = 1U << 10;
constexpr std::uint16_t control_deviation_bit = 1U << 11;

constexpr std::uint16_t mode_bits = control_active | control_hold | control_disabled;

/// A transition by the control word: taken when (word & mask) == value.
struct Transition {
    ValveState from;
    std::uint16_t mask;
    std::uint16_t value;
    ValveState to;
};

constexpr std::array transitions = {
    Transition{init, 0b001, 0b001, disabled},
    Transition{disabled, 0b011, 0b011, hold},
    Transition{hold, 0b111, 0b111, active},
    Transition{active, 0b100, 0b000, hold},
    Transition{hold, 0b110, 0b000, disabled},
    Transition{disabled, 0b111, 0b000, init},
    Transition{fault_hold, 0b110, 0b000, fault_disabled},
};

/// A reset: taken on the rising edge of the reset bit while the other bits stay at `value`.
struct Reset {
    ValveState from;
    std::uint16_t value;
    ValveState to;
};

constexpr std::array resets = {
    Reset{fault_disabled, 0b001, disabled},
    Reset{fault_hold, 0b011, hold},
};

/// Where a fault leads from a state.
struct FaultRow {
    ValveState from;
    ValveFault fault;
    ValveState to;  ///< after FAULT_REACTION
};

constexpr std::array fault_rows = {
    FaultRow{init, ValveFault::holds, fault_disabled},
    FaultRow{init, ValveFault::disables, fault_disabled},
    FaultRow{disabled, ValveFault::holds, fault_disabled},
    FaultRow{disabled, ValveFault::disables, fault_disabled},
    FaultRow{hold, ValveFault::holds, fault_hold},
    FaultRow{hold, ValveFault::disables, fault_disabled},
    FaultRow{active, ValveFault::holds, fault_hold},
    FaultRow{active, ValveFault::disables, fault_disabled},
    FaultRow{fault_hold, ValveFault::disables, fault_disabled},
};

/// Height of a state or mode on the way to ACTIVE; a fault state counts as nothing.
constexpr int level_of(ValveState state) noexcept {
    switch (state) {
        case active:
            return 4;
        case hold:
            return 3;
        case disabled:
            return 2;
        case init:
            return 1;
        default:
            return 0;
    }
}

constexpr int level_of(ValveMode mode) noexcept {
    switch (mode) {
        case ValveMode::active:
            return level_of(active);
        case ValveMode::hold:
            return level_of(hold);
        case ValveMode::disabled:
            break;
    }
    return level_of(disabled);
}

constexpr int disabled_level = level_of(ValveMode::disabled);

constexpr std::uint16_t word_for(int level) noexcept {
    switch (level) {
        case 4:
            return control_active | control_hold | control_disabled;
        case 3:
            return control_hold | control_disabled;
        default:
            return control_disabled;
    }
}

}  // namespace

std::uint16_t status_word(const ValveStatus& status) noexcept {
    return static_cast<std::uint16_t>(
        static_cast<unsigned>(status.state) | (status.pressure_control_effective ? pressure_control_bit : 0U) |
        (status.ramp_running ? ramp_running_bit : 0U) | (status.limit_touched ? limit_touched_bit : 0U) |
        (status.control_deviation ? control_deviation_bit : 0U));
}

ValveStatus valve_status(std::uint16_t status_word_raw) noexcept {
    ValveStatus status{
        .pressure_control_effective = (status_word_raw & pressure_control_bit) != 0,
        .ramp_running = (status_word_raw & ramp_running_bit) != 0,
        .limit_touched = (status_word_raw & limit_touched_bit) != 0,
        .control_deviation = (status_word_raw & control_deviation_bit) != 0,
    };
    switch (const auto state = static_cast<ValveState>(status_word_raw & 0x0F)) {
        case not_ready:
        case init:
        case disabled:
        case hold:
        case active:
        case fault_hold:
        case fault_reaction:
        case fault_disabled:
            status.state = state;
    }
    return status;
}

bool is_fault(ValveState state) noexcept {
    return state == fault_hold || state == fault_reaction || state == fault_disabled;
}

ValveState Cia408Valve::step(const Inputs& inputs) noexcept {
    const bool reset_edge = (inputs.control_word_raw & control_reset) != 0 && (last_word_ & control_reset) == 0 &&
                            (inputs.control_word_raw & mode_bits) == (last_word_ & mode_bits);
    if (state_ == not_ready && inputs.initialised) {
        state_ = init;
    }
    while (take_transition(inputs, reset_edge)) {
    }
    last_word_ = inputs.control_word_raw;
    return state_;
}

bool Cia408Valve::take_transition(const Inputs& inputs, bool reset_edge) noexcept {
    const auto go = [this](ValveState to) {
        state_ = to;
        return true;
    };
    for (const auto& row : fault_rows) {
        if (row.from == state_ && row.fault == inputs.fault) {
            fault_state_ = row.to;
            return go(fault_reaction);
        }
    }
    if (state_ == fault_reaction) {
        // A worse fault while the first is dealt with lowers the outcome.
        fault_state_ = inputs.fault == ValveFault::disables ? fault_disabled : fault_state_;
        return inputs.reaction_done && go(fault_state_);
    }
    for (const auto& row : transitions) {
        if (row.from == state_ && (inputs.control_word_raw & row.mask) == row.value) {
            return go(row.to);
        }
    }
    const bool may_reset = reset_edge && inputs.fault == ValveFault::none;
    for (const auto& row : resets) {
        if (row.from == state_ && may_reset && (inputs.control_word_raw & mode_bits) == row.value) {
            return go(row.to);
        }
    }
    return false;
}

std::uint16_t Cia408Controller::control_word(ValveMode wanted, ValveState reported) noexcept {
    const std::uint16_t reset = reset_high(wanted, reported) ? std::uint16_t{control_reset} : std::uint16_t{0};
    if (wanted == ValveMode::disabled) {
        fallen_ = false;
    } else if (is_fault(reported)) {
        fallen_ = true;
    }
    ask(fallen_ ? disabled_level : level_of(wanted), level_of(reported));
    return word_for(asked_level_) | reset;
}

void Cia408Controller::ask(int wanted_level, int reported_level) noexcept {
    const bool may_rise = wanted_level > asked_level_ && reported_level >= asked_level_;
    const int next_level = may_rise ? asked_level_ + 1 : std::min(asked_level_, wanted_level);
    if (next_level != asked_level_) {
        asked_level_ = next_level;
        ticks_asked_ = 0;
        confirmed_ = false;
    } else if (ticks_asked_ < report_lag_ticks) {
        ++ticks_asked_;
    } else if (reported_level >= asked_level_) {
        confirmed_ = true;
    } else if (confirmed_ && asked_level_ > disabled_level) {
        fallen_ = true;
        asked_level_ = disabled_level;
        confirmed_ = false;
    }
}

bool Cia408Controller::reset_high(ValveMode wanted, ValveState reported) noexcept {
    if (reset_ticks_ == 0) {
        return false;
    }
    if (wanted != ValveMode::disabled) {
        reset_ticks_ = 0;
        return false;
    }
    if (reset_ticks_ == 1 && reported == fault_reaction) {
        return false;
    }
    const bool high = reset_ticks_ > reset_low_ticks;
    reset_ticks_ = reset_ticks_ < reset_low_ticks + reset_high_ticks ? reset_ticks_ + 1 : 0;
    return high;
}

}  // namespace steadyboom::drivers
