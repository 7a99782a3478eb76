#include "runtime/controller_config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <system_error>

#include "runtime/network_file.hpp"

namespace steadyboom::runtime {

namespace {

namespace fs = std::filesystem;

const auto law_words = [] {
    std::array<std::pair<std::string_view, controllers::LawKind>, std::size(controllers::all_laws)> words;
    std::transform(std::begin(controllers::all_laws), std::end(controllers::all_laws), words.begin(),
                   [](controllers::LawKind law) {
                       return std::pair{controllers::name_of(law), law};
                   });
    return words;
}();

constexpr std::array<std::pair<std::string_view, std::optional<bool>>, 3> expect_remote_words{
    {{"automatic", std::nullopt}, {"yes", true}, {"no", false}}};

bool is_interface_name(const std::string& text) {
    return !text.empty() && text.size() <= 15 && text != "." && text != ".." &&
           std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 0x7F && c != '/' && c != ':'; });
}

constexpr std::size_t longest_socket_path = 107;  // sun_path
constexpr std::size_t longest_file_path = 4095;

bool is_absolute_file_path(const std::string& text, std::size_t longest) {
    return text.size() >= 2 && text.size() <= longest && text.front() == '/' && text.back() != '/' &&
           text.find('\0') == std::string::npos;
}

void declare_controller_config(TomlSchema& schema, ControllerConfig& config, std::string& crane_file,
                               std::string& network_file) {
    schema.text(
        "crane_file", crane_file,
        [](const std::string& text) { return !text.empty() && text.find('\0') == std::string::npos; },
        "the path of a crane file, relative to this file");
    declare_network_file(schema, network_file);
    schema.word<controllers::LawKind>("law", config.law, law_words);

    schema.section("bus");
    declare_bus(schema, config.interface, config.bit_rate_bit_s);
    schema.word<std::optional<bool>>("expect_remote", config.expect_remote, expect_remote_words);
    schema.text(
        "link_socket_path", config.link_socket_path,
        [](const std::string& text) { return text.empty() || is_absolute_file_path(text, longest_socket_path); },
        "empty or an absolute path of at most 107 bytes");
    schema.section("loop");
    declare_rate(schema, config.rate_Hz);

    schema.section("realtime");
    schema.integer("priority", config.realtime_priority, 0, 99);
    schema.integer("cpu", config.realtime_cpu, -1, 1023);
    schema.boolean("lock_memory", config.realtime_lock_memory);
    schema.boolean("required", config.realtime_required);

    schema.section("limits");
    schema.number("max_opening_m", config.max_opening_m, closed(1e-5, 0.1), "m");
    schema.number("max_slew_m_s", config.max_slew_m_s, closed(1e-3, 10), "m/s");
    schema.number("engage_ramp_s", config.engage_ramp_s, closed(0.5, 10), "s");

    schema.section("operator");
    schema.text(
        "socket_path", config.operator_socket_path,
        [](const std::string& text) { return is_absolute_file_path(text, longest_socket_path); },
        "an absolute path of at most 107 bytes");
    schema.section("telemetry");
    declare_ring_path(schema, config.telemetry_ring_path);
}

}  // namespace

void declare_bus(TomlSchema& schema, std::string& interface, int& bit_rate_bit_s) {
    schema.text("interface", interface, is_interface_name, "a CAN interface's name of 1 to 15 characters");
    schema.integer("bit_rate_bit_s", bit_rate_bit_s, 125'000, 1'000'000, "bit/s");
    schema.rule(
        [&bit_rate_bit_s] {
            const int rate = bit_rate_bit_s;
            return rate == 125'000 || rate == 250'000 || rate == 500'000 || rate == 1'000'000;
        },
        "be 125000, 250000, 500000 or 1000000 bit/s");
}

void declare_network_file(TomlSchema& schema, std::string& network_file) {
    schema.text(
        "network_file", network_file, [](const std::string& text) { return text.find('\0') == std::string::npos; },
        "the path of a network file, relative to this file, or \"\"");
}

void declare_rate(TomlSchema& schema, double& rate_Hz) {
    schema.number("rate_Hz", rate_Hz, closed(50, 2000), "Hz");
}

void declare_ring_path(TomlSchema& schema, std::string& ring_path) {
    schema.text(
        "ring_path", ring_path, [](const std::string& text) { return is_absolute_file_path(text, longest_file_path); },
        "an absolute path");
}

std::int64_t ControllerConfig::period_ns() const noexcept {
    return std::llround(1e9 / rate_Hz);
}

drivers::NetworkConfig load_network(const TomlSchema& schema, const fs::path& config_path, std::string& network_file,
                                    const drivers::NetworkConfig& base) {
    if (network_file.empty()) {
        return base;
    }
    const fs::path file = fs::absolute(config_path.parent_path() / network_file).lexically_normal();
    std::error_code error;
    schema.require("network_file", fs::is_regular_file(file, error),
                   "name a network file or be \"\"; there is none at " + file.string());
    network_file = file.string();
    return load_network_file(file, base);
}

ControllerConfig load_controller_config(const fs::path& path) {
    ControllerConfig config;
    std::string crane_file;
    std::string network_file;
    TomlSchema schema;
    declare_controller_config(schema, config, crane_file, network_file);
    schema.read_file(path);

    config.crane_file = fs::absolute(path.parent_path() / crane_file).lexically_normal();
    std::error_code error;
    schema.require("crane_file", fs::is_regular_file(config.crane_file, error),
                   "name a crane file; there is none at " + config.crane_file.string());
    config.crane = load_crane_file(config.crane_file);
    schema.require("limits.max_opening_m", config.max_opening_m <= config.crane.crane.actuator.spool_travel_m,
                   "not exceed actuator.spool_travel_m of " + config.crane_file.string());
    config.network = load_network(schema, path, network_file,
                                  {.spool_travel_m = config.crane.crane.actuator.spool_travel_m,
                                   .period_ns = config.period_ns(),
                                   .bit_rate_bit_s = static_cast<std::uint32_t>(config.bit_rate_bit_s)});
    config.network_file = network_file;
    return config;
}

std::string to_toml(const ControllerConfig& config) {
    ControllerConfig copy = config;
    std::string crane_file = config.crane_file.string();
    std::string network_file = config.network_file.string();
    TomlSchema schema;
    declare_controller_config(schema, copy, crane_file, network_file);
    return schema.write();
}

}  // namespace steadyboom::runtime
