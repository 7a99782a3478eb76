// steadyboom: the bench's command.
#include <exception>
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "hil/commands/commands.hpp"
#include "runtime/toml_reader.hpp"

int main(int argc, char** argv) {
    using namespace steadyboom;
    CLI::App app(
        "Steadyboom's bench: simulates a crawler crane and runs its controller against it.\n"
        "Exit codes: 0 done, 1 failed, 2 bad input.",
        "steadyboom");
    app.set_version_flag("--version", "steadyboom " STEADYBOOM_VERSION);
    app.require_subcommand(1);
    hil::Action selected;
    hil::add_simulate_command(app, selected);
    hil::add_equilibrium_command(app, selected);
    hil::add_run_command(app, selected);
    hil::add_reproduce_command(app, selected);
    hil::add_dbc_command(app, selected);
    hil::add_can_table_command(app, selected);
    hil::add_bus_monitor_command(app, selected);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? hil::exit_done : hil::exit_bad_input;
    }
    try {
        return selected();
    } catch (const runtime::ConfigError& error) {
        std::cerr << "steadyboom: " << error.what() << '\n';
        return hil::exit_bad_input;
    } catch (const std::invalid_argument& error) {
        std::cerr << "steadyboom: " << error.what() << '\n';
        return hil::exit_bad_input;
    } catch (const std::exception& error) {
        std::cerr << "steadyboom: " << error.what() << '\n';
        return hil::exit_failed;
    }
}
