#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hil/reproduction/claim.hpp"

namespace steadyboom::hil::reproduction {

/// One range that is varied, and why this far.
struct SensitivityRange {
    std::string parameter;  ///< key of the case file
    std::string range;
    std::string reason;
};

/// All claims, judged with one assumption changed.
struct Variation {
    std::string parameter;  ///< key of the case file
    std::string value;      ///< as it would stand there
    std::string symbol;     ///< for a reader of the thesis: "nu = 0.2", "K_WRP of B x 0.5"
    double factor = 1.0;    ///< value over the shipped one; 1 for the valve model
    std::string case_name;  ///< whose runs were made anew; empty for all cases
    std::vector<Row> rows;  ///< as `judge` gives them; empty if there is no run
    std::string failure;    ///< why there is none: the crane cannot stand, or the integration failed
};

struct Sensitivity {
    std::vector<SensitivityRange> ranges;
    std::vector<Variation> variations;
};

/// Judges all claims again for every variation, on two threads; runs that a variation does not touch are shared with
/// `nominal`. `progress(done, all)` is called from either thread, never from both at once, and must not throw.
[[nodiscard]] Sensitivity run_sensitivity(const ThesisRuns& nominal,
                                          const std::function<void(int done, int all)>& progress);

/// "soil.poisson_ratio = 0.2", with the case where it is one alone.
[[nodiscard]] std::string name_of(const Variation& variation);

/// A row whose verdict hangs on what is varied, and the variations that turn it.
struct TurnedRow {
    struct Turn {
        const Variation* variation;
        Verdict to;
    };
    const Row* row;  ///< as shipped
    std::vector<Turn> turns;
};
/// In the order of `rows`, which are the shipped cases'. Points into both arguments.
[[nodiscard]] std::vector<TurnedRow> turned_rows(const std::vector<Row>& rows, const Sensitivity& sensitivity);

}  // namespace steadyboom::hil::reproduction
