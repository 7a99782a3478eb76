#include "hil/reproduction/reproduction_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace steadyboom::hil::reproduction {

namespace {

constexpr std::array all_verdicts{Verdict::holds, Verdict::holds_in_kind, Verdict::does_not_hold,
                                  Verdict::not_examined};

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

/// At most `width` characters of ASCII text.
std::string shortened(const std::string& text, std::size_t width) {
    return text.size() <= width ? text : text.substr(0, width - 3) + "...";
}

}  // namespace

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

std::string json_of(const std::vector<Row>& rows, const Appendix& appendix) {
    nlohmann::ordered_json document{{"counts", counts_json(rows)}, {"rows", nlohmann::ordered_json::array()}};
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
    document["sensitivity"] = {{"runs", nlohmann::ordered_json::array()},
                               {"verdicts", nlohmann::ordered_json::array()}};
    for (const SensitivityRow& row : appendix.sensitivity.rows) {
        nlohmann::ordered_json figures = nlohmann::ordered_json::object();
        for (const FigureRow& figure : figure_rows) {
            figures[std::string(figure.key)] = number_or_null(row.figures.*figure.value);
        }
        document["sensitivity"]["runs"].push_back({{"parameter", row.parameter},
                                                   {"value", row.value},
                                                   {"factor", row.factor},
                                                   {"case", row.case_name},
                                                   {"law", controllers::name_of(row.law)},
                                                   {"failure", row.failure},
                                                   {"figures", figures}});
    }
    for (const SensitivityVerdict& verdict : appendix.sensitivity.verdicts) {
        document["sensitivity"]["verdicts"].push_back({{"claim", verdict.claim},
                                                       {"case", verdict.case_name},
                                                       {"nominal", verdict.nominal},
                                                       {"changed", verdict.changed}});
    }
    return document.dump(2) + "\n";
}

}  // namespace steadyboom::hil::reproduction
