// The deployed controller in command of the virtual crane, two processes at the two ends of a wire, and what can happen
// to a bus. Order and end of each reaction are claimed, from the controller's own records; never a time: a busy machine
// gives this guest none for as long as it likes. Exact ticks are in tests/scenarios and tests/controllers.
#include <fcntl.h>
#include <linux/can/error.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "controllers/interlock.hpp"
#include "drivers/socketcan_bus.hpp"
#include "hil/case_file.hpp"
#include "hil/plant_config.hpp"
#include "runtime/controller_config.hpp"
#include "runtime/file_descriptor.hpp"
#include "runtime/operator_client.hpp"
#include "runtime/tick_record.hpp"
#include "runtime/tick_ring.hpp"
#include "tests/runtime/child_process.hpp"
#include "tests/vcan/interfaces.hpp"

namespace steadyboom {
namespace {

namespace fs = std::filesystem;
using controllers::InterlockState;
using runtime::ChildProcess;
using runtime::OperatorCommand;
using runtime::TickRecord;
using test_support::eventually;
using test_support::run;

InterlockState state_of(const TickRecord& record) {
    return static_cast<InterlockState>(record.interlock_state);
}

/// steady1 here with the controller, steady2 in the network namespace "far" with the crane: as far as another machine.
class ControllerOnAFaultyBus : public testing::Test {
  protected:
    ControllerOnAFaultyBus() {
        std::string name = (fs::temp_directory_path() / "steadyboom-test.XXXXXX").string();
        folder_ = mkdtemp(name.data());
    }
    ~ControllerOnAFaultyBus() override {
        ring_.reset();
        client_.reset();
        controller_.reset();
        plant_.reset();
        (void)std::system("ip link del steady1 2>/dev/null; ip link del steady2 2>/dev/null; ip netns del far");
        fs::remove_all(folder_);
    }

    void SetUp() override { run("ip netns add far"); }

    static void lay_wire() {
        run("ip link add steady1 type vxcan peer name steady2 netns far && ip link set steady1 up && "
            "ip -n far link set steady2 up");
    }

    void start(std::optional<bool> expect_remote = true, const std::string& plants_namespace = "far") {
        fs::copy(STEADYBOOM_CASE_A, folder_ / "case.toml");
        runtime::ControllerConfig controller;
        controller.crane_file = folder_ / "case.toml";
        controller.law = controllers::LawKind::joint_deflection;
        controller.interface = "steady1";
        controller.expect_remote = expect_remote;
        controller.realtime_required = false;
        controller.max_opening_m = 7.6e-3;
        controller.max_slew_m_s = 0.5;
        controller.engage_ramp_s = 0.5;
        controller.operator_socket_path = folder_ / "command.sock";
        controller.telemetry_ring_path = folder_ / "ticks.ring";
        std::ofstream(folder_ / "controller.toml") << to_toml(controller);
        hil::PlantConfig plant;
        plant.case_file = folder_ / "case.toml";
        plant.interface = "steady2";
        plant.standing_s = 3600.0;  // no brake: what matters here is the bus
        plant.duration_s = 1.0;
        plant.ring_path = folder_ / "plant.ring";
        std::ofstream(folder_ / "plant.toml") << to_toml(plant);

        std::vector<std::string> command{STEADYBOOM_PLANT, "--config", folder_ / "plant.toml"};
        if (!plants_namespace.empty()) {
            command.insert(command.begin(), {"ip", "netns", "exec", plants_namespace});
        }
        plant_.emplace(command, folder_ / "plant.log");
        controller_.emplace(std::vector<std::string>{STEADYBOOM_CONTROLLER, "--config", folder_ / "controller.toml"},
                            folder_ / "controller.log");
        client_.emplace(folder_ / "command.sock", std::chrono::seconds(30));
        ring_.emplace(folder_ / "ticks.ring");
    }

    /// As the newest record tells.
    InterlockState state() {
        for (TickRecord record; ring_->read(record);) {
            records_.push_back(record);
        }
        return records_.empty() ? InterlockState::standby : state_of(records_.back());
    }

