#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "controllers/law.hpp"
#include "drivers/network_config.hpp"
#include "runtime/crane_file.hpp"

namespace steadyboom::runtime {

/// What the deployed controller and its telemetry are started with. The form of the file is documented in
/// systemd/controller.toml; every key is required there.
struct ControllerConfig {
    std::filesystem::path crane_file;  ///< absolute
    CraneFile crane;                   ///< what that file holds
    controllers::LawKind law = controllers::LawKind::none;

    std::filesystem::path network_file;  ///< absolute, or empty: the devices of the virtual crane
    drivers::NetworkConfig network;      ///< what that file, the bus, the tick and the crane make of it

    std::string interface;                   ///< SocketCAN
    int bit_rate_bit_s = 500'000;            ///< of the interface, for the bus load; the interface is set up elsewhere
    std::optional<bool> expect_remote = {};  ///< every device is on another machine; not set: unless the bus is virtual
    std::string link_socket_path;            ///< of the link daemon; empty: nobody watches the interface
    double rate_Hz = 200.0;                  ///< control ticks

    int realtime_priority = 80;  ///< SCHED_FIFO, 1 to 99; 0: ordinary scheduling
    int realtime_cpu = -1;       ///< pin the control thread to it; -1: any
    bool realtime_lock_memory = true;
    bool realtime_required = true;  ///< false: soft real-time; refusals and late ticks are reported, not acted on

    double max_opening_m = 0.0;  ///< performance limit of the command
    double max_slew_m_s = 0.0;   ///< performance limit of the command's rate
    double engage_ramp_s = 0.0;  ///< authority 0 to 1 after engaging

    std::string operator_socket_path;
    std::string telemetry_ring_path;

    [[nodiscard]] std::int64_t period_ns() const noexcept;  ///< of the control tick, rounded to whole ns
};

/// Reads and checks the configuration and the crane file it names. Throws ConfigError.
[[nodiscard]] ControllerConfig load_controller_config(const std::filesystem::path& path);

/// Declare keys that other programs on the same bus have too, for the section that was declared last.
void declare_bus(TomlSchema& schema, std::string& interface, int& bit_rate_bit_s);
void declare_rate(TomlSchema& schema, double& rate_Hz);
void declare_network_file(TomlSchema& schema, std::string& network_file);
void declare_ring_path(TomlSchema& schema, std::string& ring_path);

/// The network of a program on this bus: what the file named by `network_file` (as read by `schema`, relative to the
/// folder of `config_path`; empty: none) says over the defaults. Leaves the file's absolute path in `network_file`.
/// Throws ConfigError.
[[nodiscard]] drivers::NetworkConfig load_network(const TomlSchema& schema, const std::filesystem::path& config_path,
                                                  std::string& network_file, const drivers::NetworkConfig& base);

/// A file that load_controller_config reads back to the same values. The crane stays in its own file.
[[nodiscard]] std::string to_toml(const ControllerConfig& config);

}  // namespace steadyboom::runtime
