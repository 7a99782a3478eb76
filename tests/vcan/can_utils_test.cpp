// Tools of can-utils, which were not written here, on a real bus with the controller's side of the network: cansend
// plays a device that was bought, canplayer replays what it recorded; bus-monitor watches.
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "drivers/candump_log.hpp"
#include "drivers/crane_network.hpp"
#include "drivers/device_network.hpp"
#include "drivers/socketcan_bus.hpp"
#include "tests/runtime/child_process.hpp"
#include "tests/vcan/interfaces.hpp"

namespace {

namespace fs = std::filesystem;
using namespace steadyboom;
using drivers::CanFrame;
using drivers::Device;
using drivers::Pdo;
using drivers::ReceiverState;
using drivers::Signal;
using runtime::ChildProcess;
using test_support::await;
using test_support::eventually;

constexpr std::int64_t tick_ns = 5'000'000;

/// An inclinometer as catalogues have them: 16 bits of 0.01 deg, node id 10, neither counter nor checksum.
drivers::NetworkConfig with_bought_inclinometer() {
    drivers::NetworkConfig config;
    auto& device = config[Device::boom_inclinometer];
    device.node_id = 0x0A;
    device.protection = drivers::Protection::none;
    device.configure = false;
    device.device_type = 0;
    auto& angle = config[Signal::boom_angle];
    angle.object = 0x6010;
    angle.type = drivers::RawType::i16;
    angle.scale = 0.01;
    config[Pdo::boom_angle].length_bytes = 4;
    return config;
}

class CanUtils : public testing::Test {
  protected:
    CanUtils() {
        std::string name = (fs::temp_directory_path() / "steadyboom-test.XXXXXX").string();
        folder_ = mkdtemp(name.data());
    }
    ~CanUtils() override { fs::remove_all(folder_); }

    static int cansend(const std::string& frame) { return ChildProcess({"cansend", "vcan0", frame}).wait(); }

    nlohmann::json monitored(ChildProcess& monitor) const {
        monitor.signal(SIGINT);
        EXPECT_EQ(monitor.wait(), 0) << content("monitor.json");
        return nlohmann::json::parse(content("monitor.json"));
    }
    std::string content(const std::string& name) const {
        std::ifstream file(folder_ / name);
        std::ostringstream text;
        text << file.rdbuf();
        return text.str();
    }

    fs::path folder_;
};

const nlohmann::json& message_named(const nlohmann::json& monitor, const std::string& name) {
    for (const auto& device : monitor.at("devices")) {
        for (const auto& message : device.at("messages")) {
            if (message.at("name") == name) {
                return message;
            }
        }
    }
    throw std::out_of_range(name);
}

TEST_F(CanUtils, AHandMadeInclinometerJoinsByCansend) {
    const auto config = with_bought_inclinometer();
    drivers::CraneNetwork network(config);
    drivers::SocketCanBus bus("vcan0", {.filters = network.filters()});
    drivers::CommandGuard guard({.max_opening_m = 7.6e-3, .max_step_m = 1e-3});
    std::array<CanFrame, 64> frames;
    std::int64_t now_ns = 0;
    bool asked_who_it_is = false;
    bool told_to_start = false;
    /// One tick of the controller; what cansend sent before it is there.
    const auto tick = [&](std::size_t expected_frames) {
        const auto count = await(bus, frames, expected_frames);
        const auto measurement = network.decode({frames.data(), count}, now_ns);
        const auto out = network.encode(guard.neutral(), now_ns);
        asked_who_it_is = told_to_start = false;
        for (const auto& frame : out) {
            asked_who_it_is |= frame.id == 0x60A && frame.data[0] == 0x40 && frame.data[2] == 0x10;
            told_to_start |= frame.id == 0x000 && frame.data[0] == 0x01 && frame.data[1] == 0x0A;
        }
        EXPECT_EQ(bus.send(out).dropped, 0U);
        now_ns += tick_ns;
        return measurement;
    };
    ASSERT_EQ(cansend("70A#00"), 0);
    tick(1);
    EXPECT_EQ(network.node(Device::boom_inclinometer).boot_ups, 1U);
    // The manager asks one device after the other; the silent ones take it a while.
    bool started = false;
    for (int i = 0; i < 5000 && !started; ++i) {
        tick(0);
        if (asked_who_it_is) {
            ASSERT_EQ(cansend("58A#430010009A010000"), 0);  // 1000h: 410
            tick(1);
        }
        if (told_to_start) {
            ASSERT_EQ(cansend("70A#05"), 0);
            tick(1);
            started = true;
        }
    }
    ASSERT_TRUE(started);
    EXPECT_EQ(network.node(Device::boom_inclinometer).managed, drivers::DeviceState::operational);

    ASSERT_EQ(cansend("18A#61170000"), 0);  // 0x1761 = 5985: 59.85 deg
    auto measurement = tick(1);
    EXPECT_TRUE(measurement.valid[plant::boom_angle_rad]);
    EXPECT_EQ(measurement.age_ticks[plant::boom_angle_rad], 0U);
    EXPECT_NEAR(measurement.value[plant::boom_angle_rad], 59.85 * M_PI / 180.0, 1e-9);

    measurement = tick(0);
    EXPECT_EQ(measurement.age_ticks[plant::boom_angle_rad], 1U);
    // What a device sends that has another mapping than its rows say is not taken for a value.
    ASSERT_EQ(cansend("18A#6117"), 0);
    measurement = tick(1);
    EXPECT_EQ(network.status().wrong_length_frames, 1U);
    EXPECT_EQ(measurement.age_ticks[plant::boom_angle_rad], 2U);
}

/// The virtual crane's devices, protected, in this process on the bus; the controller's side too.
class LiveNetwork {
  public:
    explicit LiveNetwork(const drivers::NetworkConfig& config)
        : controller_(config),
          devices_(config),
          controller_bus_("vcan0", {.filters = controller_.filters()}),
          devices_bus_("vcan0", {.filters = devices_.filters()}) {}

