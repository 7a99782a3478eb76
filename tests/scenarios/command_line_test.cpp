// The command line is a contract: columns, keys, exit codes, one-line errors.
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hil/case_file.hpp"

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

struct Outcome {
    int exit_code = -1;
    std::string out;
    std::string error;
};

std::string content(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

class CommandLine : public testing::Test {
  protected:
    CommandLine() {
        std::string name = (fs::temp_directory_path() / "steadyboom-test.XXXXXX").string();
        folder_ = mkdtemp(name.data());
    }
    ~CommandLine() override { fs::remove_all(folder_); }

    /// Through a shell; the test writes every word of it.
    Outcome run(const std::string& program, const std::string& arguments) const {
        const fs::path error = folder_ / "stderr";
        const std::string line = "cd " + folder_.string() + " && " + program + " " + arguments + " 2>" + error.string();
        Outcome outcome;
        FILE* pipe = popen(line.c_str(), "r");
        char part[4096];
        for (std::size_t count = 0; (count = fread(part, 1, sizeof part, pipe)) > 0;) {
            outcome.out.append(part, count);
        }
        const int status = pclose(pipe);
        outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
        outcome.error = content(error);
        return outcome;
    }
    Outcome steadyboom(const std::string& arguments) const { return run(STEADYBOOM_COMMAND, arguments); }

    fs::path folder_;
};

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line);
    }
    return lines;
}

TEST_F(CommandLine, SimulateWritesExactlyTheColumnsOfTheContract) {
    const Outcome outcome =
        steadyboom("simulate case-a --law joint-deflection --duration-s 1 --output-period-s 0.1 --csv out.csv");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto lines = lines_of(content(folder_ / "out.csv"));
    ASSERT_EQ(lines.size(), 12U);
    EXPECT_EQ(lines[0],
              "t_s,R1_m,phi2_rad,R9_m,q1_m,q2_m,phi6_rad,phi9_rad,R1dot_m_s,phi2dot_rad_s,R9dot_m_s,q1dot_m_s,"
              "q2dot_m_s,phi6dot_rad_s,phi9dot_rad_s,piston_m,valve_m,pendent_tension_N,load_line_tension_N,chord_m,"
              "contact_fraction,hydraulic_power_W");
    EXPECT_THAT(lines[1], StartsWith("0,"));
    EXPECT_THAT(lines[11], StartsWith("1,"));
    for (const std::string& line : lines) {
        EXPECT_EQ(std::ranges::count(line, ','), 21) << line;
    }
}

TEST_F(CommandLine, SimulateWritesToStandardOutputForADash) {
    const Outcome outcome = steadyboom("simulate case-a --duration-s 0.01 --csv -");
    ASSERT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.out, StartsWith("t_s,R1_m"));
}

TEST_F(CommandLine, EquilibriumPrintsAnglesAndModesAsJson) {
    const Outcome outcome = steadyboom("equilibrium case-a --json");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_NEAR(json.at("phi6_deg").get<double>(), 59.84, 0.005);
    ASSERT_EQ(json.at("modes").size(), 7U);
    EXPECT_NEAR(json.at("modes")[0].at("frequency_Hz").get<double>(), 0.14, 0.005);
    EXPECT_EQ(json.at("modes")[0].at("dominant_coordinate"), "phi9");
    EXPECT_LE(json.at("residual").get<double>(), 1e-12);
}

