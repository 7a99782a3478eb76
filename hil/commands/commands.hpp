#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace steadyboom::hil {

/// Exit codes of every program.
inline constexpr int exit_done = 0;
inline constexpr int exit_failed = 1;
inline constexpr int exit_bad_input = 2;

/// Each adds its subcommand to `app`. `selected` is set to what carries it out, once the command line is parsed, if
/// that subcommand was given; calling it returns the exit code or throws.
using Action = std::function<int()>;
void add_simulate_command(CLI::App& app, Action& selected);
void add_equilibrium_command(CLI::App& app, Action& selected);
void add_run_command(CLI::App& app, Action& selected);
void add_reproduce_command(CLI::App& app, Action& selected);
void add_dbc_command(CLI::App& app, Action& selected);
void add_can_table_command(CLI::App& app, Action& selected);
void add_bus_monitor_command(CLI::App& app, Action& selected);

}  // namespace steadyboom::hil
