#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/reproduction/claim.hpp"

namespace steadyboom::hil::reproduction {

/// Rows as a table for a terminal: id, claim, thesis, here, verdict; then how many hold.
[[nodiscard]] std::string table_of(const std::vector<Row>& rows);

/// Every number: each row with its measures and the ranges they were judged by (null for no bound), and the counts.
[[nodiscard]] std::string json_of(const std::vector<Row>& rows);

/// Self-contained HTML page: the claims first, then the thesis's figures. Throws std::runtime_error if gnuplot is
/// missing.
[[nodiscard]] std::string page_of(const std::vector<Row>& rows, const ThesisRuns& runs);

}  // namespace steadyboom::hil::reproduction