    /// One tick at its time: devices listen and answer, the controller decodes.
    void tick(bool devices_answer = true) {
        usleep(tick_ns / 1000);
        controller_bus_.send(controller_.encode(guard_.neutral(), now_ns_));
        auto count = devices_bus_.receive(frames_);
        devices_.receive({frames_.data(), count}, now_ns_);
        if (devices_answer) {
            devices_bus_.send(devices_.housekeeping(now_ns_));
            devices_bus_.send(devices_.answer_sync(plant::SensorVector::Zero(), {}, now_ns_));
        }
        count = controller_bus_.receive(frames_);
        static_cast<void>(controller_.decode({frames_.data(), count}, now_ns_));
        now_ns_ += tick_ns;
    }
    [[nodiscard]] bool all(ReceiverState state) const {
        for (const auto pdo : {Pdo::strain, Pdo::boom_angle, Pdo::load_pin, Pdo::drum, Pdo::valve_status}) {
            if (controller_.state(pdo) != state) {
                return false;
            }
        }
        return true;
    }
    drivers::CraneNetwork& controller() { return controller_; }

  private:
    drivers::CraneNetwork controller_;
    drivers::DeviceNetwork devices_;
    drivers::SocketCanBus controller_bus_;
    drivers::SocketCanBus devices_bus_;
    drivers::CommandGuard guard_{{.max_opening_m = 7.6e-3, .max_step_m = 1e-3}};
    std::array<CanFrame, drivers::most_frames_a_tick> frames_;
    std::int64_t now_ns_ = 0;
};

TEST_F(CanUtils, AReplayBesideTheLiveDevicesIsNoticedAndOneThatKeepsTheirRhythmInTheirPlaceIsNot) {
    LiveNetwork live({});  // all protected
    const fs::path log = folder_ / "devices.log";
    ASSERT_TRUE(eventually([&] {
        live.tick();
        return live.all(ReceiverState::valid);
    }));
    {
        ChildProcess candump({"candump", "-L", "vcan0"}, folder_ / "candump.log");
        for (int i = 0; i < 600; ++i) {
            live.tick();
        }
        candump.signal(SIGINT);
        candump.wait();
    }
    // Only what devices sent is replayed: TPDOs and heartbeats.
    std::vector<CanFrame> replayed;
    {
        std::ifstream recorded(folder_ / "candump.log");
        std::ofstream replay(log);
        for (std::string line; std::getline(recorded, line);) {
            const auto entry = drivers::read_candump_line(line);
            ASSERT_EQ(entry.kind, drivers::CandumpKind::frame) << line;
            const auto message = live.controller().table().message_with(entry.frame.id);
            ASSERT_NE(message, drivers::Message::none) << line;
            const auto& row = live.controller().table().row(message);
            if (!row.from_controller && row.cycle != drivers::Cycle::on_demand) {
                replay << line << '\n';
                replayed.push_back(entry.frame);
            }
        }
        ASSERT_GT(replayed.size(), 2000U);
    }
    ASSERT_TRUE(live.all(ReceiverState::valid));

    {
        ChildProcess monitor({STEADYBOOM_COMMAND, "bus-monitor", "vcan0", "--json"}, folder_ / "monitor.json");
        for (int i = 0; i < 200; ++i) {
            live.tick();  // until the monitor listens
        }
        ChildProcess canplayer({"canplayer", "-I", log, "-l", "i"}, folder_ / "canplayer.log");
        EXPECT_TRUE(eventually([&] {
            live.tick();
            return live.all(ReceiverState::invalid);
        }));
        canplayer.signal(SIGKILL);
        canplayer.wait();
        const auto seen = monitored(monitor);
        const auto& protection = message_named(seen, "strain_link_tpdo1").at("protection");
        EXPECT_GT(protection.at("repeated_frames").get<int>() + protection.at("wrong_sequence_frames").get<int>(), 0);
        EXPECT_EQ(protection.at("wrong_checksum_frames"), 0);
    }
    EXPECT_GT(live.controller().status().rejected_frames, 0U);
    EXPECT_TRUE(eventually([&] {
        live.tick();
        return live.all(ReceiverState::valid);
    }));

    // No live device. By counter and checksum canplayer's frames are all good; the receiver has only their uneven
    // rhythm and the place where the recording begins anew to go by.
    const auto& receiver = *live.controller().receiver(Pdo::strain);
    const auto before = receiver.status();
    {
        ChildProcess canplayer({"canplayer", "-I", log, "-l", "i"}, folder_ / "canplayer.log");
        ASSERT_TRUE(eventually([&] {
            live.tick(false);
            return receiver.status().good_frames > before.good_frames + 1000;
        }));
    }
    EXPECT_EQ(receiver.status().wrong_checksum_frames, before.wrong_checksum_frames);
    // A replay that keeps the rhythm is believed: no receiver can tell it from the devices.
    drivers::SocketCanBus replayer("vcan0");
    std::size_t next = 0;
    for (int tick = 0; tick < 400 && next < replayed.size(); ++tick) {
        const auto begin = next++;
        while (next < replayed.size() && replayed[next].id != 0x190) {
            ++next;
        }
        replayer.send(std::span(replayed).subspan(begin, next - begin));
        live.tick(false);
    }
    EXPECT_GT(next, replayed.size() / 2);
    EXPECT_TRUE(live.all(ReceiverState::valid));
}

TEST_F(CanUtils, BusMonitorDecodesWhatCansendSends) {
    ChildProcess monitor({STEADYBOOM_COMMAND, "bus-monitor", "vcan0", "--json"}, folder_ / "monitor.json");
    // Until it listens nobody knows; so the last of many is what counts.
    for (int i = 0; i < 50; ++i) {
        ASSERT_EQ(cansend("71C#05"), 0);
        usleep(20'000);
    }
    ASSERT_EQ(cansend("09C#3081110102030405"), 0);
    ASSERT_EQ(cansend("123#AA"), 0);
    ASSERT_EQ(cansend("19C#00"), 0);
    ASSERT_EQ(cansend("19C#R"), 0);
    usleep(200'000);
    const auto seen = monitored(monitor);
    const auto& drum = seen.at("devices").at(5);
    EXPECT_EQ(drum.at("state"), "operational");
    EXPECT_EQ(drum.at("emergencies"), 1);
    EXPECT_EQ(drum.at("last_emergency").at("code"), 0x8130);
    EXPECT_EQ(message_named(seen, "drum_encoder_tpdo1").at("wrong_length_frames"), 1);
    EXPECT_EQ(seen.at("unknown_id_frames"), 1);
    EXPECT_EQ(seen.at("remote_frames"), 1);
}

TEST_F(CanUtils, BusMonitorSaysThatItsInterfaceIsGone) {
    test_support::run("ip link add vcan7 type vcan && ip link set vcan7 up");
    ChildProcess monitor({STEADYBOOM_COMMAND, "bus-monitor", "vcan7", "--duration-s", "2"}, folder_ / "monitor.txt");
    usleep(500'000);
    test_support::run("ip link del vcan7");
    EXPECT_EQ(monitor.wait(), 1);
    EXPECT_THAT(content("monitor.txt"), testing::HasSubstr("CAN interface 'vcan7' is gone"));
}

/// What follows `fence` in the page, to the next fence.
std::string block(const std::string& page, const std::string& fence) {
    const auto begin = page.find(fence);
    if (begin == std::string::npos) {
        throw std::runtime_error("the page has no block " + fence);
    }
    const auto end = page.find("```\n", begin + fence.size());
    return page.substr(begin + fence.size(), end - begin - fence.size());
}

TEST_F(CanUtils, ThePageJoinADeviceIsRightOfADeviceMadeByHand) {
    const auto text_of = [](const std::string& path) {
        std::ifstream file(path);
        std::ostringstream text;
        text << file.rdbuf();
        return text.str();
    };
    const auto write = [this](const std::string& name, const std::string& text) {
        std::ofstream(folder_ / name) << text;
    };
    // Step 2: its rows.
    write("network.toml", block(text_of(STEADYBOOM_JOIN_A_DEVICE), "```toml\n"));
    write("crane.toml", text_of(STEADYBOOM_CASE_A));
    std::string config = text_of(STEADYBOOM_CONTROLLER_CONFIG);
    const auto replace = [&config](const std::string& from, const std::string& to) {
        ASSERT_NE(config.find(from), std::string::npos) << from;
        config.replace(config.find(from), from.size(), to);
    };
    replace("network_file = \"\"", "network_file = \"network.toml\"");
    replace("interface = \"can0\"", "interface = \"vcan0\"");
    replace("/run/steadyboom-can/can0/link.sock", "");
    replace("/run/steadyboom/command.sock", folder_ / "command.sock");
    replace("/run/steadyboom/ticks.ring", folder_ / "ticks.ring");
    replace("required = true", "required = false");
    write("controller.toml", config);

    // Step 3: alone on the bus it boots and answers what the page asks.
    drivers::SocketCanBus watcher("vcan0", {.receive_buffer_frames = 4096});
    std::array<CanFrame, 512> frames;
    std::string log;
    /// Until so many frames of this identifier went by, or there is little hope.
    const auto seen_on_bus = [&](std::uint32_t id, std::size_t times) {
        std::size_t count = 0;
        return eventually([&] {
            const auto received = watcher.receive(frames);
            for (std::size_t i = 0; i < received; ++i) {
                count += frames[i].id == id ? 1U : 0U;
                log += std::string(drivers::candump_line(frames[i], "vcan0").view()) + '\n';
            }
            return count >= times;
        });
    };
    ChildProcess inclinometer({STEADYBOOM_INCLINOMETER, "vcan0"}, folder_ / "inclinometer.log");
    ASSERT_TRUE(seen_on_bus(0x714, 1)) << content("inclinometer.log");
    ASSERT_EQ(cansend("614#4000100000000000"), 0);
    ASSERT_EQ(cansend("614#4000600000000000"), 0);
    ASSERT_EQ(cansend("614#2B17100064000000"), 0);
    ASSERT_TRUE(seen_on_bus(0x714, 3));
    EXPECT_THAT(log, testing::HasSubstr(" vcan0 714#00\n")) << content("inclinometer.log");
    EXPECT_THAT(log, testing::HasSubstr(" vcan0 594#430010009A010000\n"));
    EXPECT_THAT(log, testing::HasSubstr(" vcan0 594#4B0060000A000000\n"));
    EXPECT_THAT(log, testing::HasSubstr(" vcan0 594#6017100000000000\n"));
    EXPECT_THAT(log, testing::HasSubstr(" vcan0 714#7F\n"));

    // Step 4: what the controller will believe.
    ChildProcess table({STEADYBOOM_COMMAND, "can-table", "--network", folder_ / "network.toml"}, folder_ / "table.txt");
    EXPECT_EQ(table.wait(), 0) << content("table.txt");

    // Step 5: on the bus; the controller starts it.
    ChildProcess controller({STEADYBOOM_CONTROLLER, "--config", folder_ / "controller.toml"},
                            folder_ / "controller.log");
    ASSERT_TRUE(seen_on_bus(0x194, 50)) << content("controller.log");
    ChildProcess monitor({STEADYBOOM_COMMAND, "bus-monitor", "vcan0", "--network", folder_ / "network.toml", "--json",
                          "--duration-s", "2"},
                         folder_ / "monitor.json");
    EXPECT_EQ(monitor.wait(), 0) << content("monitor.json");
    controller.signal(SIGTERM);
    EXPECT_EQ(controller.wait(), 0) << content("controller.log");
    const auto seen = nlohmann::json::parse(content("monitor.json"));
    const auto& angle = message_named(seen, "boom_inclinometer_tpdo1");
    EXPECT_GT(angle.at("frames"), 100);
    EXPECT_EQ(angle.at("wrong_length_frames"), 0);
    EXPECT_EQ(angle.at("out_of_range_values"), 0);
    EXPECT_NEAR(angle.at("values").at("boom_angle").at("value").get<double>(), 59.84, 1e-9);
    EXPECT_EQ(seen.at("devices").at(2).at("state"), "operational") << content("controller.log");
}

}  // namespace
