#include "hil/commands/network_options.hpp"

#include <cmath>

#include "hil/commands/option_checks.hpp"
#include "runtime/network_file.hpp"

namespace steadyboom::hil {

void add_network_options(CLI::App& command, NetworkOptions& options) {
    command.add_option("--network", options.file, "Network file; without it the virtual crane's own devices");
    command.add_option("--rate-hz", options.rate_Hz, "Control ticks per second")
        ->check(between(1.0, 2000.0, "Hz"))
        ->capture_default_str();
    command.add_option("--bit-rate-kbit-s", options.bit_rate_kbit_s, "Of the bus")
        ->check(CLI::IsMember({125, 250, 500, 1000}))
        ->capture_default_str();
}

drivers::DeviceTable table_of(const NetworkOptions& options) {
    drivers::NetworkConfig config;
    config.period_ns = std::llround(1.0e9 / options.rate_Hz);
    config.bit_rate_bit_s = 1000U * static_cast<std::uint32_t>(options.bit_rate_kbit_s);
    if (!options.file.empty()) {
        config = runtime::load_network_file(options.file, config);
    }
    return drivers::DeviceTable(config);
}

}  // namespace steadyboom::hil
