#include "hil/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "hil/figure_table.hpp"
#include "hil/html_page.hpp"
#include "hil/plot.hpp"
#include "hil/true_crane.hpp"
#include "hil/whole_file.hpp"
#include "plant/equilibrium.hpp"

namespace steadyboom::hil {

namespace {

using controllers::LawKind;
using plant::CraneState;

constexpr double before_brake_s = 0.5;  ///< shown of the standing crane
constexpr double valve_shown_s = 0.6;
constexpr double observer_shown_s = 3.0;
constexpr int plot_buckets = 480;  ///< about one for each pixel of a plot

/// Colours that people with any colour vision tell apart (Okabe and Ito), on light and on dark paper.
struct Look {
    LawKind law;
    std::string_view colour;
    std::string_view title;
    std::string_view words;
};
constexpr std::array looks{
    Look{LawKind::none, "#8c8c8c", "uncontrolled", "The valve stays shut."},
    Look{LawKind::boom_angle, "#e08a00", "boom angle", "Opens the valve by the boom's angle φ6 and its rate."},
    Look{LawKind::joint_deflection, "#1079bd", "joint deflection",
         "Opens the valve by the bending q1 of the lower boom joint."},
    Look{LawKind::swing_rate, "#00966e", "swing rate", "Opens the valve by the load's swing rate, dφ9/dt."},
};
constexpr std::string_view wanted_colour = "#e08a00";
constexpr std::string_view applied_colour = "#1079bd";
constexpr std::string_view spool_colour = "#00966e";
constexpr std::string_view estimate_colour = "#d1008f";
constexpr std::string_view truth_colour = "#b4b4b4";

const Look& look_of(LawKind law) {
    return *std::ranges::find(looks, law, &Look::law);
}
const Look& look_of(const RunResult& run) {
    return look_of(run.options.law);
}

constexpr std::string_view style = R"(
.lead{font-size:1.13rem;margin-top:.9rem;max-width:52rem}
.warn{border-left:4px solid #d55e00;padding:.3rem .8rem;background:var(--panel)}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,10rem),1fr));gap:.8rem;margin:1.4rem 0}
.tile{background:var(--panel);border:1px solid var(--line);border-radius:8px;padding:.7rem .9rem}
.tile b{display:block;font-size:1.55rem;line-height:1.25}
.intro{display:grid;grid-template-columns:minmax(0,24rem) minmax(0,1fr);gap:2rem;align-items:center;margin-top:1rem}
.intro figure{max-width:24rem}
.intro h2{margin-top:.5rem}
.laws{margin:.3rem 0 .8rem;padding:0;list-style:none}
.table{overflow-x:auto}
table{font-variant-numeric:tabular-nums;min-width:min(100%,30rem)}
.many{width:100%}
th,td{padding:.28rem .7rem;text-align:right;white-space:nowrap}
th:first-child,td:first-child{text-align:left;padding-left:.2rem;position:sticky;left:0;background:var(--paper)}
td small{display:inline-block;min-width:3.4em}
.best{background:var(--tint)}
td.least{font-weight:650}
dl{display:grid;grid-template-columns:max-content minmax(0,1fr);gap:.15rem 1.2rem;margin:.6rem 0;overflow-wrap:anywhere}
dt{color:var(--soft)}
dd{margin:0}
@media (max-width:52rem){.intro{grid-template-columns:minmax(0,1fr);gap:.5rem}.intro figure{margin:0 auto;width:100%}}
@media (max-width:34rem){dl{grid-template-columns:minmax(0,1fr)}dd{margin-bottom:.4rem}
th,td{padding:.28rem .45rem;font-size:.9rem}}
@media print{.table{overflow:visible}}
)";

/// Everything the page says, put together piece by piece.
class Report : HtmlPage {
  public:
    explicit Report(std::span<const RunResult> runs)
        : HtmlPage(runs.front().options.crane_case.name, style),
          runs_(runs),
          crane_(runs.front().options.crane_case.crane),
          rest_(rest_of(runs.front().options.crane_case)),
          uncontrolled_(uncontrolled_run(runs)),
          best_(best_run(runs)) {}

    std::string page() {
        const Case& shown = runs_.front().options.crane_case;
        put("<header>\n<h1>How the crane comes to rest: {}</h1>\n<p class=\"soft\">{}</p>\n", html_text(shown.name),
            html_text(shown.description));
        put_summary();
        put("</header>\n<main>\n");
        put_introduction();
        put_table();
        put_motion();
        put_forces();
        put_valve();
        put_observer();
        put("</main>\n<footer>\n");
        put_settings();
        put("</footer>\n");
        return std::move(*this).finished();
    }

