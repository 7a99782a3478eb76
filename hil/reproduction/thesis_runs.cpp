#include "hil/reproduction/thesis_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "hil/true_crane.hpp"
#include "plant/energy.hpp"
#include "plant/linear_modes.hpp"

namespace steadyboom::hil::reproduction {

using controllers::LawKind;

namespace {

constexpr auto signal_count = static_cast<std::size_t>(Signal::count);
constexpr double visible_share = 0.2;
constexpr double compared_up_to_Hz = 30.0;

constexpr std::array members{&ThesisRuns::a,
                             &ThesisRuns::a1,
                             &ThesisRuns::a2,
                             &ThesisRuns::a3,
                             &ThesisRuns::b,
                             &ThesisRuns::b2,
                             &ThesisRuns::c,
                             &ThesisRuns::c2,
                             &ThesisRuns::a1_halved,
                             &ThesisRuns::a1_doubled,
                             &ThesisRuns::a2_halved,
                             &ThesisRuns::a2_doubled,
                             &ThesisRuns::a3_halved,
                             &ThesisRuns::a3_doubled,
                             &ThesisRuns::b2_halved,
                             &ThesisRuns::b2_doubled,
                             &ThesisRuns::c2_halved,
                             &ThesisRuns::c2_doubled,
                             &ThesisRuns::a_soft,
                             &ThesisRuns::b_on_soil_of_a,
                             &ThesisRuns::b_at_angle_of_a,
                             &ThesisRuns::a_beam};
static_assert(sizeof(ThesisRuns) == members.size() * sizeof(ThesisRun), "every run is in the list");

std::vector<RunMode> modes_of(const Case& crane_case) {
    return with_boom(crane_case.boom, [&]<class Boom>(std::type_identity<Boom>) {
        const TrueCrane<Boom> crane(crane_case.crane);
        std::vector<RunMode> modes;
        for (const plant::LinearMode& mode : plant::linear_modes(crane.dynamics(), crane.equilibrium().state)) {
            modes.push_back({mode.frequency_Hz, mode.damping_ratio, plant::coordinate_name<Boom>(mode.dominant)});
        }
        return modes;
    });
}

std::span<const double> part(const ThesisRun& run, Signal signal, double from_s, double to_s) {
    const std::vector<double>& values = run.signal(signal);
    const auto index = [&](double t_s) {
        const double place = std::round(t_s / run.period_s());
        return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(values.size() - 1)));
    };
    const std::size_t first = index(from_s);
    return std::span(values).subspan(first, index(to_s) - first + 1);
}

double mean_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double rms_of(std::span<const double> values) {
    return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
                     static_cast<double>(values.size()));
}

}  // namespace

std::string_view name_of(Signal signal) noexcept {
    static constexpr std::array<std::string_view, signal_count> names{"R1_m",
                                                                      "phi2_rad",
                                                                      "R9_m",
                                                                      "q1_m",
                                                                      "q2_m",
                                                                      "phi6_rad",
                                                                      "phi9_rad",
                                                                      "R1_rate_m_s",
                                                                      "phi2_rate_rad_s",
                                                                      "R9_rate_m_s",
                                                                      "q1_rate_m_s",
                                                                      "q2_rate_m_s",
                                                                      "phi6_rate_rad_s",
                                                                      "phi9_rate_rad_s",
                                                                      "piston_m",
                                                                      "pendent_tension_N",
                                                                      "load_line_tension_N",
                                                                      "chord_m",
                                                                      "spool_m",
                                                                      "power_W",
                                                                      "contact_fraction",
                                                                      "boom_energy_J",
                                                                      "crane_energy_J"};
    return names[static_cast<std::size_t>(signal)];
}

