#include "hil/reproduction/reproduction_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "plant/pinned_boom.hpp"

namespace steadyboom::hil::reproduction {

namespace {

nlohmann::ordered_json number_or_null(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

nlohmann::ordered_json range_json(const Range& range) {
    return {number_or_null(range.low), number_or_null(range.high)};
}

nlohmann::ordered_json counts_json(const std::vector<Row>& rows) {
    nlohmann::ordered_json counts{{"rows", rows.size()}};
    for (const Verdict verdict : all_verdicts) {
        counts[std::string(name_of(verdict))] = count(rows, verdict);
    }
    return counts;
}

nlohmann::ordered_json run_json(const ThesisRun& run) {
    nlohmann::ordered_json figures = nlohmann::ordered_json::object();
    for (const FigureRow& figure : figure_rows) {
        figures[std::string(figure.key)] = number_or_null(run.figures().*figure.value);
    }
    nlohmann::ordered_json modes = nlohmann::ordered_json::array();
    for (const RunMode& mode : run.modes()) {
        modes.push_back({{"frequency_Hz", mode.frequency_Hz},
                         {"damping_ratio", mode.damping_ratio},
                         {"dominant_coordinate", mode.dominant}});
    }
    nlohmann::ordered_json spectra = nlohmann::ordered_json::object();
    for (int i = 0; i < static_cast<int>(Signal::count); ++i) {
        nlohmann::ordered_json peaks = nlohmann::ordered_json::array();
        for (const SpectralPeak& peak : visible_peaks(run, static_cast<Signal>(i))) {
            peaks.push_back({{"frequency_Hz", peak.frequency_Hz}, {"amplitude", peak.amplitude}});
        }
        spectra[std::string(name_of(static_cast<Signal>(i)))] = peaks;
    }
    return {{"run", run.name()},
            {"case", run.options().crane_case.name},
            {"boom", name_of(run.options().crane_case.boom)},
            {"law", controllers::name_of(run.options().law)},
            {"figures", figures},
            {"soil_work_J", run.soil_work_J()},
            {"piston_work_J", run.piston_work_J()},
            {"modes", modes},
            {"spectral_peaks", spectra}};
}

nlohmann::ordered_json variation_json(const std::vector<Row>& rows, const Variation& variation) {
    nlohmann::ordered_json changed = nlohmann::ordered_json::array();
    nlohmann::ordered_json judged = nlohmann::ordered_json::object();
    for (std::size_t i = 0; i < variation.rows.size(); ++i) {
        const Row& row = variation.rows[i];
        nlohmann::ordered_json values = nlohmann::ordered_json::array();
        for (const Measure& measure : row.measures) {
            values.push_back(number_or_null(measure.value));
        }
        judged[row.id] = {{"verdict", name_of(row.verdict)}, {"values", values}};
        if (row.verdict != rows[i].verdict) {
            changed.push_back({{"row", row.id}, {"from", name_of(rows[i].verdict)}, {"to", name_of(row.verdict)}});
        }
    }
    return {{"parameter", variation.parameter},
            {"value", variation.value},
            {"symbol", variation.symbol},
            {"factor", variation.factor},
            {"case", variation.case_name.empty() ? "all" : variation.case_name},
            {"failure", variation.failure},
            {"changed", changed},
            {"rows", judged}};
}

/// At most `width` characters of ASCII text.
std::string shortened(const std::string& text, std::size_t width) {
    return text.size() <= width ? text : text.substr(0, width - 3) + "...";
}

}  // namespace

std::vector<BoomAlone> booms_alone(const plant::StructureParameters& structure) {
    const plant::PinnedBoom boom = plant::pinned_boom(structure);
    const double pinned_N_m = boom.condensed_to_deflections_N_m.row(0).sum();  // exact for a beam under such forces
    return {{"three links, deflections eliminated and ends clamped (3.1.1-12)", boom.links_stiffness_N_m.row(0).sum(),
             boom.links_Hz[0], boom.links_Hz[1]},
            {"three links, rotations eliminated and ends pinned", pinned_N_m, boom.condensed_links_Hz[0],
             boom.condensed_links_Hz[1]},
            {"beam", pinned_N_m, boom.beam_Hz[0], boom.beam_Hz[1]}};
}

std::string table_of(const std::vector<Row>& rows) {
    std::string text;
    const auto line = [&](const std::string& id, const std::string& claim, const std::string& thesis,
                          const std::string& here, std::string_view verdict) {
        fmt::format_to(std::back_inserter(text), "{:<8} {:<60} {:<18} {:<46} {}\n", id, shortened(claim, 60),
                       shortened(thesis, 18), shortened(here, 46), verdict);
    };
    line("row", "claim", "thesis", "here", "verdict");
    for (const Row& row : rows) {
        line(row.id, row.claim, row.thesis, row.here, name_of(row.verdict));
    }
    fmt::format_to(std::back_inserter(text), "\n{} rows", rows.size());
    for (const Verdict verdict : all_verdicts) {
        fmt::format_to(std::back_inserter(text), ", {} {}", count(rows, verdict), name_of(verdict));
    }
    return text + "\n";
}

std::string json_of(const std::vector<Row>& rows, const Appendix& appendix, const ThesisRuns& runs) {
    nlohmann::ordered_json document{{"version", STEADYBOOM_VERSION},
                                    {"counts", counts_json(rows)},
                                    {"rows", nlohmann::ordered_json::array()},
                                    {"runs", nlohmann::ordered_json::array()}};
    for (const Row& row : rows) {
        nlohmann::ordered_json measures = nlohmann::ordered_json::array();
        for (const Measure& measure : row.measures) {
            measures.push_back({{"name", measure.name},
                                {"unit", measure.unit},
                                {"value", number_or_null(measure.value)},
                                {"holds", range_json(measure.holds)},
                                {"holds_in_kind", range_json(measure.in_kind)},
                                {"verdict", name_of(measure.verdict())}});
        }
        document["rows"].push_back({{"id", row.id},
                                    {"section", row.section},
                                    {"figures", row.figures},
                                    {"claim", row.claim},
                                    {"thesis", row.thesis},
                                    {"here", row.here},
                                    {"measures", measures},
                                    {"verdict", name_of(row.verdict)},
                                    {"reason", row.reason},
                                    {"would_hold_if", row.would_hold_if}});
    }
    for (const ThesisRun* run : runs.all()) {
        document["runs"].push_back(run_json(*run));
    }
    document["booms"] = nlohmann::ordered_json::array();
    for (const BoomAlone& row : appendix.booms) {
        document["booms"].push_back({{"boom", row.boom},
                                     {"stiffness_N_m", row.stiffness_N_m},
                                     {"first_frequency_Hz", row.first_Hz},
                                     {"second_frequency_Hz", row.second_Hz}});
    }
    document["conditioning"] = nlohmann::ordered_json::array();
    for (const Conditioning& row : appendix.conditioning) {
        document["conditioning"].push_back({{"run", row.run},
                                            {"condition_at_rest", row.condition_at_rest},
                                            {"worst_condition", row.worst_condition},
                                            {"scaled_condition_at_rest", row.scaled_condition_at_rest},
                                            {"worst_scaled_condition", row.worst_scaled_condition},
                                            {"rows", row.rows},
                                            {"rows_without_dominant_diagonal", row.rows_without_dominant_diagonal},
                                            {"solver_difference", row.solver_difference}});
    }
    document["misprints"] = nlohmann::ordered_json::array();
    for (const MisprintRow& row : appendix.misprints) {
        nlohmann::ordered_json numbers = nlohmann::ordered_json::object();
        for (const MisprintNumber& number : row.numbers) {
            numbers[number.key] = number_or_null(number.value);
        }
        document["misprints"].push_back({{"id", row.id},
                                         {"where", row.where},
                                         {"printed", row.printed},
                                         {"used", row.used},
                                         {"calculation", row.calculation},
                                         {"consequence", row.consequence},
                                         {"numbers", numbers}});
    }
    document["sensitivity"] = {{"ranges", nlohmann::ordered_json::array()},
                               {"variations", nlohmann::ordered_json::array()}};
    for (const SensitivityRange& range : appendix.sensitivity.ranges) {
        document["sensitivity"]["ranges"].push_back(
            {{"parameter", range.parameter}, {"range", range.range}, {"reason", range.reason}});
    }
    for (const Variation& variation : appendix.sensitivity.variations) {
        document["sensitivity"]["variations"].push_back(variation_json(rows, variation));
    }
    return document.dump(2) + "\n";
}

}  // namespace steadyboom::hil::reproduction
