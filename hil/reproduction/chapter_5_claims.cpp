#include "hil/reproduction/claim.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plant/pinned_boom.hpp"

namespace steadyboom::hil::reproduction {

namespace {

using enum Signal;
using Measures = std::vector<Measure>;

constexpr double end_s = 1e9;

/// Largest of a band above slowest_Hz over the largest of another.
double band_ratio(const ThesisRun& run, Signal signal, Range over, Range under) {
    return largest_amplitude(run.spectrum(signal), over.low, over.high) /
           largest_amplitude(run.spectrum(signal), under.low, under.high);
}

/// Where a cycle's slow swing ends and vibration begins.
constexpr Range slow_Hz{0.1, 2.0};
constexpr Range fast_Hz{2.0, 60.0};

constexpr std::array coordinates{R1_m, phi2_rad, R9_m, q1_m, q2_m, phi6_rad, phi9_rad};

/// Of how many coordinates less is left in one run than in another.
double coordinates_damped_faster(const ThesisRun& run, const ThesisRun& than) {
    return static_cast<double>(std::ranges::count_if(
        coordinates, [&](Signal signal) { return left_over(run, signal) < left_over(than, signal); }));
}

double unlikeness(const ThesisRun& run, const ThesisRun& other, Signal signal) {
    return std::abs(correlation(run, signal, other, signal));
}

Condition mode_at(ThesisRun ThesisRuns::*run, double frequency_Hz) {
    return [=](const ThesisRuns& r) { return mode_would_have_to_be(r.*run, frequency_Hz); };
}

Condition half_period(Signal signal, double time_s) {
    return [=](const ThesisRuns& r) {
        const double found_Hz = dominant_Hz(r.a, signal);
        return fmt::format(
            "Half a period of what dominates this motion would have to be {:g} s; at {:.2g} Hz it is "
            "{:.2g} s",
            time_s, found_Hz, 0.5 / found_Hz);
    };
}

Condition later_shock(Signal signal) {
    return [=](const ThesisRuns& r) {
        return fmt::format("A later shock would have to outdo the first; the largest from 1 s on is {:.0f} % of it",
                           100.0 * peak(r.b, signal, 1.0) / peak(r.b, signal, 0.0, 1.0));
    };
}

Condition cancelling(Signal signal, double from_s, double to_s, double again_s) {
    return [=](const ThesisRuns& r) {
        const QuietSpell spell = quiet_spell(r.b, signal, from_s, to_s, 0.5, again_s);
        return fmt::format(
            "The modes that make up this motion would have to cancel then; they do at {:.2g} s, and "
            "there is {:.2g} times that motion soon after",
            spell.time_s, spell.regain);
    };
}

}  // namespace

std::vector<Claim> chapter_5_claims() {
    return {
        // Case A
        {"5-A-01", "5, case A", "24", "The largest vertical motion of the tracks comes from the first shock, at 0.2 s",
         "0.2 s", half_period(R1_m, 0.2),
         [](const ThesisRuns& r) -> Measures {
             return {number("time of the largest R1", "s", 0.2, peak_time_s(r.a, R1_m))};
         }},
        {"5-A-02", "5, case A", "25", "The largest track rotation comes from the first shock, at 0.2 s", "0.2 s",
         half_period(phi2_rad, 0.2),
         [](const ThesisRuns& r) -> Measures {
             return {number("time of the largest phi2", "s", 0.2, peak_time_s(r.a, phi2_rad))};
         }},
        {"5-A-03", "5, case A", "24, 25", "Bounce and rotation of the tracks are strongly coupled", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("likeness of the spectra of R1 and phi2", "", spectral_likeness(r.a, R1_m, r.a, phi2_rad),
                              0.7, 0.4)};
         }},
        {"5-A-04", "5, case A", "27", "A slow component is prominent in the pendulation", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("phi9, largest below 2 Hz over largest above", "",
                              band_ratio(r.a, phi9_rad, slow_Hz, fast_Hz), 0.33, 0.1)};
         }},
        {"5-A-05", "5, case A", "26", "The boom chord's rotation has that slow component too", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("phi6, largest below 2 Hz over largest above", "",
                              band_ratio(r.a, phi6_rad, slow_Hz, fast_Hz), 0.33, 0.1)};
         }},
        {"5-A-06", "5, case A", "28, 36", "The load's stretching is strongly coupled to the boom's bending",
         "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("likeness of the spectra of R9 and q1", "", spectral_likeness(r.a, R9_m, r.a, q1_m), 0.7,
                              0.4)};
         }},
        {"5-A-07", "5, case A", "29", "The pendent goes slack", "slack at times",
         [](const ThesisRuns& r) {
             const auto least_percent = [](const ThesisRun& run) {
                 return 100.0 * lowest(run, pendent_tension_N) / run.rest().pendent_tension_N;
             };
             return fmt::format(
                 "The swing of the pendent's tension would have to take away all that it carries at "
                 "rest; {:.0f} % is always left. In case B, caught after {:.2g} times the drop, {:.0f} % "
                 "is",
                 least_percent(r.a),
                 r.b.options().crane_case.manoeuvre.load_drop_m / r.a.options().crane_case.manoeuvre.load_drop_m,
                 least_percent(r.b));
         },
         [](const ThesisRuns& r) -> Measures {
             return {at_least("pendent slack", "% of the time", 100.0 * r.a.figures().pendent_slack_share, 0.1, 0.01)};
         }},
        {"5-A-08", "5, case A", "29", "The load line goes slack", "slack at times", "",
         [](const ThesisRuns& r) -> Measures {
             return {
                 at_least("load line slack", "% of the time", 100.0 * r.a.figures().load_line_slack_share, 0.1, 0.01)};
         }},
        {"5-A-09", "5, case A", "35", "The faster of the two dominant frequencies of the load's stretch is 18 Hz",
         "18 Hz", "",
         [](const ThesisRuns& r) -> Measures {
             return {frequency("R9, largest peak above 12 Hz", 18.0, dominant_Hz(r.a, R9_m, 12.0))};
         }},
        {"5-A-10", "5, case A", "35", "The slower of the two dominant frequencies of the load's stretch is 7 Hz",
         "7 Hz", mode_at(&ThesisRuns::a, 7.0),
         [](const ThesisRuns& r) -> Measures {
             return {frequency("R9, largest peak below 12 Hz", 7.0, dominant_Hz(r.a, R9_m, slowest_Hz, 12.0))};
         }},
        {"5-A-11", "5, case A", "35", "The faster frequency dominates the load's stretch", "18 Hz over 7 Hz",
         "The catch of the load would have to excite the boom's bending more than the load line's own mode",
         [](const ThesisRuns& r) -> Measures {
             return {larger("R9, largest above 12 Hz over largest below",
                            band_ratio(r.a, R9_m, {12.0, 60.0}, {slowest_Hz, 12.0}))};
         }},
        {"5-A-12", "5, case A", "36", "The same 18 Hz dominate the boom's bending", "18 Hz",
         [](const ThesisRuns& r) {
             return fmt::format(
                 "The catch would have to excite the boom's own bending, which is there at {:.3g} Hz, "
                 "more than the load's bounce at {:.2g} Hz, which bends the boom too",
                 dominant_Hz(r.a, q1_m, 12.0), dominant_Hz(r.a, q1_m));
         },
         [](const ThesisRuns& r) -> Measures { return {frequency("q1, dominant", 18.0, dominant_Hz(r.a, q1_m))}; }},
        {"5-A-13", "5, case A", "32", "7 Hz dominate the track rotation", "7 Hz", mode_at(&ThesisRuns::a, 7.0),
         [](const ThesisRuns& r) -> Measures {
             return {frequency("phi2, dominant", 7.0, dominant_Hz(r.a, phi2_rad))};
         }},
        {"5-A-14", "5, case A", "33", "7 Hz dominate the boom chord's rotation", "7 Hz", mode_at(&ThesisRuns::a, 7.0),
         [](const ThesisRuns& r) -> Measures {
             return {frequency("phi6, dominant", 7.0, dominant_Hz(r.a, phi6_rad))};
         }},
        {"5-A-15", "5, case A", "34", "7 Hz dominate the pendulation", "7 Hz", mode_at(&ThesisRuns::a, 7.0),
         [](const ThesisRuns& r) -> Measures {
             return {frequency("phi9, dominant", 7.0, dominant_Hz(r.a, phi9_rad))};
         }},
        {"5-A-16", "5, case A", "31", "7 Hz dominate the tracks' vertical motion", "7 Hz", mode_at(&ThesisRuns::a, 7.0),
         [](const ThesisRuns& r) -> Measures { return {frequency("R1, dominant", 7.0, dominant_Hz(r.a, R1_m))}; }},
        {"5-A-17", "5, case A", "32, 33, 34",
         "Track rotation, boom rotation and pendulation share one dominant frequency", "the same", "",
         [](const ThesisRuns& r) -> Measures {
             return {same("phi6 over phi2, dominant", dominant_Hz(r.a, phi6_rad) / dominant_Hz(r.a, phi2_rad)),
                     same("phi9 over phi2, dominant", dominant_Hz(r.a, phi9_rad) / dominant_Hz(r.a, phi2_rad))};
         }},
        {"5-A-18", "5, case A", "35, 36",
         "The load's stretch is coupled more to the boom's bending than to the rotations", "qualitative",
         "The load line's mode would have to lie by the boom's, not by the chord's rotation",
         [](const ThesisRuns& r) -> Measures {
             return {larger("likeness of R9 to q1 over that to phi6",
                            spectral_likeness(r.a, R9_m, r.a, q1_m) / spectral_likeness(r.a, R9_m, r.a, phi6_rad))};
         }},
        {"5-A-19", "5, case A", "35", "Two frequencies dominate the load's stretch", "2", "",
         [](const ThesisRuns& r) -> Measures {
             return {{"visible peaks of R9", "", visible_count(r.a, R9_m), Range{2.0, 2.0}, Range{1.0, 3.0}}};
         }},
        {"5-A-20", "5, case A", "26, 27", "Boom rotation and pendulation run alike", "similar", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("|correlation| of phi6 and phi9", "", std::abs(correlation(r.a, phi6_rad, r.a, phi9_rad)),
                              0.8, 0.5)};
         }},

        // Against Patten's model: the same crane with the beam
        {"5-P-01", "5, against Patten", "24-28", "Both models' histories have alike shapes", "similar",
         booms_would_have_to_be_alike,
         [](const ThesisRuns& r) -> Measures {
             return {at_least("coordinates whose spectra are alike (likeness of 0.7 and more)", "of 5",
                              alike_with_both_booms(r), 5.0, 3.0)};
         }},
        {"5-P-02", "5, against Patten", "24, 25", "Both models peak in R1 and phi2 soon after the first shock", "soon",
         [](const ThesisRuns& r) {
             return fmt::format(
                 "With the beam too the first swing would have to be the largest: that of R1 within the "
                 "first 0.5 s is {:.0f} %, that of phi2 {:.0f} % of the largest",
                 100.0 * peak(r.a_beam, R1_m, 0.0, 0.5) / peak(r.a_beam, R1_m),
                 100.0 * peak(r.a_beam, phi2_rad, 0.0, 0.5) / peak(r.a_beam, phi2_rad));
         },
         [](const ThesisRuns& r) -> Measures {
             return {at_most("time of the largest R1 with the links", "s", peak_time_s(r.a, R1_m), 0.5, 1.0),
                     at_most("with the beam", "s", peak_time_s(r.a_beam, R1_m), 0.5, 1.0),
                     at_most("of the largest phi2 with the links", "s", peak_time_s(r.a, phi2_rad), 0.5, 1.0),
                     at_most("with the beam", "s", peak_time_s(r.a_beam, phi2_rad), 0.5, 1.0)};
         }},
        {"5-P-03", "5, against Patten", "24-28", "Patten's amplitudes damp out more within 10 s", "more",
         "The softer boom would have to bring more of the motion to where it is damped, in every coordinate",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("coordinates of which less is left with the beam", "of 7",
                              coordinates_damped_faster(r.a_beam, r.a), 7.0, 4.0)};
         }},
        {"5-P-04", "5, against Patten", "29, 30", "The three-link boom bends less and its chord shortens less", "less",
         "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("largest q1, links over beam", peak(r.a, q1_m) / peak(r.a_beam, q1_m)),
                     smaller("range of the chord, links over beam", chord_range_m(r.a) / chord_range_m(r.a_beam))};
         }},
        {"5-P-05", "5, against Patten", "29, 30", "Patten's ropes slacken less: the stiffer boom is why ropes go slack",
         "less", "Both ropes would have to be slack for more of the time with the stiffer boom",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("pendent slack, links less beam", "% of the time",
                              100.0 * (r.a.figures().pendent_slack_share - r.a_beam.figures().pendent_slack_share),
                              0.01, 0.0),
                     at_least("load line slack, links less beam", "% of the time",
                              100.0 * (r.a.figures().load_line_slack_share - r.a_beam.figures().load_line_slack_share),
                              0.01, 0.0)};
         }},
        {"5-P-06", "5, against Patten", "35", "Patten's load stretches at 11 Hz and 5.5 Hz", "11 Hz, 5.5 Hz",
         [](const ThesisRuns& r) {
             return mode_would_have_to_be(r.a_beam, 11.0) + ". " + mode_would_have_to_be(r.a_beam, 5.5);
         },
         [](const ThesisRuns& r) -> Measures {
             return {frequency("R9, largest peak above 8 Hz", 11.0, dominant_Hz(r.a_beam, R9_m, 8.0)),
                     frequency("below 8 Hz", 5.5, dominant_Hz(r.a_beam, R9_m, slowest_Hz, 8.0))};
         }},
        {"5-P-07", "5, against Patten", "35", "In Patten's model the slower one dominates the load", "5.5 over 11 Hz",
         "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("R9, largest above 8 Hz over largest below",
                             band_ratio(r.a_beam, R9_m, {8.0, 60.0}, {slowest_Hz, 8.0}))};
         }},
        {"5-P-08", "5, against Patten", "32-34", "5.5 Hz dominate Patten's rotations phi2, phi6 and phi9", "5.5 Hz",
         mode_at(&ThesisRuns::a_beam, 5.5),
         [](const ThesisRuns& r) -> Measures {
             return {frequency("phi2, dominant", 5.5, dominant_Hz(r.a_beam, phi2_rad)),
                     frequency("phi6", 5.5, dominant_Hz(r.a_beam, phi6_rad)),
                     frequency("phi9", 5.5, dominant_Hz(r.a_beam, phi9_rad))};
         }},
        {"5-P-09", "5, against Patten", "36", "11 Hz dominate Patten's first bending mode", "11 Hz",
         mode_at(&ThesisRuns::a_beam, 11.0),
         [](const ThesisRuns& r) -> Measures {
             return {frequency("q1 of the beam, dominant", 11.0, dominant_Hz(r.a_beam, q1_m))};
         }},
        {"5-P-10", "5, against Patten", "29, 30", "The three-link crane is the stiffer one, because of its boom",
         "stiffer", "",
         [](const ThesisRuns& r) -> Measures {
             const plant::PinnedBoom boom = plant::pinned_boom(r.a.options().crane_case.crane.structure);
             return {larger("first frequency of the boom alone, links over beam", boom.links_Hz[0] / boom.beam_Hz[0]),
                     larger("slowest vibration of the boom in the crane, links over beam",
                            boom_mode_Hz(r.a) / boom_mode_Hz(r.a_beam))};
         }},
        {"5-P-11", "5, against Patten", "24-36", "How the boom is modelled changes the crane's response strongly",
         "strongly", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("|correlation| of R1 with either boom", "", unlikeness(r.a, r.a_beam, R1_m), 0.5, 0.8),
                     at_most("of R9", "", unlikeness(r.a, r.a_beam, R9_m), 0.5, 0.8)};
         }},
        {"5-P-12", "5, against Patten", "27", "A slow component is prominent in Patten's pendulation too", "prominent",
         "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("phi9, largest below 2 Hz over largest above", "",
                              band_ratio(r.a_beam, phi9_rad, slow_Hz, fast_Hz), 0.33, 0.1)};
         }},
        {"5-P-13", "5, against Patten", "35", "Both of the load's frequencies are much faster than in Patten's model",
         "7 and 18 over 5.5 and 11 Hz", booms_would_have_to_be_alike,
         [](const ThesisRuns& r) -> Measures {
             return {at_least("slower one, links over beam", "",
                              dominant_Hz(r.a, R9_m, slowest_Hz, 12.0) / dominant_Hz(r.a_beam, R9_m, slowest_Hz, 8.0),
                              1.2, 1.0),
                     at_least("faster one, links over beam", "",
                              dominant_Hz(r.a, R9_m, 12.0) / dominant_Hz(r.a_beam, R9_m, 8.0), 1.2, 1.0)};
         }},
        {"5-P-14", "5, against Patten", "32-36",
         "In Patten's model the load is coupled more to the rotations than to the boom's bending", "qualitative",
         "The load's bounce would have to turn the chord more than it bends the softer boom",
         [](const ThesisRuns& r) -> Measures {
             return {larger("likeness of R9 to phi6 over that to q1",
                            spectral_likeness(r.a_beam, R9_m, r.a_beam, phi6_rad) /
                                spectral_likeness(r.a_beam, R9_m, r.a_beam, q1_m))};
         }},
        {"5-P-15", "5, against Patten", "31-36", "Faster frequencies dominate the three-link model throughout",
         "faster", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("coordinates that a faster frequency dominates with the links", "of 7",
                              static_cast<double>(std::ranges::count_if(coordinates,
                                                                        [&](Signal signal) {
                                                                            return dominant_Hz(r.a, signal) >
                                                                                   1.02 * dominant_Hz(r.a_beam, signal);
                                                                        })),
                              7.0, 4.0)};
         }},

        // Case B
        {"5-B-01", "5, case B", "24, 37", "The tracks' vertical motion looks nothing like case A's", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {
                 at_most("|correlation| of R1 in A and B", "", std::abs(correlation(r.a, R1_m, r.b, R1_m)), 0.5, 0.8)};
         }},
        {"5-B-02", "5, case B", "25, 38", "The track rotation looks nothing like case A's", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("|correlation| of phi2 in A and B", "",
                             std::abs(correlation(r.a, phi2_rad, r.b, phi2_rad)), 0.5, 0.8)};
         }},
        {"5-B-03", "5, case B", "37", "The largest vertical motion of the tracks comes late, at 2.2 s", "2.2 s",
         later_shock(R1_m),
         [](const ThesisRuns& r) -> Measures {
             return {number("time of the largest R1", "s", 2.2, peak_time_s(r.b, R1_m))};
         }},
        {"5-B-04", "5, case B", "38", "The largest track rotation comes late, at 2.0 s", "2.0 s", later_shock(phi2_rad),
         [](const ThesisRuns& r) -> Measures {
             return {number("time of the largest phi2", "s", 2.0, peak_time_s(r.b, phi2_rad))};
         }},
        {"5-B-05", "5, case B", "37, 38", "The ground's motion grows after the first second to a secondary shock",
         "qualitative", later_shock(phi2_rad),
         [](const ThesisRuns& r) -> Measures {
             return {at_least("R1, largest of 1-3 s over largest of the first", "",
                              peak(r.b, R1_m, 1.0, 3.0) / peak(r.b, R1_m, 0.0, 1.0), 1.0, 0.8),
                     at_least("phi2, the same", "", peak(r.b, phi2_rad, 1.0, 3.0) / peak(r.b, phi2_rad, 0.0, 1.0), 1.0,
                              0.8)};
         }},
        {"5-B-06", "5, case B", "41", "By then the load's oscillation has damped out a good deal", "qualitative",
         [](const ThesisRuns& r) {
             return fmt::format(
                 "Boom, ropes and soil would have to take more out of the load's bounce than Table 1 and "
                 "the boom's damping ratio of {:g} % (3.1.1) do",
                 100.0 * r.b.options().crane_case.crane.structure.boom_damping_ratio);
         },
         [](const ThesisRuns& r) -> Measures {
             return {at_most("R9, RMS of 1.75-2.75 s over the first second", "",
                             rms(r.b, R9_m, 1.75, 2.75) / rms(r.b, R9_m, 0.0, 1.0), 0.5, 0.8)};
         }},
        {"5-B-07", "5, case B", "37, 38", "Afterwards the ground's motion damps out", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("R1, RMS of the last second over 1.5-2.5 s", "",
                             fluctuation(r.b, R1_m, 9.0) / fluctuation(r.b, R1_m, 1.5, 2.5), 0.5, 0.9)};
         }},
        {"5-B-08", "5, case B", "38", "The track rotation is quietest at 5.0 s", "5.0 s",
         cancelling(phi2_rad, 3.0, 7.0, 1.0),
         [](const ThesisRuns& r) -> Measures {
             return {{"quietest half second of phi2 between 3 and 7 s", "s",
                      quiet_spell(r.b, phi2_rad, 3.0, 7.0, 0.5, 1.0).time_s, Range{4.5, 5.5}, Range{3.75, 6.25}},
                     {"of phi2'", "s", quiet_spell(r.b, phi2_rate_rad_s, 3.0, 7.0, 0.5, 1.0).time_s, Range{4.5, 5.5},
                      Range{3.75, 6.25}}};
         }},
        {"5-B-09", "5, case B", "38", "Its energy has gone elsewhere and is back within half a second or so",
         "active again at 5.5 s", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("phi2, RMS within the next second over the quietest", "",
                              quiet_spell(r.b, phi2_rad, 3.0, 7.0, 0.5, 1.0).regain, 1.5, 1.15)};
         }},
        {"5-B-10", "5, case B", "44", "11.5 Hz dominate the tracks' vertical motion", "11.5 Hz",
         mode_at(&ThesisRuns::b, 11.5),
         [](const ThesisRuns& r) -> Measures { return {frequency("R1, dominant", 11.5, dominant_Hz(r.b, R1_m))}; }},
        {"5-B-11", "5, case B", "45", "11.5 Hz dominate the track rotation", "11.5 Hz", mode_at(&ThesisRuns::b, 11.5),
         [](const ThesisRuns& r) -> Measures {
             return {frequency("phi2, dominant", 11.5, dominant_Hz(r.b, phi2_rad))};
         }},
        {"5-B-12", "5, case B", "31, 44", "Softer soil has raised the ground's dominant frequency from case A",
         "7.0 to 11.5 Hz",
         [](const ThesisRuns& r) {
             return fmt::format(
                 "Softer soil would have to stiffen something. On the soil of case A {:.2g} Hz dominate "
                 "case B's R1, on its own {:.2g} Hz",
                 dominant_Hz(r.b_on_soil_of_a, R1_m), dominant_Hz(r.b, R1_m));
         },
         [](const ThesisRuns& r) -> Measures {
             return {larger("R1, dominant in B over A", dominant_Hz(r.b, R1_m) / dominant_Hz(r.a, R1_m)),
                     larger("phi2, dominant in B over A", dominant_Hz(r.b, phi2_rad) / dominant_Hz(r.a, phi2_rad))};
         }},
        {"5-B-13", "5, case B", "37-43", "Every coordinate damps faster than in case A", "all seven", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("coordinates of which less is left than in A", "of 7",
                              coordinates_damped_faster(r.b, r.a), 7.0, 4.0)};
         }},
        {"5-B-14", "5, case B", "39, 40", "Boom rotation and pendulation run alike", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("|correlation| of phi6 and phi9", "", std::abs(correlation(r.b, phi6_rad, r.b, phi9_rad)),
                              0.8, 0.5)};
         }},
        {"5-B-15", "5, case B", "46", "A frequency below all others dominates the pendulation", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("phi9, largest below 2 Hz over largest above", "",
                              band_ratio(r.b, phi9_rad, slow_Hz, fast_Hz), 1.0, 0.5)};
         }},
        {"5-B-16", "5, case B", "34, 46", "In case A it has a third of that magnitude", "1/3",
         [](const ThesisRuns& r) {
             return fmt::format(
                 "Case A's pendulation would have to be excited a third as much; its load is caught at "
                 "{:.2g} of case B's speed",
                 r.a.options().crane_case.manoeuvre.brake_rate_m_s() /
                     r.b.options().crane_case.manoeuvre.brake_rate_m_s());
         },
         [](const ThesisRuns& r) -> Measures {
             return {number("phi9 below 2 Hz, A over B", "", 1.0 / 3.0,
                            largest_amplitude(r.a.spectrum(phi9_rad), slow_Hz.low, slow_Hz.high) /
                                largest_amplitude(r.b.spectrum(phi9_rad), slow_Hz.low, slow_Hz.high))};
         }},
        {"5-B-17", "5, case B", "42, 43", "The boom beats: its energy is least at 5.8 s", "5.8 s",
         cancelling(q1_rate_m_s, 3.0, 9.0, 1.0),
         [](const ThesisRuns& r) -> Measures {
             return {{"quietest half second of the boom between 3 and 9 s", "s",
                      quiet_spell(r.b, q1_rate_m_s, 3.0, 9.0, 0.5, 1.0).time_s, Range{5.22, 6.38}, Range{4.35, 7.25}}};
         }},
        {"5-B-18", "5, case B", "42, 43", "After the beat the boom is active again", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {
                 at_least("q1', RMS within 1.5 s after over the quietest", "",
                          quiet_spell(r.b, q1_rate_m_s, 3.0, 9.0, 0.5, 1.5).regain, 1.5, 1.15),
                 at_least("q2', the same", "", quiet_spell(r.b, q2_rate_m_s, 3.0, 9.0, 0.5, 1.5).regain, 1.5, 1.15)};
         }},
        {"5-B-19", "5, case B", "42, 43", "The energy that beats in the boom is about 5 % of the system's", "5 %",
         "The boom would have to hold more of the energy: it is stiff against the ropes that it hangs in",
         [](const ThesisRuns& r) -> Measures {
             const double quiet_s = quiet_spell(r.b, q1_rate_m_s, 3.0, 9.0, 0.5, 1.5).time_s;
             const double boom_J = highest(r.b, boom_energy_J, quiet_s - 1.5, quiet_s + 1.5) -
                                   lowest(r.b, boom_energy_J, quiet_s - 1.5, quiet_s + 1.5);
             return {number("boom energy's range about the beat over the crane's energy at the start", "%", 5.0,
                            100.0 * boom_J / r.b.signal(crane_energy_J).front())};
         }},
        {"5-B-20", "5, case B", "47", "The pendent goes slack", "slack at times", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("pendent slack", "% of the time", 100.0 * r.b.figures().pendent_slack_share, 0.1, 0.01)};
         }},
        {"5-B-21", "5, case B", "29, 47", "The pendent is slack for longer than in case A", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("pendent slack in B less that in A", "% of the time",
                              100.0 * (r.b.figures().pendent_slack_share - r.a.figures().pendent_slack_share), 0.01,
                              0.01)};
         }},
        {"5-B-22", "5, case B", "29, 47", "The pendent's tension settles faster than in case A", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("what is left of its fluctuation, B over A", "",
                             left_over(r.b, pendent_tension_N) / left_over(r.a, pendent_tension_N), 0.9, 1.0)};
         }},
        {"5-B-23", "5, case B", "24-28, 37-43", "No coordinate's history looks like case A's", "very different", "",
         [](const ThesisRuns& r) -> Measures {
             double most = 0.0;
             for (const Signal signal : coordinates) {
                 most = std::max(most, unlikeness(r.a, r.b, signal));
             }
             return {at_most("largest |correlation| of any of the seven", "", most, 0.5, 0.8)};
         }},
        {"5-B-24", "5, case B", "37, 38", "Those of the ground have changed most", "R1 and phi2", "",
         [](const ThesisRuns& r) -> Measures {
             double least_of_others = 1.0;
             for (const Signal signal : {R9_m, q1_m, q2_m, phi6_rad, phi9_rad}) {
                 least_of_others = std::min(least_of_others, unlikeness(r.a, r.b, signal));
             }
             return {smaller("|correlation| of R1 in A and B over the least of the other five",
                             unlikeness(r.a, r.b, R1_m) / least_of_others),
                     smaller("the same of phi2", unlikeness(r.a, r.b, phi2_rad) / least_of_others)};
         }},
        {"5-B-25", "5, case B", "37-43", "It is the softer soil that damps every coordinate more", "all seven",
         "On this soil every coordinate would have to lose more than on that of case A, all else being equal",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("coordinates of which less is left than on the soil of case A", "of 7",
                              coordinates_damped_faster(r.b, r.b_on_soil_of_a), 7.0, 4.0)};
         }},
        {"5-B-26", "5, case B", "29, 47", "It is the steeper boom that makes the pendent slack for longer",
         "qualitative", "A boom at case A's angle would have to keep the pendent taut for more of the time",
         [](const ThesisRuns& r) -> Measures {
             return {
                 at_least("pendent slack in B less that at case A's angle", "% of the time",
                          100.0 * (r.b.figures().pendent_slack_share - r.b_at_angle_of_a.figures().pendent_slack_share),
                          0.01, 0.01)};
         }},
        {"5-B-27", "5, case B", "29, 47", "It is the softer soil that settles the pendent's tension faster",
         "qualitative", "On case A's soil more of the tension's fluctuation would have to be left",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("what is left of its fluctuation, over that on the soil of case A", "",
                             left_over(r.b, pendent_tension_N) / left_over(r.b_on_soil_of_a, pendent_tension_N), 0.9,
                             1.0)};
         }},

        // Case C
        {"5-C-01", "5, case C", "48, 49", "The crane moves more than in the other cases", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {larger("largest R1, C over B", peak(r.c, R1_m) / peak(r.b, R1_m)),
                     larger("largest phi2, C over B", peak(r.c, phi2_rad) / peak(r.b, phi2_rad))};
         }},
        {"5-C-02", "5, case C", "48, 49", "R1 and phi2 have nearly the same record", "almost identical", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("|correlation| of R1 and phi2", "", std::abs(correlation(r.c, R1_m, r.c, phi2_rad)), 0.95,
                              0.8)};
         }},
        {"5-C-03", "5, case C", "55, 56", "Their spectra are nearly the same", "almost identical", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("likeness of the spectra", "", spectral_likeness(r.c, R1_m, r.c, phi2_rad), 0.95, 0.8)};
         }},
        {"5-C-04", "5, case C", "48, 49", "R1 and phi2 beat", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("R1', RMS within 2 s after a quiet half second over it", "",
                              quiet_spell(r.c, R1_rate_m_s, 1.0, 8.0, 0.5, 2.0).regain, 1.5, 1.15),
                     at_least("phi2', the same", "", quiet_spell(r.c, phi2_rate_rad_s, 1.0, 8.0, 0.5, 2.0).regain, 1.5,
                              1.15)};
         }},
        {"5-C-05", "5, case C", "55, 56", "2.0 Hz dominate the ground's motion", "2.0 Hz", mode_at(&ThesisRuns::c, 2.0),
         [](const ThesisRuns& r) -> Measures {
             return {frequency("R1, dominant", 2.0, dominant_Hz(r.c, R1_m)),
                     frequency("phi2, dominant", 2.0, dominant_Hz(r.c, phi2_rad))};
         }},
        {"5-C-06", "5, case C", "55, 56", "It is the lowest of several frequencies in that motion", "several", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("visible peaks of R1", "", visible_count(r.c, R1_m), 3.0, 2.0),
                     same("dominant over the lowest visible", dominant_Hz(r.c, R1_m) / lowest_visible_Hz(r.c, R1_m))};
         }},
        {"5-C-07", "5, case C", "31, 44, 55", "The ground moves more slowly than in cases A and B",
         "2.0 against 7 and 11.5 Hz", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("R1, dominant in C over A", dominant_Hz(r.c, R1_m) / dominant_Hz(r.a, R1_m)),
                     smaller("R1, dominant in C over B", dominant_Hz(r.c, R1_m) / dominant_Hz(r.b, R1_m))};
         }},
        {"5-C-08", "5, case C", "48", "The largest vertical motion of the tracks comes at 1.0 s", "1.0 s", "",
         [](const ThesisRuns& r) -> Measures {
             return {number("time of the largest R1", "s", 1.0, peak_time_s(r.c, R1_m))};
         }},
        {"5-C-09", "5, case C", "49", "The largest track rotation comes at 1.0 s", "1.0 s", "",
         [](const ThesisRuns& r) -> Measures {
             return {number("time of the largest phi2", "s", 1.0, peak_time_s(r.c, phi2_rad))};
         }},
        {"5-C-10", "5, case C", "48", "The tracks stay above where they began for all 10 s", "100 % of the time",
         "The run would have to begin below its own equilibrium: about a true equilibrium a free oscillation swings to "
         "both "
         "sides",
         [](const ThesisRuns& r) -> Measures {
             const std::vector<double>& R1 = r.c.signal(R1_m);
             double above = 0.0;
             for (const double value : R1) {
                 above += value >= 0.0 ? 1.0 : 0.0;
             }
             return {at_least("R1 above its start", "% of the time", 100.0 * above / static_cast<double>(R1.size()),
                              99.0, 75.0)};
         }},
        {"5-C-11", "5, case C", "50", "2.0 Hz alone dominate the boom chord's rotation", "2.0 Hz",
         [](const ThesisRuns& r) {
             return fmt::format(
                 "The rocking of the crane, {:.2g} Hz, would have to outweigh, in the chord's rotation, "
                 "the {:.2g} Hz that are largest there",
                 dominant_Hz(r.c, R1_m), dominant_Hz(r.c, phi6_rad));
         },
         [](const ThesisRuns& r) -> Measures {
             return {frequency("phi6, dominant", 2.0, dominant_Hz(r.c, phi6_rad)),
                     at_most("visible peaks", "", visible_count(r.c, phi6_rad), 1.0, 2.0)};
         }},
        {"5-C-12", "5, case C", "51, 57", "2.0 Hz alone dominate the pendulation", "2.0 Hz",
         "As for the chord's rotation, which drives it",
         [](const ThesisRuns& r) -> Measures {
             return {frequency("phi9, dominant", 2.0, dominant_Hz(r.c, phi9_rad)),
                     at_most("visible peaks", "", visible_count(r.c, phi9_rad), 1.0, 2.0)};
         }},
        {"5-C-13", "5, case C", "50, 51", "One and the same frequency dominates boom rotation and pendulation",
         "the same", "",
         [](const ThesisRuns& r) -> Measures {
             return {same("phi9 over phi6, dominant", dominant_Hz(r.c, phi9_rad) / dominant_Hz(r.c, phi6_rad))};
         }},
        {"5-C-14", "5, case C", "52", "The largest stretch of the load line is not the first shock's but a later one's",
         "qualitative",
         "The crane's rocking would have to stretch the load line later by more than the catch does at first",
         [](const ThesisRuns& r) -> Measures {
             return {larger("R9, highest after 0.5 s over highest before",
                            highest(r.c, R9_m, 0.5) / highest(r.c, R9_m, 0.0, 0.5))};
         }},
        {"5-C-15", "5, case C", "52", "The load's motion has damped out a good deal by 10 s", "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("R9, fluctuation of the last second over the first", "",
                             fluctuation(r.c, R9_m, 9.0) / fluctuation(r.c, R9_m, 0.0, 1.0), 0.3, 0.6)};
         }},
        {"5-C-16", "5, case C", "53", "The lower boom joint shows no damping within 10 s", "qualitative",
         "The boom's bending would have to be free of the soil and the ropes, which damp it here",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("q1, fluctuation of the last second over 1-2 s", "",
                              fluctuation(r.c, q1_m, 9.0) / fluctuation(r.c, q1_m, 1.0, 2.0), 0.8, 0.5)};
         }},
        {"5-C-17", "5, case C", "54", "The upper boom joint shows no damping within 10 s", "qualitative",
         "The boom's bending would have to be free of the soil and the ropes, which damp it here",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("q2, fluctuation of the last second over 1-2 s", "",
                              fluctuation(r.c, q2_m, 9.0) / fluctuation(r.c, q2_m, 1.0, 2.0), 0.8, 0.5)};
         }},
        {"5-C-18", "5, case C", "36, 58", "The spectrum of the lower joint is of another nature than in case A",
         "qualitative", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("likeness to case A", "", spectral_likeness(r.c, q1_m, r.a, q1_m), 0.5, 0.8)};
         }},
        {"5-C-19", "5, case C", "59", "The boom's chord oscillates at 10 s as much as at 4 s", "similar",
         "As for the joints: the boom's bending would have to be undamped",
         [](const ThesisRuns& r) -> Measures {
             return {same("chord, fluctuation of 9-10 s over 4-5 s",
                          fluctuation(r.c, chord_m, 9.0) / fluctuation(r.c, chord_m, 4.0, 5.0))};
         }},
        {"5-C-20", "5, case C", "50, 59", "The boom rotation's slow frequency marks the pendent's tension too",
         "the same",
         "The chord's rotation would have to be as slow as the pendent's tension; here the faster bending of the boom "
         "outweighs it",
         [](const ThesisRuns& r) -> Measures {
             return {same("pendent tension over phi6, dominant",
                          dominant_Hz(r.c, pendent_tension_N) / dominant_Hz(r.c, phi6_rad))};
         }},
        {"5-C-21", "5, case C", "59", "The pendent never goes slack", "0 % of the time", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("pendent slack", "% of the time", 100.0 * r.c.figures().pendent_slack_share, 0.0, 0.1)};
         }},
        {"5-C-22", "5, case C", "29, 47, 59", "The pendent's tension fluctuates much less than in cases A and B",
         "much smaller", "",
         [](const ThesisRuns& r) -> Measures {
             const double here = fluctuation(r.c, pendent_tension_N, 0.0, end_s);
             return {at_most("fluctuation in C over A", "", here / fluctuation(r.a, pendent_tension_N), 0.5, 0.9),
                     at_most("fluctuation in C over B", "", here / fluctuation(r.b, pendent_tension_N), 0.5, 0.9)};
         }},
        {"5-C-23", "5, case C", "26, 27, 39, 40, 50, 51",
         "Boom rotation and pendulation look very different from those of cases A and B", "very different", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("|correlation| of phi6 in C and A", "", unlikeness(r.c, r.a, phi6_rad), 0.5, 0.8),
                     at_most("in C and B", "", unlikeness(r.c, r.b, phi6_rad), 0.5, 0.8),
                     at_most("of phi9 in C and A", "", unlikeness(r.c, r.a, phi9_rad), 0.5, 0.8),
                     at_most("in C and B", "", unlikeness(r.c, r.b, phi9_rad), 0.5, 0.8)};
         }},
        {"5-C-24", "5, case C", "42, 53, 59", "The longer boom is damped less than that of cases A and B", "less",
         "More of the long boom's bending would have to be left at the end than of the short one's",
         [](const ThesisRuns& r) -> Measures {
             return {larger("what is left of q1, C over A", left_over(r.c, q1_m) / left_over(r.a, q1_m)),
                     larger("C over B", left_over(r.c, q1_m) / left_over(r.b, q1_m))};
         }},
    };
}

}  // namespace steadyboom::hil::reproduction
