#include <algorithm>
#include <fstream>
#include <iostream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "hil/benchmark/quiet_cpu.hpp"
#include "hil/benchmark/row.hpp"

namespace {

using namespace steadyboom::hil::benchmark;

struct Result {
    Row row;
    Measurement measurement;
    Verdict verdict;
};

struct Machine {
    std::string cpu;
    bool quiet;
    int rounds;
};

std::string cpu_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("model name")) {
            return line.substr(std::min(line.size(), line.find(':') + 2));
        }
    }
    return "unknown CPU";
}

bool has_value(const Result& result) {
    return result.verdict != Verdict::absent && result.verdict != Verdict::disagree;
}

/// Small numbers as fractions with enough digits, large ones without any.
std::string number(double value) {
    return value < 0.1 ? fmt::format("{:.3g}", value) : fmt::format("{:.4g}", value);
}

std::string limit(const Row& row, double value) {
    return fmt::format("{} {}", row.bound.at_most ? "<=" : ">=", number(value));
}

void print_table(const std::vector<Result>& results, const Machine& machine) {
    fmt::print("{}; {} rounds; /dev/cpu_dma_latency {}\n\n", machine.cpu, machine.rounds,
               machine.quiet ? "held at 0" : "not held");
    fmt::print("| what | against | must | aim | measured | verdict |\n|---|---|---|---|---|---|\n");
    for (const Result& result : results) {
        fmt::print("| {} | {} | {} | {} | {} | {} |\n", result.row.subject, result.row.against,
                   limit(result.row, result.row.bound.must), limit(result.row, result.row.bound.aim),
                   has_value(result) ? number(result.measurement.value) : "-", word(result.verdict));
    }
    fmt::print("\n");
    for (const Result& result : results) {
        std::string line;
        for (const Figure& figure : result.measurement.figures) {
            line += fmt::format("{}{} {}{}{}", line.empty() ? "" : ", ", figure.name, number(figure.value),
                                figure.unit.empty() ? "" : " ", figure.unit);
        }
        if (!result.measurement.remark.empty()) {
            line += (line.empty() ? "" : "; ") + result.measurement.remark;
        }
        fmt::print("- {}: {}\n", result.row.name, line);
    }
}

void print_json(const std::vector<Result>& results, const Machine& machine) {
    nlohmann::json rows = nlohmann::json::array();
    for (const Result& result : results) {
        nlohmann::json figures = nlohmann::json::array();
        for (const Figure& figure : result.measurement.figures) {
            figures.push_back({{"name", figure.name}, {"value", figure.value}, {"unit", figure.unit}});
        }
        rows.push_back({{"name", result.row.name},
                        {"what", result.row.subject},
                        {"against", result.row.against},
                        {"bound", result.row.bound.at_most ? "at most" : "at least"},
                        {"must", result.row.bound.must},
                        {"aim", result.row.bound.aim},
                        {"measured", has_value(result) ? nlohmann::json(result.measurement.value) : nlohmann::json()},
                        {"verdict", word(result.verdict)},
                        {"remark", result.measurement.remark},
                        {"figures", figures}});
    }
    const nlohmann::json document{{"version", STEADYBOOM_VERSION},
                                  {"cpu", machine.cpu},
                                  {"cpu_dma_latency_held", machine.quiet},
                                  {"rounds", machine.rounds},
                                  {"rows", rows}};
    std::cout << document.dump(2) << '\n';
}

std::vector<Row> all_rows() {
    std::vector<Row> rows;
    for (const std::vector<Row>& part :
         {dynamics_rows(), integration_rows(), lockstep_rows(), network_rows(), telemetry_rows(), bus_rows()}) {
        rows.insert(rows.end(), part.begin(), part.end());
    }
    return rows;
}

/// Those of `rows` that are named, in the table's order; all when none is. Throws CLI::ValidationError.
std::vector<Row> selected(std::vector<Row> rows, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        if (std::ranges::none_of(rows, [&](const Row& row) { return row.name == name; })) {
            std::string known;
            for (const Row& row : rows) {
                known += (known.empty() ? "" : ", ") + row.name;
            }
            throw CLI::ValidationError("--rows", fmt::format("no row \"{}\"; there are {}", name, known));
        }
    }
    if (!names.empty()) {
        std::erase_if(rows, [&](const Row& row) { return std::ranges::find(names, row.name) == names.end(); });
    }
    return rows;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{
        "Times Steadyboom against other ways of doing the same and prints ratios.\n"
        "Exit code: 0, whatever the times; 1 when a peer computes something else than we do; 2 on bad use.",
        "steadyboom-benchmark"};
    app.set_version_flag("--version", std::string("steadyboom-benchmark ") + STEADYBOOM_VERSION);
    int rounds = 31;
    std::vector<std::string> names;
    bool json = false;
    bool check = false;
    app.add_option("--rounds", rounds, "Rounds per row; below 31 the medians are not worth quoting")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    app.add_option("--rows", names, "Only these rows, by name")->delimiter(',')->type_name("NAME,...");
    app.add_flag("--json", json, "Print JSON instead of a table");
    app.add_flag("--check", check, "Exit with 1 also when a must is missed (absent peers do not count)");
    std::vector<Row> rows;
    try {
        app.parse(argc, argv);
        rows = selected(all_rows(), names);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        fmt::print(stderr, "steadyboom-benchmark: {}\n", error.what());
        return 2;
    }

    try {
        const QuietCpu quiet;
        const Machine machine{cpu_name(), quiet.held(), rounds};
        std::vector<Result> results;
        for (const Row& row : rows) {
            fmt::print(stderr, "steadyboom-benchmark: {} ...\n", row.name);
            Measurement measurement = row.measure(rounds);
            const Verdict verdict = judge(row.bound, measurement);
            results.push_back({row, std::move(measurement), verdict});
        }
        if (json) {
            print_json(results, machine);
        } else {
            print_table(results, machine);
        }
        const bool failed = std::ranges::any_of(results, [&](const Result& result) {
            return result.verdict == Verdict::disagree || (check && result.verdict == Verdict::missed);
        });
        return failed ? 1 : 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "steadyboom-benchmark: {}\n", error.what());
        return 1;
    }
}
