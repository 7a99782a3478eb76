#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/run_result.hpp"

namespace steadyboom::hil {

/// The figures of several runs of one case for the terminal: a row for each figure, a column for each run. Beside each
/// value stands in brackets its ratio to the uncontrolled run, if that is among `runs`. Four runs take at most 120
/// columns.
[[nodiscard]] std::string figure_table(std::span<const RunResult> runs);

/// One run as a JSON object: law, case, bus, rate_Hz, duration_s, seed, every key of figure_rows in SI, stayed_engaged,
/// trouble, and with `uncontrolled` an object ratio_to_uncontrolled with the same keys, null where a ratio says
/// nothing.
[[nodiscard]] std::string figures_json(const RunResult& run, const RunFigures* uncontrolled);

/// The run without a law among `runs`; null if there is none.
[[nodiscard]] const RunResult* uncontrolled_run(std::span<const RunResult> runs) noexcept;

/// `figures` over `uncontrolled` in one row; nothing where the row is not compared or the divisor is zero.
[[nodiscard]] std::optional<double> ratio_to(const RunFigures& uncontrolled, const RunFigures& figures,
                                             const FigureRow& row) noexcept;

/// Three significant digits without an exponent, in the row's unit: "2.08", "17.3", "0.024", "10143".
[[nodiscard]] std::string figure_text(const RunFigures& figures, const FigureRow& row);

/// What a reader of the figures must know besides: the run left command, or its load pressure passed the crane's report
/// level. Each begins with the law's name.
[[nodiscard]] std::vector<std::string> remarks(const RunResult& run);

/// A ratio for people: "0.24", "13.1", "120".
[[nodiscard]] std::string ratio_text(double ratio);

}  // namespace steadyboom::hil
