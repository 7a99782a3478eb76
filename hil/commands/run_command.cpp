#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <ranges>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/commands/commands.hpp"
#include "hil/commands/option_checks.hpp"
#include "hil/figure_table.hpp"
#include "hil/lockstep_run.hpp"
#include "hil/process_run.hpp"
#include "hil/report.hpp"
#include "hil/run_folder.hpp"
#include "hil/scratch_folder.hpp"
#include "runtime/network_file.hpp"

namespace steadyboom::hil {

namespace {

namespace fs = std::filesystem;

struct RunCommandOptions {
    std::string crane_case;
    std::string law = "joint-deflection";
    std::optional<BoomKind> boom;
    std::string bus = "loopback";
    std::string network;  ///< network file; empty: the virtual crane's own devices
    double rate_Hz = 200.0;
    std::optional<double> duration_s;
    std::uint32_t seed = 1;
    std::vector<std::string> mismatches;
    std::string out;
    bool json = false;
};

/// The laws to run. In lockstep an uncontrolled run comes first for the ratios; in real time only what was asked for.
std::vector<controllers::LawKind> laws_to_run(const RunCommandOptions& options) {
    if (options.law == "all") {
        return {std::begin(controllers::all_laws), std::end(controllers::all_laws)};
    }
    const controllers::LawKind law = *controllers::law_named(options.law);
    if (options.bus == "loopback" && law != controllers::LawKind::none) {
        return {controllers::LawKind::none, law};
    }
    return {law};
}

RunResult run_one(const RunOptions& run, const RunCommandOptions& options, const fs::path& folder) {
    if (options.bus == "loopback") {
        return run_in_lockstep(run);
    }
    const auto progress = [](const std::string& line) { std::cerr << "  " << line << '\n'; };
    if (options.out.empty()) {
        const ScratchFolder temporary(fs::temp_directory_path());
        return run_on_interface(run, options.bus, temporary.path(), progress);
    }
    fs::create_directories(folder);
    return run_on_interface(run, options.bus, folder, progress);
}

void write_out(const RunCommandOptions& options, std::span<const RunResult> runs, bool several) {
    const fs::path out = options.out;
    const RunResult* uncontrolled = uncontrolled_run(runs);
    for (const RunResult& run : runs) {
        const bool asked_for = several || &run == &runs.back();
        if (asked_for) {
            std::cerr << fmt::format("writing {}\n",
                                     (several ? out / controllers::name_of(run.options.law) : out).string());
            write_run_folder(several ? out / controllers::name_of(run.options.law) : out, run,
                             uncontrolled != nullptr ? &uncontrolled->figures : nullptr);
        }
    }
    write_report(out / "report.html", runs);
    std::cerr << fmt::format("wrote {}\n", (out / "report.html").string());
}

int run_case(const RunCommandOptions& options) {
    RunOptions run{.crane_case = load_case(options.crane_case),
                   .rate_Hz = options.rate_Hz,
                   .seed = options.seed,
                   .mismatches = options.mismatches};
    run.crane_case.boom = options.boom.value_or(run.crane_case.boom);
    run.duration_s = options.duration_s.value_or(run.crane_case.manoeuvre.duration_s);
    if (!options.network.empty()) {
        run.network = runtime::load_network_file(options.network, control_config(run).network);
    }
    const bool several = options.law == "all";

    std::vector<RunResult> runs;
    const auto laws = laws_to_run(options);
    for (const controllers::LawKind law : laws) {
        run.law = law;
        std::cerr << fmt::format("[{}/{}] {} with law {} on {}\n", runs.size() + 1, laws.size(), run.crane_case.name,
                                 controllers::name_of(law), options.bus);
        const auto begin = std::chrono::steady_clock::now();
        runs.push_back(
            run_one(run, options, several ? fs::path(options.out) / controllers::name_of(law) : fs::path(options.out)));
        const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
        std::cerr << fmt::format("  {:.1f} s of crane in {:.2f} s\n", RunResult::standing_s + run.duration_s,
                                 wall.count());
    }
    if (!options.out.empty()) {
        write_out(options, runs, several);
    }

    const RunResult* uncontrolled = uncontrolled_run(runs);
    const RunFigures* reference = uncontrolled != nullptr ? &uncontrolled->figures : nullptr;
    if (!options.json) {
        std::cout << figure_table(runs);
    } else if (!several) {
        std::cout << figures_json(runs.back(), reference) << '\n';
    } else {
        nlohmann::ordered_json json;
        json["case"] = run.crane_case.name;
        json["runs"] = nlohmann::ordered_json::array();
        for (const RunResult& result : runs) {
            json["runs"].push_back(nlohmann::ordered_json::parse(figures_json(result, reference)));
        }
        std::cout << json.dump(2) << '\n';
    }

    bool all_engaged = true;
    for (const RunResult& result : runs) {
        if (!result.stayed_engaged) {
            all_engaged = false;
            std::cerr << fmt::format("steadyboom: law {} was not in command throughout: {}\n",
                                     controllers::name_of(result.options.law), result.trouble);
        }
    }
    return all_engaged ? exit_done : exit_failed;
}

}  // namespace

void add_run_command(CLI::App& app, Action& selected) {
    const auto options = std::make_shared<RunCommandOptions>();
    CLI::App* command = app.add_subcommand(
        "run", "The product's way: virtual crane, CAN frames, observer, law, limiter, CAN frames, virtual valve");
    command->add_option("CASE", options->crane_case, "case-a, case-b, case-c or the path of a case file")->required();
    command->add_option("--law", options->law, law_names() + " or all")->check(law_name(true))->capture_default_str();
    add_boom_option(*command, options->boom);
    command
        ->add_option("--bus", options->bus,
                     "loopback: in-process bus in lockstep, faster than real time; or a SocketCAN interface: two "
                     "processes in real time")
        ->capture_default_str();
    command->add_option("--network", options->network,
                        "Network file for both ends of the bus; without it the virtual crane's own devices");
    command->add_option("--rate-hz", options->rate_Hz, "Control ticks per second")
        ->check(between(50.0, 2000.0, "Hz"))
        ->capture_default_str();
    command->add_option("--duration-s", options->duration_s, "Time after the brake event; the case's own if not given")
        ->check(positive_up_to(3600.0, "s"));
    command->add_option("--seed", options->seed, "Of the sensor noise")
        ->check(between(0.0, 2'147'483'647.0, ""))
        ->capture_default_str();
    command
        ->add_option("--mismatch", options->mismatches,
                     "KEY=FACTOR, such as soil.shear_modulus_Pa=1.2: falsify the controller's copy of the crane")
        ->take_all();
    command->add_option("--out", options->out, "Folder for ticks.csv, can.log, figures.json and report.html");
    command->add_flag("--json", options->json, "Print the figures as JSON, SI units");
    command->callback([options, &selected] { selected = [options] { return run_case(*options); }; });
}

}  // namespace steadyboom::hil
