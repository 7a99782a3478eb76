#include "hil/reproduction/claim.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace steadyboom::hil::reproduction {

namespace {

using enum Signal;
using Measures = std::vector<Measure>;

/// Largest of a signal with a law over that without.
double peak_ratio(const ThesisRun& with, const ThesisRun& without, Signal signal) {
    return peak(with, signal) / peak(without, signal);
}

double percent(double ratio) {
    return 100.0 * (ratio - 1.0);
}

/// RMS from `from_s` on, with a law over without.
double rest_ratio(const ThesisRun& with, const ThesisRun& without, Signal signal, double from_s = 5.0) {
    return fluctuation(with, signal, from_s) / fluctuation(without, signal, from_s);
}

double peak_power_kW(const ThesisRun& run) {
    return 1e-3 * run.figures().peak_power_W;
}

/// "Attenuated": at most half is left; in kind, anything less than without.
Measure attenuated(const std::string& name, double ratio) {
    return at_most(name + ", with the law over without", "", ratio, 0.5, 1.0);
}

/// How much sooner a motion falls for good below a fifth of the largest without a law.
double sooner_s(const ThesisRun& with, const ThesisRun& without, Signal signal) {
    const double level = 0.2 * peak(without, signal);
    return settling_time_s(without, signal, level) - settling_time_s(with, signal, level);
}

/// How many visible peaks of one spectrum have a visible peak of another within 0.25 Hz.
double coinciding(const ThesisRun& run, Signal signal, Signal other) {
    double found = 0.0;
    for (const SpectralPeak& one : visible_peaks(run, signal)) {
        for (const SpectralPeak& two : visible_peaks(run, other)) {
            if (std::abs(one.frequency_Hz - two.frequency_Hz) <= 0.25) {
                found += 1.0;
                break;
            }
        }
    }
    return found;
}

/// Energy that the piston gave the crane, in per cent of what the crane had at the start.
double piston_share_percent(const ThesisRun& run) {
    return 100.0 * run.piston_work_J() / run.signal(crane_energy_J).front();
}

/// Energy left with the printed gain over the least of half and twice that gain.
Measure best_gain(const ThesisRun& run, const ThesisRun& halved, const ThesisRun& doubled) {
    return at_most("energy left over the least with half and twice the gain", "",
                   run.figures().residual_energy_J /
                       std::min(halved.figures().residual_energy_J, doubled.figures().residual_energy_J),
                   1.0, 1.1);
}

Condition gain_would_have_to_be(ThesisRun ThesisRuns::*run, ThesisRun ThesisRuns::*halved,
                                ThesisRun ThesisRuns::*doubled) {
    return [=](const ThesisRuns& r) {
        const auto energy_J = [&](ThesisRun ThesisRuns::*which) { return (r.*which).figures().residual_energy_J; };
        return fmt::format(
            "The printed gain would have to lie near the best. Half of it leaves {:.0f} J, the gain as "
            "printed {:.0f} J, twice that {:.0f} J",
            energy_J(halved), energy_J(run), energy_J(doubled));
    };
}

const std::string power_if =
    "The power is (P_L - P_L0) K_q X_v here; the thesis's psi and gal/min leave its scale open, and its P_L0 does not "
    "follow "
    "from its own crane. The law's error signal would have to be as in the thesis's run, too";
const std::string peak_if =
    "The first peak would have to be as far into the piston's action as in the thesis: its size depends on the "
    "frequencies "
    "of chapter 5, which differ";

std::vector<Claim> case_a_law_1() {
    return {
        {"7-A1-01", "7, case A, law 1", "24, 63", "The tracks' largest vertical motion grows", "larger", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {larger("largest R1, with over without", peak_ratio(r.a1, r.a, R1_m))};
         }},
        {"7-A1-02", "7, case A, law 1", "25, 64", "The largest track rotation grows", "larger", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {larger("largest phi2, with over without", peak_ratio(r.a1, r.a, phi2_rad))};
         }},
        {"7-A1-03", "7, case A, law 1", "63", "The tracks' vertical motion is far smaller from 3 s on", "dramatically",
         "The law would have to damp the ground's motion; with the printed gains it goes on driving it to the end",
         [](const ThesisRuns& r) -> Measures {
             return {attenuated("RMS of R1 from 3 s", rest_ratio(r.a1, r.a, R1_m, 3.0))};
         }},
        {"7-A1-04", "7, case A, law 1", "64", "The track rotation is far smaller from 3 s on", "dramatically",
         "The law would have to damp the ground's motion; with the printed gains it goes on driving it to the end",
         [](const ThesisRuns& r) -> Measures {
             return {attenuated("RMS of phi2 from 3 s", rest_ratio(r.a1, r.a, phi2_rad, 3.0))};
         }},
        {"7-A1-05", "7, case A, law 1", "26, 65", "The boom chord's largest rotation is slightly smaller",
         "slightly smaller", "",
         [](const ThesisRuns& r) -> Measures {
             const double ratio = peak_ratio(r.a1, r.a, phi6_rad);
             return {{"largest phi6, with over without", "", ratio, Range{0.75, 1.0}, Range{0.0, 1.0}}};
         }},
        {"7-A1-06", "7, case A, law 1", "65", "The chord's rotation goes on to the end without getting smaller",
         "no further reduction",
         "The law would have to leave the chord's motion undamped, as with a lag or a limit in its loop",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("phi6, fluctuation of 8-10 s over 2-4 s", "",
                              fluctuation(r.a1, phi6_rad, 8.0) / fluctuation(r.a1, phi6_rad, 2.0, 4.0), 0.8, 0.5)};
         }},
        {"7-A1-07", "7, case A, law 1", "67", "9.0 Hz dominate the boom chord's rotation", "9.0 Hz",
         [](const ThesisRuns& r) { return mode_would_have_to_be(r.a1, 9.0); },
         [](const ThesisRuns& r) -> Measures {
             return {frequency("phi6, dominant", 9.0, dominant_Hz(r.a1, phi6_rad))};
         }},
        {"7-A1-08", "7, case A, law 1", "33, 67", "That is faster than without control", "9.0 over 7.0 Hz", "",
         [](const ThesisRuns& r) -> Measures {
             return {
                 larger("phi6, dominant with over without", dominant_Hz(r.a1, phi6_rad) / dominant_Hz(r.a, phi6_rad))};
         }},
        {"7-A1-09", "7, case A, law 1", "66", "The boom's bending is damped where it was not", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("what is left of q1, with over without", "", left_over(r.a1, q1_m) / left_over(r.a, q1_m),
                             0.8, 1.0)};
         }},
        {"7-A1-10", "7, case A, law 1", "63-66", "The largest of every coordinate but R1 and phi2 is smaller",
         "all five", peak_if,
         [](const ThesisRuns& r) -> Measures {
             double fewer = 0.0;
             for (const Signal signal : {R9_m, q1_m, q2_m, phi6_rad, phi9_rad}) {
                 fewer += peak_ratio(r.a1, r.a, signal) < 1.0 ? 1.0 : 0.0;
             }
             return {at_least("coordinates with a smaller largest value", "of 5", fewer, 5.0, 3.0)};
         }},
        {"7-A1-11", "7, case A, law 1", "68", "The actuator needs almost 96 kW", "96 kW", power_if,
         [](const ThesisRuns& r) -> Measures { return {number("peak power", "kW", 96.0, peak_power_kW(r.a1))}; }},
        {"7-A1-12", "7, case A, law 1", "31, 69", "The spectrum of R1 has changed: the law works against the ground",
         "very different", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("likeness of R1's spectrum to that without", "", spectral_likeness(r.a1, R1_m, r.a, R1_m),
                             0.5, 0.8)};
         }},
        {"7-A1-13", "7, case A, law 1", "35, 70", "The spectrum of the load's stretch has changed", "very different",
         "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("likeness of R9's spectrum to that without", "", spectral_likeness(r.a1, R9_m, r.a, R9_m),
                             0.5, 0.8)};
         }},
        {"7-A1-14", "7, case A, law 1", "68", "The energy goes into the actuator rather than into the soil",
         "qualitative",
         "The piston would have to yield to the tension's swings; with these gains it pushes against the motion and "
         "feeds it",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("piston's work on the crane, of the energy at the start", "%", piston_share_percent(r.a1),
                             -50.0, 0.0)};
         }},
        {"7-A1-15", "7, case A, law 1", "-", "Its gains are those that leave the least motion", "the best",
         gain_would_have_to_be(&ThesisRuns::a1, &ThesisRuns::a1_halved, &ThesisRuns::a1_doubled),
         [](const ThesisRuns& r) -> Measures { return {best_gain(r.a1, r.a1_halved, r.a1_doubled)}; }},
        {"7-A1-16", "7, case A, law 1", "63-66", "The law improves the crane's response", "improved", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("energy left, with over without", residual_share(r.a1, r.a))};
         }},
        {"7-A1-17", "7, case A, law 1", "-", "Without control too the soil takes energy out of the crane",
         "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("taken by the soil within 10 s, of the energy at the start", "%",
                              -100.0 * r.a.soil_work_J() / r.a.signal(crane_energy_J).front(), 1.0, 0.0)};
         }},
    };
}

