#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/case_file.hpp"
#include "hil/commands/commands.hpp"
#include "hil/commands/option_checks.hpp"
#include "hil/state_names.hpp"
#include "hil/true_crane.hpp"
#include "plant/linear_modes.hpp"

namespace steadyboom::hil {

namespace {

constexpr double deg_per_rad = 180.0 / std::numbers::pi;

/// A linear mode and the name of its dominant coordinate.
struct NamedMode {
    plant::LinearMode mode;
    const char* dominant;
};

void print_json(const Case& crane_case, const plant::Equilibrium& equilibrium, const plant::CraneOutputs& outputs,
                const std::vector<NamedMode>& modes) {
    nlohmann::ordered_json json;
    json["case"] = crane_case.name;
    json["boom"] = name_of(crane_case.boom);
    for (std::size_t i = 0; i < plant::coordinate_count; ++i) {
        json[std::string(state_names[i])] = equilibrium.state[static_cast<int>(i)];
    }
    json["phi6_deg"] = equilibrium.state[plant::phi6_rad] * deg_per_rad;
    json["chord_m"] = outputs.chord_m;
    json["pendent_tension_N"] = equilibrium.pendent_tension_N;
    json["load_line_tension_N"] = equilibrium.load_line_tension_N;
    json["load_pressure_Pa"] = outputs.load_pressure_Pa;
    json["contact_fraction"] = outputs.contact_fraction;
    json["residual"] = equilibrium.residual;
    json["newton_steps"] = equilibrium.iterations;
    json["modes"] = nlohmann::ordered_json::array();
    for (const auto& [mode, dominant] : modes) {
        json["modes"].push_back({{"frequency_Hz", mode.frequency_Hz},
                                 {"damping_ratio", mode.damping_ratio},
                                 {"dominant_coordinate", dominant}});
    }
    std::cout << json.dump(2) << '\n';
}

void print_text(const Case& crane_case, const plant::Equilibrium& equilibrium, const plant::CraneOutputs& outputs,
                const std::vector<NamedMode>& modes) {
    const plant::CraneState& p = equilibrium.state;
    std::cout << fmt::format(
        "{} with boom {}: equilibrium after {} Newton steps, residual {:.1e} of the weight\n\n"
        "  R1    {:10.4f} mm     phi2  {:10.5f} deg\n"
        "  R9    {:10.4f} m      phi9  {:10.5f} deg\n"
        "  q1    {:10.4f} mm     q2    {:10.4f} mm\n"
        "  phi6  {:10.4f} deg    chord {:10.4f} m\n"
        "  pendent {:.1f} kN (load pressure {:.2f} MPa), load line {:.1f} kN, track bearing {:.0f} %\n\n"
        "Linear modes, valve shut\n  {:>9}  {:>13}  {}\n",
        crane_case.name, name_of(crane_case.boom), equilibrium.iterations, equilibrium.residual, 1e3 * p[plant::R1_m],
        deg_per_rad * p[plant::phi2_rad], p[plant::R9_m], deg_per_rad * p[plant::phi9_rad], 1e3 * p[plant::q1_m],
        1e3 * p[plant::q2_m], deg_per_rad * p[plant::phi6_rad], outputs.chord_m, 1e-3 * equilibrium.pendent_tension_N,
        1e-6 * outputs.load_pressure_Pa, 1e-3 * equilibrium.load_line_tension_N, 100.0 * outputs.contact_fraction, "Hz",
        "damping ratio", "dominant");
    for (const auto& [mode, dominant] : modes) {
        std::cout << fmt::format("  {:9.3f}  {:13.4f}  {}\n", mode.frequency_Hz, mode.damping_ratio, dominant);
    }
}

int show_equilibrium(const std::string& name_or_path, std::optional<BoomKind> boom, bool json) {
    Case crane_case = load_case(name_or_path);
    crane_case.boom = boom.value_or(crane_case.boom);
    with_boom(crane_case.boom, [&]<class Boom>(std::type_identity<Boom>) {
        const TrueCrane<Boom> crane(crane_case.crane);
        std::vector<NamedMode> modes;
        for (const plant::LinearMode& mode : linear_modes(crane.dynamics(), crane.equilibrium().state)) {
            modes.push_back({mode, plant::coordinate_name<Boom>(mode.dominant)});
        }
        (json ? print_json : print_text)(crane_case, crane.thesis_equilibrium(),
                                         crane.dynamics().outputs(crane.equilibrium().state), modes);
    });
    return exit_done;
}

}  // namespace

void add_equilibrium_command(CLI::App& app, Action& selected) {
    struct Options {
        std::string crane_case;
        std::optional<BoomKind> boom;
        bool json = false;
    };
    const auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("equilibrium", "The static equilibrium and the linear modes about it");
    command->add_option("CASE", options->crane_case, "case-a, case-b, case-c or the path of a case file")->required();
    add_boom_option(*command, options->boom);
    command->add_flag("--json", options->json, "Print JSON, SI units");
    command->callback([options, &selected] {
        selected = [options] { return show_equilibrium(options->crane_case, options->boom, options->json); };
    });
}

}  // namespace steadyboom::hil
