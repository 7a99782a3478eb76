#include "hil/reproduction/thesis_runs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "plant/energy.hpp"

namespace steadyboom::hil::reproduction {

using controllers::LawKind;

namespace {

constexpr auto signal_count = static_cast<std::size_t>(Signal::count);
constexpr double least_Hz = 0.3;
constexpr double visible_share = 0.2;
constexpr double compared_up_to_Hz = 30.0;

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

ThesisRun::ThesisRun(std::string name, const SimulationOptions& options)
    : name_(std::move(name)), options_(options), signals_(signal_count), spectra_(signal_count) {
    const plant::CraneDynamics crane(options.crane_case.crane);
    const plant::Equilibrium rest = plant::find_equilibrium(crane);
    const plant::ResidualEnergy energy(crane, rest.state);
    const plant::StructureParameters& structure = options.crane_case.crane.structure;
    const double link_m = structure.link_length_m();
    const double bending_N_m = 3.0 * structure.boom_joint_stiffness_N_m / (link_m * link_m);
    const Eigen::Matrix2d joint_mass =
        crane.mass_matrix(plant::coordinates_of(rest.state)).block<2, 2>(plant::q1_m, plant::q1_m);

    double last_t_s = 0.0;
    plant::CraneState last_state = rest.state;
    figures_ = simulate(options_, [&](const TruthSample& sample) {
        const plant::CraneState deviation = sample.state - rest.state;
        const auto add = [&](Signal signal, double value) {
            signals_[static_cast<std::size_t>(signal)].push_back(value);
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
        const Eigen::Vector2d q = deviation.segment<2>(plant::q1_m);
        const Eigen::Vector2d q_rate = deviation.segment<2>(plant::velocity_offset + plant::q1_m);
        add(Signal::boom_energy_J,
            bending_N_m * (q.squaredNorm() - q[0] * q[1]) + 0.5 * q_rate.dot(joint_mass * q_rate));
        add(Signal::crane_energy_J, energy.energy_J(sample.state));
        const plant::NonConservativePower power = plant::non_conservative_power(crane, sample.state, sample.spool_m);
        soil_work_J_ += power.soil_W * (sample.t_s - last_t_s);
        piston_work_J_ += power.piston_W * (sample.t_s - last_t_s);
        last_t_s = sample.t_s;
        last_state = sample.state;
    });
    soil_work_J_ += plant::full_contact_energy_J(crane, last_state) - plant::full_contact_energy_J(crane, rest.state);
    piston_work_J_ -= rest.pendent_tension_N * last_state[plant::piston_index];
    for (std::size_t i = 0; i < signal_count; ++i) {
        spectra_[i] = amplitude_spectrum(signals_[i], options_.output_period_s);
    }
}

ThesisRuns run_thesis(const RunSettings& settings, const std::function<void(std::string_view)>& progress) {
    if (!(settings.duration_s >= 10.0 * settings.period_s)) {
        throw std::invalid_argument("the runs must last at least ten sampling periods");
    }
    const auto run = [&](std::string name, std::string_view crane_case, LawKind law, auto change) {
        progress(name);
        SimulationOptions options{.crane_case = load_case(crane_case),
                                  .law = law,
                                  .duration_s = settings.duration_s,
                                  .step_s = {},
                                  .output_period_s = settings.period_s};
        change(options.crane_case);
        return ThesisRun(std::move(name), options);
    };
    const auto as_it_is = [](Case&) {};
    return {.a = run("case A", "case-a", LawKind::none, as_it_is),
            .b = run("case B", "case-b", LawKind::none, as_it_is),
            .c = run("case C", "case-c", LawKind::none, as_it_is),
            .a1 = run("case A, law 1", "case-a", LawKind::boom_angle, as_it_is),
            .a2 = run("case A, law 2", "case-a", LawKind::joint_deflection, as_it_is),
            .a3 = run("case A, law 3", "case-a", LawKind::swing_rate, as_it_is),
            .b2 = run("case B, law 2", "case-b", LawKind::joint_deflection, as_it_is),
            .c2 = run("case C, law 2", "case-c", LawKind::joint_deflection, as_it_is),
            .c2_doubled = run("case C, law 2 with twice its gain", "case-c", LawKind::joint_deflection,
                              [](Case& c) { c.gains.joint_gain_m_m *= 2.0; }),
            .a_soft = run("case A on soil half as stiff", "case-a", LawKind::none,
                          [](Case& c) { c.crane.soil.shear_modulus_Pa *= 0.5; })};
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
    return peaks(run.spectrum(signal), least_Hz, visible_share);
}

double spectral_likeness(const ThesisRun& run, Signal signal, const ThesisRun& other, Signal other_signal) {
    const Spectrum& left = run.spectrum(signal);
    const Spectrum& right = other.spectrum(other_signal);
    double both = 0.0, left_squares = 0.0, right_squares = 0.0;
    for (std::size_t i = 0; i < std::min(left.amplitude.size(), right.amplitude.size()); ++i) {
        const double frequency_Hz = static_cast<double>(i) * left.spacing_Hz;
        if (frequency_Hz < least_Hz || frequency_Hz > compared_up_to_Hz) {
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