std::vector<Claim> case_a_law_2() {
    return {
        {"7-A2-01", "7, case A, law 2", "24, 71", "The tracks' largest vertical motion grows by 20 %", "+20 %", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {change("largest R1", 20.0, percent(peak_ratio(r.a2, r.a, R1_m)))};
         }},
        {"7-A2-02", "7, case A, law 2", "71", "The tracks' vertical motion is far smaller from 2 s on", "dramatically",
         "",
         [](const ThesisRuns& r) -> Measures {
             return {attenuated("RMS of R1 from 2 s", rest_ratio(r.a2, r.a, R1_m, 2.0))};
         }},
        {"7-A2-03", "7, case A, law 2", "25, 72", "The largest track rotation is smaller", "smaller", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {smaller("largest phi2, with over without", peak_ratio(r.a2, r.a, phi2_rad))};
         }},
        {"7-A2-04", "7, case A, law 2", "72", "The track rotation damps out much within 10 s", "significantly", "",
         [](const ThesisRuns& r) -> Measures {
             return {attenuated("RMS of phi2 from 5 s", rest_ratio(r.a2, r.a, phi2_rad))};
         }},
        {"7-A2-05", "7, case A, law 2", "26, 73", "The boom chord's rotation looks as without control", "similar", "",
         [](const ThesisRuns& r) -> Measures {
             return {
                 same("phi6, dominant with over without", dominant_Hz(r.a2, phi6_rad) / dominant_Hz(r.a, phi6_rad))};
         }},
        {"7-A2-06", "7, case A, law 2", "73", "The boom chord's rotation damps out much", "significantly", "",
         [](const ThesisRuns& r) -> Measures {
             return {attenuated("RMS of phi6 from 5 s", rest_ratio(r.a2, r.a, phi6_rad))};
         }},
        {"7-A2-07", "7, case A, law 2", "27, 74", "The largest pendulation is smaller", "smaller", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {smaller("largest phi9, with over without", peak_ratio(r.a2, r.a, phi9_rad))};
         }},
        {"7-A2-08", "7, case A, law 2", "74", "The pendulation is much smaller during the run", "significantly",
         "The law would have to damp the slow pendulum swing, which bends the boom too little to be seen in q1",
         [](const ThesisRuns& r) -> Measures {
             return {attenuated("RMS of phi9 from 5 s", rest_ratio(r.a2, r.a, phi9_rad))};
         }},
        {"7-A2-09", "7, case A, law 2", "74, 77", "The slow frequency of the ground is still there in the pendulation",
         "still there", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("phi9 below 2 Hz, with over without", "",
                              largest_amplitude(r.a2.spectrum(phi9_rad), 0.1, 2.0) /
                                  largest_amplitude(r.a.spectrum(phi9_rad), 0.1, 2.0),
                              0.5, 0.2)};
         }},
        {"7-A2-10", "7, case A, law 2", "75, 76", "Load stretch and lower joint have nearly the same record",
         "almost identical",
         "One mode would have to make up both: the pendent's motion reaches the joint and not the load line",
         [](const ThesisRuns& r) -> Measures {
             return {
                 at_least("|correlation| of R9 and q1", "", std::abs(correlation(r.a2, R9_m, r.a2, q1_m)), 0.9, 0.7)};
         }},
        {"7-A2-11", "7, case A, law 2", "75, 76", "Both are smaller", "attenuated", "",
         [](const ThesisRuns& r) -> Measures {
             return {attenuated("RMS of R9 from 5 s", rest_ratio(r.a2, r.a, R9_m)),
                     attenuated("RMS of q1 from 5 s", rest_ratio(r.a2, r.a, q1_m))};
         }},
        {"7-A2-12", "7, case A, law 2", "29, 78", "The pendent's tension fluctuates less", "smaller", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("fluctuation, with over without",
                             fluctuation(r.a2, pendent_tension_N) / fluctuation(r.a, pendent_tension_N))};
         }},
        {"7-A2-13", "7, case A, law 2", "78", "The pendent does not go slack", "never", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("pendent slack", "% of the time", 100.0 * r.a2.figures().pendent_slack_share, 0.0, 0.1)};
         }},
        {"7-A2-14", "7, case A, law 2", "29, 78", "The load line is slack less often", "fewer periods", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("slack share, with over without",
                             r.a2.figures().load_line_slack_share / r.a.figures().load_line_slack_share)};
         }},
        {"7-A2-15", "7, case A, law 2", "78", "The load's motion damps out faster", "faster", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("what is left of the load line's tension, with over without",
                             left_over(r.a2, load_line_tension_N) / left_over(r.a, load_line_tension_N))};
         }},
        {"7-A2-16", "7, case A, law 2", "24-28, 71-76", "The crane keeps its character, unlike with law 1",
         "very similar", "",
         [](const ThesisRuns& r) -> Measures {
             double more_alike = 0.0;
             for (const Signal signal : {R1_m, phi2_rad, R9_m, phi6_rad, phi9_rad}) {
                 more_alike +=
                     spectral_likeness(r.a2, signal, r.a, signal) > spectral_likeness(r.a1, signal, r.a, signal) ? 1.0
                                                                                                                 : 0.0;
             }
             return {at_least("spectra more like those without than law 1's are", "of 5", more_alike, 5.0, 3.0)};
         }},
        {"7-A2-17", "7, case A, law 2", "79", "The actuator needs 13.0 kW", "13.0 kW", power_if,
         [](const ThesisRuns& r) -> Measures { return {number("peak power", "kW", 13.0, peak_power_kW(r.a2))}; }},
        {"7-A2-18", "7, case A, law 2", "68, 79", "It needs far less power than law 1", "13.0 against 96 kW", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("power, law 2 over law 1", "", peak_power_kW(r.a2) / peak_power_kW(r.a1), 0.2, 1.0)};
         }},
        {"7-A2-19", "7, case A, law 2", "63-66, 71-76", "It leaves less motion than law 1", "less", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("residual energy, law 2 over law 1", residual_share(r.a2, r.a1))};
         }},
        {"7-A2-20", "7, case A, law 2", "79", "The energy goes into the soil rather than into the actuator",
         "qualitative",
         "The soil's share of the crane's energy would have to be the larger: here the piston takes it out",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("piston's take over the soil's", "", r.a2.piston_work_J() / r.a2.soil_work_J(), 0.5, 1.0)};
         }},
        {"7-A2-21", "7, case A, law 2", "67, 80", "Its signal q1 is faster than law 1's phi6", "faster", "",
         [](const ThesisRuns& r) -> Measures {
             return {larger("q1 with law 2 over phi6 with law 1, dominant",
                            dominant_Hz(r.a2, q1_m) / dominant_Hz(r.a1, phi6_rad))};
         }},
        {"7-A2-22", "7, case A, law 2", "77", "Many frequencies make up R1", "many",
         "The catch would have to excite the faster modes as much as the slow ones: they are there, at less than a "
         "fifth of the largest",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("visible peaks of R1", "", visible_count(r.a2, R1_m), 4.0, 3.0)};
         }},
        {"7-A2-23", "7, case A, law 2", "80", "Three frequencies make up q1", "3", "",
         [](const ThesisRuns& r) -> Measures {
             return {number("visible peaks of q1", "", 3.0, visible_count(r.a2, q1_m))};
         }},
        {"7-A2-24", "7, case A, law 2", "77, 80", "They lie among those of R1", "all three", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("share of q1's visible peaks that R1 has", "",
                              coinciding(r.a2, q1_m, R1_m) / visible_count(r.a2, q1_m), 1.0, 0.5)};
         }},
        {"7-A2-25", "7, case A, law 2", "-", "Its gain is that which leaves the least motion", "the best",
         gain_would_have_to_be(&ThesisRuns::a2, &ThesisRuns::a2_halved, &ThesisRuns::a2_doubled),
         [](const ThesisRuns& r) -> Measures { return {best_gain(r.a2, r.a2_halved, r.a2_doubled)}; }},
        {"7-A2-26", "7, case A, law 2", "-", "The two boom joints are strongly coupled", "strongly", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("|correlation| of q1 and q2 without control", "",
                              std::abs(correlation(r.a, q1_m, r.a, q2_m)), 0.8, 0.5)};
         }},
        {"7-A2-27", "7, case A, law 2", "78", "Less bending means that the boom's chord fluctuates less", "less", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("fluctuation of the chord, with over without",
                             fluctuation(r.a2, chord_m) / fluctuation(r.a, chord_m))};
         }},
        {"7-A2-28", "7, case A, law 2", "76", "Feeding back the lower joint alone calms the upper one too",
         "the whole boom", "",
         [](const ThesisRuns& r) -> Measures {
             return {attenuated("RMS of q2 from 5 s", rest_ratio(r.a2, r.a, q2_m))};
         }},
        {"7-A2-29", "7, case A, law 2", "68, 79, 85", "Of the three laws it needs the least power",
         "13.0, 96, over 200 kW", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("power, law 2 over law 1", peak_power_kW(r.a2) / peak_power_kW(r.a1)),
                     smaller("law 2 over law 3", peak_power_kW(r.a2) / peak_power_kW(r.a3))};
         }},
    };
}

