#pragma once

#include <cstdint>

#include "plant/valve_command.hpp"

namespace steadyboom::drivers {

/// A command that the guard has let through: the only thing a valve frame is ever built from.
class GuardedCommand {
  public:
    /// Spool opening in m, a whole number of nanometres, always finite.
    [[nodiscard]] double opening_m() const noexcept { return 1.0e-9 * opening_nm_; }
    [[nodiscard]] plant::ValveMode mode() const noexcept { return mode_; }
    [[nodiscard]] bool cutoff_energised() const noexcept { return cutoff_energised_; }
    /// The valve may be asked to leave a fault state; only with ValveMode::disabled.
    [[nodiscard]] bool valve_reset() const noexcept { return valve_reset_; }
    [[nodiscard]] std::uint32_t reasons() const noexcept { return reasons_; }  ///< plant::LimitReason bits
    [[nodiscard]] bool violated() const noexcept { return (reasons_ & plant::limit_guard) != 0; }

  private:
    friend class CommandGuard;
    GuardedCommand() = default;

    std::int32_t opening_nm_ = 0;
    plant::ValveMode mode_ = plant::ValveMode::disabled;
    bool cutoff_energised_ = false;
    bool valve_reset_ = false;
    std::uint32_t reasons_ = plant::limit_none;
};

struct GuardLimits {
    double max_opening_m = 0.0;  ///< largest |opening|
    double max_step_m = 0.0;     ///< largest change from one tick to the next; towards zero there is none
};

/// The last word on every command. It trusts neither law nor limiter: it clips nothing, it rejects. A rejected command
/// becomes neutral in the same tick: opening 0, valve disabled, cut-off not energised, reason limit_guard.
///
/// Rejected is a command that is not finite, is larger than `max_opening_m`, is further than `max_step_m` from the last
/// one passed (unless it lies between that one and zero), wants an opening without a permission for motion, or asks for
/// a mode that is none. All comparisons are between whole nanometres; one is granted to rounding.
class CommandGuard {
  public:
    /// Throws std::invalid_argument unless 0 < max_step_m <= max_opening_m <= 1.
    explicit CommandGuard(const GuardLimits& limits);

    [[nodiscard]] GuardedCommand pass(const plant::LimitedCommand& command, const plant::Permission& permit) noexcept;

    /// Opening 0, valve disabled, cut-off not energised; the next step counts from 0.
    [[nodiscard]] GuardedCommand neutral() noexcept;

    /// Commands rejected since construction; nothing resets it.
    [[nodiscard]] std::uint64_t violations() const noexcept { return violations_; }

  private:
    std::int32_t max_opening_nm_;
    std::int32_t max_step_nm_;
    std::int32_t last_nm_ = 0;
    std::uint64_t violations_ = 0;
};

}  // namespace steadyboom::drivers