  private:
    static const RunResult& best_run(std::span<const RunResult> runs) {
        return *std::ranges::min_element(runs, [](const RunResult& left, const RunResult& right) {
            return std::pair(!left.stayed_engaged, left.figures.residual_energy_J) <
                   std::pair(!right.stayed_engaged, right.figures.residual_energy_J);
        });
    }

    [[nodiscard]] bool law_wins() const { return best_.options.law != LawKind::none; }
    [[nodiscard]] double duration_s() const {
        return std::ranges::max(runs_, {}, [](const RunResult& run) { return run.options.duration_s; })
            .options.duration_s;
    }

    void put_summary() {
        const Case& shown = runs_.front().options.crane_case;
        put("<p class=\"lead\">A load of {:.1f} t drops {:.0f} mm and the brake catches it at <i>t</i> = 0, on a boom "
            "of "
            "{:.1f} m at {:.1f}°.",
            1e-3 * shown.crane.structure.load_mass_kg, 1e3 * shown.manoeuvre.load_drop_m,
            shown.crane.structure.boom_length_m, rest_.state[plant::phi6_rad] * 180.0 / std::numbers::pi);
        const auto energy = [](const RunResult& run) { return figure_text_of(run.figures, "residual_energy_J"); };
        if (uncontrolled_ != nullptr) {
            put(" Left alone, the crane still holds {} J of motion at the end of {:g} s.", energy(*uncontrolled_),
                uncontrolled_->options.duration_s);
        }
        if (law_wins()) {
            put(" The law <b>{}</b> leaves <b>{} J</b>", look_of(best_).title, energy(best_));
            if (uncontrolled_ != nullptr && uncontrolled_->figures.residual_energy_J > 0.0) {
                put(", {:.1f} % of that",
                    100.0 * best_.figures.residual_energy_J / uncontrolled_->figures.residual_energy_J);
            }
            put(", with at most {} kW from the hydraulics.", figure_text_of(best_.figures, "peak_power_W"));
        } else if (runs_.size() > 1) {
            put(" None of the laws left less.");
        }
        put("</p>\n");
        for (const RunResult& run : runs_) {
            for (const std::string& remark : remarks(run)) {
                put("<p class=\"warn\">{}</p>\n", html_text(remark));
            }
        }
        put("<div class=\"tiles\">\n");
        for (const std::string_view key : {"residual_energy_J", "late_rms_R1_m", "late_rms_q1_m", "peak_power_W"}) {
            const FigureRow& row = *std::ranges::find(figure_rows, key, &FigureRow::key);
            put("<div class=\"tile\">{}<b>{} {}</b><span class=\"soft\">", row.label, figure_text(best_.figures, row),
                row.unit);
            if (law_wins() && uncontrolled_ != nullptr && row.compared) {
                put("{} {} uncontrolled", figure_text(uncontrolled_->figures, row), row.unit);
            } else {
                put("{}", look_of(best_).title);
            }
            put("</span></div>\n");
        }
        put("</div>\n");
    }

    static std::string figure_text_of(const RunFigures& figures, std::string_view key) {
        return figure_text(figures, *std::ranges::find(figure_rows, key, &FigureRow::key));
    }

    void put_introduction() {
        put("<section class=\"intro\">\n<figure>\n");
        put_drawing();
        put("<figcaption>The crane at rest, to scale, with its coordinates.</figcaption>\n</figure>\n<div>\n"
            "<h2>How to read this</h2>\n"
            "<p>Every curve is of the true (simulated) crane; the controller saw only what noisy sensors sent over the "
            "bus. Excursions are deviations from rest. “Late” is the second half of the run; the residual energy is "
            "the mean over its last second.</p>\n"
            "<p>A good law brings the curves to zero soon, without slack ropes and with little power. The valve moves "
            "a piston in the pendent line: opening it raises or lowers the boom a little.</p>\n"
            "<ul class=\"laws\">\n");
        for (const RunResult& run : runs_) {
            const Look& look = look_of(run);
            put("<li><i class=\"swatch\" style=\"border-color:{}\"></i><b>{}</b> <span class=\"soft\">{}</span></li>\n",
                look.colour, look.title, look.words);
        }
        put("</ul>\n</div>\n</section>\n");
    }

