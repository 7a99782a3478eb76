#pragma once

#include <filesystem>
#include <string>

#include "drivers/network_config.hpp"

namespace steadyboom::runtime {

/// Reads a network file: which devices are on the bus and how their values lie in their PDOs. Its form is documented in
/// systemd/network.toml; a row that it leaves out stays as it is in `base`, which also gives tick, bit rate and the
/// spool's travel. The result is checked as a whole, bus load included. Throws ConfigError.
[[nodiscard]] drivers::NetworkConfig load_network_file(const std::filesystem::path& path,
                                                       const drivers::NetworkConfig& base);

/// A file that load_network_file reads back to the same devices, PDOs and signals.
[[nodiscard]] std::string to_toml(const drivers::NetworkConfig& config);

}  // namespace steadyboom::runtime
