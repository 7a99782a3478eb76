#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace steadyboom::runtime {

/// A program that is started with a configuration file and runs until it is told to end.
struct ServiceProgram {
    std::string name;                                     ///< as installed; names its log lines
    std::string purpose;                                  ///< first lines of --help
    std::string config_form;                              ///< file that documents the configuration's form
    std::function<void(CLI::App&)> declare_options = {};  ///< beside --config; may be empty
    /// The program itself. Returns the exit code; ConfigError becomes 2 and any other exception 1, each with one line.
    std::function<int(const std::filesystem::path& config)> work;
};

/// True once SIGTERM or SIGINT came.
[[nodiscard]] const std::atomic<bool>& stop_requested() noexcept;

/// main() of a service: --config, --help, --version, log lines on standard error, signals, exit codes 0 done, 1 failed,
/// 2 bad input.
[[nodiscard]] int run_service(const ServiceProgram& program, int argc, char** argv);

}  // namespace steadyboom::runtime