    void put_drawing() {
        const plant::StructureParameters& body = crane_.parameters().structure;
        const plant::CranePoints points = crane_.points(plant::coordinates_of(rest_.state));
        const double half_track_m = crane_.parameters().soil.track_half_length_m;
        const double anchor_direction_rad =
            rest_.state[plant::phi2_rad] + body.pendent_anchor_angle_rad + 0.5 * std::numbers::pi;
        const Eigen::Vector2d anchor =
            points.boom_butt + body.pendent_anchor_radius_m *
                                   Eigen::Vector2d(std::cos(anchor_direction_rad), std::sin(anchor_direction_rad));
        const double left_m = std::min({-half_track_m, points.car_body_centre.x(), anchor.x()}) - 2.0;
        const double right_m = std::max({half_track_m, points.boom_tip.x(), points.load.x()});
        const double top_m = std::max(points.boom_tip.y(), anchor.y());
        constexpr double width_px = 400.0;
        constexpr double height_px = 400.0;
        const double scale = std::min((width_px - 90.0) / (right_m - left_m), (height_px - 60.0) / top_m);
        const double x0 = 20.0 + 0.5 * (width_px - 90.0 - scale * (right_m - left_m)) - scale * left_m;
        const double y0 = height_px - 36.0;
        const auto at = [&](const Eigen::Vector2d& point) {
            return Eigen::Vector2d(x0 + scale * point.x(), y0 - scale * point.y());
        };
        const auto line = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::string_view look) {
            put("<path d=\"M{:.1f},{:.1f}L{:.1f},{:.1f}\" {}/>\n", from.x(), from.y(), to.x(), to.y(), look);
        };
        const auto label = [&](const Eigen::Vector2d& where, std::string_view text, std::string_view anchor_word) {
            put("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", where.x(), where.y(), anchor_word,
                text);
        };
        constexpr std::string_view rope = "stroke=\"currentColor\" stroke-width=\"1.3\"";
        constexpr std::string_view thin = "stroke=\"currentColor\" stroke-opacity=\".45\" stroke-dasharray=\"3 3\"";
        constexpr std::string_view measure = "stroke=\"#1079bd\" stroke-width=\"1.4\" fill=\"none\"";
        constexpr std::string_view arrow = "stroke=\"#1079bd\" stroke-width=\"1.4\" marker-end=\"url(#tip)\"";

        put("<svg viewBox=\"0 0 {0:g} {1:g}\" role=\"img\" aria-label=\"Crane at rest\" font-size=\"15\" "
            "fill=\"currentColor\"><defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" "
            "markerWidth=\"7\" markerHeight=\"7\" orient=\"auto-start-reverse\"><path d=\"M0,0L8,4L0,8z\" "
            "fill=\"#1079bd\"/></marker></defs>\n",
            width_px, height_px);
        const Eigen::Vector2d butt = at(points.boom_butt);
        const Eigen::Vector2d tip = at(points.boom_tip);
        const Eigen::Vector2d load = at(points.load);
        line({8.0, y0}, {width_px - 8.0, y0}, "stroke=\"currentColor\" stroke-opacity=\".5\" stroke-width=\"1\"");
        const double track_px = std::max(7.0, 2.0 * scale * body.track_centre_height_m);
        put("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"{:.1f}\" fill-opacity=\".55\"/>\n",
            x0 - scale * half_track_m, y0 - track_px, 2.0 * scale * half_track_m, track_px, 0.5 * track_px);
        const Eigen::Vector2d body_centre = at(points.car_body_centre);
        const double body_left = body_centre.x() - 1.8 * scale;
        const double body_top = std::min(y0 - track_px - 8.0, body_centre.y() - 1.0 * scale);
        put("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"2\" fill-opacity=\".8\"/>\n",
            body_left, body_top, butt.x() + 3.0 - body_left, y0 - track_px - body_top);
        line(butt, at(anchor), "stroke=\"currentColor\" stroke-width=\"2.2\"");
        line(at(anchor), tip, rope);
        const std::array boom{butt, at(points.lower_joint), at(points.upper_joint), tip};
        for (std::size_t i = 0; i + 1 < boom.size(); ++i) {
            line(boom[i], boom[i + 1], "stroke=\"currentColor\" stroke-width=\"5\" stroke-linecap=\"round\"");
        }
        line(tip, load, rope);
        put("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"18\" height=\"16\" rx=\"2\"/>\n", load.x() - 9.0, load.y());
        label({load.x() + 14.0, load.y() + 14.0}, "load", "start");

