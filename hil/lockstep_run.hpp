#pragma once

#include "hil/run_result.hpp"
#include "runtime/control_tick.hpp"

namespace steadyboom::hil {

/// What the control tick is built from for a run: the case's crane with the run's mismatches applied, its gains, and
/// limits that the valve's travel and speed allow. Throws runtime::ConfigError for a mismatch that names no key.
[[nodiscard]] runtime::ControlTickConfig control_config(const RunOptions& options);

/// The product's way in simulated time: virtual crane, frames on the in-process bus, control tick, frames, valve; one
/// thread, no waiting. The same options give the same bits.
///
/// The bench arms and engages through the operator's mailbox as soon as the interlock lets it. Throws
/// plant::EquilibriumError, std::invalid_argument, runtime::ConfigError.
[[nodiscard]] RunResult run_in_lockstep(const RunOptions& options);

}  // namespace steadyboom::hil
