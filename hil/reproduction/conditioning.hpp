#pragma once

#include "hil/reproduction/thesis_runs.hpp"

namespace steadyboom::hil::reproduction {

/// How well M p'' = Q can be solved along a run, by the singular values' ratio of M: as it is, with metres and radians
/// mixed, and with rows and columns scaled to a unit diagonal.
struct Conditioning {
    std::string run;
    double condition_at_rest = 0.0;
    double worst_condition = 0.0;  ///< over all steps of the integrator
    double scaled_condition_at_rest = 0.0;
    double worst_scaled_condition = 0.0;
    int rows = 0;  ///< of M: coordinates of the crane on the run's boom
    /// Rows whose diagonal entry does not outweigh the sum of the others, at rest, which the thesis calls
    /// ill-conditioned (chapter 4).
    int rows_without_dominant_diagonal = 0;
    /// Largest difference over the run between the accelerations by LDL' without pivoting, which the crane uses, and by
    /// Gauss elimination with full pivoting, which the thesis uses; relative, each entry weighted by the root of M's.
    double solver_difference = 0.0;
};

/// Of a run without control, on its own boom: integrates it anew with the valve shut, because a beam's state is more
/// than the thesis's coordinates tell. Takes a few tenths of a second for 10 s. Throws what simulate throws.
[[nodiscard]] Conditioning conditioning_of(const ThesisRun& run);

}  // namespace steadyboom::hil::reproduction
