// What we write is read by tools that were not written here: canmatrix the DBC file and recorded frames, tshark a log.
#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "drivers/candump_log.hpp"
#include "drivers/emcy.hpp"
#include "drivers/inverted_twin.hpp"
#include "drivers/pdo_codec.hpp"
#include "drivers/sdo_client.hpp"
#include "drivers/sdo_server.hpp"
#include "hil/bus_monitor.hpp"
#include "hil/can_table.hpp"
#include "hil/dbc_file.hpp"
#include "hil/lockstep_run.hpp"
#include "hil/run_folder.hpp"
#include "runtime/network_file.hpp"
#include "tests/hil/sample_networks.hpp"

namespace steadyboom::hil {
namespace {

namespace fs = std::filesystem;
using drivers::CanFrame;
using drivers::DeviceTable;

struct Outcome {
    int exit_code = -1;
    std::string out;
};

class CanTools : public testing::Test {
  protected:
    CanTools() {
        std::string name = (fs::temp_directory_path() / "steadyboom-test.XXXXXX").string();
        folder_ = mkdtemp(name.data());
    }
    ~CanTools() override { fs::remove_all(folder_); }

    Outcome run(const std::string& line) const {
        Outcome outcome;
        FILE* pipe = popen(("cd " + folder_.string() + " && " + line + " 2>&1").c_str(), "r");
        char part[4096];
        for (std::size_t count = 0; (count = fread(part, 1, sizeof part, pipe)) > 0;) {
            outcome.out.append(part, count);
        }
        const int status = pclose(pipe);
        outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
        return outcome;
    }
    void write(const std::string& name, const std::string& content) const {
        std::ofstream(folder_ / name, std::ios::binary) << content;
    }

