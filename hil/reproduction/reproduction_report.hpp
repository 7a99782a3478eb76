#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/reproduction/claim.hpp"
#include "hil/reproduction/conditioning.hpp"
#include "hil/reproduction/misprints.hpp"
#include "hil/reproduction/sensitivity.hpp"

namespace steadyboom::hil::reproduction {

/// Rows as a table for a terminal: id, claim, thesis, here, verdict; then how many hold.
[[nodiscard]] std::string table_of(const std::vector<Row>& rows);

/// One model of case A's boom by itself, ends pinned: plant/pinned_boom.hpp.
struct BoomAlone {
    std::string boom;
    double stiffness_N_m;  ///< equal forces at both thirds that deflect both by 1 m, one of them
    double first_Hz;
    double second_Hz;
};
/// The links of 3.1.1-12, the links with the rotations eliminated instead, and the beam, in this order.
[[nodiscard]] std::vector<BoomAlone> booms_alone(const plant::StructureParameters& structure);

/// What stands beside the claims.
struct Appendix {
    std::vector<BoomAlone> booms;
    std::vector<Conditioning> conditioning;
    std::vector<MisprintRow> misprints;  ///< empty if left out
    Sensitivity sensitivity;             ///< empty if left out
};

/// Every number: the counts, each row with its measures and the ranges they were judged by (null for no bound), each
/// run with its figures, modes and visible spectral peaks, and the appendix, where every variation has every row's
/// verdict and values.
[[nodiscard]] std::string json_of(const std::vector<Row>& rows, const Appendix& appendix, const ThesisRuns& runs);

/// Self-contained HTML page: the claims first, then the thesis's figures, then the appendix. Throws std::runtime_error
/// if gnuplot is missing.
[[nodiscard]] std::string page_of(const std::vector<Row>& rows, const Appendix& appendix, const ThesisRuns& runs);

}  // namespace steadyboom::hil::reproduction
