#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "drivers/device_table.hpp"

namespace steadyboom::hil {

/// Which network a command speaks of.
struct NetworkOptions {
    std::string file;  ///< empty: the virtual crane's own devices
    double rate_Hz = 200.0;
    int bit_rate_kbit_s = 500;
};

/// --network FILE, --rate-hz, --bit-rate-kbit-s.
void add_network_options(CLI::App& command, NetworkOptions& options);

/// Throws runtime::ConfigError.
[[nodiscard]] drivers::DeviceTable table_of(const NetworkOptions& options);

}  // namespace steadyboom::hil
