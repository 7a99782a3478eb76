#pragma once

#include <functional>
#include <optional>

#include "controllers/law.hpp"
#include "hil/case_file.hpp"
#include "hil/run_figures.hpp"
#include "hil/truth_sample.hpp"

namespace steadyboom::hil {

struct SimulationOptions {
    Case crane_case;
    controllers::LawKind law = controllers::LawKind::none;
    double duration_s = 10.0;
    std::optional<double> step_s;  ///< fixed-step Runge-Kutta 4; the adaptive integrator without it
    /// Of the adaptive integrator: error allowed in a step, as a share of each entry; a tenth of it in the entry's own
    /// unit (m, rad, and per s) near zero.
    double tolerance = 1e-9;
    double output_period_s = 0.005;
};

/// The thesis's own way: the law is fed the true state inside the integration, its command is the spool's opening at
/// once, nothing is sampled, sent or measured. t_s = 0 is the brake event at equilibrium.
///
/// Calls `output` at 0, output_period_s, 2 output_period_s, ... and at the end, in between the integrator's steps by
/// its dense output (cubic Hermite for fixed steps). Returns the figures, taken at every step and every output.
///
/// Throws plant::EquilibriumError, plant::IntegrationError, and std::invalid_argument for times that are not positive
/// or a step that is longer than the run, or a tolerance outside [1e-13, 1e-2]. Fixed steps beyond the stability limit
/// (about 6 ms) end in IntegrationError.
RunFigures simulate(const SimulationOptions& options, const std::function<void(const TruthSample&)>& output);

}  // namespace steadyboom::hil
