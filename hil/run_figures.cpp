#include "hil/run_figures.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace steadyboom::hil {

using namespace plant;

FigureAccumulator::FigureAccumulator(const CraneState& equilibrium, double duration_s)
    : reference_(equilibrium), duration_s_(duration_s) {
    if (!(duration_s > 0.0)) {
        throw std::invalid_argument("figures: the duration must be positive");
    }
}

void FigureAccumulator::add(const TruthSample& sample) noexcept {
    constexpr double rounding_s = 1e-9;
    if (sample.t_s < -rounding_s || sample.t_s > duration_s_ + rounding_s) {
        return;
    }
    const double span_s = std::max(0.0, sample.t_s - last_t_s_);
    last_t_s_ = sample.t_s;
    const Coordinates deviation = coordinates_of(sample.state) - coordinates_of(reference_);
    const auto raise = [](double& peak, double value) { peak = std::max(peak, std::abs(value)); };
    if (std::abs(deviation[R1_m]) > peaks_.peak_R1_m) {
        peaks_.peak_R1_time_s = sample.t_s;
    }
    raise(peaks_.peak_R1_m, deviation[R1_m]);
    raise(peaks_.peak_phi2_rad, deviation[phi2_rad]);
    raise(peaks_.peak_phi6_rad, deviation[phi6_rad]);
    raise(peaks_.peak_phi9_rad, deviation[phi9_rad]);
    raise(peaks_.peak_q1_m, deviation[q1_m]);
    raise(peaks_.peak_opening_m, sample.spool_m);
    raise(peaks_.peak_power_W, sample.hydraulic_power_W);
    raise(peaks_.peak_load_pressure_Pa, sample.load_pressure_Pa);
    time_s_ += span_s;
    if (sample.pendent_tension_N <= 0.0) {
        pendent_slack_s_ += span_s;
    }
    if (sample.load_line_tension_N <= 0.0) {
        load_line_slack_s_ += span_s;
    }
    if (sample.t_s > 0.5 * duration_s_) {
        late_time_s_ += span_s;
        late_squares_ += span_s * deviation.cwiseAbs2();
    }
    if (sample.t_s > duration_s_ - 1.0) {
        residual_time_s_ += span_s;
        residual_J_s_ += span_s * sample.residual_energy_J;
    }
}

RunFigures FigureAccumulator::figures() const noexcept {
    RunFigures figures = peaks_;
    const auto mean = [](double sum, double time_s) { return time_s > 0.0 ? sum / time_s : 0.0; };
    const auto rms = [&](Coordinate coordinate) { return std::sqrt(mean(late_squares_[coordinate], late_time_s_)); };
    figures.late_rms_R1_m = rms(R1_m);
    figures.late_rms_phi2_rad = rms(phi2_rad);
    figures.late_rms_phi6_rad = rms(phi6_rad);
    figures.late_rms_phi9_rad = rms(phi9_rad);
    figures.late_rms_q1_m = rms(q1_m);
    figures.pendent_slack_share = mean(pendent_slack_s_, time_s_);
    figures.load_line_slack_share = mean(load_line_slack_s_, time_s_);
    figures.residual_energy_J = mean(residual_J_s_, residual_time_s_);
    return figures;
}

}  // namespace steadyboom::hil
