#include "drivers/device_network.hpp"

#include <array>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace steadyboom::drivers {
namespace {

NetworkConfig without_protection() {
    NetworkConfig config;
    config.protect_all(Protection::none);
    for (auto& device : config.devices) {
        device.configure = false;  // they come as the table says
    }
    return config;
}

class DeviceNetworkTest : public ::testing::Test {
  protected:
    void receive(const std::vector<CanFrame>& frames) { network_.receive(frames, now_ns_); }

    std::vector<CanFrame> housekeeping() {
        const auto frames = network_.housekeeping(now_ns_);
        return {frames.begin(), frames.end()};
    }

    std::set<std::uint32_t> answer_ids() {
        receive({sync()});
        std::set<std::uint32_t> ids;
        for (const auto& frame : network_.answer_sync(plant::SensorVector::Zero(), {}, now_ns_)) {
            ids.insert(frame.id);
        }
        return ids;
    }

    void boot_and_start() {
        (void)housekeeping();
        receive({nmt(0x01, 0)});
    }

    static CanFrame nmt(std::uint8_t command, std::uint8_t node) {
        return {.id = 0x000, .length = 2, .data = {command, node}};
    }
    static CanFrame sync(std::uint8_t counter = 1) { return {.id = 0x080, .length = 1, .data = {counter}}; }
    static CanFrame valve(std::uint8_t control_word, std::int16_t set_point) {
        return {.id = 0x220,
                .length = 4,
                .data = {control_word, 0, static_cast<std::uint8_t>(set_point & 0xFF),
                         static_cast<std::uint8_t>((set_point >> 8) & 0xFF)}};
    }
    static CanFrame cutoff(std::uint8_t outputs) { return {.id = 0x228, .length = 1, .data = {outputs}}; }

