#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/html_page.hpp"
#include "hil/reproduction/reproduction_report.hpp"

namespace steadyboom::hil::reproduction {

namespace {

constexpr int plot_buckets = 260;
constexpr double spectra_up_to_Hz = 25.0;

constexpr std::string_view style = R"(
.counts{display:flex;flex-wrap:wrap;gap:.6rem;margin:1rem 0;padding:0;list-style:none}
.counts li{border:1px solid var(--line);border-radius:8px;padding:.4rem .8rem;background:var(--panel)}
.counts b{font-size:1.4rem;margin-right:.4rem}
table{width:100%;font-size:.9rem;table-layout:fixed}
th,td{padding:.35rem .5rem;text-align:left;vertical-align:top;overflow-wrap:anywhere}
td small{display:block;margin-top:.15rem}
.v{font-weight:650;padding-left:.5rem}
.v0{border-left:6px solid var(--good);color:var(--good)}
.v1{border-left:6px double var(--fair);color:var(--fair)}
.v2{border-left:6px dashed var(--bad);color:var(--bad)}
@media (max-width:46rem){table,tbody,tr,td{display:block;width:auto!important}thead{display:none}
tr{border-bottom:2px solid var(--line);padding:.5rem 0}td{border-bottom:0;padding:.12rem .2rem}
.v{border-left-width:6px;padding-left:.6rem;margin-top:.3rem}
td[data-k]::before{content:attr(data-k) ": ";color:var(--soft)}}
@media print{table{font-size:8.5pt}th,td{padding:.2rem .35rem}td small{font-size:7.5pt;line-height:1.35}}
)";

constexpr std::array<std::string_view, all_verdicts.size()> marks{"●", "◐", "○"};

struct Shown {
    Signal signal;
    std::string_view name;
    std::string_view unit;
    double scale;
    std::string_view figures;
    bool spectrum = false;
};

struct Look {
    const ThesisRun* run;
    std::string_view colour;
    std::string_view words;
    bool dashed;
};

class Page : HtmlPage {
  public:
    Page(const std::vector<Row>& rows, const Appendix& appendix, const ThesisRuns& runs)
        : HtmlPage("the thesis, claim by claim", style),
          rows_(rows),
          appendix_(appendix),
          runs_(runs),
          turned_(turned_rows(rows, appendix.sensitivity)) {}

    std::string text() {
        put_head();
        put_claims();
        put_figures();
        put_booms();
        put_sensitivity();
        put_misprints();
        put_numerics();
        put("<p class=\"soft\">Steadyboom {}</p>\n", STEADYBOOM_VERSION);
        return std::move(*this).finished();
    }

  private:
    void put_head() {
        put("<h1>The thesis, claim by claim</h1>\n"
            "<p>What K. M. Finn's <i>A Reduced-Order Crawler Crane Model with Active Control to Attenuate the "
            "Transient "
            "Vibrations</i> says about behaviour in chapters 5, 7 and 8, and what this model does. Every number and "
            "every "
            "verdict is computed from the runs; nothing is tuned to make a row hold.</p>\n<ul class=\"counts\">\n");
        for (const Verdict verdict : all_verdicts) {
            put("<li class=\"v v{}\">{} <b>{}</b>{}</li>\n", static_cast<int>(verdict),
                marks[static_cast<std::size_t>(verdict)], count(rows_, verdict), name_of(verdict));
        }
        put("</ul>\n<p class=\"soft\">Each run lasts {:g} s, is sampled every {:g} ms and has the law inside the "
            "integration, fed with the true state, as in the thesis. A number holds within 10 %, in kind within a "
            "factor of "
            "2; a frequency within 10 and 25 %; a change in per cent within 10 % of itself or 2 points, in kind with "
            "the "
            "right sign; a comparison in words by the limit that its row states. A row is as good as its worst "
            "measure. "
            "Spectra: Hann window, amplitude-correct, {:.1g} Hz from bin to bin; the dominant frequency is the largest "
            "peak from {:g} Hz on, which is what 10 s resolve: slower swings, as of the load on its line, are not "
            "counted; a peak is visible from a fifth of the largest. Likeness is the cosine between two amplitude "
            "spectra up to 30 Hz. What the thesis says of Patten's model is asked of the same crane with a beam for a "
            "boom.</p>\n",
            runs_.a.duration_s(), 1e3 * runs_.a.period_s(), runs_.a.spectrum(Signal::R1_m).spacing_Hz, slowest_Hz);
    }