ThesisRun::ThesisRun(std::string name, const SimulationOptions& options) {
    const auto record = std::make_shared<Record>(Record{.name = std::move(name),
                                                        .options = options,
                                                        .rest = rest_of(options.crane_case),
                                                        .modes = modes_of(options.crane_case),
                                                        .figures = {},
                                                        .signals = std::vector<std::vector<double>>(signal_count),
                                                        .spectra = std::vector<Spectrum>(signal_count)});
    const plant::Equilibrium& rest = record->rest;
    const plant::Soil soil(options.crane_case.crane.soil);
    const auto soil_energy_J = [&](const plant::CraneState& state) {
        return plant::full_contact_energy_J(soil, state[plant::R1_m], state[plant::phi2_rad]);
    };

    TruthSample last;
    last.state = rest.state;
    last.pendent_tension_N = rest.pendent_tension_N;
    record->figures = simulate(options, [&](const TruthSample& sample) {
        const plant::CraneState deviation = sample.state - rest.state;
        const auto add = [&](Signal signal, double value) {
            record->signals[static_cast<std::size_t>(signal)].push_back(value);
        };
        for (int i = 0; i < plant::state_count; ++i) {
            add(static_cast<Signal>(i), deviation[i]);
        }
        add(Signal::pendent_tension_N, sample.pendent_tension_N);
        add(Signal::load_line_tension_N, sample.load_line_tension_N);
        add(Signal::chord_m, sample.chord_m);
        add(Signal::spool_m, sample.spool_m);
        add(Signal::power_W, sample.hydraulic_power_W);
        add(Signal::contact_fraction, sample.contact_fraction);
        add(Signal::boom_energy_J, sample.boom_energy_J);
        add(Signal::crane_energy_J, sample.residual_energy_J);
        record->soil_work_J += plant::soil_power_W(soil, sample.state[plant::R1_m], sample.state[plant::phi2_rad],
                                                   sample.state[plant::velocity_offset + plant::R1_m],
                                                   sample.state[plant::velocity_offset + plant::phi2_rad]) *
                               (sample.t_s - last.t_s);
        const double tension_N = 0.5 * (sample.pendent_tension_N + last.pendent_tension_N) - rest.pendent_tension_N;
        record->piston_work_J += tension_N * (sample.state[plant::piston_index] - last.state[plant::piston_index]);
        last = sample;
    });
    record->soil_work_J += soil_energy_J(last.state) - soil_energy_J(rest.state);
    for (std::size_t i = 0; i < signal_count; ++i) {
        // Without the last sample the record is as long as the run: whole periods of 1/duration stand on a bin.
        record->spectra[i] = amplitude_spectrum(std::span(record->signals[i]).first(record->signals[i].size() - 1),
                                                options.output_period_s);
    }
    record_ = record;
}

std::vector<const ThesisRun*> ThesisRuns::all() const {
    std::vector<const ThesisRun*> runs;
    for (ThesisRun ThesisRuns::*run : members) {
        runs.push_back(&(this->*run));
    }
    return runs;
}

