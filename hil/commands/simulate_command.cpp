#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "hil/commands/commands.hpp"
#include "hil/commands/option_checks.hpp"
#include "hil/simulation.hpp"
#include "hil/state_names.hpp"
#include "hil/whole_file.hpp"

namespace steadyboom::hil {

namespace {

struct SimulateOptions {
    std::string crane_case;
    std::string law = "none";
    std::optional<BoomKind> boom;
    std::optional<double> duration_s;
    std::optional<double> step_s;
    double tolerance = SimulationOptions{}.tolerance;
    double output_period_s = 0.005;
    std::string csv;
};

std::string csv_header() {
    std::string header = "t_s";
    for (const std::string_view name : state_names) {
        header += fmt::format(",{}", name);
    }
    return header + ",valve_m,pendent_tension_N,load_line_tension_N,chord_m,contact_fraction,hydraulic_power_W\n";
}

void append_row(std::string& csv, const TruthSample& sample) {
    fmt::format_to(std::back_inserter(csv), "{}", sample.t_s);
    for (const double value : sample.state) {
        fmt::format_to(std::back_inserter(csv), ",{}", value);
    }
    fmt::format_to(std::back_inserter(csv), ",{},{},{},{},{},{}\n", sample.spool_m, sample.pendent_tension_N,
                   sample.load_line_tension_N, sample.chord_m, sample.contact_fraction, sample.hydraulic_power_W);
}

int simulate_case(const SimulateOptions& options) {
    SimulationOptions simulation{.crane_case = load_case(options.crane_case),
                                 .law = *controllers::law_named(options.law),
                                 .step_s = options.step_s,
                                 .tolerance = options.tolerance,
                                 .output_period_s = options.output_period_s};
    simulation.crane_case.boom = options.boom.value_or(simulation.crane_case.boom);
    simulation.duration_s = options.duration_s.value_or(simulation.crane_case.manoeuvre.duration_s);
    std::string csv = csv_header();
    const RunFigures figures = simulate(simulation, [&](const TruthSample& sample) { append_row(csv, sample); });
    if (options.csv == "-") {
        std::cout << csv;
    } else {
        write_whole_file(options.csv, csv);
    }
    std::cerr << fmt::format(
        "{} with law {}: residual energy {:.0f} J, peak power {:.1f} kW, peak R1 {:.2f} mm at "
        "{:.2f} s{}\n",
        simulation.crane_case.name, options.law, figures.residual_energy_J, 1e-3 * figures.peak_power_W,
        1e3 * figures.peak_R1_m, figures.peak_R1_time_s, options.csv == "-" ? "" : "; wrote " + options.csv);
    return exit_done;
}

}  // namespace

void add_simulate_command(CLI::App& app, Action& selected) {
    const auto options = std::make_shared<SimulateOptions>();
    CLI::App* command = app.add_subcommand(
        "simulate", "The thesis's own way: the law is fed the true state inside the integration, no bus");
    command->add_option("CASE", options->crane_case, "case-a, case-b, case-c or the path of a case file")->required();
    command->add_option("--law", options->law, law_names())->check(law_name())->capture_default_str();
    add_boom_option(*command, options->boom);
    command->add_option("--duration-s", options->duration_s, "Simulated time; the case's own if not given")
        ->check(positive_up_to(86'400.0, "s"));
    CLI::Option* step =
        command
            ->add_option("--step-s", options->step_s,
                         "Runge-Kutta of order 4 with this fixed step, instead of order 5(4) with steps "
                         "as the error asks")
            ->check(positive_up_to(0.1, "s"));
    command
        ->add_option("--tolerance", options->tolerance,
                     "Error allowed in a step of order 5(4), as a share of each entry of the state")
        ->check(between(1e-13, 1e-2, "of the entry"))
        ->capture_default_str()
        ->excludes(step);
    command->add_option("--output-period-s", options->output_period_s, "Time between two lines of the file")
        ->check(between(1e-6, 3600.0, "s"))
        ->capture_default_str();
    command->add_option("--csv", options->csv, "File to write, - for standard output")->required();
    command->callback([options, &selected] { selected = [options] { return simulate_case(*options); }; });
}

}  // namespace steadyboom::hil
