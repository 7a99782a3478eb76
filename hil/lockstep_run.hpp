#pragma once

#include <memory>
#include <vector>

#include "drivers/loopback_bus.hpp"
#include "hil/run_result.hpp"
#include "hil/virtual_crane.hpp"
#include "runtime/control_tick.hpp"

namespace steadyboom::hil {

/// What the control tick is built from for a run: the case's crane with the run's mismatches applied, its gains, and
/// limits that the valve's travel and speed allow. Throws runtime::ConfigError for a mismatch that names no key.
[[nodiscard]] runtime::ControlTickConfig control_config(const RunOptions& options);

/// The product's way in simulated time: virtual crane, frames on the in-process bus, control tick, frames, valve; one
/// thread, no waiting. The same options give the same bits.
///
/// The bench arms and engages through the operator's mailbox as soon as the interlock lets it.
class LockstepBench {
  public:
    /// Throws plant::EquilibriumError, std::invalid_argument, runtime::ConfigError.
    explicit LockstepBench(const RunOptions& options);
    ~LockstepBench();

    /// One control tick and the crane's motion until the next.
    void step();

    /// The last tick of options.duration_s has been stepped.
    [[nodiscard]] bool finished() const noexcept;

    /// Time of the tick that step() does next; 0 is the brake event.
    [[nodiscard]] double next_t_s() const noexcept;

    /// For what a test does to the crane between two steps.
    [[nodiscard]] VirtualCrane& crane() noexcept;
    [[nodiscard]] runtime::OperatorMailbox& mailbox() noexcept;
    [[nodiscard]] drivers::LoopbackBus& bus() noexcept;
    [[nodiscard]] const runtime::ControlTick& tick() const noexcept;

    /// Ticks so far; figures and verdict as of now.
    [[nodiscard]] const std::vector<RunTick>& ticks() const noexcept;
    [[nodiscard]] RunResult take_result();

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// A LockstepBench from its first step to its last.
[[nodiscard]] RunResult run_in_lockstep(const RunOptions& options);

}  // namespace steadyboom::hil