TEST_F(CommandLine, BoomIsTheCasesOwnUnlessTheOptionSaysAnother) {
    const auto sag_m = [&](const std::string& arguments, const std::string& boom) {
        const Outcome outcome = steadyboom("equilibrium " + arguments + " --json");
        EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
        const auto json = nlohmann::json::parse(outcome.out);
        EXPECT_EQ(json.at("boom"), boom);
        EXPECT_EQ(json.at("modes").size(), boom == "beam" ? 8U : 7U);
        return json.at("q1_m").get<double>();
    };
    const double links_m = sag_m("case-a", "links");
    const double beam_m = sag_m("case-a --boom beam", "beam");
    EXPECT_GT(beam_m, 5.0 * links_m);
    std::string file = content(steadyboom::hil::find_case("case-a"));
    file.replace(file.find("\"links\""), 7, "\"beam\"");
    std::ofstream(folder_ / "beam.toml") << file;
    EXPECT_EQ(sag_m("beam.toml", "beam"), beam_m);
    EXPECT_EQ(sag_m("beam.toml --boom links", "links"), links_m);

    const Outcome run = steadyboom("run case-a --boom beam --law none --duration-s 1 --json");
    ASSERT_EQ(run.exit_code, 0) << run.error;
    EXPECT_EQ(nlohmann::json::parse(run.out).at("boom"), "beam");
    ASSERT_EQ(steadyboom("simulate case-a --duration-s 0.1 --csv links.csv").exit_code, 0);
    ASSERT_EQ(steadyboom("simulate case-a --boom beam --duration-s 0.1 --csv beam.csv").exit_code, 0);
    EXPECT_NE(content(folder_ / "links.csv"), content(folder_ / "beam.csv"));
}

TEST_F(CommandLine, RunPrintsTheFiguresUnderStableKeysAndWritesTheRunFolder) {
    const Outcome outcome = steadyboom("run case-a --law joint-deflection --duration-s 2 --json --out run");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json.at("law"), "joint-deflection");
    for (const char* key : {"residual_energy_J", "peak_power_W", "peak_R1_m", "peak_phi2_rad", "pendent_slack_share"}) {
        EXPECT_TRUE(json.at(key).is_number()) << key;
    }
    EXPECT_GT(json.at("residual_energy_J").get<double>(), 0.0);
    const auto lines = lines_of(content(folder_ / "run/ticks.csv"));
    ASSERT_EQ(lines.size(), 1U + 7U * 200U + 1U);
    EXPECT_THAT(lines[0], StartsWith("t_s,strain_lower_microstrain_meas,"));
    EXPECT_THAT(lines[1], StartsWith("-5,"));
    EXPECT_THAT(content(folder_ / "run/can.log"), HasSubstr(" can0 080#"));
    EXPECT_THAT(content(folder_ / "run/report.html"), HasSubstr("<svg"));
}

TEST_F(CommandLine, RunOfOneSeedIsTheSameToTheByte) {
    ASSERT_EQ(steadyboom("run case-b --duration-s 1 --seed 7 --out one").exit_code, 0);
    ASSERT_EQ(steadyboom("run case-b --duration-s 1 --seed 7 --out two").exit_code, 0);
    EXPECT_EQ(content(folder_ / "one/ticks.csv"), content(folder_ / "two/ticks.csv"));
    EXPECT_EQ(content(folder_ / "one/can.log"), content(folder_ / "two/can.log"));
    EXPECT_EQ(content(folder_ / "one/report.html"), content(folder_ / "two/report.html"));
}

TEST_F(CommandLine, EveryProgramHasHelpAndVersion) {
    for (const char* program : {STEADYBOOM_COMMAND, STEADYBOOM_CONTROLLER, STEADYBOOM_PLANT}) {
        EXPECT_EQ(run(program, "--help").exit_code, 0) << program;
        const Outcome version = run(program, "--version");
        EXPECT_EQ(version.exit_code, 0) << program;
        EXPECT_THAT(version.out, HasSubstr(STEADYBOOM_VERSION)) << program;
    }
    for (const char* command : {"simulate", "equilibrium", "run"}) {
        EXPECT_EQ(steadyboom(std::string(command) + " --help").exit_code, 0) << command;
    }
}