    void put_claims() {
        std::string section;
        for (const Row& row : rows_) {
            if (row.section != section) {
                put("{}<h2>Chapter {}</h2>\n<table>\n<thead><tr><th style=\"width:8%\">row</th><th "
                    "style=\"width:25%\">claim</th><th style=\"width:11%\">thesis</th><th>here</th><th "
                    "style=\"width:14%\">verdict</th></tr></thead>\n<tbody>\n",
                    section.empty() ? "" : "</tbody>\n</table>\n", html_text(row.section));
                section = row.section;
            }
            const auto verdict = static_cast<std::size_t>(row.verdict);
            put("<tr><td>{}</td><td>{}<small>{}</small></td><td data-k=\"thesis\">{}</td><td data-k=\"here\">{}",
                row.id, html_text(row.claim), row.figures == "-" ? "" : "Fig. " + row.figures, html_text(row.thesis),
                html_text(row.here));
            put("<small>{}</small>", html_text(row.reason));
            if (!row.would_hold_if.empty()) {
                put("<small>For it to hold: {}</small>", html_text(row.would_hold_if));
            }
            if (const auto turned = std::ranges::find(turned_, &row, &TurnedRow::row); turned != turned_.end()) {
                put("<small>Sensitivity: {}</small>", html_text(turns_in_words(*turned)));
            }
            put("</td><td class=\"v v{}\">{} {}</td></tr>\n", verdict, marks[verdict], name_of(row.verdict));
        }
        put("</tbody>\n</table>\n");
    }

    /// "holds with nu = 0.2, nu = 0.4; does not hold with valve nonlinear"
    static std::string turns_in_words(const TurnedRow& row) {
        std::string words;
        for (const Verdict verdict : all_verdicts) {
            std::string_view separator;
            for (const TurnedRow::Turn& turn : row.turns) {
                if (turn.to == verdict) {
                    if (separator.empty()) {
                        words += fmt::format("{}{} with ", words.empty() ? "" : "; ", name_of(verdict));
                    }
                    words += fmt::format("{}{}", separator, turn.variation->symbol);
                    separator = ", ";
                }
            }
        }
        return words;
    }

    void put_booms() {
        if (appendix_.booms.empty()) {
            return;
        }
        const BoomAlone& links = appendix_.booms.front();
        const BoomAlone& beam = appendix_.booms.back();
        put("<h2>Three links and a beam</h2>\n<p>The thesis makes its joints' springs by static condensation "
            "(3.1.1-12): it eliminates the joints' deflections and keeps their rotations, of a boom whose ends cannot "
            "rotate, and then takes the rotations for angles between rigid links. A beam of the same E I and mass "
            "shows "
            "what that does: the links are {:.3g} times as stiff against forces at both joints, and their first "
            "frequency, {:.3g} Hz in case A, is {:.3g} times the beam's {:.3g} Hz. The links' masses on elements that "
            "keep the deflections, with ends free to rotate as in Fig. 4, come to {:.3g} "
            "Hz.</p>\n<table>\n<thead><tr><th "
            "style=\"width:46%\">boom alone</th><th>stiffness, forces at both thirds</th><th>first "
            "frequency</th><th>second</th></tr></thead>\n<tbody>\n",
            links.stiffness_N_m / beam.stiffness_N_m, links.first_Hz, links.first_Hz / beam.first_Hz, beam.first_Hz,
            appendix_.booms[1].first_Hz);
        for (const BoomAlone& row : appendix_.booms) {
            put("<tr><td>{}</td><td data-k=\"stiffness\">{:.3g} kN/mm</td><td data-k=\"first frequency\">{:.3g} "
                "Hz</td><td data-k=\"second\">{:.3g} Hz</td></tr>\n",
                html_text(row.boom), 1e-6 * row.stiffness_N_m, row.first_Hz, row.second_Hz);
        }
        put("</tbody>\n</table>\n<h3>Modes of the crane of case A</h3>\n<table>\n<thead><tr><th "
            "style=\"width:22%\">boom</th><th>frequency, and the coordinate that moves "
            "most</th></tr></thead>\n<tbody>\n");
        for (const auto& [name, run] : {std::pair{"three links", &runs_.a}, {"beam", &runs_.a_beam}}) {
            std::string words;
            for (const RunMode& mode : run->modes()) {
                words += fmt::format("{}{:.3g} Hz {}", words.empty() ? "" : ", ", mode.frequency_Hz, mode.dominant);
            }
            put("<tr><td>{}</td><td>{}</td></tr>\n", name, words);
        }
        put("</tbody>\n</table>\n");
    }

