// steadyboom-can: looks after one CAN interface for the controller, which may neither ask nor change it. Reports its
// state and error counters, and restarts it after bus-off when the controller asks.
#include <chrono>
#include <thread>

#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>
#include <CLI/CLI.hpp>

#include "drivers/device_table.hpp"
#include "runtime/can_link/can_link.hpp"
#include "runtime/can_link/link_server.hpp"
#include "runtime/clock.hpp"
#include "runtime/controller_config.hpp"
#include "runtime/service_program.hpp"
#include "runtime/toml_reader.hpp"

using namespace steadyboom;

namespace {

constexpr int exit_done = 0;

int look_after(const runtime::ControllerConfig& config) {
    if (config.link_socket_path.empty()) {
        throw runtime::ConfigError("bus.link_socket_path is empty: name the socket to report at");
    }
    runtime::CanLink link(
        config.interface,
        {.bit_rate_bit_s = static_cast<std::uint32_t>(config.bit_rate_bit_s),
         .queue_frames = static_cast<std::uint32_t>(drivers::DeviceTable(config.network).most_frames_a_tick())});
    runtime::MonotonicClock clock;
    runtime::LinkServer server(
        {.socket_path = config.link_socket_path,
         .read = [&] { return link.read(); },
         .restart =
             [&] {
                 const bool done = link.restart();
                 spdlog::warn("{}: bus-off, {}", config.interface, done ? "restarted" : "the kernel refuses a restart");
                 return done;
             },
         .changed =
             [&](const runtime::LinkReport& report) {
                 const bool well = report.problems == 0 && report.condition != runtime::LinkCondition::absent &&
                                   report.condition < runtime::LinkCondition::warning;
                 spdlog::log(well ? spdlog::level::info : spdlog::level::warn, "{}", link.in_words(report));
             }});
    bool ready = false;
    while (!runtime::stop_requested().load(std::memory_order_relaxed)) {
        server.step(clock.now_ns());
        sd_notify(0, ready ? "WATCHDOG=1" : "READY=1\nWATCHDOG=1");
        ready = true;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return exit_done;
}

}  // namespace

int main(int argc, char** argv) {
    std::string interface;
    return runtime::run_service(
        {.name = "steadyboom-can",
         .purpose = "Looks after the controller's CAN interface: reports state and error counters, restarts after "
                    "bus-off on request.",
         .config_form = "systemd/controller.toml",
         .declare_options =
             [&](CLI::App& app) {
                 app.add_option("--interface", interface, "Must be the configuration's bus.interface, if given");
             },
         .work =
             [&](const std::filesystem::path& path) {
                 const runtime::ControllerConfig config = runtime::load_controller_config(path);
                 if (!interface.empty() && interface != config.interface) {
                     throw runtime::ConfigError("--interface " + interface + ": " + path.string() +
                                                " has bus.interface = \"" + config.interface + "\"; give that one");
                 }
                 return look_after(config);
             }},
        argc, argv);
}
