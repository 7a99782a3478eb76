#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "drivers/network_config.hpp"
#include "hil/case_file.hpp"

namespace steadyboom::hil {

/// What steadyboom-plant is started with. The form of the file is documented in hil/plant.toml; every key is required
/// there.
struct PlantConfig {
    std::filesystem::path case_file;  ///< absolute
    Case crane_case;                  ///< what that file holds: the true crane

    std::filesystem::path network_file;  ///< absolute, or empty: the devices of the virtual crane
    drivers::NetworkConfig network;      ///< what that file, the bus, the tick and the crane make of it

    std::string interface;         ///< SocketCAN
    int bit_rate_bit_s = 500'000;  ///< of the interface
    double rate_Hz = 200.0;        ///< of the controller's ticks, for the network's timing

    int seed = 1;              ///< of the sensor noise
    double standing_s = 5.0;   ///< from the start to the brake event
    double duration_s = 10.0;  ///< from the brake event to the end of the program

    int realtime_priority = 70;  ///< SCHED_FIFO, 1 to 99; 0: ordinary scheduling
    int realtime_cpu = -1;       ///< pin to it; -1: any

    std::string ring_path;  ///< PlantRecords, for the bench
};

/// Reads and checks the configuration and the case file it names. Throws runtime::ConfigError.
[[nodiscard]] PlantConfig load_plant_config(const std::filesystem::path& path);

/// A file that load_plant_config reads back to the same values. The case stays in its own file.
[[nodiscard]] std::string to_toml(const PlantConfig& config);

}  // namespace steadyboom::hil