    /// No more often than an operator could; the controller hangs up on who asks too much.
    runtime::OperatorReply ask(OperatorCommand command) {
        usleep(50'000);
        return client_->request(command);
    }

    /// Does what an operator does until the machine is in command.
    bool engage() {
        return eventually(
            [this] {
                switch (state()) {
                    case InterlockState::fault_hold:
                        (void)ask(OperatorCommand::reset);
                        break;
                    case InterlockState::ready:
                    case InterlockState::hold:
                        usleep(50'000);
                        (void)client_->arm_and_engage();
                        break;
                    default:
                        break;
                }
                return state() == InterlockState::active;
            },
            60);
    }

    /// Records not seen before.
    std::vector<TickRecord> new_records() {
        (void)state();
        return std::exchange(records_, {});
    }

    using Settled = std::function<bool(const TickRecord&)>;

    static bool held(const TickRecord& record) { return state_of(record) == InterlockState::fault_hold; }

    /// The machine in command, then `fault`: the records from the first with `reason` until `settled` holds. A tick for
    /// which the host gave no time may have taken the command away before; then all is tried again.
    std::vector<TickRecord> reaction(controllers::InterlockReason reason, const std::function<void()>& fault,
                                     const std::function<void()>& mend, const Settled& settled) {
        for (int attempt = 1; attempt <= 10; ++attempt) {
            if (!engage()) {
                ADD_FAILURE() << "never in command: " << ask(OperatorCommand::status).words() << '\n' << log();
                return {};
            }
            (void)new_records();
            fault();
            std::vector<TickRecord> seen;
            const bool came = eventually([&] {
                for (const TickRecord& record : new_records()) {
                    seen.push_back(record);
                }
                return !seen.empty() && settled(seen.back()) &&
                       std::ranges::any_of(
                           seen, [&](const TickRecord& record) { return (record.permission_reasons & reason) != 0; });
            });
            mend();
            const auto first = std::ranges::find_if(
                seen, [&](const TickRecord& record) { return (record.permission_reasons & reason) != 0; });
            const bool in_command_until_then = std::all_of(seen.begin(), first, [](const TickRecord& record) {
                return state_of(record) != InterlockState::fault_hold;
            });
            if (came && in_command_until_then) {
                return {first, seen.end()};
            }
            if (!came) {
                std::cerr << "attempt " << attempt << ": "
                          << (seen.empty() ? "no record"
                                           : controllers::reasons_in_words(seen.back().permission_reasons))
                          << '\n';
            }
        }
        ADD_FAILURE() << "no clean reaction in ten attempts\n" << log();
        return {};
    }

    void expect_stop(controllers::InterlockReason reason, const std::function<void()>& fault,
                     const std::function<void()>& mend) {
        const auto records = reaction(reason, fault, mend, held);
        ASSERT_FALSE(records.empty());
        EXPECT_EQ(state_of(records.front()), InterlockState::stopping) << "a ramp begins with the reason";
        EXPECT_LT(records.front().authority, 1.0);
        const auto end_of_ramp = std::ranges::find_if(records, held);
        EXPECT_LE(end_of_ramp - records.begin(), 20) << "ticks of the ramp";
        expect_neutral(*end_of_ramp);
        expect_nothing_moves_before_the_operator_says_so();
    }

    void expect_immediate_stop(controllers::InterlockReason reason, const std::function<void()>& fault,
                               const std::function<void()>& mend) {
        const auto records = reaction(reason, fault, mend, held);
        ASSERT_FALSE(records.empty());
        EXPECT_EQ(state_of(records.front()), InterlockState::fault_hold) << "neutral in the tick that has the reason";
        expect_neutral(records.front());
        expect_nothing_moves_before_the_operator_says_so();
    }

    static void expect_neutral(const TickRecord& record) {
        EXPECT_EQ(record.applied_opening_m, 0.0);
        EXPECT_EQ(record.cutoff_energised, 0);
        EXPECT_EQ(record.authority, 0.0);
    }

    /// All is mended: the bus comes back by itself, so that a reset is taken; command comes back by the operator only.
    void expect_nothing_moves_before_the_operator_says_so() {
        (void)new_records();
        EXPECT_TRUE(eventually([&] { return ask(OperatorCommand::reset).outcome() == runtime::OperatorResult::done; }))
            << "the cause never went: " << ask(OperatorCommand::status).words();
        EXPECT_TRUE(eventually([&] { return state() == InterlockState::ready; }))
            << ask(OperatorCommand::status).words();
        for (const TickRecord& record : new_records()) {
            EXPECT_FALSE(controllers::moves(state_of(record)));
            EXPECT_EQ(record.applied_opening_m, 0.0);
        }
    }

    std::string log() {
        std::ostringstream text;
        text << std::ifstream(folder_ / "controller.log").rdbuf() << std::ifstream(folder_ / "plant.log").rdbuf();
        return text.str();
    }

    static void far(const std::string& command) { run("ip netns exec far " + command); }

    /// A socket at the crane's end of the wire. To start a program for each frame would stop the guest for longer than
    /// the machine bears.
    static std::unique_ptr<drivers::SocketCanBus> socket_at_the_far_end() {
        const runtime::FileDescriptor here(open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC));
        const runtime::FileDescriptor there(open("/run/netns/far", O_RDONLY | O_CLOEXEC));
        EXPECT_EQ(setns(there.get(), CLONE_NEWNET), 0);
        auto bus = std::make_unique<drivers::SocketCanBus>("steady2");
        EXPECT_EQ(setns(here.get(), CLONE_NEWNET), 0);
        return bus;
    }

    static drivers::CanFrame error_message(std::uint32_t error_class, std::uint8_t controller = 0) {
        return {.id = error_class, .length = 8, .data = {0, controller, 0, 0, 0, 0, 0x81, 0x82}, .error = true};
    }

    static void say(drivers::SocketCanBus& bus, const drivers::CanFrame& frame) {
        EXPECT_EQ(bus.send(std::array{frame}).sent, 1U);
    }
    static void nothing() {}

    fs::path folder_;
    std::optional<ChildProcess> plant_;
    std::optional<ChildProcess> controller_;
    std::optional<runtime::OperatorClient> client_;
    std::optional<runtime::TickRingReader<TickRecord>> ring_;
    std::vector<TickRecord> records_;
};

TEST_F(ControllerOnAFaultyBus, InterfaceDownRampsToNeutralAndTheSameSocketHearsAgain) {
    lay_wire();
    start();
    expect_stop(
        controllers::reason_interface_down, [] { run("ip link set steady1 down"); },
        [] { run("ip link set steady1 up"); });
}

TEST_F(ControllerOnAFaultyBus, InterfaceDeletedAndMadeAnewRampsToNeutralAndIsHeardAgain) {
    lay_wire();
    start();
    expect_stop(
        controllers::reason_interface_gone, [] { run("ip link del steady1"); }, lay_wire);
}

TEST_F(ControllerOnAFaultyBus, FullSendQueueRampsToNeutral) {
    lay_wire();
    start();
    expect_stop(
        controllers::reason_bus_fault, [] { run("tc qdisc add dev steady1 root netem limit 2 delay 60s"); },
        [] { run("tc qdisc del dev steady1 root"); });
    EXPECT_TRUE(eventually([&] {
        const auto records = new_records();
        return !records.empty() && records.back().send_errors > 0;
    }));
}

TEST_F(ControllerOnAFaultyBus, SilenceLossDelayAndCorruptionOnTheWireAreNeutralAtOnce) {
    lay_wire();
    start();
    // The emergency stop's input falls silent with the rest, and that leaves no time for a ramp.
    expect_immediate_stop(
        controllers::reason_emergency_stop, [] { far("ip link set steady2 down"); },
        [] { far("ip link set steady2 up"); });
    expect_immediate_stop(
        controllers::reason_emergency_stop, [] { far("tc qdisc add dev steady2 root netem delay 200ms"); },
        [] { far("tc qdisc del dev steady2 root"); });
    // Chance decides what of these is missed first.
    for (const char* disturbance : {"loss 80%", "corrupt 100%"}) {
        SCOPED_TRACE(disturbance);
        ASSERT_TRUE(engage()) << log();
        far(std::string("tc qdisc add dev steady2 root netem ") + disturbance);
        EXPECT_TRUE(eventually([&] { return state() == InterlockState::fault_hold; }));
        expect_neutral(new_records().back());
        far("tc qdisc del dev steady2 root");
        expect_nothing_moves_before_the_operator_says_so();
    }
}

TEST_F(ControllerOnAFaultyBus, BusOffIsNeutralAtOnce) {
    lay_wire();
    start();
    const auto far_end = socket_at_the_far_end();
    expect_immediate_stop(
        controllers::reason_bus_off, [&] { say(*far_end, error_message(CAN_ERR_BUSOFF)); }, nothing);
}

TEST_F(ControllerOnAFaultyBus, ErrorPassiveLimitsErrorWarningIsShownAndNeitherLatches) {
    lay_wire();
    start();
    const auto far_end = socket_at_the_far_end();
    const auto limited = reaction(
        controllers::reason_error_passive,
        [&] { say(*far_end, error_message(CAN_ERR_CRTL | CAN_ERR_CNT, CAN_ERR_CRTL_TX_PASSIVE)); },
        [&] { say(*far_end, error_message(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE)); },
        [](const TickRecord& record) {
            return state_of(record) == InterlockState::limited && record.authority <= 0.15 + 1e-9;
        });
    ASSERT_FALSE(limited.empty());
    EXPECT_EQ(state_of(limited.front()), InterlockState::limited);
    EXPECT_LT(limited.front().authority, 1.0);
    EXPECT_EQ(limited.front().transmit_error_count, 0x81);
    EXPECT_EQ(limited.front().receive_error_count, 0x82);
    const auto warned = reaction(
        controllers::reason_error_warning, [&] { say(*far_end, error_message(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING)); },
        nothing, [](const TickRecord& record) { return state_of(record) == InterlockState::active; });
    ASSERT_FALSE(warned.empty());
    EXPECT_EQ(warned.front().authority, 1.0);
}

TEST_F(ControllerOnAFaultyBus, SensorFrameOfThisMachineIsNeutralAtOnce) {
    lay_wire();
    start();
    drivers::SocketCanBus local("steady1", {.expect_remote = false});
    expect_immediate_stop(
        controllers::reason_spoof, [&] { say(local, {.id = 0x194, .length = 4}); }, nothing);
    expect_immediate_stop(
        controllers::reason_spoof, [&] { say(local, error_message(CAN_ERR_BUSOFF)); }, nothing);
    EXPECT_TRUE(eventually([&] {
        const auto records = new_records();
        return !records.empty() && records.back().link_state == static_cast<std::uint8_t>(drivers::LinkState::active);
    })) << "a fake error message is not believed";
}

TEST_F(ControllerOnAFaultyBus, FloodRampsToNeutralAndLeavesNothingStale) {
    lay_wire();
    start();
    const auto far_end = socket_at_the_far_end();
    const std::vector<drivers::CanFrame> flood(3000, {.id = 0x190, .length = 8});
    expect_stop(
        controllers::reason_flood, [&] { (void)far_end->send(flood); }, nothing);
}

TEST_F(ControllerOnAFaultyBus, StoppedProcessReadsWhatPiledUpInOneTickAndMakesUpForNone) {
    lay_wire();
    start();
    const auto far_end = socket_at_the_far_end();
    ASSERT_TRUE(engage()) << log();
    std::vector<TickRecord> seen{new_records().back()};
    controller_->signal(SIGSTOP);
    for (int i = 0; i < 900; ++i) {
        say(*far_end, {.id = 0x710, .length = 1, .data = {0x05}});
        usleep(1000);
    }
    controller_->signal(SIGCONT);
    ASSERT_TRUE(eventually([&] {
        for (const TickRecord& record : new_records()) {
            seen.push_back(record);
        }
        return !seen.empty() && state_of(seen.back()) == InterlockState::fault_hold;
    })) << log();
    const auto resumed =
        std::ranges::find_if(seen, [](const TickRecord& record) { return record.skipped_ticks > 100; });
    ASSERT_NE(resumed, seen.end());
    ASSERT_NE(resumed, seen.begin());
    ASSERT_NE(resumed + 1, seen.end());
    const auto read = [](const TickRecord& newer, const TickRecord& older) {
        return newer.received_frames - older.received_frames;
    };
    EXPECT_GE(read(*resumed, *(resumed - 1)), 500U);
    EXPECT_LE(read(*resumed, *(resumed - 1)), drivers::most_frames_a_tick);
    EXPECT_LT(read(*(resumed + 1), *resumed), drivers::flood_frames) << "nothing stale is left for the next tick";
    EXPECT_GT(seen.back().dropped_frames, seen.front().dropped_frames) << "and what did not fit is counted";
    EXPECT_EQ(
        std::ranges::count_if(resumed, seen.end(),
                              [](const TickRecord& record) { return state_of(record) == InterlockState::active; }),
        0);
}

TEST_F(ControllerOnAFaultyBus, PayloadChangedOnTheWayToAnImpossibleAngleRampsToNeutral) {
    run("ip link add steady1 type vcan && ip link add steady2 type vcan && ip link set steady1 up && "
        "ip link set steady2 up && modprobe can-gw 2>/dev/null; cangw -A -s steady1 -d steady2 -e && "
        "cangw -A -s steady2 -d steady1 -e -f 194~7FF && cangw -A -s steady2 -d steady1 -e -f 194:7FF");
    start(std::nullopt, "");
    expect_stop(
        controllers::reason_channel_missing,
        [] {
            run("cangw -D -s steady2 -d steady1 -e -f 194:7FF && "
                "cangw -A -s steady2 -d steady1 -e -f 194:7FF -m SET:D:194.4.FFFFFF7F00000000");
        },
        [] {
            run("cangw -D -s steady2 -d steady1 -e -f 194:7FF -m SET:D:194.4.FFFFFF7F00000000 && "
                "cangw -A -s steady2 -d steady1 -e -f 194:7FF");
        });
    run("cangw -F");
}

}  // namespace
}  // namespace steadyboom