    const std::set<std::uint32_t> all_answers_ = {0x190, 0x194, 0x198, 0x199, 0x19C, 0x1A0, 0x2A0, 0x1A8};
    std::int64_t now_ns_ = 0;
    DeviceNetwork network_{without_protection()};
};

TEST_F(DeviceNetworkTest, NodesAnnounceThemselvesAndWaitToBeStarted) {
    const auto boot_ups = housekeeping();
    ASSERT_EQ(boot_ups.size(), 7U);
    for (const auto& frame : boot_ups) {
        EXPECT_EQ(frame.id & 0x780U, 0x700U);
        EXPECT_EQ(frame.length, 1);
        EXPECT_EQ(frame.data[0], 0x00);
    }
    EXPECT_TRUE(housekeeping().empty());
    EXPECT_TRUE(answer_ids().empty()) << "no process data before the start";
    now_ns_ = 100'000'000;
    for (const auto& frame : housekeeping()) {
        EXPECT_EQ(frame.data[0], 0x7F);
    }
    receive({nmt(0x01, 0)});
    EXPECT_EQ(answer_ids(), all_answers_);
    now_ns_ = 200'000'000;
    for (const auto& frame : housekeeping()) {
        EXPECT_EQ(frame.data[0], 0x05);
    }
}

TEST_F(DeviceNetworkTest, HeartbeatsKeepTheirPaceOnALateClockAndSkipWhatWasSleptThrough) {
    (void)housekeeping();
    std::size_t heartbeats = 0;
    for (int tick = 0; tick < 2000; ++tick) {
        now_ns_ = tick * 5'000'000LL + tick % 3 * 100'000;
        heartbeats += housekeeping().size();
    }
    EXPECT_EQ(heartbeats, 7U * 99U);
    now_ns_ += 10'000'000'000;
    EXPECT_EQ(housekeeping().size(), 7U);
    EXPECT_TRUE(housekeeping().empty());
}

TEST_F(DeviceNetworkTest, StartBeforeTheBootUpMessageIsNotHeard) {
    receive({nmt(0x01, 0)});
    (void)housekeeping();
    EXPECT_EQ(network_.state(Device::servo_valve), NodeState::pre_operational);
}

TEST_F(DeviceNetworkTest, NmtReachesOneNodeOrAll) {
    boot_and_start();
    receive({nmt(0x02, 0x14)});
    EXPECT_EQ(network_.state(Device::boom_inclinometer), NodeState::stopped);
    EXPECT_EQ(network_.state(Device::load_pin), NodeState::operational);
    receive({nmt(0x80, 0)});
    EXPECT_EQ(network_.state(Device::boom_inclinometer), NodeState::pre_operational);
    EXPECT_EQ(network_.state(Device::load_pin), NodeState::pre_operational);
    receive({nmt(0x01, 0x14), nmt(0x01, 0x7F), nmt(0x33, 0)});
    EXPECT_EQ(answer_ids(), (std::set<std::uint32_t>{0x194}));
    EXPECT_EQ(network_.status().unknown_orders, 1U);
    receive({nmt(0x81, 0x14)});
    EXPECT_TRUE(answer_ids().empty());
    const auto boot_up = housekeeping();
    ASSERT_EQ(boot_up.size(), 1U);
    EXPECT_EQ(boot_up[0].id, 0x714U);
    EXPECT_EQ(boot_up[0].data[0], 0x00);
}

TEST_F(DeviceNetworkTest, OrdersAreTakenOnlyWhileOperationalAndOfExactLength) {
    (void)housekeeping();
    receive({valve(0x0F, 8192), cutoff(1)});
    EXPECT_FALSE(network_.valve_order().ever);
    EXPECT_FALSE(network_.valve_order().cutoff_energised);
    EXPECT_EQ(network_.status().not_operational_frames, 2U);
    receive({nmt(0x01, 0)});
    auto too_short = valve(0x0F, 8192);
    too_short.length = 3;
    auto too_long = cutoff(1);
    too_long.length = 2;
    auto remote = valve(0x0F, 8192);
    remote.remote = true;
    receive({too_short, too_long, remote});
    EXPECT_FALSE(network_.valve_order().ever);
    EXPECT_FALSE(network_.valve_order().cutoff_energised);
    now_ns_ = 77;
    receive({valve(0x0F, 8192), cutoff(1)});
    const auto& order = network_.valve_order();
    EXPECT_TRUE(order.ever);
    EXPECT_EQ(order.stamp_ns, 77);
    EXPECT_EQ(order.control_word, 0x0F);
    EXPECT_NEAR(order.set_point_m, 3.8e-3, 1e-12);
    EXPECT_TRUE(order.cutoff_energised);
    EXPECT_EQ(order.cutoff_stamp_ns, 77);
    receive({cutoff(0xFE)});
    EXPECT_FALSE(order.cutoff_energised);
}

TEST_F(DeviceNetworkTest, AnswersNothingButOrdersOfTheController) {
    boot_and_start();
    for (std::uint32_t id = 0; id < standard_id_count; ++id) {
        for (std::uint8_t length = 0; length <= 8; ++length) {
            receive({{.id = id, .length = length}});
        }
    }
    // NMT, SYNC, both RPDOs, the controller's heartbeat and seven SDO requests, each with one length.
    EXPECT_EQ(network_.status().accepted_frames, 1U + 12U);
    EXPECT_EQ(network_.status().wrong_length_frames, 12U * 8U);
    EXPECT_EQ(network_.status().unknown_id_frames, (2048U - 12U) * 9U);
    EXPECT_EQ(network_.filters().size(), 11U);
}

TEST_F(DeviceNetworkTest, SetPointBeyondFullScaleIsCut) {
    boot_and_start();
    receive({valve(0x0F, 32767)});
    EXPECT_NEAR(network_.valve_order().set_point_m, 7.6e-3, 1e-15);
    receive({valve(0x0F, -32768)});
    EXPECT_NEAR(network_.valve_order().set_point_m, -7.6e-3, 1e-15);
}

TEST_F(DeviceNetworkTest, StoppedValveForgetsItsOrder) {
    boot_and_start();
    receive({valve(0x0F, 8192), cutoff(1)});
    receive({nmt(0x02, 0x20), nmt(0x81, 0x28)});
    EXPECT_FALSE(network_.valve_order().ever);
    EXPECT_EQ(network_.valve_order().control_word, 0);
    EXPECT_EQ(network_.valve_order().set_point_m, 0.0);
    EXPECT_FALSE(network_.valve_order().cutoff_energised);
}

TEST_F(DeviceNetworkTest, OneSyncBringsOneAnswer) {
    boot_and_start();
    EXPECT_FALSE(network_.sync_pending());
    receive({sync(17)});
    EXPECT_TRUE(network_.sync_pending());
    EXPECT_EQ(network_.sync_counter(), 17);
    EXPECT_EQ(network_.answer_sync(plant::SensorVector::Zero(), {}, 0).size(), 8U);
    EXPECT_FALSE(network_.sync_pending());
    EXPECT_TRUE(network_.answer_sync(plant::SensorVector::Zero(), {}, 0).empty());
    receive({{.id = 0x080, .length = 0}});
    EXPECT_FALSE(network_.sync_pending()) << "a SYNC without its counter is not this network's";
}

TEST_F(DeviceNetworkTest, SilencedNodeSendsNothingAndSilencedChannelOnlyLosesItsPdo) {
    boot_and_start();
    network_.set_silent(Device::load_pin, true);
    auto expected = all_answers_;
    expected.erase(0x198);
    EXPECT_EQ(answer_ids(), expected);
    now_ns_ = 100'000'000;
    for (const auto& frame : housekeeping()) {
        EXPECT_NE(frame.id, 0x718U);
    }
    network_.set_silent(Device::load_pin, false);
    network_.set_silent(plant::piston_m, true);
    expected = all_answers_;
    expected.erase(0x2A0);
    EXPECT_EQ(answer_ids(), expected);
    network_.set_silent(plant::piston_m, false);
    EXPECT_EQ(answer_ids(), all_answers_);
}

TEST_F(DeviceNetworkTest, StatusBytesTellOverflowAndUnderflow) {
    boot_and_start();
    receive({sync()});
    plant::SensorVector sensors = plant::SensorVector::Zero();
    sensors[plant::strain_lower_microstrain] = 4000.0;
    sensors[plant::strain_upper_microstrain] = -4000.0;
    sensors[plant::line_tension_N] = 3.0e6;
    const auto frames = network_.answer_sync(sensors, {}, 0);
    std::map<std::uint32_t, CanFrame> by_id;
    for (const auto& frame : frames) {
        by_id[frame.id] = frame;
    }
    EXPECT_EQ(by_id[0x190].data[4], 3);
    EXPECT_EQ(by_id[0x190].data[5], 5);
    EXPECT_EQ(by_id[0x198].data[4], 3);
}

}  // namespace
}  // namespace steadyboom::drivers