    void put_sensitivity() {
        const std::vector<Variation>& variations = appendix_.sensitivity.variations;
        if (variations.empty()) {
            return;
        }
        put("<h2>Sensitivity</h2>\n<p>What the thesis leaves open, varied one by one. Each variation runs the cases "
            "anew "
            "and all {} claims are judged again: {} keep their verdict in every one of the {} variations.</p>\n<ul>\n",
            rows_.size(), rows_.size() - turned_.size(), variations.size());
        for (const SensitivityRange& range : appendix_.sensitivity.ranges) {
            put("<li>{}: {} <span class=\"soft\">({})</span></li>\n", html_text(range.parameter),
                html_text(range.range), html_text(range.reason));
        }
        put("</ul>\n<table>\n<thead><tr><th style=\"width:20%\">variation</th><th "
            "style=\"width:38%\">in the case file</th><th style=\"width:12%\">of the shipped value</th><th>rows that "
            "change their verdict</th></tr></thead>\n<tbody>\n");
        for (const Variation& variation : variations) {
            put("<tr><td>{}</td><td data-k=\"in the case file\">{}</td><td data-k=\"of the shipped value\">{}</td><td "
                "data-k=\"rows that change\">",
                html_text(variation.symbol), html_text(name_of(variation)),
                variation.parameter == "actuator.valve_model" ? "" : fmt::format("× {:.3g}", variation.factor));
            if (!variation.failure.empty()) {
                put("no run: {}", html_text(variation.failure));
            } else {
                put("{}", std::ranges::count_if(turned_, [&](const TurnedRow& row) {
                        return std::ranges::find(row.turns, &variation, &TurnedRow::Turn::variation) != row.turns.end();
                    }));
            }
            put("</td></tr>\n");
        }
        put("</tbody>\n</table>\n<h3>Rows that change their verdict</h3>\n<table>\n<thead><tr><th "
            "style=\"width:8%\">row</th><th style=\"width:32%\">claim</th><th style=\"width:14%\">as "
            "shipped</th><th>turned by</th></tr></thead>\n<tbody>\n");
        for (const TurnedRow& turned : turned_) {
            const auto verdict = static_cast<std::size_t>(turned.row->verdict);
            put("<tr><td>{}</td><td>{}</td><td class=\"v v{}\">{} {}</td><td data-k=\"turned by\">{}</td></tr>\n",
                turned.row->id, html_text(turned.row->claim), verdict, marks[verdict], name_of(turned.row->verdict),
                html_text(turns_in_words(turned)));
        }
        put("</tbody>\n</table>\n");
    }

    void put_misprints() {
        if (appendix_.misprints.empty()) {
            return;
        }
        put("<h2>Misprints</h2>\n<p class=\"soft\">Where the thesis contradicts itself, what is used instead and the "
            "calculation that decides.</p>\n<table>\n<thead><tr><th style=\"width:12%\">where</th><th "
            "style=\"width:17%\">printed</th><th style=\"width:17%\">used</th><th>what decides</th><th>with the "
            "printed one</th></tr></thead>\n<tbody>\n");
        for (const MisprintRow& row : appendix_.misprints) {
            put("<tr><td>{}</td><td data-k=\"printed\">{}</td><td data-k=\"used\">{}</td><td data-k=\"what "
                "decides\">{}</td><td data-k=\"with the printed one\">{}</td></tr>\n",
                html_text(row.where), html_text(row.printed), html_text(row.used), html_text(row.calculation),
                html_text(row.consequence));
        }
        put("</tbody>\n</table>\n");
    }

