#include <array>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "hil/html_text.hpp"
#include "hil/plot.hpp"
#include "hil/reproduction/reproduction_report.hpp"

namespace steadyboom::hil::reproduction {

namespace {

constexpr int plot_buckets = 260;
constexpr double spectra_up_to_Hz = 25.0;

constexpr std::string_view style = R"(
:root{--paper:#fcfcfa;--ink:#1d2329;--soft:#5c6670;--line:#d9dcdf}
*{box-sizing:border-box}
body{margin:0 auto;padding:2rem 1.1rem 3rem;max-width:76rem;background:var(--paper);color:var(--ink);
font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
h1{font-size:1.9rem;line-height:1.2;margin:0}
h2{font-size:1.3rem;margin:2.4rem 0 .3rem}
h3{font-size:1.05rem;margin:1.6rem 0 .3rem}
p{margin:.5rem 0;max-width:48rem}
.soft,figcaption span{color:var(--soft)}
.counts{display:flex;flex-wrap:wrap;gap:.6rem;margin:1rem 0;padding:0;list-style:none}
.counts li{border:1px solid var(--line);border-radius:8px;padding:.4rem .8rem;background:#fff}
.counts b{font-size:1.4rem;margin-right:.4rem}
table{border-collapse:collapse;width:100%;font-size:.9rem;table-layout:fixed}
th,td{padding:.35rem .5rem;text-align:left;vertical-align:top;border-bottom:1px solid var(--line);overflow-wrap:anywhere}
thead th{border-bottom:2px solid var(--ink)}
tr{break-inside:avoid}
td small{display:block;color:var(--soft);margin-top:.15rem}
.v{font-weight:650;padding-left:.6rem}
.v0{border-left:6px solid #00966e;color:#006b4f}
.v1{border-left:6px double #b77400;color:#8a5800}
.v2{border-left:6px dashed #c0392b;color:#a32a1e}
.v3{border-left:6px dotted #8c8c8c;color:#5c6670;font-weight:400}
.key{display:flex;flex-wrap:wrap;gap:.2rem 1.3rem;margin:.4rem 0}
.swatch{display:inline-block;width:1.6em;height:0;border-top:3px solid;vertical-align:.25em;margin-right:.4em}
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,29rem),1fr));gap:1.2rem 1.5rem}
figure{margin:0;break-inside:avoid}
figcaption{font-size:.93rem}
figcaption span{margin-left:.4em}
svg{display:block;width:100%;height:auto}
@media (max-width:46rem){table,tbody,tr,td{display:block;width:auto!important}thead{display:none}
tr{border-bottom:2px solid var(--line);padding:.4rem 0}td{border:0;padding:.12rem .5rem}
td[data-k]::before{content:attr(data-k) ": ";color:var(--soft)}}
@media print{body{font-size:9.5pt;padding:0;max-width:none}.plots{grid-template-columns:1fr 1fr}}
)";

constexpr std::array<std::string_view, 4> marks{"●", "◐", "○", "–"};

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

class Page {
  public:
    Page(const std::vector<Row>& rows, const Appendix& appendix, const ThesisRuns& runs)
        : rows_(rows), appendix_(appendix), runs_(runs) {}

    std::string text() {
        put("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
            "<title>Steadyboom: the thesis, claim by claim</title>\n<style>{}</style>\n</head>\n<body>\n",
            style);
        put_head();
        put_claims();
        put_misprints();
        put_sensitivity();
        put_figures();
        put("<p class=\"soft\">Steadyboom {}</p>\n</body>\n</html>\n", STEADYBOOM_VERSION);
        return with_plots();
    }

  private:
    template <typename... Values>
    void put(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    }

    void put_head() {
        put("<h1>The thesis, claim by claim</h1>\n"
            "<p>What K. M. Finn's <i>A Reduced-Order Crawler Crane Model with Active Control to Attenuate the "
            "Transient "
            "Vibrations</i> says about behaviour in chapters 5, 7 and 8, and what this model does. Every number and "
            "every "
            "verdict is computed from the runs; nothing is tuned to make a row hold.</p>\n<ul class=\"counts\">\n");
        for (const Verdict verdict :
             {Verdict::holds, Verdict::holds_in_kind, Verdict::does_not_hold, Verdict::not_examined}) {
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
            "peak "
            "above 0.3 Hz; a peak is visible from a fifth of the largest. Likeness is the cosine between two amplitude "
            "spectra up to 30 Hz. Not examined are claims about Patten's higher-order boom.</p>\n",
            runs_.a.duration_s(), 1e3 * runs_.a.period_s(), runs_.a.spectrum(Signal::R1_m).spacing_Hz);
    }

    void put_claims() {
        std::string section;
        for (const Row& row : rows_) {
            if (row.section != section) {
                put("{}<h2>Chapter {}</h2>\n<table>\n<thead><tr><th style=\"width:6rem\">row</th><th "
                    "style=\"width:28%\">claim</th><th style=\"width:11%\">thesis</th><th>here</th><th "
                    "style=\"width:10rem\">verdict</th></tr></thead>\n<tbody>\n",
                    section.empty() ? "" : "</tbody>\n</table>\n", html_text(row.section));
                section = row.section;
            }
            const auto verdict = static_cast<std::size_t>(row.verdict);
            put("<tr><td>{}</td><td>{}<small>{}</small></td><td data-k=\"thesis\">{}</td><td data-k=\"here\">{}",
                row.id, html_text(row.claim), row.figures == "-" ? "" : "Fig. " + row.figures, html_text(row.thesis),
                html_text(row.here));
            if (row.verdict != Verdict::not_examined) {
                put("<small>{}</small>", html_text(row.reason));
            }
            if (!row.would_hold_if.empty()) {
                put("<small>{}: {}</small>", row.verdict == Verdict::not_examined ? "Needs" : "Would have to be true",
                    html_text(row.would_hold_if));
            }
            put("</td><td class=\"v v{}\">{} {}</td></tr>\n", verdict, marks[verdict], name_of(row.verdict));
        }
        put("</tbody>\n</table>\n");
    }

    void put_misprints() {
        put("<h2>Misprints</h2>\n<p class=\"soft\">Where the thesis contradicts itself, what is used instead and the "
            "calculation that decides.</p>\n<table>\n<thead><tr><th style=\"width:12%\">where</th><th "
            "style=\"width:17%\">printed</th><th style=\"width:17%\">used</th><th>what decides</th><th>with the "
            "printed "
            "one</th></tr></thead>\n<tbody>\n");
        for (const MisprintRow& row : appendix_.misprints) {
            put("<tr><td>{}</td><td data-k=\"printed\">{}</td><td data-k=\"used\">{}</td><td>{}</td><td>{}</td></tr>\n",
                html_text(row.where), html_text(row.printed), html_text(row.used), html_text(row.calculation),
                html_text(row.consequence));
        }
        put("</tbody>\n</table>\n");
    }

    void put_sensitivity() {
        put("<h2>Sensitivity</h2>\n<p class=\"soft\">What the thesis leaves open, varied over a range; claims in "
            "words, "
            "without a law and with law 2, and which variations turn the answer.</p>\n<ul>\n");
        for (const SensitivityRange& range : appendix_.sensitivity.ranges) {
            put("<li>{}: {} <span class=\"soft\">({})</span></li>\n", html_text(range.parameter),
                html_text(range.range), html_text(range.reason));
        }
        put("</ul>\n<table>\n<thead><tr><th style=\"width:38%\">claim</th><th style=\"width:10%\">case</th><th "
            "style=\"width:14%\">as shipped</th><th>turned by</th></tr></thead>\n<tbody>\n");
        for (const SensitivityVerdict& verdict : appendix_.sensitivity.verdicts) {
            put("<tr><td>{}</td><td>{}</td><td data-k=\"as shipped\">{}</td><td data-k=\"turned by\">{}</td></tr>\n",
                html_text(verdict.claim), html_text(verdict.case_name), verdict.nominal ? "holds" : "does not hold",
                verdict.changed.empty() ? "nothing" : html_text(fmt::format("{}", fmt::join(verdict.changed, "; "))));
        }
        put("</tbody>\n</table>\n");
    }

    void put_figures() {
        using enum Signal;
        const std::array in_a{Look{&runs_.a, "#8c8c8c", "uncontrolled", false},
                              Look{&runs_.a1, "#e08a00", "law 1", true}, Look{&runs_.a3, "#00966e", "law 3", true},
                              Look{&runs_.a2, "#1079bd", "law 2", false}};
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
                  {chord_m, "chord", "m", 1.0, "29, 78"},
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
                  {chord_m, "chord", "m", 1.0, "47, 91"},
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
                  {chord_m, "chord", "m", 1.0, "59, 97"},
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
        put("<h3>{}</h3>\n<div class=\"key\">", title);
        for (const Look& look : looks) {
            put("<span><i class=\"swatch\" style=\"border-color:{}{}\"></i>{}</span>", look.colour,
                look.dashed ? ";border-top-style:dashed" : "", look.words);
        }
        put("</div>\n<div class=\"plots\">\n");
        for (const Shown& shown : list) {
            Plot plot;
            plot.x_label = shown.spectrum ? "f [Hz]" : "t [s]";
            plot.y_label = fmt::format("{} [{}]", shown.name, shown.unit);
            plot.x_range =
                shown.spectrum ? PlotRange{0.0, spectra_up_to_Hz} : PlotRange{0.0, looks[0].run->duration_s()};
            for (const Look& look : looks) {
                plot.curves.push_back(curve_of(look, shown, plot.x_range));
            }
            put("<figure>\n<figcaption><b>Fig. {}</b><span>{}{}</span></figcaption>\n", shown.figures,
                shown.spectrum ? "amplitude spectrum of " : "", shown.name);
            places_.push_back(text_.size());
            plots_.push_back(std::move(plot));
            put("</figure>\n");
        }
        put("</div>\n");
    }

    static Curve curve_of(const Look& look, const Shown& shown, PlotRange range) {
        Curve curve;
        curve.colour = look.colour;
        curve.dashed = look.dashed;
        curve.width_px = look.dashed ? 1.0 : 1.3;
        const std::vector<double>& values =
            shown.spectrum ? look.run->spectrum(shown.signal).amplitude : look.run->signal(shown.signal);
        const double spacing = shown.spectrum ? look.run->spectrum(shown.signal).spacing_Hz : look.run->period_s();
        for (std::size_t i = 0; i < values.size(); ++i) {
            curve.x.push_back(static_cast<double>(i) * spacing);
            curve.y.push_back(shown.scale * values[i]);
        }
        return thinned(curve, range, plot_buckets);
    }

    std::string with_plots() const {
        const std::vector<std::string> drawn = draw_plots(plots_);
        std::string page;
        std::size_t from = 0;
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            page += text_.substr(from, places_[i] - from);
            page += drawn[i];
            from = places_[i];
        }
        return page + text_.substr(from);
    }

    const std::vector<Row>& rows_;
    const Appendix& appendix_;
    const ThesisRuns& runs_;
    std::string text_;
    std::vector<Plot> plots_;
    std::vector<std::size_t> places_;  ///< in text_, of each plot
};

}  // namespace

std::string page_of(const std::vector<Row>& rows, const Appendix& appendix, const ThesisRuns& runs) {
    return Page(rows, appendix, runs).text();
}

}  // namespace steadyboom::hil::reproduction
