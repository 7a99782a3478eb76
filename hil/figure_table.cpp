#include "hil/figure_table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace steadyboom::hil {

namespace {

std::string significant(double value, int most_decimals) {
    const double magnitude = std::abs(value);
    int decimals = most_decimals;
    for (double bound = 1.0; decimals > 0 && magnitude >= bound; bound *= 10.0) {
        --decimals;
    }
    return fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

std::string figure_text(const RunFigures& figures, const FigureRow& row) {
    const double value = row.scale * figures.*row.value;
    return value == 0.0 ? "0" : significant(value, 3);
}

std::string ratio_text(double ratio) {
    return significant(ratio, ratio < 1.0 ? 2 : 3);
}

const RunResult* uncontrolled_run(std::span<const RunResult> runs) noexcept {
    const auto found =
        std::ranges::find(runs, controllers::LawKind::none, [](const RunResult& run) { return run.options.law; });
    return found == runs.end() ? nullptr : &*found;
}

std::optional<double> ratio_to(const RunFigures& uncontrolled, const RunFigures& figures,
                               const FigureRow& row) noexcept {
    const double divisor = uncontrolled.*row.value;
    if (!row.compared || divisor == 0.0) {
        return std::nullopt;
    }
    return figures.*row.value / divisor;
}

std::vector<std::string> remarks(const RunResult& run) {
    std::vector<std::string> found;
    const std::string_view law = name_of(run.options.law);
    if (!run.stayed_engaged) {
        found.push_back(fmt::format("{}: the controller was not in command throughout: {}", law,
                                    run.trouble.empty() ? "no reason given" : run.trouble));
    }
    const double reported_Pa = run.options.crane_case.crane.actuator.load_pressure_report_Pa;
    if (run.figures.peak_load_pressure_Pa > reported_Pa) {
        found.push_back(fmt::format("{}: the load pressure reached {:.1f} MPa, above {:.1f} MPa", law,
                                    1e-6 * run.figures.peak_load_pressure_Pa, 1e-6 * reported_Pa));
    }
    return found;
}

std::string figure_table(std::span<const RunResult> runs) {
    constexpr int value_width = 10;
    constexpr int ratio_width = 9;
    std::string table;
    const auto put = [&]<typename... Values>(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(table), format, std::forward<Values>(values)...);
    };
    const auto end_line = [&] {
        table.erase(table.find_last_not_of(' ') + 1);
        table += '\n';
    };
    put("{:<21}{:<5}", "", "");
    for (const RunResult& run : runs) {
        put("{:>{}}", name_of(run.options.law), value_width + ratio_width);
    }
    end_line();
    const RunResult* const uncontrolled = uncontrolled_run(runs);
    for (const FigureRow& row : figure_rows) {
        put("{:<21}{:<5}", row.label, row.unit);
        for (const RunResult& run : runs) {
            put("{:>{}}", figure_text(run.figures, row), value_width);
            const auto ratio =
                uncontrolled != nullptr ? ratio_to(uncontrolled->figures, run.figures, row) : std::nullopt;
            put("{:>{}}", ratio ? fmt::format("({})", ratio_text(*ratio)) : "", ratio_width);
        }
        end_line();
    }
    for (const RunResult& run : runs) {
        for (const std::string& remark : remarks(run)) {
            put("{}\n", remark);
        }
    }
    return table;
}

std::string figures_json(const RunResult& run, const RunFigures* uncontrolled) {
    const RunOptions& options = run.options;
    nlohmann::ordered_json json{{"law", name_of(options.law)},
                                {"case", options.crane_case.name},
                                {"boom", name_of(options.crane_case.boom)},
                                {"bus", run.bus},
                                {"rate_Hz", options.rate_Hz},
                                {"duration_s", options.duration_s},
                                {"seed", options.seed}};
    for (const FigureRow& row : figure_rows) {
        json[std::string(row.key)] = run.figures.*row.value;
    }
    json["stayed_engaged"] = run.stayed_engaged;
    json["trouble"] = run.trouble;
    if (uncontrolled != nullptr) {
        nlohmann::ordered_json& ratios = json["ratio_to_uncontrolled"];
        for (const FigureRow& row : figure_rows) {
            const auto ratio = ratio_to(*uncontrolled, run.figures, row);
            ratios[std::string(row.key)] = ratio ? nlohmann::ordered_json(*ratio) : nlohmann::ordered_json();
        }
    }
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

}  // namespace steadyboom::hil