ThesisRuns run_thesis(const RunSettings& settings, const std::function<void(std::string_view)>& progress) {
    if (!(settings.duration_s >= 10.0 * settings.period_s)) {
        throw std::invalid_argument("the runs must last at least ten sampling periods");
    }
    const Case case_a = load_case("case-a");
    const Case case_b = load_case("case-b");
    const Case case_c = load_case("case-c");
    const auto run = [&](std::string name, const Case& crane_case, LawKind law) {
        progress(name);
        return ThesisRun(std::move(name), {.crane_case = crane_case,
                                           .law = law,
                                           .duration_s = settings.duration_s,
                                           .step_s = {},
                                           .output_period_s = settings.period_s});
    };
    const auto with_gains = [](Case crane_case, double factor) {
        controllers::ThesisGains& gains = crane_case.gains;
        for (double* gain : {&gains.boom_angle_gain_m_rad, &gains.boom_rate_gain_m_s_rad, &gains.joint_gain_m_m,
                             &gains.swing_rate_gain_m_s_rad}) {
            *gain *= factor;
        }
        return crane_case;
    };
    const auto halved = [&](const std::string& name, const Case& crane_case, LawKind law) {
        return run(name + ", gains halved", with_gains(crane_case, 0.5), law);
    };
    const auto doubled = [&](const std::string& name, const Case& crane_case, LawKind law) {
        return run(name + ", gains doubled", with_gains(crane_case, 2.0), law);
    };
    Case a_soft = case_a;
    a_soft.crane.soil.shear_modulus_Pa *= 0.5;
    Case b_on_soil_of_a = case_b;
    b_on_soil_of_a.crane.soil.shear_modulus_Pa = case_a.crane.soil.shear_modulus_Pa;
    Case b_at_angle_of_a = case_b;
    b_at_angle_of_a.crane.structure.boom_angle_rad = case_a.crane.structure.boom_angle_rad;
    Case a_beam = case_a;
    a_beam.boom = BoomKind::beam;
    using enum LawKind;
    return {.a = run("case A", case_a, none),
            .b = run("case B", case_b, none),
            .c = run("case C", case_c, none),
            .a1 = run("case A, law 1", case_a, boom_angle),
            .a2 = run("case A, law 2", case_a, joint_deflection),
            .a3 = run("case A, law 3", case_a, swing_rate),
            .b2 = run("case B, law 2", case_b, joint_deflection),
            .c2 = run("case C, law 2", case_c, joint_deflection),
            .a1_halved = halved("case A, law 1", case_a, boom_angle),
            .a1_doubled = doubled("case A, law 1", case_a, boom_angle),
            .a2_halved = halved("case A, law 2", case_a, joint_deflection),
            .a2_doubled = doubled("case A, law 2", case_a, joint_deflection),
            .a3_halved = halved("case A, law 3", case_a, swing_rate),
            .a3_doubled = doubled("case A, law 3", case_a, swing_rate),
            .b2_halved = halved("case B, law 2", case_b, joint_deflection),
            .b2_doubled = doubled("case B, law 2", case_b, joint_deflection),
            .c2_halved = halved("case C, law 2", case_c, joint_deflection),
            .c2_doubled = doubled("case C, law 2", case_c, joint_deflection),
            .a_soft = run("case A on soil half as stiff", a_soft, none),
            .b_on_soil_of_a = run("case B on the soil of case A", b_on_soil_of_a, none),
            .b_at_angle_of_a = run("case B at the boom angle of case A", b_at_angle_of_a, none),
            .a_beam = run("case A with the beam", a_beam, none)};
}

ThesisRuns rerun(const ThesisRuns& runs, std::string_view case_name,
                 const std::function<void(plant::CraneParameters&)>& change) {
    ThesisRuns changed = runs;
    for (ThesisRun ThesisRuns::*member : members) {
        ThesisRun& run = changed.*member;
        if (case_name.empty() || run.options().crane_case.name == case_name) {
            SimulationOptions options = run.options();
            change(options.crane_case.crane);
            run = ThesisRun(run.name(), options);
        }
    }
    return changed;
}

double peak(const ThesisRun& run, Signal signal, double from_s, double to_s) {
    return std::max(highest(run, signal, from_s, to_s), -lowest(run, signal, from_s, to_s));
}

double peak_time_s(const ThesisRun& run, Signal signal) {
    const std::vector<double>& values = run.signal(signal);
    const auto largest = std::ranges::max_element(values, {}, [](double value) { return std::abs(value); });
    return static_cast<double>(largest - values.begin()) * run.period_s();
}

double highest(const ThesisRun& run, Signal signal, double from_s, double to_s) {
    return std::ranges::max(part(run, signal, from_s, to_s));
}

double lowest(const ThesisRun& run, Signal signal, double from_s, double to_s) {
    return std::ranges::min(part(run, signal, from_s, to_s));
}

double rms(const ThesisRun& run, Signal signal, double from_s, double to_s) {
    return rms_of(part(run, signal, from_s, to_s));
}

double fluctuation(const ThesisRun& run, Signal signal, double from_s, double to_s) {
    const std::span<const double> values = part(run, signal, from_s, to_s);
    const double mean = mean_of(values);
    double squares = 0.0;
    for (const double value : values) {
        squares += (value - mean) * (value - mean);
    }
    return std::sqrt(squares / static_cast<double>(values.size()));
}

double correlation(const ThesisRun& run, Signal signal, const ThesisRun& other, Signal other_signal, double from_s) {
    const std::span<const double> left = part(run, signal, from_s, 1e9);
    const std::span<const double> right = part(other, other_signal, from_s, 1e9);
    const double left_mean = mean_of(left);
    const double right_mean = mean_of(right);
    double both = 0.0, left_squares = 0.0, right_squares = 0.0;
    for (std::size_t i = 0; i < std::min(left.size(), right.size()); ++i) {
        both += (left[i] - left_mean) * (right[i] - right_mean);
        left_squares += (left[i] - left_mean) * (left[i] - left_mean);
        right_squares += (right[i] - right_mean) * (right[i] - right_mean);
    }
    return both / std::sqrt(left_squares * right_squares);
}

