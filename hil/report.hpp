#pragma once

#include <filesystem>
#include <span>

#include "hil/run_result.hpp"

namespace steadyboom::hil {

/// Writes one self-contained HTML page about several runs of one case: what happened, the figures, time histories of
/// the true crane with all runs overlaid, the valve, the observer against the truth, and the settings. It loads nothing
/// from elsewhere; equal runs give equal bytes. Throws std::runtime_error if gnuplot is missing or the file cannot be
/// written, std::invalid_argument if `runs` is empty, holds a run without ticks or mixes cases.
void write_report(const std::filesystem::path& file, std::span<const RunResult> runs);

}  // namespace steadyboom::hil
