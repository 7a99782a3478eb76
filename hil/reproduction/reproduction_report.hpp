#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/reproduction/claim.hpp"
#include "hil/reproduction/misprints.hpp"
#include "hil/reproduction/sensitivity.hpp"

namespace steadyboom::hil::reproduction {

/// Rows as a table for a terminal: id, claim, thesis, here, verdict; then how many hold.
[[nodiscard]] std::string table_of(const std::vector<Row>& rows);

/// What stands beside the claims.
struct Appendix {
    std::vector<MisprintRow> misprints;
    Sensitivity sensitivity;
};

/// Every number: each row with its measures and the ranges they were judged by (null for no bound), the counts, and the
/// numbers of the appendix.
[[nodiscard]] std::string json_of(const std::vector<Row>& rows, const Appendix& appendix);

/// Self-contained HTML page: the claims first, then the appendix, then the thesis's figures. Throws std::runtime_error
/// if gnuplot is missing.
[[nodiscard]] std::string page_of(const std::vector<Row>& rows, const Appendix& appendix, const ThesisRuns& runs);

}  // namespace steadyboom::hil::reproduction
