#pragma once

#include <cstdint>

#include "plant/crane_measurement.hpp"
#include "plant/valve_command.hpp"

/// CiA 408 device control, both ends: how control word 6040h moves a valve through its states, and how status word
/// 6041h tells of them. Source: the public manual of a CiA 408 servo valve (drivers/README.md says which parts).
namespace steadyboom::drivers {

/// Bits of control word 6040h. `control_reset` acts on its rising edge alone.
enum ControlBit : std::uint16_t {
    control_disabled = 1U << 0,
    control_hold = 1U << 1,
    control_active = 1U << 2,
    control_reset = 1U << 3,
};

/// Status word 6041h: the state in bits 0 to 3, flags in bits 8 to 11.
struct ValveStatus {
    plant::ValveState state = plant::ValveState::not_ready;
    bool pressure_control_effective = false;
    bool ramp_running = false;
    bool limit_touched = false;
    bool control_deviation = false;
    bool operator==(const ValveStatus&) const = default;
};

[[nodiscard]] std::uint16_t status_word(const ValveStatus& status) noexcept;

/// Bit patterns that are no state read as not_ready.
[[nodiscard]] ValveStatus valve_status(std::uint16_t status_word_raw) noexcept;

/// One of the three fault states.
[[nodiscard]] bool is_fault(plant::ValveState state) noexcept;

/// How far a fault lowers a valve.
enum class ValveFault : std::uint8_t {
    none,
    holds,     ///< FAULT_HOLD at most: the spool is held at its closed centre
    disables,  ///< FAULT_DISABLED at most: the spool is where springs put it
};

/// The valve's end. A fault only lowers the state; what it lowered stays down until the fault is over and a reset edge
/// comes with no higher state asked for, and then it is HOLD or DISABLED again, never ACTIVE.
class Cia408Valve {
  public:
    struct Inputs {
        std::uint16_t control_word_raw = 0;   ///< the newest; bits 4 to 15 mean nothing here
        ValveFault fault = ValveFault::none;  ///< as long as it lasts
        bool initialised = true;              ///< self-test done
        bool reaction_done = true;            ///< the spool has come to rest where the fault wants it
    };

    /// Takes all transitions that the inputs ask for, one after the other. One call whenever an input may have changed.
    plant::ValveState step(const Inputs& inputs) noexcept;

    [[nodiscard]] plant::ValveState state() const noexcept { return state_; }

    /// Power off and on.
    void restart() noexcept { *this = Cia408Valve(); }

  private:
    bool take_transition(const Inputs& inputs, bool reset_edge) noexcept;

    plant::ValveState state_ = plant::ValveState::not_ready;
    plant::ValveState fault_state_ = plant::ValveState::fault_disabled;  ///< where FAULT_REACTION leads
    std::uint16_t last_word_ = 0;
};

/// The controller's end: the control word of each tick. It asks for the next state on the way up to the wanted one, and
/// for the wanted one at once on the way down. It never raises a valve that has fallen by itself, by a fault or not:
/// until `disabled` has been wanted, it then asks for nothing more. (A fall within three ticks of a new word cannot be
/// told from a late report.)
class Cia408Controller {
  public:
    /// One call a tick. `reported` is the newest known state.
    [[nodiscard]] std::uint16_t control_word(plant::ValveMode wanted, plant::ValveState reported) noexcept;

    /// Sends one reset edge, while `disabled` is wanted: the reset bit low, then high, each for long enough that a lost
    /// frame does not matter. Waits while the valve reports FAULT_REACTION, and is forgotten as soon as more is wanted.
    void request_reset() noexcept { reset_ticks_ = 1; }

    /// A reset edge is under way.
    [[nodiscard]] bool resetting() const noexcept { return reset_ticks_ > 0; }

    /// The valve has fallen by itself and is kept down.
    [[nodiscard]] bool fallen() const noexcept { return fallen_; }

  private:
    static constexpr int report_lag_ticks = 3;  ///< a report may be this much older than what was asked
    static constexpr int reset_low_ticks = 2;
    static constexpr int reset_high_ticks = 2;

    void ask(int wanted_level, int reported_level) noexcept;
    [[nodiscard]] bool reset_high(plant::ValveMode wanted, plant::ValveState reported) noexcept;

    int asked_level_ = 2;     ///< of the last word: 2 DISABLED, 3 HOLD, 4 ACTIVE
    int ticks_asked_ = 0;     ///< since it changed, up to report_lag_ticks
    bool confirmed_ = false;  ///< the valve has reported it since
    int reset_ticks_ = 0;
    bool fallen_ = false;
};

}  // namespace steadyboom::drivers