TEST_F(CommandLine, BadInputEndsWithCodeTwoAndSaysWhatIsAllowed) {
    const std::vector<std::pair<std::string, std::string>> table{
        {"", "subcommand"},
        {"simulate case-a", "--csv"},
        {"simulate case-z --csv x.csv", "case-a, case-b, case-c"},
        {"simulate case-a --csv x.csv --law nosuch", "joint-deflection"},
        {"equilibrium case-a --boom tube", "\"tube\": must be links or beam"},
        {"simulate case-a --csv x.csv --duration-s 0", "(0, 86400] s"},
        {"simulate case-a --csv x.csv --duration-s nan", "(0, 86400] s"},
        {"simulate case-a --csv x.csv --step-s -1", "(0, 0.1] s"},
        {"simulate case-a --csv x.csv --step-s 0.05 --duration-s 0.01", "no longer than the duration"},
        {"simulate case-a --csv x.csv --tolerance 0.1", "[1e-13, 0.01] of the entry"},
        {"simulate case-a --csv x.csv --tolerance 1e-6 --step-s 0.001", "--step-s"},
        {"reproduce --nosuch", "--nosuch"},
        {"run case-a --rate-hz 10", "[50, 2000] Hz"},
        {"run case-a --rate-hz 2000", "70 %"},
        {"run case-a --mismatch soil.shear_modulus_Pa", "KEY=FACTOR"},
        {"run case-a --mismatch nosuch=1.1", "nosuch"},
        {"run case-a --seed -1", "--seed"},
        {"equilibrium", "CASE"},
    };
    for (const auto& [arguments, expected] : table) {
        const Outcome outcome = steadyboom(arguments);
        EXPECT_EQ(outcome.exit_code, 2) << arguments << ": " << outcome.error;
        EXPECT_THAT(outcome.error + outcome.out, HasSubstr(expected)) << arguments;
        EXPECT_FALSE(fs::exists(folder_ / "x.csv")) << arguments;
    }
}

TEST_F(CommandLine, ABadCaseFileIsNamedWithLineKeyAndValue) {
    std::string text = content(steadyboom::hil::find_case("case-a"));
    const std::string good = "load_mass_kg = 13600";
    ASSERT_NE(text.find(good), std::string::npos);
    text.replace(text.find(good), good.size(), "load_mass_kg = -1");
    std::ofstream(folder_ / "bad.toml") << text;
    const Outcome outcome = steadyboom("equilibrium bad.toml");
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.error, testing::ContainsRegex("bad.toml:[0-9]+: crane.load_mass_kg = -1: must be"));
    EXPECT_EQ(lines_of(outcome.error).size(), 1U) << outcome.error;
}

TEST_F(CommandLine, ACraneThatCannotStandIsAnErrorNotANumber) {
    std::string text = content(steadyboom::hil::find_case("case-a"));
    const std::string good = "pendent_stiffness_N_m = 1.59e7";
    ASSERT_NE(text.find(good), std::string::npos);
    text.replace(text.find(good), good.size(), "pendent_stiffness_N_m = 6.57e4");
    std::ofstream(folder_ / "soft.toml") << text;
    const Outcome outcome = steadyboom("equilibrium soft.toml --json");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.error, HasSubstr("cannot stand"));
    EXPECT_EQ(outcome.out, "");
}

TEST_F(CommandLine, AnUnwritableFileFailsAndLeavesNothing) {
    const Outcome outcome = steadyboom("simulate case-a --duration-s 0.01 --csv /proc/nosuch/x.csv");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.error, HasSubstr("/proc/nosuch"));
}

TEST_F(CommandLine, ReproduceSaysBeforeItsRunsThatItCannotWrite) {
    std::ofstream(folder_ / "file") << "no folder";
    for (const char* out : {"/proc/nosuch", "file", "file/below"}) {
        const Outcome outcome = steadyboom(std::string("reproduce --out ") + out);
        EXPECT_EQ(outcome.exit_code, 1) << out;
        EXPECT_THAT(outcome.error, StartsWith(std::string("steadyboom: ") + out + ": cannot be written: "));
        EXPECT_EQ(lines_of(outcome.error).size(), 1U) << outcome.error;
        EXPECT_EQ(outcome.out, "") << out;
    }
    EXPECT_EQ(content(folder_ / "file"), "no folder");
}

TEST_F(CommandLine, ReproduceQuickPrintsEveryRowAsJsonAndItsProgressApart) {
    const Outcome outcome = steadyboom("reproduce --quick --json --out DIR");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto document = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(document.at("rows").size(), document.at("counts").at("rows"));
    EXPECT_EQ(document.at("conditioning").size(), 4U);
    EXPECT_TRUE(document.at("sensitivity").at("variations").empty());
    EXPECT_THAT(outcome.error, HasSubstr("case A, law 2 ..."));
    EXPECT_EQ(content(folder_ / "DIR" / "reproduction.json"), outcome.out);
    EXPECT_THAT(content(folder_ / "DIR" / "reproduction.html"), HasSubstr("</html>"));
}