        const Eigen::Vector2d along = (tip - butt).normalized();
        const Eigen::Vector2d across(-along.y(), along.x());  // on the screen: below and ahead of the boom
        const Eigen::Vector2d rope_along = (tip - at(anchor)).normalized();
        const Eigen::Vector2d piston = at(anchor) + 34.0 * rope_along;
        const double rope_deg = std::atan2(rope_along.y(), rope_along.x()) * 180.0 / std::numbers::pi;
        put("<rect x=\"-11\" y=\"-4.5\" width=\"22\" height=\"9\" rx=\"2\" fill=\"#1079bd\" "
            "transform=\"translate({:.1f},{:.1f}) rotate({:.1f})\"/>\n",
            piston.x(), piston.y(), rope_deg);
        label({piston.x() - 12.0, piston.y() - 8.0}, "piston", "end");

        for (std::size_t i = 1; i <= 2; ++i) {
            put("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\" fill=\"var(--paper)\" stroke=\"currentColor\" "
                "stroke-width=\"1.6\"/>\n",
                boom[i].x(), boom[i].y());
            line(boom[i] + 7.0 * across, boom[i] + 27.0 * across, arrow);
            label(boom[i] + 41.0 * across + Eigen::Vector2d(0.0, 5.0), i == 1 ? "q1" : "q2", "middle");
        }
        const double boom_rad = std::atan2(butt.y() - tip.y(), tip.x() - butt.x());
        constexpr double arc_px = 62.0;
        line(butt, butt + Eigen::Vector2d(arc_px + 22.0, 0.0), thin);
        put("<path d=\"M{:.1f},{:.1f}A{:g},{:g} 0 0 0 {:.1f},{:.1f}\" marker-end=\"url(#tip)\" {}/>\n",
            butt.x() + arc_px, butt.y(), arc_px, arc_px, butt.x() + arc_px * std::cos(boom_rad),
            butt.y() - arc_px * std::sin(boom_rad), measure);
        label(butt + Eigen::Vector2d((arc_px + 8.0) * std::cos(0.5 * boom_rad),
                                     -(arc_px + 8.0) * std::sin(0.5 * boom_rad) + 4.0),
              "φ6", "start");

        const double line_px = (load - tip).norm();
        label({load.x() + 5.0, tip.y() + 0.88 * line_px}, "R9", "start");
        const double swing_px = 0.55 * line_px;
        const double swing_rad = std::atan(40.0 / line_px);  // leaves room for the name of R9
        line(tip, tip + line_px * Eigen::Vector2d(std::sin(swing_rad), std::cos(swing_rad)), thin);
        put("<path d=\"M{:.1f},{:.1f}A{:.1f},{:.1f} 0 0 0 {:.1f},{:.1f}\" marker-end=\"url(#tip)\" {}/>\n", tip.x(),
            tip.y() + swing_px, swing_px, swing_px, tip.x() + swing_px * std::sin(swing_rad),
            tip.y() + swing_px * std::cos(swing_rad), measure);
        label({tip.x() + swing_px * std::sin(swing_rad) + 8.0, tip.y() + swing_px * std::cos(swing_rad) + 1.0}, "φ9",
              "start");

        const double track_right = x0 + scale * half_track_m;
        line({x0, y0 + 26.0}, {x0, y0 + 4.0}, arrow);
        label({x0 - 8.0, y0 + 22.0}, "R1", "end");
        put("<path d=\"M{:.1f},{:.1f}A60,60 0 0 0 {:.1f},{:.1f}\" marker-end=\"url(#tip)\" {}/>\n", track_right + 12.0,
            y0 - 3.0, track_right + 6.0, y0 - 27.0, measure);
        label({track_right + 6.0, y0 + 17.0}, "φ2", "start");
        put("</svg>\n");
    }