    void put_numerics() {
        put("<h2>Numerical methods</h2>\n<p>The thesis (chapter 4) integrates with a Runge-Kutta method of variable "
            "step "
            "and solves for the accelerations by Gauss elimination with full pivoting, because it finds the mass "
            "matrix "
            "M ill-conditioned. Here a Runge-Kutta method of order 5(4) keeps the error of each step below {:g} of "
            "each "
            "entry, and M is factorised as LDL' without pivoting. How well M can be inverted, and how far the two ways "
            "of solving are apart, at every step of the runs without control:</p>\n<table>\n<thead><tr><th "
            "style=\"width:14%\">run</th><th>condition of M at rest</th><th>worst of the run</th><th>diagonal scaled "
            "to "
            "one, at rest</th><th>worst of the run</th><th>rows without a dominant diagonal</th><th>largest difference "
            "of "
            "LDL' and full pivoting</th></tr></thead>\n<tbody>\n",
            runs_.a.options().tolerance);
        for (const Conditioning& row : appendix_.conditioning) {
            put("<tr><td>{}</td><td data-k=\"condition of M at rest\">{:.3g}</td><td data-k=\"worst\">{:.3g}</td><td "
                "data-k=\"scaled, at rest\">{:.3g}</td><td data-k=\"scaled, worst\">{:.3g}</td><td data-k=\"rows "
                "without a dominant diagonal\">{} of {}</td><td data-k=\"LDL' against full "
                "pivoting\">{:.1e}</td></tr>\n",
                html_text(row.run), row.condition_at_rest, row.worst_condition, row.scaled_condition_at_rest,
                row.worst_scaled_condition, row.rows_without_dominant_diagonal, row.rows, row.solver_difference);
        }
        put("</tbody>\n</table>\n<p class=\"soft\">Metres and radians make up most of the unscaled number. A condition "
            "number of 10<sup>k</sup> costs about k of a double's sixteen digits.</p>\n");
    }

