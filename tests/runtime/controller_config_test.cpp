#include "runtime/controller_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/runtime/toml_text.hpp"

namespace steadyboom::runtime {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class ControllerConfigFile : public ::testing::Test {
  protected:
    const std::string text = text_of(STEADYBOOM_TEST_CONTROLLER_CONFIG);
    const std::vector<Line> keys = key_lines(text);

    [[nodiscard]] const Line& line(const std::string& key) const {
        return *std::find_if(keys.begin(), keys.end(), [&](const Line& candidate) { return candidate.key == key; });
    }

    /// The configuration `toml` beside case A as crane.toml.
    static ControllerConfig load(const std::string& toml) {
        const TemporaryFile file("controller.toml", toml);
        std::filesystem::copy(STEADYBOOM_TEST_CASE_FOLDER "/case-a.toml", file.folder() / "crane.toml");
        return load_controller_config(file.path());
    }

    /// what() from the file name on; empty when it loads.
    static std::string error_of(const std::string& toml) {
        try {
            (void)load(toml);
        } catch (const ConfigError& error) {
            const std::string message = error.what();
            EXPECT_EQ(message.find('\n'), std::string::npos);
            return message.substr(message.find("controller.toml"));
        }
        return "";
    }
};

TEST_F(ControllerConfigFile, ShippedDefaultLoads) {
    const ControllerConfig config = load(text);
    EXPECT_EQ(config.crane_file.filename(), "crane.toml");
    EXPECT_TRUE(config.crane_file.is_absolute());
    EXPECT_EQ(config.crane.name, "case-a");
    EXPECT_EQ(config.law, controllers::LawKind::joint_deflection);
    EXPECT_EQ(config.interface, "can0");
    EXPECT_EQ(config.bit_rate_bit_s, 500'000);
    EXPECT_EQ(config.expect_remote, std::nullopt);
    EXPECT_EQ(config.link_socket_path, "/run/steadyboom-can/can0/link.sock");
    EXPECT_EQ(config.rate_Hz, 200.0);
    EXPECT_EQ(config.period_ns(), 5'000'000);
    EXPECT_EQ(config.realtime_priority, 80);
    EXPECT_EQ(config.realtime_cpu, -1);
    EXPECT_TRUE(config.realtime_lock_memory);
    EXPECT_TRUE(config.realtime_required);
    EXPECT_EQ(config.max_opening_m, 7.6e-3);
    EXPECT_EQ(config.max_slew_m_s, 0.5);
    EXPECT_EQ(config.engage_ramp_s, 0.5);
    EXPECT_EQ(config.operator_socket_path, "/run/steadyboom/command.sock");
    EXPECT_EQ(config.telemetry_ring_path, "/run/steadyboom/ticks.ring");
}

TEST_F(ControllerConfigFile, EveryLawOfTheControllersHasItsWord) {
    for (const controllers::LawKind law : controllers::all_laws) {
        const std::string word = "\"" + std::string(controllers::name_of(law)) + "\"";
        EXPECT_EQ(load(with_value(text, line("law"), word)).law, law);
    }
    EXPECT_THAT(error_of(with_value(text, line("law"), "\"bang-bang\"")),
                EndsWith(": law = \"bang-bang\": must be \"none\", \"boom-angle\", \"joint-deflection\" or "
                         "\"swing-rate\""));
}

TEST_F(ControllerConfigFile, NamesEachMissingKeyAndTheLineOfItsSection) {
    ASSERT_EQ(keys.size(), 17U);
    const std::vector<std::string> lines = lines_of(text);
    for (const Line& key : keys) {
        std::vector<std::string> without = lines;
        without[key.number - 1].clear();
        const auto header = std::find(lines.begin(), lines.end(), "[" + key.section + "]");
        const auto header_line = key.section.empty() ? 1 : header - lines.begin() + 1;
        EXPECT_THAT(error_of(joined(without)), StartsWith("controller.toml:" + std::to_string(header_line) + ": " +
                                                          key.full_name() + ": is missing; must be "));
    }
}

TEST_F(ControllerConfigFile, NamesLineKeyAndValueOfEachBadValue) {
    const std::vector<std::pair<std::string, std::vector<std::string>>> bad_values{
        {"crane_file", {"3", "\"\"", "\"a\\u0000b\""}},
        {"network_file", {"3", "\"a\\u0000b\"", "\"nowhere.toml\"", "\".\""}},
        {"law", {"0", "\"Swing-rate\""}},
        {"interface", {"3", "\"\"", "\"can 0\"", "\"a/b\"", "\"..\"", "\"sixteen-letters-\""}},
        {"bit_rate_bit_s", {"500000.0", "300000", "0", "-125000", "9223372036854775807", "\"500k\""}},
        {"expect_remote", {"true", "\"maybe\""}},
        {"link_socket_path", {"1", "\"link.sock\"", "\"/run/\"", "\"/" + std::string(107, 'x') + "\""}},
        {"rate_Hz", {"49.9", "2000.1", "nan", "inf", "-200", "0", "true", "\"200\""}},
        {"priority", {"-1", "100", "80.0", "true", "4294967376"}},
        {"cpu", {"-2", "1024", "0.0", "\"0\""}},
        {"lock_memory", {"1", "\"true\"", "0.0"}},
        {"required", {"1", "\"no\""}},
        {"max_opening_m", {"0", "-0.001", "nan", "0.2", "0.0077"}},
        {"max_slew_m_s", {"0", "-1", "inf", "11"}},
        {"engage_ramp_s", {"0", "0.49", "nan", "10.1"}},
        {"socket_path", {"1", "\"\"", "\"command.sock\"", "\"/run/\"", "\"/" + std::string(107, 'x') + "\""}},
        {"ring_path", {"1", "\"\"", "\"ticks\"", "\"/\"", "[\"/a\"]"}},
    };
    ASSERT_EQ(bad_values.size(), keys.size()) << "a key has no bad values here";
    for (const auto& [name, values] : bad_values) {
        const Line& key = line(name);
        for (const std::string& value : values) {
            EXPECT_THAT(
                error_of(with_value(text, key, value)),
                AllOf(StartsWith("controller.toml:" + std::to_string(key.number) + ": " + key.full_name() + " = "),
                      HasSubstr(": must ")))
                << value;
        }
    }
}

TEST_F(ControllerConfigFile, SuggestsTheClosestKey) {
    EXPECT_THAT(error_of(text + "ring = \"/a\"\n"), EndsWith("telemetry.ring = \"/a\": unknown key; did you mean "
                                                             "telemetry.ring_path?"));
    EXPECT_THAT(error_of(text + "[bsu]\n"), HasSubstr("[bsu]: unknown section; known are [bus], [loop], "));
}

TEST_F(ControllerConfigFile, RejectsAnOpeningBeyondTheCranesSpool) {
    EXPECT_THAT(error_of(with_value(text, line("max_opening_m"), "7.7e-3")),
                HasSubstr("limits.max_opening_m = 0.0077: must not exceed actuator.spool_travel_m of "));
}

TEST_F(ControllerConfigFile, RejectsAMissingOrBadCraneFile) {
    EXPECT_THAT(error_of(with_value(text, line("crane_file"), "\"nowhere.toml\"")),
                HasSubstr(": crane_file = \"nowhere.toml\": must name a crane file; there is none at /"));
    EXPECT_THAT(error_of(with_value(text, line("crane_file"), "\".\"")), HasSubstr("must name a crane file"));
    EXPECT_THAT(error_of(with_value(text, line("crane_file"), "\"controller.toml\"")),
                HasSubstr("controller.toml:6: crane_file = \"controller.toml\": unknown key"))
        << "it is no crane file";
}

TEST_F(ControllerConfigFile, NetworkFileDescribesTheDevicesOfItsBus) {
    const auto plain = load(text);
    EXPECT_TRUE(plain.network_file.empty());
    const TemporaryFile network("network.toml", "[device]\ncontroller = { node_id = 5, heartbeat_ms = 50 }\n");
    const auto named = load(with_value(text, line("network_file"), "\"" + network.path().string() + "\""));
    EXPECT_EQ(named.network_file, network.path());
    EXPECT_EQ(named.network[drivers::Device::controller].node_id, 5);
    for (const auto& config : {plain, named}) {
        EXPECT_EQ(config.network.spool_travel_m, config.crane.crane.actuator.spool_travel_m);
        EXPECT_EQ(config.network.period_ns, 5'000'000);
        EXPECT_EQ(config.network.bit_rate_bit_s, 500'000U);
    }
}

TEST_F(ControllerConfigFile, ComesBackFromItsOwnWriting) {
    ControllerConfig config = load(text);
    config.crane_file = STEADYBOOM_TEST_CASE_FOLDER "/case-b.toml";
    config.law = controllers::LawKind::swing_rate;
    config.interface = "vcan0";
    config.bit_rate_bit_s = 250'000;
    config.expect_remote = false;
    config.link_socket_path = "";
    config.rate_Hz = 1000.0 / 3.0;
    config.realtime_priority = 0;
    config.realtime_cpu = 3;
    config.realtime_lock_memory = false;
    config.realtime_required = false;
    config.max_opening_m = 5e-3;
    config.max_slew_m_s = 0.1 + 0.2;
    config.engage_ramp_s = 2.0;
    config.operator_socket_path = "/tmp/a \"b\".sock";
    config.telemetry_ring_path = "/tmp/ring";
    const TemporaryFile file("controller.toml", to_toml(config));
    const ControllerConfig read = load_controller_config(file.path());
    EXPECT_EQ(read.crane_file, config.crane_file);
    EXPECT_EQ(read.crane.name, "case-b");
    EXPECT_EQ(read.law, config.law);
    EXPECT_EQ(read.interface, config.interface);
    EXPECT_EQ(read.bit_rate_bit_s, config.bit_rate_bit_s);
    EXPECT_EQ(read.expect_remote, config.expect_remote);
    EXPECT_EQ(read.link_socket_path, config.link_socket_path);
    EXPECT_EQ(read.rate_Hz, config.rate_Hz);
    EXPECT_EQ(read.period_ns(), 3'000'000);
    EXPECT_EQ(read.realtime_priority, config.realtime_priority);
    EXPECT_EQ(read.realtime_cpu, config.realtime_cpu);
    EXPECT_EQ(read.realtime_lock_memory, config.realtime_lock_memory);
    EXPECT_EQ(read.realtime_required, config.realtime_required);
    EXPECT_EQ(read.max_opening_m, config.max_opening_m);
    EXPECT_EQ(read.max_slew_m_s, config.max_slew_m_s);
    EXPECT_EQ(read.engage_ramp_s, config.engage_ramp_s);
    EXPECT_EQ(read.operator_socket_path, config.operator_socket_path);
    EXPECT_EQ(read.telemetry_ring_path, config.telemetry_ring_path);
}

TEST_F(ControllerConfigFile, GarbageNeverGetsPastAsAnythingButAConfigError) {
    std::mt19937 random(4711);
    const TemporaryFile file("controller.toml", "");
    std::filesystem::copy(STEADYBOOM_TEST_CASE_FOLDER "/case-a.toml", file.folder() / "crane.toml");
    std::size_t rejected = 0;
    for (int trial = 0; trial < 400; ++trial) {
        std::string garbage = text;
        for (int change = 0; change < 3; ++change) {
            const std::size_t at = std::uniform_int_distribution<std::size_t>(0, garbage.size() - 1)(random);
            garbage[at] = static_cast<char>(std::uniform_int_distribution<int>(0, 255)(random));
        }
        std::ofstream(file.path(), std::ios::binary | std::ios::trunc) << garbage;
        // Any other exception leaves the test and fails it.
        try {
            (void)load_controller_config(file.path());
        } catch (const ConfigError&) {
            ++rejected;
        }
    }
    EXPECT_GT(rejected, 100U);
    EXPECT_LT(rejected, 400U);
}

}  // namespace
}  // namespace steadyboom::runtime