    void put_table() {
        put("<section>\n<h2>Figures</h2>\n");
        if (runs_.size() > 1) {
            put("<p class=\"soft\">{}The least of a row is bold{}.</p>\n",
                uncontrolled_ != nullptr ? "Beside each value stands its ratio to the uncontrolled run. " : "",
                law_wins() ? ", the law that leaves least energy is tinted" : "");
        }
        put("<div class=\"table\"><table{}>\n<thead><tr><th>figure</th><th>unit</th>",
            runs_.size() > 1 ? " class=\"many\"" : "");
        const auto tint = [&](const RunResult& run) {
            return runs_.size() > 1 && law_wins() && &run == &best_ ? "best" : "";
        };
        for (const RunResult& run : runs_) {
            put("<th class=\"{}\"><i class=\"swatch\" style=\"border-color:{}\"></i>{}</th>", tint(run),
                look_of(run).colour, look_of(run).title);
        }
        put("</tr></thead>\n<tbody>\n");
        for (const FigureRow& row : figure_rows) {
            put("<tr><td>{}</td><td class=\"soft\">{}</td>", row.label, row.unit);
            const auto value = [&](const RunResult& run) { return run.figures.*row.value; };
            const double least = value(std::ranges::min(runs_, {}, value));
            const double most = value(std::ranges::max(runs_, {}, value));
            for (const RunResult& run : runs_) {
                const bool bold = row.compared && most > least && value(run) == least;
                put("<td class=\"{}{}\">{}", tint(run), bold ? " least" : "", figure_text(run.figures, row));
                const auto ratio = uncontrolled_ != nullptr && &run != uncontrolled_
                                       ? ratio_to(uncontrolled_->figures, run.figures, row)
                                       : std::nullopt;
                put(" <small>{}</small></td>", ratio ? "×" + ratio_text(*ratio) : "");
            }
            put("</tr>\n");
        }
        put("</tbody></table></div>\n</section>\n");
    }

    void put_run_key() {
        std::vector<KeyEntry> entries;
        for (const RunResult& run : runs_) {
            entries.push_back({look_of(run).colour, look_of(run).title});
        }
        put_key(entries, true);
    }

    void put_history(Plot plot, std::string_view symbol, std::string_view words) {
        plot.x_label = "t [s]";
        put_plot(std::move(plot), symbol, words, plot_buckets);
    }

    template <typename Value>
    static Curve curve_of(const RunResult& run, std::string_view colour, Value value) {
        Curve curve;
        curve.colour = colour;
        curve.x.reserve(run.ticks.size());
        curve.y.reserve(run.ticks.size());
        for (const RunTick& tick : run.ticks) {
            curve.x.push_back(tick.truth.t_s);
            curve.y.push_back(value(tick));
        }
        return curve;
    }

    /// All runs overlaid, the best on top.
    template <typename Value>
    Plot overlaid(std::string y_label, Value value) const {
        Plot plot;
        plot.y_label = std::move(y_label);
        plot.x_range = {-before_brake_s, duration_s()};
        for (const RunResult& run : runs_) {
            if (&run != &best_) {
                plot.curves.push_back(curve_of(run, look_of(run).colour, value));
            }
        }
        plot.curves.push_back(curve_of(best_, look_of(best_).colour, value));
        plot.curves.back().width_px = 1.8;
        return plot;
    }

    [[nodiscard]] auto deviation(plant::Coordinate coordinate) const {
        return [coordinate, rest = rest_.state[coordinate]](const RunTick& tick) {
            return 1e3 * (tick.truth.state[coordinate] - rest);
        };
    }

    void put_motion() {
        put("<section>\n<h2>Motion</h2>\n<p class=\"soft\">Deviations from rest.</p>\n");
        put_run_key();
        put("<div class=\"plots\">\n");
        Plot energy = overlaid("energy [kJ]", [&](const RunTick& tick) { return 1e-3 * tick.truth.residual_energy_J; });
        energy.x_range.low = 0.0;
        energy.logarithmic = true;
        put_history(std::move(energy), "Residual energy", "kinetic and elastic, of the whole crane; logarithmic");
        put_history(overlaid("R1 [mm]", deviation(plant::R1_m)), "R1", "vertical motion of the tracks on the soil");
        put_history(overlaid("φ2 [mrad]", deviation(plant::phi2_rad)), "φ2", "rocking of tracks and car body");
        put_history(overlaid("φ6 [mrad]", deviation(plant::phi6_rad)), "φ6", "boom angle");
        put_history(overlaid("q1 [mm]", deviation(plant::q1_m)), "q1", "bending of the boom at its lower joint");
        put_history(overlaid("φ9 [mrad]", deviation(plant::phi9_rad)), "φ9", "swing of the load");
        put("</div>\n</section>\n");
    }

