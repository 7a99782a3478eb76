// steadyboomctl: the operator's command line to a running controller.
#include <charconv>
#include <cstdio>
#include <exception>
#include <iostream>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "runtime/operator_client.hpp"

namespace {

using steadyboom::runtime::OperatorClient;
using steadyboom::runtime::OperatorCommand;
using steadyboom::runtime::OperatorReply;
using steadyboom::runtime::OperatorResult;

constexpr int exit_done = 0;
constexpr int exit_failed = 1;
constexpr int exit_bad_input = 2;

std::string token_text(std::uint64_t token) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(token));
    return text;
}

std::optional<std::uint64_t> parse_token(const std::string& text) {
    std::uint64_t token = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), token, 16);
    return text.size() == 16 && error == std::errc() && end == text.data() + text.size() ? std::optional(token)
                                                                                         : std::nullopt;
}

void print_json(OperatorCommand command, const OperatorReply& reply) {
    nlohmann::ordered_json json;
    json["command"] = name_of(command);
    json["result"] = name_of(reply.outcome());
    json["state"] = reply.state;
    json["reasons"] = reply.reasons;
    json["text"] = reply.words();
    json["tick"] = reply.tick;
    json["tick_age_ns"] = reply.tick_age_ns;
    if (reply.token != 0) {
        json["token"] = token_text(reply.token);
    }
    // The text came over a socket: bytes that are no UTF-8 must not end the program.
    std::cout << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

void print_words(OperatorCommand command, const OperatorReply& reply) {
    if (reply.outcome() != OperatorResult::done) {
        std::cerr << "steadyboomctl: " << name_of(command) << ": " << name_of(reply.outcome()) << ": " << reply.words()
                  << '\n';
        return;
    }
    if (command == OperatorCommand::arm) {
        std::cout << token_text(reply.token) << '\n';
        return;
    }
    std::cout << reply.words() << '\n';
    if (command == OperatorCommand::status && reply.tick_age_ns >= 0) {
        std::cout << "tick " << reply.tick << ", due " << static_cast<double>(reply.tick_age_ns) * 1e-6 << " ms ago\n";
    } else if (command == OperatorCommand::status) {
        std::cout << "no tick yet\n";
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Commands a running steadyboom-controller.\n"
        "Exit codes: 0 done, 1 refused or failed, 2 bad input.",
        "steadyboomctl");
    app.set_version_flag("--version", "steadyboomctl " STEADYBOOM_VERSION);
    app.require_subcommand(1);
    app.fallthrough();

    std::string path = "/run/steadyboom/command.sock";
    bool json = false;
    app.add_option("--socket", path, "The controller's operator socket")->capture_default_str();
    app.add_flag("--json", json, "Print the reply as JSON");

    std::string token_given;
    bool arm_first = false;
    app.add_subcommand("status", "Print the controller's state and the reasons for it");
    app.add_subcommand("arm", "First step to motion: prints the one-time token that engage needs within 30 s");
    CLI::App* engage = app.add_subcommand("engage", "Second step to motion: lets the law move the valve");
    CLI::Option* token_option = engage->add_option("token", token_given, "The 16 hexadecimal digits that arm printed");
    engage->add_flag("--arm", arm_first, "Arm first and use the token of that arm")->excludes(token_option);
    app.add_subcommand("disengage", "Bring the valve to neutral in order");
    app.add_subcommand("reset", "Clear a fault whose cause is gone; never starts motion");
    app.add_subcommand("stop", "Stop motion at once and close the cut-off valve");

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? exit_done : exit_bad_input;
    }

    const std::string chosen = app.get_subcommands().front()->get_name();
    OperatorCommand command = OperatorCommand::status;
    for (const OperatorCommand each : {OperatorCommand::arm, OperatorCommand::engage, OperatorCommand::disengage,
                                       OperatorCommand::reset, OperatorCommand::stop}) {
        command = chosen == name_of(each) ? each : command;
    }
    std::optional<std::uint64_t> token(0);
    if (command == OperatorCommand::engage && !arm_first) {
        token = parse_token(token_given);
        if (!token) {
            std::cerr << "steadyboomctl: engage needs the 16 hexadecimal digits that 'steadyboomctl arm' printed, or "
                         "--arm\n";
            return exit_bad_input;
        }
    }

    try {
        OperatorClient client(path);
        const OperatorReply reply = arm_first ? client.arm_and_engage() : client.request(command, *token);
        if (json) {
            print_json(command, reply);
        } else {
            print_words(command, reply);
        }
        return reply.outcome() == OperatorResult::done ? exit_done : exit_failed;
    } catch (const std::exception& error) {
        std::cerr << "steadyboomctl: " << error.what() << '\n';
        return exit_failed;
    }
}
