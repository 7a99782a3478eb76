#include "hil/reproduction/claim.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace steadyboom::hil::reproduction {

namespace {

using enum Signal;
using Measures = std::vector<Measure>;

/// Share of the time, in per cent, in which part of the tracks is off the soil.
double lifted_percent(const ThesisRun& run) {
    const std::vector<double>& contact = run.signal(contact_fraction);
    const auto lifted = std::ranges::count_if(contact, [](double fraction) { return fraction < 1.0; });
    return 100.0 * static_cast<double>(lifted) / static_cast<double>(contact.size());
}

/// Largest over smallest dominant frequency.
double spread(const ThesisRun& run, std::initializer_list<Signal> signals) {
    double low_Hz = 1e9;
    double high_Hz = 0.0;
    for (const Signal signal : signals) {
        low_Hz = std::min(low_Hz, dominant_Hz(run, signal));
        high_Hz = std::max(high_Hz, dominant_Hz(run, signal));
    }
    return high_Hz / low_Hz;
}

/// Work of the piston over that of the soil: above one, the actuator takes more of the crane's energy than the soil.
double piston_over_soil(const ThesisRun& run) {
    return run.piston_work_J() / run.soil_work_J();
}

const std::string one_mode =
    "The coordinates would have to share their largest mode in the case that spreads them most";

}  // namespace

