#include <iostream>
#include <memory>
#include <string>

#include "hil/commands/commands.hpp"
#include "hil/commands/network_options.hpp"
#include "hil/dbc_file.hpp"
#include "hil/whole_file.hpp"

namespace steadyboom::hil {

void add_dbc_command(CLI::App& app, Action& selected) {
    struct Options {
        NetworkOptions network;
        std::string out;
    };
    const auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("dbc", "The network as a DBC file, for tools that read CAN");
    add_network_options(*command, options->network);
    command->add_option("--out", options->out, "File to write; without it standard output");
    command->callback([options, &selected] {
        selected = [options] {
            const std::string dbc = dbc_of(table_of(options->network));
            if (options->out.empty()) {
                std::cout << dbc << std::flush;
            } else {
                write_whole_file(options->out, dbc);
            }
            return exit_done;
        };
    });
}

}  // namespace steadyboom::hil
