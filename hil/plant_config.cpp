#include "hil/plant_config.hpp"

#include <cmath>

#include "runtime/controller_config.hpp"

namespace steadyboom::hil {

namespace {

namespace fs = std::filesystem;

void declare_plant_config(runtime::TomlSchema& schema, PlantConfig& config, std::string& case_file,
                          std::string& network_file) {
    schema.text(
        "case_file", case_file,
        [](const std::string& text) { return !text.empty() && text.find('\0') == std::string::npos; },
        "the path of a case file, relative to this file");
    runtime::declare_network_file(schema, network_file);
    schema.section("bus");
    runtime::declare_bus(schema, config.interface, config.bit_rate_bit_s);
    schema.section("loop");
    runtime::declare_rate(schema, config.rate_Hz);
    schema.section("realtime");
    schema.integer("priority", config.realtime_priority, 0, 99);
    schema.integer("cpu", config.realtime_cpu, -1, 1023);
    schema.section("run");
    schema.integer("seed", config.seed, 0, 2'147'483'647);
    schema.number("standing_s", config.standing_s, runtime::closed(0, 3600), "s");
    schema.number("duration_s", config.duration_s, runtime::above(0, 86'400), "s");
    schema.section("output");
    runtime::declare_ring_path(schema, config.ring_path);
}

}  // namespace

PlantConfig load_plant_config(const fs::path& path) {
    PlantConfig config;
    std::string case_file;
    std::string network_file;
    runtime::TomlSchema schema;
    declare_plant_config(schema, config, case_file, network_file);
    schema.read_file(path);

    std::error_code error;
    config.case_file = fs::absolute(path.parent_path() / case_file).lexically_normal();
    schema.require("case_file", fs::is_regular_file(config.case_file, error),
                   "name a case file; there is none at " + config.case_file.string());
    config.crane_case = load_case(config.case_file.string());
    config.network = runtime::load_network(schema, path, network_file,
                                           {.spool_travel_m = config.crane_case.crane.actuator.spool_travel_m,
                                            .period_ns = std::llround(1e9 / config.rate_Hz),
                                            .bit_rate_bit_s = static_cast<std::uint32_t>(config.bit_rate_bit_s)});
    config.network_file = network_file;
    return config;
}

std::string to_toml(const PlantConfig& config) {
    PlantConfig copy = config;
    std::string case_file = config.case_file.string();
    std::string network_file = config.network_file.string();
    runtime::TomlSchema schema;
    declare_plant_config(schema, copy, case_file, network_file);
    return schema.write();
}

}  // namespace steadyboom::hil