std::vector<Claim> chapter_8_claims() {
    return {
        {"8-01", "8", "-", "The model shows tilting: part of the tracks leaves the soil", "shown", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("part of the tracks off the soil in case C", "% of the time", lifted_percent(r.c), 0.1,
                              0.01)};
         }},
        {"8-02", "8", "29, 47", "The model shows slack pendents", "shown", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("pendent slack in case B", "% of the time", 100.0 * r.b.figures().pendent_slack_share,
                              0.1, 0.01)};
         }},
        {"8-03", "8", "29", "The model shows a slack load line", "shown", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("load line slack in case A", "% of the time", 100.0 * r.a.figures().load_line_slack_share,
                              0.1, 0.01)};
         }},
        {"8-04", "8", "53, 59", "The model shows finite deflections of the boom, which shorten its chord", "shown", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("largest q1 in case C", "mm", 1e3 * peak(r.c, q1_m), 10.0, 1.0),
                     at_least("range of the chord in case C", "mm",
                              1e3 * (highest(r.c, chord_m) - lowest(r.c, chord_m)), 0.1, 0.01)};
         }},
        {"8-05", "8", "38", "The model shows nonlinear coupling: a motion that fades and quickly grows again", "shown",
         "",
         [](const ThesisRuns& r) -> Measures {
             return {at_least("phi2' in case B, RMS within a second after a quiet half second over it", "",
                              quiet_spell(r.b, phi2_rate_rad_s, 1.0, 8.0, 0.5, 1.0).regain, 1.5, 1.15)};
         }},
        {"8-06", "8", "24-28", "Histories have shapes like those of Patten's model", "similar",
         booms_would_have_to_be_alike,
         [](const ThesisRuns& r) -> Measures {
             return {at_least("coordinates whose spectra are alike (likeness of 0.7 and more)", "of 5",
                              alike_with_both_booms(r), 5.0, 3.0)};
         }},
        {"8-07", "8", "36", "A point of the boom deflects as in Patten's model, in size and frequency", "similar",
         booms_would_have_to_be_alike,
         [](const ThesisRuns& r) -> Measures {
             return {same("largest q1, links over beam", peak(r.a, q1_m) / peak(r.a_beam, q1_m)),
                     same("what dominates q1, links over beam", dominant_Hz(r.a, q1_m) / dominant_Hz(r.a_beam, q1_m))};
         }},
        {"8-08", "8", "29, 30", "The three-link chord shortens less than Patten's", "less", "",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("range of the chord, links over beam", chord_range_m(r.a) / chord_range_m(r.a_beam))};
         }},
        {"8-09", "8", "31, 44, 55", "The soil's shear modulus changes the crane's motion a good deal", "greatly",
         "The soil would have to be about as soft as ropes and boom are; its modes lie above theirs",
         [](const ThesisRuns& r) -> Measures {
             const double likeness = std::abs(correlation(r.a_soft, R1_m, r.a, R1_m));
             return {at_most("|correlation| of R1 in case A with half the modulus", "", likeness, 0.5, 0.8)};
         }},
        {"8-10", "8", "31, 35, 36", "R1, R9, q1 and q2 oscillate with the same dominant frequency", "the same",
         one_mode,
         [](const ThesisRuns& r) -> Measures {
             return {same("largest over smallest, case A", spread(r.a, {R1_m, R9_m, q1_m, q2_m})),
                     same("case B", spread(r.b, {R1_m, R9_m, q1_m, q2_m})),
                     same("case C", spread(r.c, {R1_m, R9_m, q1_m, q2_m}))};
         }},
        {"8-11", "8", "32-34", "phi2, phi6 and phi9 have dominant frequencies in common", "the same", one_mode,
         [](const ThesisRuns& r) -> Measures {
             return {same("largest over smallest, case A", spread(r.a, {phi2_rad, phi6_rad, phi9_rad})),
                     same("case B", spread(r.b, {phi2_rad, phi6_rad, phi9_rad})),
                     same("case C", spread(r.c, {phi2_rad, phi6_rad, phi9_rad}))};
         }},
        {"8-12", "8", "71-76", "Proportional feedback can calm the crane in conservative conditions", "able", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("energy left in case A, law 2 over none", "", residual_share(r.a2, r.a), 0.5, 1.0)};
         }},
        {"8-13", "8", "68, 85", "Laws 1 and 3 take the energy into the actuator", "absorbing",
         "The piston would have to yield to the tension's swings with these laws; here it feeds the crane",
         [](const ThesisRuns& r) -> Measures {
             return {larger("piston's take over the soil's, law 1", piston_over_soil(r.a1)),
                     larger("law 3", piston_over_soil(r.a3))};
         }},
        {"8-14", "8", "63, 64, 81, 82", "With laws 1 and 3 the tracks move and rotate more than without", "larger",
         "The first peak would have to be enlarged by every one of them",
         [](const ThesisRuns& r) -> Measures {
             return {larger("largest R1, law 1 over none", peak(r.a1, R1_m) / peak(r.a, R1_m)),
                     larger("largest phi2, law 1 over none", peak(r.a1, phi2_rad) / peak(r.a, phi2_rad)),
                     larger("largest R1, law 3 over none", peak(r.a3, R1_m) / peak(r.a, R1_m)),
                     larger("largest phi2, law 3 over none", peak(r.a3, phi2_rad) / peak(r.a, phi2_rad))};
         }},
        {"8-15", "8", "76, 77, 79", "Law 2 passes the energy on to the soil", "to the soil",
         "The soil would have to take more than the piston does",
         [](const ThesisRuns& r) -> Measures {
             return {smaller("piston's take over the soil's", piston_over_soil(r.a2))};
         }},
        {"8-16", "8", "101", "Law 2 does well on the stiff soil of case A", "quite well", "",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("RMS of R1 from 5 s in case A, with over without", "",
                             rms(r.a2, R1_m, 5.0) / rms(r.a, R1_m, 5.0), 0.5, 1.0)};
         }},
        {"8-17", "8", "101", "It does less well on the softer soils of cases B and C", "not as significantly", "",
         [](const ThesisRuns& r) -> Measures {
             const double stiff = residual_share(r.a2, r.a);
             return {larger("share of the energy left, B over A", residual_share(r.b2, r.b) / stiff),
                     larger("share of the energy left, C over A", residual_share(r.c2, r.c) / stiff)};
         }},
        {"8-18", "8", "32, 45, 56", "The soil's shear modulus changes the rotation of the tracks a good deal",
         "largely", "The soil would have to be about as soft as ropes and boom are; its modes lie above theirs",
         [](const ThesisRuns& r) -> Measures {
             return {at_most("|correlation| of phi2 in case A with half the modulus", "",
                             std::abs(correlation(r.a_soft, phi2_rad, r.a, phi2_rad)), 0.5, 0.8)};
         }},
        {"8-19", "8", "31, 44, 55", "The frequencies that make up the ground's motion change with the shear modulus",
         "change",
         [](const ThesisRuns& r) {
             return fmt::format(
                 "The soil would have to set the frequency of the ground's motion; with half the modulus "
                 "{:.2g} Hz dominate R1, with the whole {:.2g} Hz",
                 dominant_Hz(r.a_soft, R1_m), dominant_Hz(r.a, R1_m));
         },
         [](const ThesisRuns& r) -> Measures {
             const double ratio = dominant_Hz(r.a_soft, R1_m) / dominant_Hz(r.a, R1_m);
             return {at_least("change of what dominates R1, half the modulus against the whole", "%",
                              100.0 * std::abs(ratio - 1.0), 10.0, 2.0)};
         }},
    };
}

}  // namespace steadyboom::hil::reproduction
