#pragma once

#include <array>
#include <string_view>

#include "hil/truth_sample.hpp"

namespace steadyboom::hil {

/// What a run is judged by, all of the true crane and of t_s >= 0. Excursions are deviations from the equilibrium.
/// "Late" is the second half of the run; the residual energy is the mean over its last second.
struct RunFigures {
    double peak_R1_m = 0.0;
    double peak_phi2_rad = 0.0;
    double peak_phi6_rad = 0.0;
    double peak_phi9_rad = 0.0;
    double peak_q1_m = 0.0;
    double late_rms_R1_m = 0.0;
    double late_rms_phi2_rad = 0.0;
    double late_rms_phi6_rad = 0.0;
    double late_rms_phi9_rad = 0.0;
    double late_rms_q1_m = 0.0;
    double pendent_slack_share = 0.0;    ///< of the time, 0 to 1
    double load_line_slack_share = 0.0;  ///< of the time, 0 to 1
    double peak_opening_m = 0.0;         ///< largest |X_v| of the spool
    double peak_power_W = 0.0;           ///< largest |hydraulic power|
    double residual_energy_J = 0.0;      ///< model page, section 9
    double peak_R1_time_s = 0.0;         ///< when the largest R1 excursion was
    double peak_load_pressure_Pa = 0.0;
};

/// Key, unit and member of each figure, in the order of tables and JSON.
struct FigureRow {
    std::string_view key;    ///< JSON key, unit suffix included
    std::string_view label;  ///< for people
    std::string_view unit;   ///< as shown to people
    double scale = 1.0;      ///< from SI to `unit`
    double RunFigures::*value = nullptr;
    bool compared = true;  ///< whether its ratio to the uncontrolled run says anything
};
inline constexpr std::array figure_rows{
    FigureRow{"peak_R1_m", "peak R1", "mm", 1e3, &RunFigures::peak_R1_m},
    FigureRow{"late_rms_R1_m", "late RMS R1", "mm", 1e3, &RunFigures::late_rms_R1_m},
    FigureRow{"peak_phi2_rad", "peak phi2", "mrad", 1e3, &RunFigures::peak_phi2_rad},
    FigureRow{"late_rms_phi2_rad", "late RMS phi2", "mrad", 1e3, &RunFigures::late_rms_phi2_rad},
    FigureRow{"peak_phi6_rad", "peak phi6", "mrad", 1e3, &RunFigures::peak_phi6_rad},
    FigureRow{"late_rms_phi6_rad", "late RMS phi6", "mrad", 1e3, &RunFigures::late_rms_phi6_rad},
    FigureRow{"peak_phi9_rad", "peak phi9", "mrad", 1e3, &RunFigures::peak_phi9_rad},
    FigureRow{"late_rms_phi9_rad", "late RMS phi9", "mrad", 1e3, &RunFigures::late_rms_phi9_rad},
    FigureRow{"peak_q1_m", "peak q1", "mm", 1e3, &RunFigures::peak_q1_m},
    FigureRow{"late_rms_q1_m", "late RMS q1", "mm", 1e3, &RunFigures::late_rms_q1_m},
    FigureRow{"pendent_slack_share", "pendent slack", "%", 100.0, &RunFigures::pendent_slack_share},
    FigureRow{"load_line_slack_share", "load line slack", "%", 100.0, &RunFigures::load_line_slack_share},
    FigureRow{"peak_opening_m", "peak valve opening", "mm", 1e3, &RunFigures::peak_opening_m, false},
    FigureRow{"peak_power_W", "peak hydraulic power", "kW", 1e-3, &RunFigures::peak_power_W, false},
    FigureRow{"residual_energy_J", "residual energy", "J", 1.0, &RunFigures::residual_energy_J},
    FigureRow{"peak_R1_time_s", "time of peak R1", "s", 1.0, &RunFigures::peak_R1_time_s, false},
    FigureRow{"peak_load_pressure_Pa", "peak load pressure", "MPa", 1e-6, &RunFigures::peak_load_pressure_Pa, false},
};

/// Sums up a run as it goes, one sample per integration step.
class FigureAccumulator {
  public:
    /// Figures are of 0 <= t_s <= duration_s; other samples are ignored. `equilibrium` is the state that excursions
    /// count from. Throws std::invalid_argument unless duration_s is positive.
    FigureAccumulator(const plant::CraneState& equilibrium, double duration_s);

    /// Samples come in the order of time; each stands for the time since the one before it.
    void add(const TruthSample& sample) noexcept;

    [[nodiscard]] RunFigures figures() const noexcept;

  private:
    plant::CraneState reference_;
    double duration_s_;
    double last_t_s_ = 0.0;
    double time_s_ = 0.0;
    double late_time_s_ = 0.0;
    double residual_time_s_ = 0.0;
    double pendent_slack_s_ = 0.0;
    double load_line_slack_s_ = 0.0;
    double residual_J_s_ = 0.0;
    plant::Coordinates late_squares_ = plant::Coordinates::Zero();
    RunFigures peaks_;
};

}  // namespace steadyboom::hil