std::vector<Claim> case_a_law_3() {
    return {
        {"7-A3-01", "7, case A, law 3", "63, 81", "R1 looks much as with law 1", "very similar",
         "Boom angle and swing rate would have to act alike; here the valve at its limits makes law 3 a motion of its "
         "own",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("likeness of the spectra", "", spectral_likeness(r.a3, R1_m, r.a1, R1_m), 0.7, 0.4)};
         }},
        {"7-A3-02", "7, case A, law 3", "64, 82", "phi2 looks much as with law 1", "very similar",
         "Boom angle and swing rate would have to act alike; here the valve at its limits makes law 3 a motion of its "
         "own",
         [](const ThesisRuns& r) -> Measures {
             return {
                 at_least("likeness of the spectra", "", spectral_likeness(r.a3, phi2_rad, r.a1, phi2_rad), 0.7, 0.4)};
         }},
        {"7-A3-03", "7, case A, law 3", "63, 81", "The largest R1 is larger than with law 1", "larger", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {larger("largest R1, law 3 over law 1", peak_ratio(r.a3, r.a1, R1_m))};
         }},
        {"7-A3-04", "7, case A, law 3", "64, 82", "The largest phi2 is larger than with law 1", "larger", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {larger("largest phi2, law 3 over law 1", peak_ratio(r.a3, r.a1, phi2_rad))};
         }},
        {"7-A3-05", "7, case A, law 3", "81, 82", "Over 10 s the ground's motion is smaller than with law 1", "smaller",
         "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("RMS of R1 from 5 s, law 3 over law 1", rest_ratio(r.a3, r.a1, R1_m)),
                     smaller("RMS of phi2 from 5 s, law 3 over law 1", rest_ratio(r.a3, r.a1, phi2_rad))};
         }},
        {"7-A3-06", "7, case A, law 3", "27, 83", "The largest pendulation is smaller than without control", "smaller",
         peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {smaller("largest phi9, with over without", peak_ratio(r.a3, r.a, phi9_rad))};
         }},
        {"7-A3-07", "7, case A, law 3", "83", "The pendulation is far smaller from 3 s on", "dramatically",
         "The law would have to damp the pendulum; moving the boom's tip after the load excites its slow swing",
         [](const ThesisRuns& r) -> Measures {
             return {attenuated("RMS of phi9 from 3 s", rest_ratio(r.a3, r.a, phi9_rad, 3.0))};
         }},
        {"7-A3-08", "7, case A, law 3", "84", "The boom bends less", "reduced", "",
         [](const ThesisRuns& r) -> Measures {
             return {attenuated("RMS of q1 from 5 s", rest_ratio(r.a3, r.a, q1_m))};
         }},
        {"7-A3-09", "7, case A, law 3", "83", "The pendulation is smaller than with laws 1 and 2", "smaller",
         "Swing-rate feedback would have to act in the valve's small range most of the time, not at its limits",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("RMS of phi9 from 5 s, law 3 over law 1", rest_ratio(r.a3, r.a1, phi9_rad)),
                     smaller("the same over law 2", rest_ratio(r.a3, r.a2, phi9_rad))};
         }},
        {"7-A3-10", "7, case A, law 3", "84", "The boom bends less than with laws 1 and 2", "less",
         "As for the pendulation: more of the boom's motion would have to reach the swing rate",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("RMS of q1 from 5 s, law 3 over law 1", rest_ratio(r.a3, r.a1, q1_m)),
                     smaller("the same over law 2", rest_ratio(r.a3, r.a2, q1_m))};
         }},
        {"7-A3-11", "7, case A, law 3", "81, 82",
         "The ground pays for it: its largest motion is larger than without control", "larger", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {larger("largest R1, with over without", peak_ratio(r.a3, r.a, R1_m)),
                     larger("largest phi2, with over without", peak_ratio(r.a3, r.a, phi2_rad))};
         }},
        {"7-A3-12", "7, case A, law 3", "85", "The actuator needs over 200 kW", "over 200 kW", power_if,
         [](const ThesisRuns& r) -> Measures {
             return {at_least("peak power", "kW", peak_power_kW(r.a3), 200.0, 100.0)};
         }},
        {"7-A3-13", "7, case A, law 3", "85", "The valve reaches its limit on both sides", "both limits", "",
         [](const ThesisRuns& r) -> Measures {
             const double travel_m = r.a3.options().crane_case.crane.actuator.spool_travel_m;
             return {at_least("highest opening over the travel", "", highest(r.a3, spool_m) / travel_m, 0.9999, 0.9),
                     at_most("lowest opening over the travel", "", lowest(r.a3, spool_m) / travel_m, -0.9999, -0.9)};
         }},
        {"7-A3-14", "7, case A, law 3", "31, 86", "The spectrum of R1 has changed", "very different", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("likeness to that without", "", spectral_likeness(r.a3, R1_m, r.a, R1_m), 0.5, 0.8)};
         }},
        {"7-A3-15", "7, case A, law 3", "32, 87", "The spectrum of phi2 has changed", "very different", "",
         [](const ThesisRuns& r) -> Measures {
             return {
                 at_most("likeness to that without", "", spectral_likeness(r.a3, phi2_rad, r.a, phi2_rad), 0.5, 0.8)};
         }},
        {"7-A3-16", "7, case A, law 3", "86, 87", "10.5 Hz dominate the ground's motion", "10.5 Hz",
         [](const ThesisRuns& r) { return mode_would_have_to_be(r.a3, 10.5); },
         [](const ThesisRuns& r) -> Measures {
             return {frequency("R1, dominant", 10.5, dominant_Hz(r.a3, R1_m)),
                     frequency("phi2, dominant", 10.5, dominant_Hz(r.a3, phi2_rad))};
         }},
        {"7-A3-17", "7, case A, law 3", "31, 32, 86, 87", "That is faster than without control", "10.5 over 7.0 Hz", "",
         [](const ThesisRuns& r) -> Measures {
             return {
                 larger("R1, dominant with over without", dominant_Hz(r.a3, R1_m) / dominant_Hz(r.a, R1_m)),
                 larger("phi2, dominant with over without", dominant_Hz(r.a3, phi2_rad) / dominant_Hz(r.a, phi2_rad))};
         }},
        {"7-A3-18", "7, case A, law 3", "-", "Its gain is that which leaves the least motion", "the best",
         gain_would_have_to_be(&ThesisRuns::a3, &ThesisRuns::a3_halved, &ThesisRuns::a3_doubled),
         [](const ThesisRuns& r) -> Measures { return {best_gain(r.a3, r.a3_halved, r.a3_doubled)}; }},
        {"7-A3-19", "7, case A, law 3", "85-87", "It too passes no energy on to the soil", "qualitative",
         "The soil would have to take no more of the energy than it does without control",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("soil's take, with over without", "", r.a3.soil_work_J() / r.a.soil_work_J(), 1.0, 1.1)};
         }},
    };
}