    fs::path folder_;
};

/// One second of the closed loop, from the first frame on.
const RunResult& recorded_run() {
    static const RunResult run = run_in_lockstep(
        {.crane_case = load_case("case-a"), .law = controllers::LawKind::joint_deflection, .duration_s = 1.0});
    return run;
}

std::string hex(const CanFrame& frame) {
    std::string text;
    for (std::size_t i = 0; i < frame.length; ++i) {
        char byte[3];
        std::snprintf(byte, sizeof byte, "%02x", frame.data[i]);
        text += byte;
    }
    return text;
}

/// What our own codec makes of a frame, as lines for canmatrix_check.py.
void expect_codecs_values(const BusMonitor& monitor, const drivers::MessageRow& row, const CanFrame& frame,
                          std::ostream& out) {
    out.precision(17);
    // The twin's values are those of the command it repeats.
    const bool twin = row.kind == drivers::MessageKind::pdo && row.pdo == drivers::Pdo::valve_twin;
    CanFrame plain = frame;
    if (twin) {
        drivers::invert(plain);
    }
    const auto& fields = monitor.fields(twin ? message_of(drivers::Pdo::valve_command) : row.message);
    for (const auto& field : fields) {
        const auto raw = monitor.raw(field, plain);
        const auto word = word_for(field.words, raw);
        const auto value = static_cast<double>(raw) * field.scale + field.offset;
        out << row.name << ' ' << hex(frame) << ' ' << field.name << (twin ? "_inverted" : "") << ' ' << value << ' '
            << (word.empty() || twin ? std::string_view("-") : word) << '\n';
        if (field.signal != drivers::Signal::none && field.unit.empty() && field.words.empty()) {
            continue;
        }
        // Where the codec decodes it as a value in SI, the field's scale must mean the same.
        if (field.signal != drivers::Signal::none && !field.unit.empty()) {
            const auto& signal = monitor.table().row(field.signal);
            const double si_per_unit = signal.scale_unit / field.scale;
            const double si = static_cast<double>(read_raw(signal, plain)) * signal.scale_unit + signal.offset_unit;
            EXPECT_NEAR(si, value * si_per_unit, 1e-12 * std::max(1.0, std::abs(si))) << field.name;
        }
    }
}

TEST_F(CanTools, CanconvertReadsTheWholeDbc) {
    for (const auto& config : {drivers::NetworkConfig{}, unprotected_network(), foreign_network(), j1939_network()}) {
        const DeviceTable table(config);
        write("network.dbc", dbc_of(table));
        const auto outcome = run("canconvert --jsonExportAll network.dbc network.json");
        ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
        EXPECT_THAT(outcome.out, testing::Not(testing::HasSubstr("ERROR"))) << outcome.out;
        EXPECT_THAT(outcome.out, testing::Not(testing::HasSubstr("WARNING"))) << outcome.out;
        std::ifstream file(folder_ / "network.json");
        const auto json = nlohmann::json::parse(file);
        std::map<std::string, const nlohmann::json*> read;
        for (const auto& message : json.at("messages")) {
            read[message.at("name")] = &message;
        }
        std::size_t present = 0;
        for (const auto& row : table.messages()) {
            if (!row.present) {
                continue;
            }
            ++present;
            ASSERT_TRUE(read.contains(row.name)) << row.name;
            const auto& message = *read.at(row.name);
            EXPECT_EQ(message.at("id"), row.id);
            EXPECT_EQ(message.at("is_extended_frame"), row.extended);
            EXPECT_EQ(message.at("length"), row.length_bytes);
            EXPECT_EQ(message.at("signals").size(), fields_of(table, row.message).size()) << row.name;
        }
        EXPECT_EQ(read.size(), present);
    }
}

TEST_F(CanTools, CanmatrixDecodesFramesToTheSameValuesAsTheCodec) {
    std::mt19937_64 random(404);
    for (const auto& config : {drivers::NetworkConfig{}, unprotected_network(), foreign_network(), j1939_network()}) {
        const BusMonitor monitor{DeviceTable(config)};
        std::ostringstream expected;
        for (const auto& row : monitor.table().messages()) {
            if (!row.present) {
                continue;
            }
            for (int i = 0; i < 40; ++i) {
                auto frame = monitor.table().blank(row.message, 0);
                for (std::size_t j = 0; j < frame.length; ++j) {
                    frame.data[j] = static_cast<std::uint8_t>(i == 0 ? 0x00 : i == 1 ? 0xFF : random());
                }
                expect_codecs_values(monitor, row, frame, expected);
            }
        }
        write("network.dbc", dbc_of(monitor.table()));
        write("expected", expected.str());
        const auto outcome = run(STEADYBOOM_CANMATRIX_CHECK " network.dbc expected");
        EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
        EXPECT_THAT(outcome.out, testing::ContainsRegex("compared [1-9][0-9]{3}"));
    }
}

TEST_F(CanTools, CanmatrixDecodesARecordedRunToTheSameValuesAsTheCodec) {
    const BusMonitor monitor{DeviceTable(drivers::NetworkConfig{})};
    std::ostringstream expected;
    for (const auto& frame : recorded_run().frames) {
        const auto message = monitor.table().message_with(frame.id);
        ASSERT_NE(message, drivers::Message::none) << frame.id;
        expect_codecs_values(monitor, monitor.table().row(message), frame, expected);
    }
    write("network.dbc", dbc_of(monitor.table()));
    write("expected", expected.str());
    const auto outcome = run(STEADYBOOM_CANMATRIX_CHECK " network.dbc expected");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
    EXPECT_THAT(outcome.out, testing::ContainsRegex("compared [1-9][0-9]{4}"));
}

/// Rows of tshark's fields, one a frame, cells separated by tabs.
std::vector<std::vector<std::string>> rows_of(const std::string& text) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        std::vector<std::string> cells(1);
        for (const char character : line) {
            if (character == '\t') {
                cells.emplace_back();
            } else {
                cells.back() += character;
            }
        }
        rows.push_back(std::move(cells));
    }
    return rows;
}

std::string tshark(const std::string& log, const std::string& fields) {
    return "{ HOME=$PWD tshark -r " + log + " -d can.subdissector,canopen -T fields " + fields + " 2>tshark.error; }";
}

std::string number(const std::string& text) {
    return text.empty() ? "" : std::to_string(std::stoul(text, nullptr, 0));
}

