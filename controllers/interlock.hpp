#pragma once

#include <cstdint>
#include <string>

#include "controllers/crane_estimate.hpp"
#include "plant/crane_measurement.hpp"
#include "plant/valve_command.hpp"

namespace steadyboom::controllers {

/// Where the machine stands between silent and in command. Only engaging, active, limited and
/// stopping move the valve.
enum class InterlockState : std::uint8_t {
    standby,     ///< waiting for every required channel; valve disabled, cut-off closed
    ready,       ///< channels good; valve disabled, cut-off closed; waits for arm
    hold,        ///< armed: valve on hold, cut-off open; waits for engage
    engaging,    ///< authority ramps up
    active,      ///< full authority
    stopping,    ///< authority ramps down, then hold or fault_hold
    fault_hold,  ///< a fault is latched: valve disabled, cut-off closed, until reset
    limited,     ///< engaged, with little authority while a limiting fault lasts
};

/// Whether the valve may move in that state.
[[nodiscard]] bool moves(InterlockState state) noexcept;

/// "STANDBY", "READY", ...
[[nodiscard]] const char* name_of(InterlockState state) noexcept;

/// Why the interlock withholds motion. Bits; latched ones stay until reset. What each does (controllers/README.md):
/// warn is shown and no more; limit takes authority down while it lasts; the others latch once armed, stop ramps down
/// to neutral, immediate is neutral in the same tick.
enum InterlockReason : std::uint32_t {
    reason_none = 0,
    reason_channel_missing = 1U << 0,      ///< a required channel is invalid or older than it may be
    reason_estimate_not_finite = 1U << 1,  ///< the observer diverged
    reason_emergency_stop = 1U << 2,       ///< pressed, or its input not heard
    reason_valve_not_following = 1U << 3,  ///< the valve's device state is not what was commanded
    reason_bus_fault = 1U << 4,            ///< frames could not be sent, twice in a row
    reason_overrun = 1U << 5,              ///< the tick was too late
    reason_operator_stop = 1U << 6,        ///< the operator pressed stop
    reason_guard = 1U << 7,                ///< the guard rejected a command: a bug upstream of it
    reason_not_armed = 1U << 8,            ///< nothing is wrong; nobody has armed or engaged
    reason_interface_down = 1U << 9,       ///< the CAN interface is down
    reason_interface_gone = 1U << 10,      ///< the CAN interface was deleted or unplugged
    reason_bus_off = 1U << 11,             ///< the CAN controller is off the bus
    reason_bus_off_lockout = 1U << 12,     ///< restarts did not cure bus-off; only a new start of the program resets
    reason_error_passive = 1U << 13,       ///< limits: the CAN controller is error-passive
    reason_error_warning = 1U << 14,       ///< warns: the CAN controller counts errors
    reason_flood = 1U << 15,               ///< more frames than the devices can have sent, or frames lost for that
    reason_spoof = 1U << 16,               ///< a process on this machine plays a device
    reason_frames_lost = 1U << 17,         ///< warns: the interface lost frames before they were read
    reason_bus_setup = 1U << 18,           ///< warns: the interface is not set up as configured, or nobody watches it
    reason_device_not_operational = 1U << 19,  ///< a required device is missing, wrong or not started
};

/// Largest authority while a limiting reason lasts.
inline constexpr double limited_authority = 0.15;

/// The reasons in words, "channel missing, emergency stop"; empty for none. Allocates: not for the tick.
[[nodiscard]] std::string reasons_in_words(std::uint32_t reasons);

enum class OperatorIntent : std::uint8_t { none, arm, engage, disengage, reset, stop };

/// What the runtime knows about itself that the interlock must weigh.
struct Health {
    bool send_failed = false;                 ///< the newest command did not leave this machine
    bool overran = false;                     ///< a deadline was missed since the previous tick
    bool guard_violated = false;              ///< the guard rejected the previous tick's command
    bool device_missing = false;              ///< a required device is not operational
    std::uint32_t bus_reasons = reason_none;  ///< InterlockReason bits of bus and link in this tick
};

struct InterlockConfig {
    double period_s = 0.005;
    double engage_ramp_s = 0.5;  ///< authority 0 to 1
    double stop_ramp_s = 0.1;    ///< authority 1 to 0
};

/// First interlock: no valid measurements, no valve opening; nothing moves before the operator armed and engaged.
///
/// A required channel may be missing for at most 3 ticks; then the command ramps down within stop_ramp_s and a fault
/// is latched. An estimate that is not finite, an emergency stop or a guard violation goes to neutral in the same tick.
/// Recovery of a signal never re-engages: a latched fault needs reset, its cause gone for 1 s, and a new arm and
/// engage.
class Interlock {
  public:
    /// Throws std::invalid_argument for times that are not positive.
    explicit Interlock(const InterlockConfig& config);

    /// One tick. `intent` is the operator's wish of this tick, none if there is none; accepted() tells its fate.
    [[nodiscard]] plant::Permission evaluate(const plant::CraneMeasurement& measured, const CraneEstimate& estimate,
                                             const Health& health, OperatorIntent intent) noexcept;

    [[nodiscard]] InterlockState state() const noexcept { return state_; }
    /// Whether the newest intent other than none was acted on; a refused one changed nothing.
    [[nodiscard]] bool accepted() const noexcept { return accepted_; }

  private:
    [[nodiscard]] std::uint32_t present_faults(const plant::CraneMeasurement& measured, const CraneEstimate& estimate,
                                               const Health& health) noexcept;
    [[nodiscard]] bool obey(OperatorIntent intent, std::uint32_t faults) noexcept;

    std::uint32_t ready_ticks_;
    double ramp_up_per_tick_;
    double ramp_down_per_tick_;
    InterlockState state_ = InterlockState::standby;
    InterlockState after_stop_ = InterlockState::hold;
    plant::ValveMode last_mode_ = plant::ValveMode::disabled;
    double authority_ = 0.0;
    std::uint32_t latched_ = reason_none;
    std::uint32_t clear_ticks_ = 0;     ///< without any fault
    std::uint32_t mismatch_ticks_ = 0;  ///< valve state other than commanded
    std::uint32_t send_failures_ = 0;   ///< in a row
    bool accepted_ = false;
};

}  // namespace steadyboom::controllers