TEST_F(CommandLine, ARunOnAnInterfaceThatIsNotThereSaysSo) {
    const Outcome outcome = steadyboom("run case-a --bus nosuchcan0 --duration-s 1");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.error, HasSubstr("nosuchcan0"));
}

TEST_F(CommandLine, ControllerAndPlantRefuseABadConfigurationBeforeAnythingElse) {
    std::ofstream(folder_ / "bad.toml") << "crane_file = 7\n";
    for (const char* program : {STEADYBOOM_CONTROLLER, STEADYBOOM_PLANT}) {
        EXPECT_EQ(run(program, "").exit_code, 2) << program;
        const Outcome outcome = run(program, "--config bad.toml");
        EXPECT_EQ(outcome.exit_code, 2) << program;
        EXPECT_THAT(outcome.error, HasSubstr("bad.toml:1")) << program;
    }
}

TEST_F(CommandLine, CanTableListsEveryDeviceAndTheBusLoad) {
    const Outcome text = steadyboom("can-table");
    ASSERT_EQ(text.exit_code, 0) << text.error;
    EXPECT_THAT(text.out, HasSubstr("boom_inclinometer_tpdo1"));
    EXPECT_THAT(text.out, HasSubstr("of 70 % allowed"));
    const Outcome outcome = steadyboom("can-table --json");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json.at("devices").size(), 8U);
    EXPECT_NEAR(json.at("bus_load_nominal").get<double>(), 0.4456, 0.0005);
    EXPECT_GT(json.at("bus_load_worst_case").get<double>(), json.at("bus_load_nominal").get<double>());
    EXPECT_GT(json.at("messages").size(), 20U);
    const auto slower = nlohmann::json::parse(steadyboom("can-table --json --rate-hz 100 --bit-rate-kbit-s 250").out);
    EXPECT_EQ(slower.at("period_ms"), 10.0);
    EXPECT_EQ(slower.at("bit_rate_bit_s"), 250'000);
}

/// The shipped network file with the load pin's node id changed.
std::string network_with_load_pin_at(const std::string& node_id) {
    std::string text = content(STEADYBOOM_NETWORK_FILE);
    const std::string row = "load_pin          = { node_id = 0x18";
    text.replace(text.find(row), row.size(), "load_pin          = { node_id = " + node_id);
    return text;
}

TEST_F(CommandLine, TheNetworkFileDecidesWhatTheTableAndTheDbcSay) {
    std::ofstream(folder_ / "network.toml") << network_with_load_pin_at("0x33");
    const auto json = nlohmann::json::parse(steadyboom("can-table --json --network network.toml").out);
    EXPECT_EQ(json.at("devices").at(3).at("node_id"), 0x33);
    EXPECT_EQ(json.at("devices").at(3).at("protection"), "e2e");
    ASSERT_EQ(steadyboom("dbc --network network.toml --out network.dbc").exit_code, 0);
    EXPECT_EQ(content(folder_ / "network.dbc"), steadyboom("dbc --network network.toml").out);
    EXPECT_TRUE(content(folder_ / "network.dbc").find("BO_ 435 load_pin_tpdo1: 7 load_pin\n") != std::string::npos);

    std::ofstream(folder_ / "bad.toml") << network_with_load_pin_at("200");
    for (const char* command :
         {"can-table", "dbc --out bad.dbc", "bus-monitor network.dbc", "run case-a --out bad.dbc"}) {
        const Outcome outcome = steadyboom(std::string(command) + " --network bad.toml");
        EXPECT_EQ(outcome.exit_code, 2) << command;
        EXPECT_THAT(outcome.error, testing::ContainsRegex("bad.toml:[0-9]+: device.load_pin.node_id = 200")) << command;
        EXPECT_EQ(lines_of(outcome.error).size(), 1U) << outcome.error;
        EXPECT_EQ(outcome.out, "") << command;
    }
    EXPECT_FALSE(fs::exists(folder_ / "bad.dbc"));
}

