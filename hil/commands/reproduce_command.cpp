#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "hil/commands/commands.hpp"
#include "hil/plot.hpp"
#include "hil/reproduction/claim.hpp"
#include "hil/reproduction/reproduction_report.hpp"
#include "hil/reproduction/thesis_runs.hpp"
#include "hil/whole_file.hpp"

namespace steadyboom::hil {

namespace {

struct ReproduceOptions {
    std::string out;
    bool json = false;
    bool quick = false;
};

void make_folder(const std::filesystem::path& folder) {
    std::error_code trouble;
    std::filesystem::create_directories(folder, trouble);
    if (!trouble && access(folder.c_str(), W_OK) != 0) {
        trouble = {errno, std::generic_category()};
    }
    if (trouble) {
        throw std::runtime_error(fmt::format("{}: cannot be written: {}", folder.string(), trouble.message()));
    }
}

int reproduce(const ReproduceOptions& options) {
    using namespace reproduction;
    const std::filesystem::path folder(options.out);
    if (!options.out.empty()) {  // what cannot be written is said before the work, not after it
        make_folder(folder);
        (void)draw_plots({});
    }
    const ThesisRuns runs = run_thesis({}, [](std::string_view name) { std::cerr << fmt::format("{} ...\n", name); });
    const std::vector<Row> rows = judge(runs);
    Appendix appendix;
    if (options.json || !options.out.empty()) {
        std::cerr << "booms and conditioning ...\n";
        appendix.booms = booms_alone(runs.a.options().crane_case.crane.structure);
        for (const ThesisRun* run : {&runs.a, &runs.b, &runs.c, &runs.a_beam}) {
            appendix.conditioning.push_back(conditioning_of(*run));
        }
        if (!options.quick) {
            std::cerr << "misprints ...\n";
            appendix.misprints = misprint_rows();
            appendix.sensitivity = run_sensitivity(runs, [](int done, int all) {
                std::cerr << fmt::format("sensitivity: {} of {} variations\n", done, all);
            });
        }
    }
    if (!options.out.empty()) {
        std::cerr << "report ...\n";
        write_whole_file(folder / "reproduction.html", page_of(rows, appendix, runs));
        write_whole_file(folder / "reproduction.json", json_of(rows, appendix, runs));
        std::cerr << fmt::format("wrote {}\n", (folder / "reproduction.html").string());
    }
    std::cout << (options.json ? json_of(rows, appendix, runs) : table_of(rows)) << std::flush;
    return std::cout ? exit_done : exit_failed;
}

}  // namespace

void add_reproduce_command(CLI::App& app, Action& selected) {
    const auto options = std::make_shared<ReproduceOptions>();
    CLI::App* command = app.add_subcommand(
        "reproduce", "Asks this model about every claim of the thesis's chapters 5, 7 and 8 and judges the answer");
    command->add_option("--out", options->out, "Folder for reproduction.html and reproduction.json");
    command->add_flag("--json", options->json, "Print every number as JSON instead of the table");
    command->add_flag("--quick", options->quick,
                      "Claims, figures and conditioning alone: no sensitivity, no misprints");
    command->callback([options, &selected] { selected = [options] { return reproduce(*options); }; });
}

}  // namespace steadyboom::hil