std::vector<Claim> case_b_law_2() {
    return {
        {"7-B2-01", "7, case B, law 2", "37, 88", "R1 looks as without control", "similar",
         "The law would have to leave the ground's frequencies as they are; damping the load's bounce alters which of "
         "them dominates",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("likeness of the spectra", "", spectral_likeness(r.b2, R1_m, r.b, R1_m), 0.8, 0.5)};
         }},
        {"7-B2-02", "7, case B, law 2", "37, 88", "The tracks' largest vertical motion is 43 % smaller", "-43 %",
         "The largest motion would have to be the late, secondary one of the thesis, which a law has time to prevent; "
         "here it is "
         "the first",
         [](const ThesisRuns& r) -> Measures {
             return {change("largest R1", -43.0, percent(peak_ratio(r.b2, r.b, R1_m)))};
         }},
        {"7-B2-03", "7, case B, law 2", "88", "It damps out 2 s sooner", "2 s", "",
         [](const ThesisRuns& r) -> Measures {
             const double earlier_s = sooner_s(r.b2, r.b, R1_m);
             return {{"R1 below a fifth for good, sooner by", "s", earlier_s, Range{1.8, 2.2}, Range{0.0, 1e9}}};
         }},
        {"7-B2-04", "7, case B, law 2", "38, 89", "The largest track rotation is 7 % smaller", "-7 %", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {change("largest phi2", -7.0, percent(peak_ratio(r.b2, r.b, phi2_rad)))};
         }},
        {"7-B2-05", "7, case B, law 2", "89", "It damps out 2 s sooner", "2 s", "",
         [](const ThesisRuns& r) -> Measures {
             const double earlier_s = sooner_s(r.b2, r.b, phi2_rad);
             return {{"phi2 below a fifth for good, sooner by", "s", earlier_s, Range{1.8, 2.2}, Range{0.0, 1e9}}};
         }},
        {"7-B2-06", "7, case B, law 2", "42, 90", "The lower joint's largest deflection is the same", "the same",
         peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {same("largest q1, with over without", peak_ratio(r.b2, r.b, q1_m))};
         }},
        {"7-B2-07", "7, case B, law 2", "90", "The boom is damped slightly more", "slightly more", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("RMS of q1 from 5 s, with over without", rest_ratio(r.b2, r.b, q1_m))};
         }},
        {"7-B2-08", "7, case B, law 2", "42, 90", "The lower joint's largest velocity is 46 % smaller", "-46 %",
         "The largest joint velocity would have to come after the law had time to act; here it is the first shock's",
         [](const ThesisRuns& r) -> Measures {
             return {change("largest q1'", -46.0, percent(peak_ratio(r.b2, r.b, q1_rate_m_s)))};
         }},
        {"7-B2-09", "7, case B, law 2", "42, 90", "The boom's beat is gone", "no beat", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("regain after the quiet spell, with over without",
                             quiet_spell(r.b2, q1_rate_m_s, 3.0, 9.0, 0.5, 1.5).regain /
                                 quiet_spell(r.b, q1_rate_m_s, 3.0, 9.0, 0.5, 1.5).regain)};
         }},
        {"7-B2-10", "7, case B, law 2", "47, 91", "The boom's chord fluctuates slightly less and settles faster",
         "smaller, faster", "",
         [](const ThesisRuns& r) -> Measures {
             return {
                 smaller("fluctuation, with over without", fluctuation(r.b2, chord_m) / fluctuation(r.b, chord_m)),
                 smaller("what is left of it, with over without", left_over(r.b2, chord_m) / left_over(r.b, chord_m))};
         }},
        {"7-B2-11", "7, case B, law 2", "47, 91", "The pendent's largest tension is slightly smaller",
         "slightly smaller", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {smaller("largest tension, with over without", peak_ratio(r.b2, r.b, pendent_tension_N))};
         }},
        {"7-B2-12", "7, case B, law 2", "47, 91", "The pendent's tension settles more", "more attenuated", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("fluctuation from 5 s, with over without", rest_ratio(r.b2, r.b, pendent_tension_N))};
         }},
        {"7-B2-13", "7, case B, law 2", "47, 91", "The load line's tension settles more", "more attenuated", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("fluctuation from 5 s, with over without", rest_ratio(r.b2, r.b, load_line_tension_N))};
         }},
        {"7-B2-14", "7, case B, law 2", "92", "The actuator needs 18 kW at most", "18 kW", power_if,
         [](const ThesisRuns& r) -> Measures { return {number("peak power", "kW", 18.0, peak_power_kW(r.b2))}; }},
        {"7-B2-15", "7, case B, law 2", "88-92", "The same law and gain help less than in case A",
         "modest against dramatic", "",
         [](const ThesisRuns& r) -> Measures {
             return {
                 larger("share of the energy left, B over A", residual_share(r.b2, r.b) / residual_share(r.a2, r.a))};
         }},
        {"7-B2-16", "7, case B, law 2", "44, 93", "The spectrum of R1 is as without control", "practically unchanged",
         "The law would have to leave the ground's frequencies as they are; damping the load's bounce alters which of "
         "them dominates",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("likeness of the spectra", "", spectral_likeness(r.b2, R1_m, r.b, R1_m), 0.9, 0.6)};
         }},
        {"7-B2-17", "7, case B, law 2", "77, 93", "It is unlike case A's with the same law", "very different", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("likeness to case A's", "", spectral_likeness(r.b2, R1_m, r.a2, R1_m), 0.5, 0.8)};
         }},
        {"7-B2-18", "7, case B, law 2", "77, 93", "Fewer frequencies make up R1 than in case A", "few against many",
         "Case A would have to show more: there the load bounces on taut ropes and one or two frequencies stand out",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("visible peaks of R1, B over A", "", visible_count(r.b2, R1_m) / visible_count(r.a2, R1_m),
                             0.75, 0.99)};
         }},
        {"7-B2-19", "7, case B, law 2", "94", "One frequency makes up q1", "1",
         "The load's bounce would have to be a single frequency; a rope that goes slack spreads it",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("visible peaks of q1", "", visible_count(r.b2, q1_m), 1.0, 2.0)};
         }},
        {"7-B2-20", "7, case B, law 2", "93, 94", "It is the one that dominates R1", "the same", "",
         [](const ThesisRuns& r) -> Measures {
             return {same("q1 over R1, dominant", dominant_Hz(r.b2, q1_m) / dominant_Hz(r.b2, R1_m))};
         }},
        {"7-B2-21", "7, case B, law 2", "-", "Its gain is that which leaves the least motion", "the best",
         gain_would_have_to_be(&ThesisRuns::b2, &ThesisRuns::b2_halved, &ThesisRuns::b2_doubled),
         [](const ThesisRuns& r) -> Measures { return {best_gain(r.b2, r.b2_halved, r.b2_doubled)}; }},
        {"7-B2-22", "7, case B, law 2", "38, 89", "phi2 looks as without control", "similar",
         "The law would have to leave the ground's frequencies as they are; damping the load's bounce alters which of "
         "them dominates",
         [](const ThesisRuns& r) -> Measures {
             return {
                 at_least("likeness of the spectra", "", spectral_likeness(r.b2, phi2_rad, r.b, phi2_rad), 0.8, 0.5)};
         }},
        {"7-B2-23", "7, case B, law 2", "88-92", "The crane is calmed only modestly", "modestly",
         "The law would have to do less: it leaves less of the energy than a modest help would",
         [](const ThesisRuns& r) -> Measures {
             return {
                 {"energy left, with over without", "", residual_share(r.b2, r.b), Range{0.5, 1.0}, Range{0.25, 1.0}}};
         }},
        {"7-B2-24", "7, case B, law 2", "92-94", "The energy goes into the soil, with whose motion the law works",
         "qualitative",
         "The soil's share of the crane's energy would have to be the larger: here the piston takes it out",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("piston's take over the soil's", "", r.b2.piston_work_J() / r.b2.soil_work_J(), 0.5, 1.0)};
         }},
        {"7-B2-25", "7, case B, law 2", "77, 80, 93, 94",
         "Fewer of the law's frequencies meet one of the ground than in case A", "fewer", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("visible peaks of q1 that R1 has, A less B", "",
                              coinciding(r.a2, q1_m, R1_m) - coinciding(r.b2, q1_m, R1_m), 1.0, 1.0)};
         }},
    };
}

