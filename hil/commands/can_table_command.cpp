#include <iostream>
#include <memory>
#include <string>

#include "hil/can_table.hpp"
#include "hil/commands/commands.hpp"
#include "hil/commands/network_options.hpp"

namespace steadyboom::hil {

void add_can_table_command(CLI::App& app, Action& selected) {
    struct Options {
        NetworkOptions network;
        bool json = false;
    };
    const auto options = std::make_shared<Options>();
    CLI::App* command =
        app.add_subcommand("can-table", "The network: devices, identifiers, values, cycles, protection, bus load");
    add_network_options(*command, options->network);
    command->add_flag("--json", options->json, "Print JSON");
    command->callback([options, &selected] {
        selected = [options] {
            const auto table = table_of(options->network);
            std::cout << (options->json ? can_table_json(table) : can_table_text(table)) << std::flush;
            return exit_done;
        };
    });
}

}  // namespace steadyboom::hil
