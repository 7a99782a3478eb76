#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "hil/commands/commands.hpp"
#include "hil/reproduction/claim.hpp"
#include "hil/reproduction/reproduction_report.hpp"
#include "hil/reproduction/thesis_runs.hpp"
#include "hil/whole_file.hpp"

namespace steadyboom::hil {

namespace {

struct ReproduceOptions {
    std::string out;
    bool json = false;
};

int reproduce(const ReproduceOptions& options) {
    using namespace reproduction;
    const ThesisRuns runs = run_thesis({}, [](std::string_view name) { std::cerr << fmt::format("{} ...\n", name); });
    const std::vector<Row> rows = judge(runs);
    Appendix appendix;
    if (options.json || !options.out.empty()) {
        std::cerr << "misprints ...\nsensitivity ...\n";
        appendix.misprints = misprint_rows();
        appendix.sensitivity = run_sensitivity([](int, int) {});
    }
    if (!options.out.empty()) {
        const std::filesystem::path folder(options.out);
        std::cerr << "report ...\n";
        write_whole_file(folder / "reproduction.html", page_of(rows, appendix, runs));
        write_whole_file(folder / "reproduction.json", json_of(rows, appendix));
        std::cerr << fmt::format("wrote {}\n", (folder / "reproduction.html").string());
    }
    std::cout << (options.json ? json_of(rows, appendix) : table_of(rows)) << std::flush;
    return std::cout ? exit_done : exit_failed;
}

}  // namespace

void add_reproduce_command(CLI::App& app, Action& selected) {
    const auto options = std::make_shared<ReproduceOptions>();
    CLI::App* command = app.add_subcommand(
        "reproduce", "Asks this model about every claim of the thesis's chapters 5, 7 and 8 and judges the answer");
    command->add_option("--out", options->out, "Folder for reproduction.html and reproduction.json");
    command->add_flag("--json", options->json, "Print every number as JSON instead of the table");
    command->callback([options, &selected] { selected = [options] { return reproduce(*options); }; });
}

}  // namespace steadyboom::hil