TEST_F(CanTools, TsharkDecodesSyncNmtHeartbeatPdosAndSdoOfARecordedRun) {
    write("can.log", can_log(recorded_run().frames, "loopback"));
    const auto outcome = run(tshark("can.log",
                                    "-e canopen.cob_id -e canopen.nmt_ctrl.cd -e canopen.nmt_ctrl.node_id "
                                    "-e canopen.nmt_guard.state -e canopen.sync.counter -e canopen.pdo.data.bytes "
                                    "-e _ws.malformed -e canopen.sdo.main_idx -e canopen.sdo.sub_idx"));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
    const auto rows = rows_of(outcome.out);
    const auto& frames = recorded_run().frames;
    ASSERT_EQ(rows.size(), frames.size());
    const DeviceTable table{drivers::NetworkConfig{}};
    std::map<drivers::MessageKind, int> seen;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto& row = rows[i];
        const auto& frame = frames[i];
        ASSERT_EQ(row.size(), 9U);
        ASSERT_EQ(number(row[0]), std::to_string(frame.id));
        ASSERT_EQ(row[6], "") << i;
        const auto kind = table.row(table.message_with(frame.id)).kind;
        ++seen[kind];
        switch (kind) {
            case drivers::MessageKind::nmt:
                ASSERT_EQ(number(row[1]), std::to_string(frame.data[0]));
                ASSERT_EQ(number(row[2]), std::to_string(frame.data[1]));
                break;
            case drivers::MessageKind::heartbeat:
                ASSERT_EQ(number(row[3]), std::to_string(frame.data[0]));
                break;
            case drivers::MessageKind::sync:
                ASSERT_EQ(number(row[4]), std::to_string(frame.data[0]));
                break;
            case drivers::MessageKind::pdo:
                ASSERT_EQ(row[5], hex(frame));
                break;
            case drivers::MessageKind::sdo_request:
            case drivers::MessageKind::sdo_answer:
                ASSERT_EQ(number(row[7]), std::to_string(frame.data[1] + 256 * frame.data[2]));
                ASSERT_EQ(number(row[8]), std::to_string(frame.data[3]));
                break;
            default:
                break;
        }
    }
    EXPECT_GE(seen[drivers::MessageKind::nmt], 1);
    EXPECT_GT(seen[drivers::MessageKind::sdo_request], 10);
    EXPECT_EQ(seen[drivers::MessageKind::sdo_answer], seen[drivers::MessageKind::sdo_request]);
    EXPECT_GT(seen[drivers::MessageKind::sync], 1000);
    EXPECT_GT(seen[drivers::MessageKind::heartbeat], 400);
    EXPECT_GT(seen[drivers::MessageKind::pdo], 10'000);
}

TEST_F(CanTools, TsharkDecodesSdoTransfersAndEmergencies) {
    std::vector<CanFrame> frames;
    std::array<drivers::ObjectEntry, 2> dictionary = {{
        {.object = {0x1018, 1}, .size_bytes = 4, .value_raw = 0x0000'0195},
        {.object = {0x1017, 0}, .size_bytes = 2, .access = drivers::ObjectAccess::read_write, .highest_raw = 0xFFFF},
    }};
    drivers::SdoServer server(0x14, dictionary);
    drivers::SdoClient client;
    const auto transfer = [&] {
        const auto request = client.poll(0);
        ASSERT_TRUE(request.has_value());
        frames.push_back(*request);
        const auto answer = server.answer(*request, 0);
        ASSERT_TRUE(answer.has_value());
        frames.push_back(*answer);
        client.receive(*answer);
    };
    ASSERT_TRUE(client.upload(0x14, {0x1018, 1}));
    transfer();
    ASSERT_TRUE(client.download(0x14, {0x1017, 0}, 100, 2));
    transfer();
    ASSERT_TRUE(client.upload(0x14, {0x2345, 6}));
    transfer();
    frames.push_back(drivers::emergency_frame(
        {.node = 0x14, .code = drivers::emergency_heartbeat, .error_register = 0x11, .vendor = {1, 2, 3, 4, 5}}, 0));
    write("can.log", can_log(frames, "loopback"));

    const auto outcome = run(tshark("can.log",
                                    "-e canopen.node_id -e canopen.sdo.cmd -e canopen.sdo.main_idx "
                                    "-e canopen.sdo.sub_idx -e canopen.sdo.data.bytes -e canopen.sdo.abort_code "
                                    "-e canopen.em.err_code -e canopen.em.err_reg -e canopen.em.err_field "
                                    "-e _ws.malformed"));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
    const auto rows = rows_of(outcome.out);
    ASSERT_EQ(rows.size(), 7U);
    const std::vector<std::vector<std::string>> expected = {
        {"0x40", "0x1018", "0x01", "", ""},         {"0x43", "0x1018", "0x01", "95010000", ""},
        {"0x2b", "0x1017", "0x00", "64000000", ""}, {"0x60", "0x1017", "0x00", "", ""},
        {"0x40", "0x2345", "0x06", "", ""},         {"0x80", "0x2345", "0x06", "", "0x06020000"},
    };
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(number(rows[i][0]), "20") << i;
        EXPECT_EQ(rows[i][9], "") << i;
        for (std::size_t j = 0; i < expected.size() && j < expected[i].size(); ++j) {
            EXPECT_EQ(rows[i][1 + j], expected[i][j]) << i << ' ' << j;
        }
    }
    EXPECT_EQ(rows[6][6], "0x8130");
    EXPECT_EQ(rows[6][7], "0x11");
    EXPECT_EQ(rows[6][8], "0102030405");
}

