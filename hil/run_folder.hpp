#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "drivers/can_frame.hpp"
#include "hil/run_result.hpp"

namespace steadyboom::hil {

/// Writes a run as ticks.csv, can.log and figures.json into `folder`, which is created. Every file appears whole under
/// its name. `uncontrolled`, if given, are the figures of the same case without a law. Throws std::runtime_error that
/// names the path and the cause.
void write_run_folder(const std::filesystem::path& folder, const RunResult& run,
                      const RunFigures* uncontrolled = nullptr);

/// Content of ticks.csv, one line a tick, numbers in the shortest form that reads back the same. Columns, each with its
/// unit: t_s; the sensors' values `_meas`, empty where no good sample came with the tick; the observer's state `_est`;
/// the true crane's state and outputs `_true`; then the command. sampled_t_s is when the measured values were taken,
/// empty before the first.
[[nodiscard]] std::string ticks_csv(const RunResult& run);

/// Content of can.log, as `candump -L` writes it. The in-process bus goes by the name can0, because readers of such
/// logs want an interface's name.
[[nodiscard]] std::string can_log(std::span<const drivers::CanFrame> frames, std::string_view bus);

}  // namespace steadyboom::hil