std::vector<Claim> case_c_law_2() {
    return {
        {"7-C2-01", "7, case C, law 2", "48, 95", "The tracks' largest vertical motion is 9 % smaller", "-9 %", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {change("largest R1", -9.0, percent(peak_ratio(r.c2, r.c, R1_m)))};
         }},
        {"7-C2-02", "7, case C, law 2", "95", "The tracks stay above where they began for all 10 s",
         "100 % of the time", "As without control: the run would have to begin below its own equilibrium",
         [](const ThesisRuns& r) -> Measures {
             const std::vector<double>& R1 = r.c2.signal(R1_m);
             double above = 0.0;
             for (const double value : R1) {
                 above += value >= 0.0 ? 1.0 : 0.0;
             }
             return {at_least("R1 above its start", "% of the time", 100.0 * above / static_cast<double>(R1.size()),
                              99.0, 75.0)};
         }},
        {"7-C2-03", "7, case C, law 2", "48, 95", "R1 has nearly the same record as without control",
         "almost identical", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("correlation of R1 with and without", "", correlation(r.c2, R1_m, r.c, R1_m), 0.9, 0.7)};
         }},
        {"7-C2-04", "7, case C, law 2", "49, 96", "The largest track rotation is 5 % smaller", "-5 %", peak_if,
         [](const ThesisRuns& r) -> Measures {
             return {change("largest phi2", -5.0, percent(peak_ratio(r.c2, r.c, phi2_rad)))};
         }},
        {"7-C2-05", "7, case C, law 2", "49, 96", "phi2 has nearly the same record as without control",
         "almost identical", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("correlation of phi2 with and without", "", correlation(r.c2, phi2_rad, r.c, phi2_rad),
                              0.9, 0.7)};
         }},
        {"7-C2-06", "7, case C, law 2", "95, 96", "The law adds no damping to the ground's motion", "none", "",
         [](const ThesisRuns& r) -> Measures {
             return {
                 same("what is left of R1, with over without", left_over(r.c2, R1_m) / left_over(r.c, R1_m)),
                 same("what is left of phi2, with over without", left_over(r.c2, phi2_rad) / left_over(r.c, phi2_rad))};
         }},
        {"7-C2-07", "7, case C, law 2", "59, 97", "The boom's chord fluctuates slightly more: the law drives the boom",
         "slightly larger", "The law would have to be in phase with the boom's bending, as with a lag in the loop",
         [](const ThesisRuns& r) -> Measures {
             return {larger("fluctuation, with over without", fluctuation(r.c2, chord_m) / fluctuation(r.c, chord_m))};
         }},
        {"7-C2-08", "7, case C, law 2", "97", "The boom's motion stays bounded and damps out", "damps out", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("what is left of the chord's fluctuation", "", left_over(r.c2, chord_m), 0.5, 1.0)};
         }},
        {"7-C2-09", "7, case C, law 2", "-", "Twice the gain bends the boom more", "larger",
         "As for the chord: more gain would have to mean more drive and not more damping",
         [](const ThesisRuns& r) -> Measures {
             return {larger("fluctuation of q1, twice the gain over once",
                            fluctuation(r.c2_doubled, q1_m) / fluctuation(r.c2, q1_m))};
         }},
        {"7-C2-10", "7, case C, law 2", "-", "Twice the gain does not drive the crane away from equilibrium", "bounded",
         "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("crane's energy at the end over the start", "",
                             r.c2_doubled.signal(crane_energy_J).back() / r.c2_doubled.signal(crane_energy_J).front(),
                             1.0, 1.0)};
         }},
        {"7-C2-11", "7, case C, law 2", "98", "The actuator needs 37.1 kW at most", "37.1 kW", power_if,
         [](const ThesisRuns& r) -> Measures { return {number("peak power", "kW", 37.1, peak_power_kW(r.c2))}; }},
        {"7-C2-12", "7, case C, law 2", "95-98", "The law hardly helps", "marginally", "",
         [](const ThesisRuns& r) -> Measures {
             const double share = residual_share(r.c2, r.c);
             return {{"energy left, with over without", "", share, Range{0.75, 1.0}, Range{0.5, 1.0}}};
         }},
        {"7-C2-13", "7, case C, law 2", "99, 100", "Many frequencies make up R1, and many q1", "many", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("visible peaks of R1", "", visible_count(r.c2, R1_m), 4.0, 3.0),
                     at_least("visible peaks of q1", "", visible_count(r.c2, q1_m), 4.0, 3.0)};
         }},
        {"7-C2-14", "7, case C, law 2", "99, 100", "They have but one of them in common", "1",
         "Fewer of the boom's frequencies would have to reach the ground; the coupling of 3.1 passes them all on",
         [](const ThesisRuns& r) -> Measures {
             return {{"visible peaks of q1 that R1 has", "", coinciding(r.c2, q1_m, R1_m), Range{1.0, 1.0},
                      Range{0.0, 2.0}}};
         }},
        {"7-C2-15", "7, case C, law 2", "-", "Its gain is that which leaves the least motion", "the best",
         gain_would_have_to_be(&ThesisRuns::c2, &ThesisRuns::c2_halved, &ThesisRuns::c2_doubled),
         [](const ThesisRuns& r) -> Measures { return {best_gain(r.c2, r.c2_halved, r.c2_doubled)}; }},
        {"7-C2-16", "7, case C, law 2", "99, 100", "The law passes hardly any more energy on to the soil", "not much",
         "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("soil's take, with over without", "", r.c2.soil_work_J() / r.c.soil_work_J(), 1.1, 1.25)};
         }},
    };
}

}  // namespace

std::vector<Claim> chapter_7_claims() {
    std::vector<Claim> claims;
    for (auto part : {case_a_law_1, case_a_law_2, case_a_law_3, case_b_law_2, case_c_law_2}) {
        for (Claim& claim : part()) {
            claims.push_back(std::move(claim));
        }
    }
    return claims;
}

}  // namespace steadyboom::hil::reproduction
