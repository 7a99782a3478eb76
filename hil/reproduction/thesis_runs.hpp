#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/reproduction/spectrum.hpp"
#include "hil/simulation.hpp"
#include "plant/equilibrium.hpp"

namespace steadyboom::hil::reproduction {

/// What of a run is looked at: the deviation of a state from the equilibrium, or a quantity as it is.
enum class Signal : int {
    R1_m,
    phi2_rad,
    R9_m,
    q1_m,
    q2_m,
    phi6_rad,
    phi9_rad,
    R1_rate_m_s,
    phi2_rate_rad_s,
    R9_rate_m_s,
    q1_rate_m_s,
    q2_rate_m_s,
    phi6_rate_rad_s,
    phi9_rate_rad_s,
    piston_m,
    pendent_tension_N,
    load_line_tension_N,
    chord_m,
    spool_m,
    power_W,
    contact_fraction,
    boom_energy_J,   ///< bending and joint motion, about the equilibrium
    crane_energy_J,  ///< plant::ResidualEnergy
    count
};

/// One run of the thesis: the law sees the true state, nothing is sampled. Signals have one value every `period_s` from
/// t_s = 0 to `duration_s`.
class ThesisRun {
  public:
    /// Runs hil::simulate. Throws what it throws.
    ThesisRun(std::string name, const SimulationOptions& options);

    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    [[nodiscard]] const SimulationOptions& options() const noexcept { return options_; }
    [[nodiscard]] const RunFigures& figures() const noexcept { return figures_; }
    [[nodiscard]] double duration_s() const noexcept { return options_.duration_s; }
    [[nodiscard]] double period_s() const noexcept { return options_.output_period_s; }
    [[nodiscard]] const std::vector<double>& signal(Signal signal) const noexcept {
        return signals_[static_cast<std::size_t>(signal)];
    }
    [[nodiscard]] const Spectrum& spectrum(Signal signal) const noexcept {
        return spectra_[static_cast<std::size_t>(signal)];
    }
    /// Energy of the motion that the soil's damping took, J, at most 0: the soil's work less what its spring holds at
    /// the end (full contact at both ends).
    [[nodiscard]] double soil_work_J() const noexcept { return soil_work_J_; }
    /// Energy of the motion that the piston gave, J, negative if it took some: the integral of T_P - T_P0 over X_p.
    /// What lifts the standing boom is not in it.
    [[nodiscard]] double piston_work_J() const noexcept { return piston_work_J_; }

  private:
    std::string name_;
    SimulationOptions options_;
    RunFigures figures_;
    std::vector<std::vector<double>> signals_;
    std::vector<Spectrum> spectra_;
    double soil_work_J_ = 0.0;
    double piston_work_J_ = 0.0;
};

/// Every run that a claim of chapters 5, 7 and 8 is judged by: cases A, B and C without control, laws 1 to 3 on A, law
/// 2 on B and C, law 2 on C with twice its gain, and case A on soil with half its shear modulus.
struct ThesisRuns {
    ThesisRun a, b, c, a1, a2, a3, b2, c2, c2_doubled, a_soft;

    [[nodiscard]] std::vector<const ThesisRun*> all() const {
        return {&a, &a1, &a2, &a3, &b, &b2, &c, &c2, &c2_doubled, &a_soft};
    }
};

struct RunSettings {
    double duration_s = 10.0;
    double period_s = 0.001;
};

/// Runs them; `progress` is told of each before it starts. Throws what load_case and simulate throw.
[[nodiscard]] ThesisRuns run_thesis(const RunSettings& settings, const std::function<void(std::string_view)>& progress);

// Measures of signals. Times in s since the brake event.

[[nodiscard]] double peak(const ThesisRun& run, Signal signal, double from_s = 0.0, double to_s = 1e9);
[[nodiscard]] double peak_time_s(const ThesisRun& run, Signal signal);
[[nodiscard]] double highest(const ThesisRun& run, Signal signal, double from_s = 0.0, double to_s = 1e9);
[[nodiscard]] double lowest(const ThesisRun& run, Signal signal, double from_s = 0.0, double to_s = 1e9);
[[nodiscard]] double rms(const ThesisRun& run, Signal signal, double from_s = 0.0, double to_s = 1e9);
/// Standard deviation.
[[nodiscard]] double fluctuation(const ThesisRun& run, Signal signal, double from_s = 0.0, double to_s = 1e9);
/// Correlation coefficient of two signals, of one run or of two of equal sampling.
[[nodiscard]] double correlation(const ThesisRun& run, Signal signal, const ThesisRun& other, Signal other_signal,
                                 double from_s = 0.0);
/// Last time at which |signal| is above `level`.
[[nodiscard]] double settling_time_s(const ThesisRun& run, Signal signal, double level);
/// Frequency of the largest peak above 0.3 Hz, three bins of a run of 10 s; 0 if there is none.
[[nodiscard]] double dominant_Hz(const ThesisRun& run, Signal signal, double from_Hz = 0.3, double to_Hz = 60.0);
/// Peaks above 0.3 Hz of at least a fifth of the largest, which is what a printed plot shows.
[[nodiscard]] std::vector<SpectralPeak> visible_peaks(const ThesisRun& run, Signal signal);
/// Cosine between two amplitude spectra up to 30 Hz: 1 if they are proportional, 0 if they share nothing.
[[nodiscard]] double spectral_likeness(const ThesisRun& run, Signal signal, const ThesisRun& other,
                                       Signal other_signal);

/// A quiet spell: where the RMS over `window_s` is smallest between two times, and how much larger it is again within
/// `again_s` after that.
struct QuietSpell {
    double time_s;
    double regain;
};
[[nodiscard]] QuietSpell quiet_spell(const ThesisRun& run, Signal signal, double from_s, double to_s, double window_s,
                                     double again_s);

}  // namespace steadyboom::hil::reproduction
