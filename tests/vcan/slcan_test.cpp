// What a vcan cannot show: bit rate, error states, bus-off and its recovery, a full send queue, an adapter unplugged,
// on an interface that is a CAN device to the kernel.
#include <libsocketcan.h>
#include <linux/can/error.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "controllers/interlock.hpp"
#include "drivers/crane_network.hpp"
#include "drivers/socketcan_bus.hpp"
#include "runtime/can_link/can_link.hpp"
#include "runtime/controller_config.hpp"
#include "runtime/operator_client.hpp"
#include "tests/runtime/child_process.hpp"
#include "tests/vcan/interfaces.hpp"
#include "tests/vcan/slcan_adapter.hpp"

namespace steadyboom {
namespace {

namespace fs = std::filesystem;
using drivers::BusError;
using drivers::CanFrame;
using drivers::LinkState;
using drivers::SocketCanBus;
using runtime::LinkCondition;
using test_support::await;
using test_support::eventually;
using test_support::run;
using testing::HasSubstr;

class Slcan : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_EQ(can_set_bitrate(name().c_str(), 500'000), 0);
        run("ip link set " + name() + " txqueuelen " + std::to_string(drivers::CraneNetwork::most_frames) + " up");
        ASSERT_TRUE(eventually([&] { return adapter.count("O") == 1; }));
    }

    [[nodiscard]] const std::string& name() const { return adapter.interface(); }

    runtime::LinkReport link() { return can_link_.read(); }

    std::string link_in_words(const runtime::LinkSetUp& wanted) {
        runtime::CanLink other(name(), wanted);
        return other.in_words(other.read());
    }

    test_support::SlcanAdapter adapter;
    std::array<CanFrame, 512> frames;

  private:
    runtime::CanLink can_link_{name(), {.bit_rate_bit_s = 500'000, .queue_frames = drivers::CraneNetwork::most_frames}};
};

TEST_F(Slcan, BitRateSetByLibsocketcanReachesTheAdapterAndIsReadBack) {
    EXPECT_THAT(adapter.lines(), testing::IsSupersetOf({"C", "S6", "O"}));
    const auto report = link();
    EXPECT_EQ(report.bit_rate_bit_s, 500'000U);
    EXPECT_EQ(report.condition, LinkCondition::active);
    EXPECT_EQ(report.queue_frames, drivers::CraneNetwork::most_frames);
    EXPECT_EQ(report.problems, runtime::link_problem_none) << link_in_words({});
    EXPECT_FALSE(report.virtual_bus);
}

TEST_F(Slcan, WhatDiffersFromTheConfigurationIsNamedWithTheCommandThatHelps) {
    EXPECT_THAT(link_in_words({.bit_rate_bit_s = 250'000, .queue_frames = drivers::CraneNetwork::most_frames}),
                HasSubstr("type can bitrate 250000"));
    EXPECT_THAT(link_in_words({.bit_rate_bit_s = 500'000, .queue_frames = 7}), HasSubstr("txqueuelen 7"));
    EXPECT_EQ(runtime::CanLink("steady9", {}).read().condition, LinkCondition::absent);
    run("ip link set " + name() + " down");
    EXPECT_EQ(link().condition, LinkCondition::stopped);
}

TEST_F(Slcan, FramesPassBothWaysAndThisMachinesOwnAreASpoof) {
    SocketCanBus bus(name(), {.filters = {{0x190}}});
    EXPECT_TRUE(bus.expects_remote()) << "a real interface";
    ASSERT_EQ(bus.send(std::array{CanFrame{.id = 0x220, .length = 2, .data = {0xAA, 0xBB}}}).sent, 1U);
    EXPECT_TRUE(eventually([&] { return adapter.count("t2202AABB") == 1; }));
    adapter.say("t1903010203");
    ASSERT_EQ(await(bus, frames, 1), 1U);
    EXPECT_EQ(frames[0].data[2], 3);
    run("cansend " + name() + " 190#04");
    EXPECT_TRUE(eventually([&] {
        EXPECT_EQ(bus.receive(frames), 0U);
        return bus.status().spoofed_frames == 1;
    }));
}

TEST_F(Slcan, ErrorStatesOfTheControllerAreValuesToTheSocketAndToTheDaemon) {
    SocketCanBus bus(name(), {.filters = {{0x190}}});
    const struct {
        const char* line;
        LinkState state;
        LinkCondition condition;
        int transmit;
        int receive;
    } rows[] = {
        {"sw100096", LinkState::warning, LinkCondition::warning, 96, 100},
        {"sp130130", LinkState::passive, LinkCondition::passive, 130, 130},
        {"sw110090", LinkState::warning, LinkCondition::warning, 90, 110},
        {"sa000000", LinkState::active, LinkCondition::active, 0, 0},
    };
    for (const auto& row : rows) {
        adapter.say(row.line);
        ASSERT_EQ(await(bus, frames, 1), 1U) << row.line;
        EXPECT_EQ(bus.status().link, row.state) << row.line;
        EXPECT_EQ(bus.status().transmit_error_count, row.transmit) << row.line;
        EXPECT_EQ(bus.status().receive_error_count, row.receive) << row.line;
        EXPECT_EQ(link().condition, row.condition) << row.line;
    }
    adapter.say("e1o");
    ASSERT_EQ(await(bus, frames, 1), 1U);
    EXPECT_EQ(bus.status().controller_overruns, 1U);
    adapter.say("e1a");
    ASSERT_EQ(await(bus, frames, 1), 1U);
    EXPECT_EQ(bus.status().error_frames, 6U);
    EXPECT_EQ(bus.status().link, LinkState::active) << "no acknowledgement is no state";
}

TEST_F(Slcan, SendsSeemToSucceedInBusOffAndARestartTakesTheLinkDownAndUp) {
    SocketCanBus bus(name(), {.filters = {{0x190}}});
    adapter.say("sb000256");
    ASSERT_EQ(await(bus, frames, 1), 1U);
    EXPECT_EQ(bus.status().link, LinkState::bus_off);
    EXPECT_EQ(link().condition, LinkCondition::bus_off);
    EXPECT_EQ(bus.send(std::array{CanFrame{.id = 0x220, .length = 1}}).error, BusError::none)
        << "which is why the error message counts and not the send";
    EXPECT_NE(std::system(("ip link set " + name() + " type can restart 2>/dev/null").c_str()), 0)
        << "the driver has no restart of its own";

    ASSERT_TRUE(runtime::CanLink(name(), {}).restart());
    EXPECT_TRUE(eventually([&] { return adapter.count("O") == 2; }));
    EXPECT_EQ(adapter.count("t2201"), 0) << "nothing of what was sent meanwhile";
    EXPECT_EQ(link().condition, LinkCondition::active);
    (void)bus.receive(frames);  // takes the ENETDOWN that waits
    EXPECT_EQ(bus.status().link, LinkState::active);
    adapter.say("t1901AA");
    ASSERT_EQ(await(bus, frames, 1), 1U);
    EXPECT_EQ(bus.status().receive_error, BusError::none);
}

TEST_F(Slcan, AdapterThatTakesNothingShowsAsAFullQueueWithinAFewFrames) {
    SocketCanBus bus(name());
    adapter.stop_reading();
    std::size_t sent = 0;
    BusError error = BusError::none;
    for (int tick = 0; tick < 2000 && error == BusError::none; ++tick) {
        const auto result = bus.send(std::array{CanFrame{.id = 0x220, .length = 8}});
        sent += result.sent;
        error = result.error;
    }
    EXPECT_EQ(error, BusError::no_room) << "after " << sent;
    EXPECT_EQ(bus.status().last_errno, ENOBUFS);
}

TEST_F(Slcan, UnpluggedAdapterIsGone) {
    SocketCanBus bus(name());
    adapter.unplug();
    EXPECT_TRUE(eventually([&] {
        (void)bus.receive(frames);
        return bus.status().receive_error == BusError::gone;
    }));
    EXPECT_EQ(bus.send(std::array{CanFrame{.id = 0x220}}).error, BusError::gone);
    EXPECT_EQ(link().condition, LinkCondition::absent);
}

TEST_F(Slcan, ControllerAndDaemonBringTheLinkBackThreeTimesAndThenLockOut) {
    std::string scratch = (fs::temp_directory_path() / "steadyboom-test.XXXXXX").string();
    const fs::path folder = mkdtemp(scratch.data());
    fs::copy(STEADYBOOM_CASE_A, folder / "crane.toml");
    runtime::ControllerConfig config;
    config.crane_file = folder / "crane.toml";
    config.interface = name();
    config.link_socket_path = folder / "link.sock";
    config.realtime_required = false;
    config.max_opening_m = 5e-3;
    config.max_slew_m_s = 0.5;
    config.engage_ramp_s = 0.5;
    config.operator_socket_path = folder / "command.sock";
    config.telemetry_ring_path = folder / "ticks.ring";
    std::ofstream(folder / "controller.toml") << to_toml(config);

    runtime::ChildProcess daemon({STEADYBOOM_CAN, "--config", folder / "controller.toml", "--interface", name()},
                                 folder / "can.log");
    runtime::ChildProcess controller({STEADYBOOM_CONTROLLER, "--config", folder / "controller.toml"},
                                     folder / "controller.log");
    const auto log_of = [&](const char* file) {
        std::ostringstream text;
        text << std::ifstream(folder / file).rdbuf();
        return text.str();
    };
    runtime::OperatorClient client(folder / "command.sock", std::chrono::seconds(20));
    const auto reasons = [&] { return client.request(runtime::OperatorCommand::status).reasons; };
    ASSERT_TRUE(eventually([&] { return (reasons() & controllers::reason_bus_setup) == 0; })) << log_of("can.log");

    for (int round = 1; round <= 3; ++round) {
        adapter.say("sb000256");
        ASSERT_TRUE(eventually([&] { return adapter.count("O") == round + 1; })) << round << '\n' << log_of("can.log");
        ASSERT_TRUE(eventually([&] { return (reasons() & controllers::reason_bus_off) == 0; })) << round;
    }
    adapter.say("sb000256");
    ASSERT_TRUE(eventually([&] { return (reasons() & controllers::reason_bus_off_lockout) != 0; }))
        << log_of("can.log");
    EXPECT_EQ(adapter.count("O"), 4) << "no fourth restart";
    EXPECT_EQ(static_cast<controllers::InterlockState>(client.request(runtime::OperatorCommand::status).state),
              controllers::InterlockState::fault_hold);
    EXPECT_EQ(client.request(runtime::OperatorCommand::reset).outcome(), runtime::OperatorResult::refused);
    EXPECT_THAT(log_of("can.log"), HasSubstr("500000 bit/s"));
    EXPECT_THAT(log_of("controller.log"), HasSubstr("devices are on other machines only"));
    controller.signal(SIGTERM);
    daemon.signal(SIGTERM);
    EXPECT_EQ(controller.wait(), 0) << log_of("controller.log");
    EXPECT_EQ(daemon.wait(), 0) << log_of("can.log");
    fs::remove_all(folder);
}

}  // namespace
}  // namespace steadyboom