    void put_figures() {
        using enum Signal;
        const std::array in_a{Look{&runs_.a, "#8c8c8c", "uncontrolled", false},
                              Look{&runs_.a1, "#e08a00", "law 1", true}, Look{&runs_.a3, "#00966e", "law 3", true},
                              Look{&runs_.a2, "#1079bd", "law 2", false}};
        const std::array with_both_booms{Look{&runs_.a, "#1079bd", "three links", false},
                                         Look{&runs_.a_beam, "#d1008f", "beam", false}};
        const std::array in_b{Look{&runs_.b, "#8c8c8c", "uncontrolled", false},
                              Look{&runs_.b2, "#1079bd", "law 2", false}};
        const std::array in_c{Look{&runs_.c, "#8c8c8c", "uncontrolled", false},
                              Look{&runs_.c2, "#1079bd", "law 2", false}};
        put("<h2>Figures</h2>\n<p class=\"soft\">By the numbers of the thesis's figures, with and without control in "
            "one "
            "plot. Coordinates are deviations from the equilibrium.</p>\n");
        put_case("Case A", in_a,
                 {{R1_m, "R1", "mm", 1e3, "24, 63, 71, 81, 101"},
                  {R1_rate_m_s, "R1'", "mm/s", 1e3, "63, 71, 81"},
                  {phi2_rad, "φ2", "mrad", 1e3, "25, 64, 72, 82"},
                  {phi2_rate_rad_s, "φ2'", "mrad/s", 1e3, "64, 72, 82"},
                  {phi6_rad, "φ6", "mrad", 1e3, "26, 65, 73"},
                  {phi6_rate_rad_s, "φ6'", "mrad/s", 1e3, "65, 73"},
                  {phi9_rad, "φ9", "mrad", 1e3, "27, 74, 83"},
                  {phi9_rate_rad_s, "φ9'", "mrad/s", 1e3, "74, 83"},
                  {R9_m, "R9", "mm", 1e3, "28, 75"},
                  {R9_rate_m_s, "R9'", "mm/s", 1e3, "75"},
                  {q1_m, "q1", "mm", 1e3, "66, 76, 84"},
                  {q1_rate_m_s, "q1'", "mm/s", 1e3, "66, 76, 84"},
                  {chord_m, "chord, less the straight boom's length", "mm", 1e3, "29, 78"},
                  {pendent_tension_N, "pendent tension", "kN", 1e-3, "29, 78"},
                  {load_line_tension_N, "load line tension", "kN", 1e-3, "29, 78"},
                  {power_W, "hydraulic power", "kW", 1e-3, "68, 79, 85"},
                  {piston_m, "piston", "mm", 1e3, "68, 79, 85"},
                  {spool_m, "valve", "mm", 1e3, "68, 79, 85"},
                  {R1_m, "R1", "mm", 1e3, "31, 69, 77, 86", true},
                  {phi2_rad, "φ2", "mrad", 1e3, "32, 87", true},
                  {phi6_rad, "φ6", "mrad", 1e3, "33, 67", true},
                  {phi9_rad, "φ9", "mrad", 1e3, "34", true},
                  {R9_m, "R9", "mm", 1e3, "35, 70", true},
                  {q1_m, "q1", "mm", 1e3, "36, 80", true}});
        const std::string chord_of_both =
            fmt::format("chord, less the straight boom's length; that of the links moves by {:.2g} mm alone",
                        1e3 * chord_range_m(runs_.a));
        put_case("Case A with both booms, uncontrolled", with_both_booms,
                 {{R1_m, "R1", "mm", 1e3, "24"},
                  {phi2_rad, "φ2", "mrad", 1e3, "25"},
                  {phi6_rad, "φ6", "mrad", 1e3, "26"},
                  {phi9_rad, "φ9", "mrad", 1e3, "27"},
                  {R9_m, "R9", "mm", 1e3, "28"},
                  {chord_m, chord_of_both, "mm", 1e3, "29, 30"},
                  {pendent_tension_N, "pendent tension", "kN", 1e-3, "29, 30"},
                  {load_line_tension_N, "load line tension", "kN", 1e-3, "29, 30"},
                  {R1_m, "R1", "mm", 1e3, "31", true},
                  {phi2_rad, "φ2", "mrad", 1e3, "32", true},
                  {phi6_rad, "φ6", "mrad", 1e3, "33", true},
                  {phi9_rad, "φ9", "mrad", 1e3, "34", true},
                  {R9_m, "R9", "mm", 1e3, "35", true},
                  {q1_m, "q1, of the beam its deflection at a third", "mm", 1e3, "36", true}});
        put_case("Case B", in_b,
                 {{R1_m, "R1", "mm", 1e3, "37, 88, 101"},
                  {R1_rate_m_s, "R1'", "mm/s", 1e3, "37, 88"},
                  {phi2_rad, "φ2", "mrad", 1e3, "38, 89"},
                  {phi2_rate_rad_s, "φ2'", "mrad/s", 1e3, "38, 89"},
                  {phi6_rad, "φ6", "mrad", 1e3, "39"},
                  {phi6_rate_rad_s, "φ6'", "mrad/s", 1e3, "39"},
                  {phi9_rad, "φ9", "mrad", 1e3, "40"},
                  {phi9_rate_rad_s, "φ9'", "mrad/s", 1e3, "40"},
                  {R9_m, "R9", "mm", 1e3, "41"},
                  {R9_rate_m_s, "R9'", "mm/s", 1e3, "41"},
                  {q1_m, "q1", "mm", 1e3, "42, 90"},
                  {q1_rate_m_s, "q1'", "mm/s", 1e3, "42, 90"},
                  {q2_m, "q2", "mm", 1e3, "43"},
                  {q2_rate_m_s, "q2'", "mm/s", 1e3, "43"},
                  {chord_m, "chord, less the straight boom's length", "mm", 1e3, "47, 91"},
                  {pendent_tension_N, "pendent tension", "kN", 1e-3, "47, 91"},
                  {load_line_tension_N, "load line tension", "kN", 1e-3, "47, 91"},
                  {power_W, "hydraulic power", "kW", 1e-3, "92"},
                  {piston_m, "piston", "mm", 1e3, "92"},
                  {spool_m, "valve", "mm", 1e3, "92"},
                  {R1_m, "R1", "mm", 1e3, "44, 93", true},
                  {phi2_rad, "φ2", "mrad", 1e3, "45", true},
                  {phi9_rad, "φ9", "mrad", 1e3, "46", true},
                  {q1_m, "q1", "mm", 1e3, "94", true}});
        put_case("Case C", in_c,
                 {{R1_m, "R1", "mm", 1e3, "48, 95, 101"},
                  {R1_rate_m_s, "R1'", "mm/s", 1e3, "48, 95"},
                  {phi2_rad, "φ2", "mrad", 1e3, "49, 96"},
                  {phi2_rate_rad_s, "φ2'", "mrad/s", 1e3, "49, 96"},
                  {phi6_rad, "φ6", "mrad", 1e3, "50"},
                  {phi6_rate_rad_s, "φ6'", "mrad/s", 1e3, "50"},
                  {phi9_rad, "φ9", "mrad", 1e3, "51"},
                  {phi9_rate_rad_s, "φ9'", "mrad/s", 1e3, "51"},
                  {R9_m, "R9", "mm", 1e3, "52"},
                  {R9_rate_m_s, "R9'", "mm/s", 1e3, "52"},
                  {q1_m, "q1", "mm", 1e3, "53"},
                  {q1_rate_m_s, "q1'", "mm/s", 1e3, "53"},
                  {q2_m, "q2", "mm", 1e3, "54"},
                  {q2_rate_m_s, "q2'", "mm/s", 1e3, "54"},
                  {chord_m, "chord, less the straight boom's length", "mm", 1e3, "59, 97"},
                  {pendent_tension_N, "pendent tension", "kN", 1e-3, "59, 97"},
                  {load_line_tension_N, "load line tension", "kN", 1e-3, "59, 97"},
                  {power_W, "hydraulic power", "kW", 1e-3, "98"},
                  {piston_m, "piston", "mm", 1e3, "98"},
                  {spool_m, "valve", "mm", 1e3, "98"},
                  {R1_m, "R1", "mm", 1e3, "55, 99", true},
                  {phi2_rad, "φ2", "mrad", 1e3, "56", true},
                  {phi9_rad, "φ9", "mrad", 1e3, "57", true},
                  {q1_m, "q1", "mm", 1e3, "58, 100", true}});
    }