TEST_F(CommandLine, TheNetworkFileDecidesWhatBothEndsOfARunSpeak) {
    std::ofstream(folder_ / "network.toml") << network_with_load_pin_at("0x33");
    const Outcome outcome = steadyboom("run case-a --duration-s 1 --out run --json --network network.toml");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_EQ(nlohmann::json::parse(outcome.out).at("stayed_engaged"), true);
    const std::string log = content(folder_ / "run/can.log");
    EXPECT_THAT(log, HasSubstr(" 1B3#"));
    EXPECT_THAT(log, testing::Not(HasSubstr(" 198#")));

    // A network that the bus can carry at 200 Hz only.
    const Outcome fast = steadyboom("run case-a --network network.toml --rate-hz 400 --out fast");
    EXPECT_EQ(fast.exit_code, 2);
    EXPECT_THAT(fast.error, HasSubstr("network.toml: CAN load"));
    EXPECT_FALSE(fs::exists(folder_ / "fast"));
    const Outcome missing = steadyboom("run case-a --network nosuch.toml");
    EXPECT_EQ(missing.exit_code, 2);
    EXPECT_THAT(missing.error, HasSubstr("nosuch.toml"));
}

TEST_F(CommandLine, BusMonitorReadsTheLogOfARun) {
    ASSERT_EQ(steadyboom("run case-a --law joint-deflection --duration-s 1 --out run").exit_code, 0);
    const Outcome outcome = steadyboom("bus-monitor run/can.log --json");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_NEAR(json.at("duration_s").get<double>(), 6.0, 0.01);
    EXPECT_EQ(json.at("unknown_id_frames"), 0);
    std::size_t operational = 0;
    for (const auto& device : json.at("devices")) {
        operational += device.at("state") == "operational" ? 1U : 0U;
        for (const auto& message : device.at("messages")) {
            EXPECT_EQ(message.at("wrong_length_frames"), 0) << message.at("name");
            EXPECT_EQ(message.at("out_of_range_values"), 0) << message.at("name");
        }
    }
    EXPECT_EQ(operational, 8U);
    const auto& angle = json.at("devices").at(2).at("messages").at(0);
    EXPECT_NEAR(angle.at("rate_Hz").get<double>(), 200.0, 0.5);
    EXPECT_NEAR(angle.at("values").at("boom_angle").at("value").get<double>(), 59.9, 1.0);

    // No terminal: one table, no colours.
    const Outcome text = steadyboom("bus-monitor run/can.log --duration-s 2");
    EXPECT_THAT(text.out, HasSubstr("run/can.log: 2.0 s"));
    EXPECT_THAT(text.out, HasSubstr("boom_angle 59."));
    EXPECT_EQ(text.out.find('\033'), std::string::npos);
}

TEST_F(CommandLine, BusMonitorNamesLineAndColumnOfWhatItCannotRead) {
    std::ofstream(folder_ / "bad.log") << "(0000000000.000000) can0 080#01\n(0000000000.005000) can0 080#0\n"
                                          "(0000000000.010000) can0 080#03\n";
    const Outcome outcome = steadyboom("bus-monitor bad.log");
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.error, HasSubstr("bad.log:2:31: half a byte"));
    EXPECT_EQ(lines_of(outcome.error).size(), 1U) << outcome.error;
    EXPECT_EQ(outcome.out, "");

    // A log that was cut while it was written is read to there.
    std::ofstream(folder_ / "cut.log") << "(0000000000.000000) can0 080#01\n(0000000000.005000) can0 0";
    const Outcome cut = steadyboom("bus-monitor cut.log --json");
    ASSERT_EQ(cut.exit_code, 0) << cut.error;
    EXPECT_EQ(nlohmann::json::parse(cut.out).at("cut_lines"), 1);

    for (const char* source : {"nosuchcan0", "nosuch/can.log", "."}) {
        const Outcome missing = steadyboom(std::string("bus-monitor ") + source);
        EXPECT_EQ(missing.exit_code, 2) << source;
        EXPECT_THAT(missing.error, HasSubstr("neither a network interface nor a file")) << source;
    }
}

}  // namespace