    void put_forces() {
        put("<section>\n<h2>Ropes, ground and power</h2>\n<p class=\"soft\">Ropes only pull: a tension of zero is a "
            "slack "
            "rope. Dotted lines are the tensions at rest.</p>\n");
        put_run_key();
        put("<div class=\"plots\">\n");
        Plot pendent =
            overlaid("tension [kN]", [](const RunTick& tick) { return 1e-3 * tick.truth.pendent_tension_N; });
        pendent.marks = {1e-3 * rest_.pendent_tension_N};
        put_history(std::move(pendent), "Pendent", "tension of the rope that holds the boom");
        Plot load = overlaid("tension [kN]", [](const RunTick& tick) { return 1e-3 * tick.truth.load_line_tension_N; });
        load.marks = {1e-3 * rest_.load_line_tension_N};
        put_history(std::move(load), "Load line", "tension of the rope that holds the load");
        Plot contact = overlaid("contact [%]", [](const RunTick& tick) { return 100.0 * tick.truth.contact_fraction; });
        contact.y_range = PlotRange{0.0, 105.0};
        put_history(std::move(contact), "Ground contact", "share of the tracks' length that bears");
        put_history(overlaid("power [kW]", [](const RunTick& tick) { return 1e-3 * tick.truth.hydraulic_power_W; }),
                    "Hydraulic power", "that the valve lets through to the piston");
        put("</div>\n</section>\n");
    }

    void put_valve() {
        if (std::ranges::all_of(runs_, [](const RunResult& run) { return run.options.law == LawKind::none; })) {
            return;
        }
        const double travel_mm = 1e3 * crane_.parameters().actuator.spool_travel_m;
        put("<section>\n<h2>Valve</h2>\n<p class=\"soft\">From the law's wish to the spool, close up. Dotted lines are "
            "the "
            "ends of the spool's travel, ±{:.3g} mm.</p>\n",
            travel_mm);
        put_key(std::array{KeyEntry{wanted_colour, "wanted by the law"}, KeyEntry{applied_colour, "sent to the valve"},
                           KeyEntry{spool_colour, "true spool"}},
                false);
        put("<div class=\"plots\">\n");
        for (const RunResult& run : runs_) {
            if (run.options.law == LawKind::none) {
                continue;
            }
            Plot plot;
            plot.y_label = "opening [mm]";
            plot.x_range = {-0.05, std::min(valve_shown_s, duration_s())};
            plot.curves.push_back(
                curve_of(run, wanted_colour, [](const RunTick& tick) { return 1e3 * tick.record.wanted_opening_m; }));
            plot.curves.back().width_px = 1.2;
            plot.curves.push_back(
                curve_of(run, applied_colour, [](const RunTick& tick) { return 1e3 * tick.record.applied_opening_m; }));
            plot.curves.back().stepped = true;
            plot.curves.push_back(
                curve_of(run, spool_colour, [](const RunTick& tick) { return 1e3 * tick.truth.spool_m; }));
            double most_mm = 0.05 * travel_mm;
            for (const Curve& curve : plot.curves) {
                for (std::size_t i = 0; i < curve.x.size(); ++i) {
                    if (curve.x[i] >= plot.x_range.low && curve.x[i] <= plot.x_range.high) {
                        most_mm = std::max(most_mm, std::abs(curve.y[i]));
                    }
                }
            }
            if (most_mm > travel_mm) {
                most_mm = 1.25 * travel_mm;
                plot.marks = {-travel_mm, travel_mm};
            } else {
                most_mm *= 1.08;
            }
            plot.y_range = PlotRange{-most_mm, most_mm};
            put_history(std::move(plot), look_of(run).title, "valve opening");
        }
        put("</div>\n</section>\n");
    }