TEST_F(CanTools, TsharkDecodesTheEmergencyOfARecordedRun) {
    LockstepBench bench({.crane_case = load_case("case-a"), .duration_s = 0.1});
    for (int tick = 0; !bench.finished(); ++tick) {
        bench.step();
        if (tick == 400) {
            const CanFrame cut_short{.id = 0x220, .length = 3};
            bench.crane().receive({&cut_short, 1}, std::llround(1e9 * (bench.next_t_s() + RunResult::standing_s)));
        }
    }
    write("can.log", can_log(bench.take_result().frames, "loopback"));
    const auto outcome = run(tshark("can.log",
                                    "-Y canopen.em.err_code -e canopen.node_id -e canopen.em.err_code "
                                    "-e canopen.em.err_reg -e _ws.malformed"));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
    const auto rows = rows_of(outcome.out);
    ASSERT_EQ(rows.size(), 2U) << outcome.out;
    EXPECT_EQ(number(rows[0][0]), "32");
    EXPECT_EQ(rows[0][1], "0x8210");
    EXPECT_EQ(number(rows[1][0]), "32");
    EXPECT_EQ(rows[1][1], "0x0000");
    EXPECT_EQ(rows[0][3] + rows[1][3], "");
}

/// Text of a file in the repository.
std::string content(const std::string& path) {
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// Runs of spaces as one: how wide a table's columns are is not what a page shows it for.
std::string squeezed(const std::string& text) {
    std::string result;
    for (const char character : text) {
        if (character != ' ' || !result.ends_with(' ')) {
            result += character;
        }
    }
    return result;
}

TEST_F(CanTools, TheRowsOfThePageJoinADeviceLoadAndMeanWhatItSays) {
    const auto page = content(STEADYBOOM_JOIN_A_DEVICE);
    const std::string fence = "```toml\n";
    const auto begin = page.find(fence);
    ASSERT_NE(begin, std::string::npos);
    const auto end = page.find("```\n", begin + fence.size());
    ASSERT_NE(end, std::string::npos);
    write("network.toml", page.substr(begin + fence.size(), end - begin - fence.size()));
    const auto config = runtime::load_network_file(folder_ / "network.toml", {});
    const auto& device = config[drivers::Device::boom_inclinometer];
    EXPECT_EQ(device.protection, drivers::Protection::none);
    EXPECT_EQ(device.vendor_id, 0x195U);
    // The frame of the page's device: 59.84 deg in steps of 0.01, and the second axis behind it.
    const DeviceTable table(config);
    auto frame = table.blank(message_of(drivers::Pdo::boom_angle), 0);
    EXPECT_EQ(frame.id, 0x194U);
    ASSERT_EQ(frame.length, 4);
    frame.data = {0x60, 0x17};
    EXPECT_NEAR(*decode_value(table.row(drivers::Signal::boom_angle), frame), 59.84 * M_PI / 180.0, 1e-12);
    // Lines that the page shows of the table are the table's.
    const auto text = squeezed(can_table_text(table));
    int shown = 0;
    std::istringstream lines(page);
    for (std::string line; std::getline(lines, line);) {
        line = squeezed(line);
        if (line.starts_with(" 0x14 boom_inclinometer CiA 410") ||
            line.starts_with(" 194 boom_inclinometer_tpdo1 boom_angle b") ||
            line.starts_with(" boom_inclinometer_tpdo1 boom_angle")) {
            ++shown;
            EXPECT_NE(text.find('\n' + line.substr(1) + '\n'), std::string::npos) << line;
        }
    }
    EXPECT_EQ(shown, 3);
}

}  // namespace
}  // namespace steadyboom::hil