    void put_case(std::string_view title, std::span<const Look> looks, const std::vector<Shown>& list) {
        put("<h3>{}</h3>\n", title);
        std::vector<KeyEntry> entries;
        for (const Look& look : looks) {
            entries.push_back({look.colour, look.words, look.dashed});
        }
        put_key(entries, true);
        put("<div class=\"plots\">\n");
        for (const Shown& shown : list) {
            Plot plot;
            plot.x_label = shown.spectrum ? "f [Hz]" : "t [s]";
            plot.y_label = fmt::format("{} [{}]", shown.name.substr(0, shown.name.find(',')), shown.unit);
            plot.x_range =
                shown.spectrum ? PlotRange{0.0, spectra_up_to_Hz} : PlotRange{0.0, looks[0].run->duration_s()};
            for (const Look& look : looks) {
                plot.curves.push_back(curve_of(look, shown));
            }
            put_plot(std::move(plot), fmt::format("Fig. {}", shown.figures),
                     fmt::format("{}{}", shown.spectrum ? "amplitude spectrum of " : "", shown.name), plot_buckets);
        }
        put("</div>\n");
    }

    static Curve curve_of(const Look& look, const Shown& shown) {
        Curve curve;
        curve.colour = look.colour;
        curve.dashed = look.dashed;
        curve.width_px = look.dashed ? 1.0 : 1.3;
        const std::vector<double>& values =
            shown.spectrum ? look.run->spectrum(shown.signal).amplitude : look.run->signal(shown.signal);
        const double spacing = shown.spectrum ? look.run->spectrum(shown.signal).spacing_Hz : look.run->period_s();
        // A chord is metres long and shortens by fractions of a millimetre.
        const double from = shown.signal == Signal::chord_m && !shown.spectrum
                                ? look.run->options().crane_case.crane.structure.boom_length_m
                                : 0.0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            curve.x.push_back(static_cast<double>(i) * spacing);
            curve.y.push_back(shown.scale * (values[i] - from));
        }
        return curve;
    }

    const std::vector<Row>& rows_;
    const Appendix& appendix_;
    const ThesisRuns& runs_;
    std::vector<TurnedRow> turned_;
};

}  // namespace

std::string page_of(const std::vector<Row>& rows, const Appendix& appendix, const ThesisRuns& runs) {
    return Page(rows, appendix, runs).text();
}

}  // namespace steadyboom::hil::reproduction
