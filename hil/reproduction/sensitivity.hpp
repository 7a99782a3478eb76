#pragma once

#include <functional>
#include <string>
#include <vector>

#include "controllers/law.hpp"
#include "hil/run_figures.hpp"

namespace steadyboom::hil {

/// One run of a thesis case with one assumption changed, judged by what the thesis claims in words.
struct SensitivityRow {
    std::string parameter;  ///< key of the case file, "nominal" for the case as shipped
    std::string value;      ///< as it stands in the case file
    double factor = 1.0;    ///< value over the shipped one; 1 for the valve model
    std::string case_name;  ///< "case-a", "case-b", "case-c"
    controllers::LawKind law = controllers::LawKind::none;
    RunFigures figures;   ///< of the thesis's 10 s with true states
    std::string failure;  ///< why there is no run; empty where there is one
};

/// One range that is varied, and why this far.
struct SensitivityRange {
    std::string parameter;
    std::string range;
    std::string reason;
};

/// One claim in words, in one case, and where the varied runs contradict the shipped one.
struct SensitivityVerdict {
    std::string claim;
    std::string case_name;
    bool nominal = false;              ///< whether it holds with the values of the case file
    std::vector<std::string> changed;  ///< "key = value" of every variation in which it is the other way round
};

struct Sensitivity {
    std::vector<SensitivityRange> ranges;
    std::vector<SensitivityRow> rows;  ///< in the order of the runs: case, then variation, then law
    std::vector<SensitivityVerdict> verdicts;
};

/// Runs every variation of every case without a law and with law 2 on two threads; `progress(done, all)` is called from
/// either thread, never from both at once, and must not throw. A variation that cannot stand or integrate is a row with
/// its failure, and changes every verdict of its case. `duration_s` is the thesis's 10 s; shorter for a quick look.
/// Throws
/// std::invalid_argument for a duration that is not positive, and what load_case throws.
[[nodiscard]] Sensitivity run_sensitivity(const std::function<void(int done, int all)>& progress,
                                          double duration_s = 10.0);

}  // namespace steadyboom::hil