    void put_observer() {
        put("<section>\n<h2>Observer</h2>\n<p class=\"soft\">What no sensor measures, as the controller believed it to "
            "be, "
            "over the truth; run <b>{}</b>, close up.</p>\n",
            look_of(best_).title);
        put_key(std::array{KeyEntry{truth_colour, "true"}, KeyEntry{estimate_colour, "estimated"}}, false);
        put("<div class=\"plots\">\n");
        struct Shown {
            plant::Coordinate coordinate;
            std::string_view label, symbol, words, unit;
        };
        for (const Shown& shown :
             {Shown{plant::R1_m, "R1 [mm]", "R1", "vertical motion of the tracks", "mm"},
              Shown{plant::phi2_rad, "φ2 [mrad]", "φ2", "rocking of tracks and car body", "mrad"}}) {
            Plot plot;
            plot.y_label = shown.label;
            plot.x_range = {-before_brake_s, std::min(observer_shown_s, duration_s())};
            plot.curves.push_back(curve_of(best_, truth_colour, deviation(shown.coordinate)));
            plot.curves.back().width_px = 5.0;
            const auto estimated = [&](const RunTick& tick) {
                return tick.record.estimate[static_cast<std::size_t>(shown.coordinate)];
            };
            plot.curves.push_back(curve_of(best_, estimate_colour, [&](const RunTick& tick) {
                return 1e3 * (estimated(tick) - rest_.state[shown.coordinate]);
            }));
            double squares = 0.0;
            for (const RunTick& tick : best_.ticks) {
                const double error = 1e3 * (estimated(tick) - tick.truth.state[shown.coordinate]);
                squares += error * error;
            }
            put_history(std::move(plot), shown.symbol,
                        fmt::format("{}; RMS error of the run {:.2g} {}", shown.words,
                                    std::sqrt(squares / static_cast<double>(best_.ticks.size())), shown.unit));
        }
        put("</div>\n</section>\n");
    }

    /// What all runs say, once if they agree.
    template <typename Say>
    [[nodiscard]] std::string said(Say say) const {
        std::vector<std::string> distinct;
        for (const RunResult& run : runs_) {
            std::string word = say(run);
            if (std::ranges::find(distinct, word) == distinct.end()) {
                distinct.push_back(std::move(word));
            }
        }
        return html_text(fmt::format("{}", fmt::join(distinct, "; ")));
    }

    void put_settings() {
        const Case& shown = runs_.front().options.crane_case;
        const controllers::ThesisGains& gains = shown.gains;
        put("<h2>Settings</h2>\n<dl>\n");
        const auto entry = [&](std::string_view name, const std::string& value) {
            put("<dt>{}</dt><dd>{}</dd>\n", name, value);
        };
        entry("case", html_text(shown.name));
        entry("control rate", said([](const RunResult& run) { return fmt::format("{:g} Hz", run.options.rate_Hz); }));
        entry("duration", said([](const RunResult& run) { return fmt::format("{:g} s", run.options.duration_s); }));
        entry("bus", said([](const RunResult& run) {
                  return run.bus == "loopback" ? std::string("in-process, in lockstep") : run.bus + ", in real time";
              }));
        entry("seed of the noise", said([](const RunResult& run) { return fmt::format("{}", run.options.seed); }));
        entry("falsified in the controller's model", said([](const RunResult& run) {
                  return run.options.mismatches.empty() ? std::string("nothing")
                                                        : fmt::format("{}", fmt::join(run.options.mismatches, ", "));
              }));
        entry("gains",
              fmt::format("K1 {:g} m/rad, K2 {:g} m s/rad, K3 {:g} m/m, K4 {:g} m s/rad", gains.boom_angle_gain_m_rad,
                          gains.boom_rate_gain_m_s_rad, gains.joint_gain_m_m, gains.swing_rate_gain_m_s_rad));
        entry("frames on the bus", said([](const RunResult& run) { return fmt::format("{}", run.frames.size()); }));
        entry("boom of the crane", said([](const RunResult& run) {
                  return run.options.crane_case.boom == BoomKind::links
                             ? std::string("three links, as the controller models it")
                             : std::string("beam with three bending modes; the controller models three links");
              }));
        entry("crane", fmt::format("{:016x}", runtime::crane_hash(shown.crane)));
        entry("Steadyboom", STEADYBOOM_VERSION);
        put("</dl>\n");
    }

    std::span<const RunResult> runs_;
    plant::CraneDynamics crane_;
    plant::Equilibrium rest_;
    const RunResult* uncontrolled_;
    const RunResult& best_;
};

}  // namespace

void write_report(const std::filesystem::path& file, std::span<const RunResult> runs) {
    if (runs.empty()) {
        throw std::invalid_argument("report: there is no run to report");
    }
    for (const RunResult& run : runs) {
        if (run.ticks.empty()) {
            throw std::invalid_argument(fmt::format("report: run {} has no ticks", name_of(run.options.law)));
        }
        if (run.options.crane_case.name != runs.front().options.crane_case.name) {
            throw std::invalid_argument("report: the runs are of different cases");
        }
    }
    write_whole_file(file, Report(runs).page());
}

}  // namespace steadyboom::hil