double settling_time_s(const ThesisRun& run, Signal signal, double level) {
    const std::vector<double>& values = run.signal(signal);
    for (std::size_t i = values.size(); i > 0; --i) {
        if (std::abs(values[i - 1]) > level) {
            return static_cast<double>(i - 1) * run.period_s();
        }
    }
    return 0.0;
}

double dominant_Hz(const ThesisRun& run, Signal signal, double from_Hz, double to_Hz) {
    for (const SpectralPeak& found : peaks(run.spectrum(signal), from_Hz, 0.0)) {
        if (found.frequency_Hz <= to_Hz) {
            return found.frequency_Hz;
        }
    }
    return 0.0;
}

std::vector<SpectralPeak> visible_peaks(const ThesisRun& run, Signal signal) {
    return peaks(run.spectrum(signal), slowest_Hz, visible_share);
}

double visible_count(const ThesisRun& run, Signal signal) {
    return static_cast<double>(visible_peaks(run, signal).size());
}

double lowest_visible_Hz(const ThesisRun& run, Signal signal) {
    const std::vector<SpectralPeak> found = visible_peaks(run, signal);
    return found.empty() ? 0.0 : std::ranges::min(found, {}, &SpectralPeak::frequency_Hz).frequency_Hz;
}

double left_over(const ThesisRun& run, Signal signal) {
    return fluctuation(run, signal, run.duration_s() - 3.0) / fluctuation(run, signal, 0.0, 2.0);
}

double chord_range_m(const ThesisRun& run) {
    return highest(run, Signal::chord_m) - lowest(run, Signal::chord_m);
}

double boom_mode_Hz(const ThesisRun& run) {
    const auto found = std::ranges::find_if(run.modes(), [](const RunMode& mode) {
        return mode.dominant.starts_with('q') || mode.dominant.starts_with('a');
    });
    return found == run.modes().end() ? 0.0 : found->frequency_Hz;
}

double residual_share(const ThesisRun& run, const ThesisRun& other) {
    return run.figures().residual_energy_J / other.figures().residual_energy_J;
}

double spectral_likeness(const ThesisRun& run, Signal signal, const ThesisRun& other, Signal other_signal) {
    const Spectrum& left = run.spectrum(signal);
    const Spectrum& right = other.spectrum(other_signal);
    double both = 0.0, left_squares = 0.0, right_squares = 0.0;
    for (std::size_t i = 0; i < std::min(left.amplitude.size(), right.amplitude.size()); ++i) {
        const double frequency_Hz = static_cast<double>(i) * left.spacing_Hz;
        if (frequency_Hz < slowest_Hz || frequency_Hz > compared_up_to_Hz) {
            continue;
        }
        both += left.amplitude[i] * right.amplitude[i];
        left_squares += left.amplitude[i] * left.amplitude[i];
        right_squares += right.amplitude[i] * right.amplitude[i];
    }
    return both / std::sqrt(left_squares * right_squares);
}

QuietSpell quiet_spell(const ThesisRun& run, Signal signal, double from_s, double to_s, double window_s,
                       double again_s) {
    constexpr double step_s = 0.05;
    const auto around = [&](double t_s) { return rms(run, signal, t_s - 0.5 * window_s, t_s + 0.5 * window_s); };
    double quiet_s = from_s;
    double least = around(from_s);
    for (double t_s = from_s; t_s <= to_s + 1e-9; t_s += step_s) {
        if (const double here = around(t_s); here < least) {
            least = here;
            quiet_s = t_s;
        }
    }
    double most = least;
    const double end_s = std::min(quiet_s + again_s, run.duration_s() - 0.5 * window_s);
    for (double t_s = quiet_s; t_s <= end_s + 1e-9; t_s += step_s) {
        most = std::max(most, around(t_s));
    }
    return {quiet_s, most / least};
}

}  // namespace steadyboom::hil::reproduction
