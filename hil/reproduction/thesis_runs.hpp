#pragma once

#include <functional>
#include <memory>
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
    q1_m,  ///< of the beam: its deflection at a third and at two thirds of its length
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
    boom_energy_J,   ///< TruthSample::boom_energy_J
    crane_energy_J,  ///< TruthSample::residual_energy_J
    count
};

/// "R1_m", "pendent_tension_N" and so on.
[[nodiscard]] std::string_view name_of(Signal signal) noexcept;

/// plant::LinearMode with the name of its coordinate, whatever the boom.
struct RunMode {
    double frequency_Hz;
    double damping_ratio;
    std::string dominant;
};

/// One run of the thesis: the law sees the true state, nothing is sampled. Signals have one value every `period_s` from
/// t_s = 0 to `duration_s`. Copies share what was computed, which nothing changes.
class ThesisRun {
  public:
    /// Runs hil::simulate. Throws what it throws.
    ThesisRun(std::string name, const SimulationOptions& options);

    [[nodiscard]] const std::string& name() const noexcept { return record_->name; }
    [[nodiscard]] const SimulationOptions& options() const noexcept { return record_->options; }
    [[nodiscard]] const RunFigures& figures() const noexcept { return record_->figures; }
    [[nodiscard]] double duration_s() const noexcept { return record_->options.duration_s; }
    [[nodiscard]] double period_s() const noexcept { return record_->options.output_period_s; }
    [[nodiscard]] const plant::Equilibrium& rest() const noexcept { return record_->rest; }
    /// About the equilibrium, valve shut, ascending in frequency.
    [[nodiscard]] const std::vector<RunMode>& modes() const noexcept { return record_->modes; }
    [[nodiscard]] const std::vector<double>& signal(Signal signal) const noexcept {
        return record_->signals[static_cast<std::size_t>(signal)];
    }
    [[nodiscard]] const Spectrum& spectrum(Signal signal) const noexcept {
        return record_->spectra[static_cast<std::size_t>(signal)];
    }
    /// Energy of the motion that the soil's damping took, J, at most 0: the soil's work less what its spring holds at
    /// the end (full contact at both ends).
    [[nodiscard]] double soil_work_J() const noexcept { return record_->soil_work_J; }
    /// Energy of the motion that the piston gave, J, negative if it took some: the integral of T_P - T_P0 over X_p.
    /// What lifts the standing boom is not in it.
    [[nodiscard]] double piston_work_J() const noexcept { return record_->piston_work_J; }

  private:
    struct Record {
        std::string name;
        SimulationOptions options;
        plant::Equilibrium rest;
        std::vector<RunMode> modes;
        RunFigures figures;
        std::vector<std::vector<double>> signals;
        std::vector<Spectrum> spectra;
        double soil_work_J = 0.0;
        double piston_work_J = 0.0;
    };
    std::shared_ptr<const Record> record_;
};

/// Every run that a claim of chapters 5, 7 and 8 is judged by: the cases without control, laws 1 to 3 on A, law 2 on B
/// and C, each law with half and twice its gains, case A on soil with half its shear modulus, case B with case A's soil
/// or boom angle, and case A with the beam for a boom.
struct ThesisRuns {
    ThesisRun a, b, c, a1, a2, a3, b2, c2;
    ThesisRun a1_halved, a1_doubled, a2_halved, a2_doubled, a3_halved, a3_doubled;
    ThesisRun b2_halved, b2_doubled, c2_halved, c2_doubled;
    ThesisRun a_soft, b_on_soil_of_a, b_at_angle_of_a, a_beam;

    [[nodiscard]] std::vector<const ThesisRun*> all() const;
};

struct RunSettings {
    double duration_s = 10.0;
    double period_s = 0.001;
};

/// Runs them; `progress` is told of each before it starts. Throws what load_case and simulate throw.
[[nodiscard]] ThesisRuns run_thesis(const RunSettings& settings, const std::function<void(std::string_view)>& progress);

/// `runs` with every run of the named case, or of all cases if the name is empty, made anew after `change`; the others
/// are shared. Throws what simulate throws.
[[nodiscard]] ThesisRuns rerun(const ThesisRuns& runs, std::string_view case_name,
                               const std::function<void(plant::CraneParameters&)>& change);

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
/// Slowest vibration that counts as a frequency: the resolution of 10 s under a Hann window, 4/T. What is slower cannot
/// be told from a drift of the mean.
inline constexpr double slowest_Hz = 0.4;
/// Frequency of the largest peak between two frequencies; 0 if there is none.
[[nodiscard]] double dominant_Hz(const ThesisRun& run, Signal signal, double from_Hz = slowest_Hz, double to_Hz = 60.0);
/// Peaks from slowest_Hz on of at least a fifth of the largest, which is what a printed plot shows.
[[nodiscard]] std::vector<SpectralPeak> visible_peaks(const ThesisRun& run, Signal signal);
[[nodiscard]] double visible_count(const ThesisRun& run, Signal signal);
/// The slowest of the visible peaks; 0 if there is none.
[[nodiscard]] double lowest_visible_Hz(const ThesisRun& run, Signal signal);
/// How much of a motion's first two seconds is left in its last three.
[[nodiscard]] double left_over(const ThesisRun& run, Signal signal);
/// Longest less shortest chord of the run, m.
[[nodiscard]] double chord_range_m(const ThesisRun& run);
/// Slowest mode of which the boom's own coordinates have the largest share, Hz.
[[nodiscard]] double boom_mode_Hz(const ThesisRun& run);
/// Residual energy of one run over that of another.
[[nodiscard]] double residual_share(const ThesisRun& run, const ThesisRun& other);
/// Cosine between two amplitude spectra from slowest_Hz to 30 Hz: 1 if they are proportional, 0 if they share nothing.
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
