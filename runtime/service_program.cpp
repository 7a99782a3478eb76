#include "runtime/service_program.hpp"

#include <csignal>
#include <exception>

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "runtime/toml_reader.hpp"

namespace steadyboom::runtime {

namespace {

constexpr int exit_done = 0;
constexpr int exit_failed = 1;
constexpr int exit_bad_input = 2;

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

void request_stop(int) {
    stop.store(true, std::memory_order_relaxed);
}

}  // namespace

const std::atomic<bool>& stop_requested() noexcept {
    return stop;
}

int run_service(const ServiceProgram& program, int argc, char** argv) {
    CLI::App app(program.purpose + "\nExit codes: 0 done or stopped by SIGTERM or SIGINT, 1 failed, 2 bad input.",
                 program.name);
    app.set_version_flag("--version", program.name + " " STEADYBOOM_VERSION);
    std::string config;
    app.add_option("--config", config, "Configuration file; its form: " + program.config_form)->required();
    if (program.declare_options) {
        program.declare_options(app);
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? exit_done : exit_bad_input;
    }

    spdlog::set_default_logger(spdlog::stderr_logger_mt(program.name));
    spdlog::set_pattern("%n: %l: %v");
    struct sigaction action {};
    action.sa_handler = request_stop;
    sigaction(SIGTERM, &action, nullptr);
    sigaction(SIGINT, &action, nullptr);
    try {
        return program.work(config);
    } catch (const ConfigError& error) {
        spdlog::error("{}", error.what());
        return exit_bad_input;
    } catch (const std::exception& error) {
        spdlog::error("{}", error.what());
        return exit_failed;
    }
}

}  // namespace steadyboom::runtime
