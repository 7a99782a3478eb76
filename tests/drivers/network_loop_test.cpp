#include <cmath>
#include <optional>

#include "network_loop.hpp"

namespace steadyboom::drivers {
namespace {

TEST_F(NetworkLoop, NodesAreOperationalWithinTheFirstTicks) {
    start();
    const auto measured = tick();
    for (int sensor = 0; sensor < plant::sensor_count; ++sensor) {
        EXPECT_TRUE(measured.fresh(static_cast<plant::Sensor>(sensor))) << sensor;
    }
    for (std::size_t i = 1; i < device_count; ++i) {
        EXPECT_EQ(devices_.state(static_cast<Device>(i)), NodeState::operational);
        EXPECT_TRUE(controller_.node(static_cast<Device>(i)).alive);
    }
}

TEST_F(NetworkLoop, SamplesArriveOneTickAfterTheSyncTheyAnswerToWithinHalfAStep) {
    start();
    std::optional<plant::SensorVector> sampled;
    std::int64_t sync_ns = 0;
    for (int i = 0; i < 2000; ++i) {
        sensors_ = plausible(std::sin(0.01 * i));
        const auto measured = tick();
        if (sampled) {
            ASSERT_EQ(measured.stamp_ns, sync_ns);
            for (int s = 0; s < plant::sensor_count; ++s) {
                ASSERT_TRUE(measured.fresh(static_cast<plant::Sensor>(s)));
                ASSERT_NEAR(measured.value[s], (*sampled)[s], 0.501 * resolution_[s]) << s;
            }
        }
        sampled = sensors_;
        sync_ns = now_ns_;
    }
    EXPECT_EQ(controller_.status().superseded_frames, 0U);
    EXPECT_EQ(controller_.status().unknown_id_frames + controller_.status().wrong_length_frames, 0U);
    EXPECT_EQ(devices_.status().unknown_id_frames + devices_.status().wrong_length_frames, 0U);
    for (std::size_t i = 1; i < device_count; ++i) {
        EXPECT_LE(controller_.node(static_cast<Device>(i)).heartbeat_age_ns, 100'000'000);
    }
}

TEST_F(NetworkLoop, OrderReachesTheValveInTheSameTickWithinHalfAStep) {
    start();
    for (int i = 0; i < 500; ++i) {
        const double opening_m = 7.6e-3 * std::sin(0.05 * i);
        (void)tick(opening_m);
        ASSERT_NEAR(devices_.valve_order().set_point_m, opening_m, 0.5 * 7.6e-3 / 16384.0 + 1.0e-9);
        ASSERT_EQ(devices_.valve_order().stamp_ns, now_ns_);
        ASSERT_EQ(devices_.valve_order().control_word, 0b0111);
        ASSERT_TRUE(devices_.valve_order().cutoff_energised);
    }
    (void)tick(0.0, {.mode = plant::ValveMode::hold});
    EXPECT_EQ(devices_.valve_order().control_word, 0b0011);
    EXPECT_FALSE(devices_.valve_order().cutoff_energised);
}

TEST_F(NetworkLoop, RefusedCommandReachesTheValveAsDisabledInTheSameTick) {
    start();
    (void)tick(2.0e-3);
    (void)tick(std::nan(""));
    EXPECT_EQ(devices_.valve_order().set_point_m, 0.0);
    EXPECT_EQ(devices_.valve_order().control_word, 0b0001);
    EXPECT_FALSE(devices_.valve_order().cutoff_energised);
}

TEST_F(NetworkLoop, ValveStateAndSafetyInputsCrossTheBus) {
    start();
    valve_follows_ = false;
    feedback_ = {
        .status = {.state = plant::ValveState::fault_hold}, .cutoff_open = true, .emergency_stop_healthy = false};
    (void)tick();
    const auto measured = tick();
    EXPECT_EQ(measured.valve_state, plant::ValveState::fault_hold);
    EXPECT_TRUE(measured.cutoff_open);
    EXPECT_FALSE(measured.emergency_stop_healthy);
    EXPECT_EQ(measured.safety_inputs_age_ticks, 0U);
}

TEST_F(NetworkLoop, RestartedNodeIsStartedAgainAndBelievedAfterTenGoodTicks) {
    start();
    devices_.restart(Device::boom_inclinometer);
    int ticks_until_operational = 0;
    while (devices_.state(Device::boom_inclinometer) != NodeState::operational && ticks_until_operational < 30) {
        (void)tick();
        ++ticks_until_operational;
    }
    EXPECT_LT(ticks_until_operational, 30);
    int ticks_until_believed = 0;
    while (!tick().fresh(plant::boom_angle_rad) && ticks_until_believed < 30) {
        ++ticks_until_believed;
    }
    EXPECT_LE(ticks_until_believed, 13);
    EXPECT_EQ(controller_.node(Device::boom_inclinometer).boot_ups, 2U);
}

TEST_F(NetworkLoop, AllNodesRestartedAtOnceAreBackWithinASecond) {
    start();
    for (std::size_t i = 1; i < device_count; ++i) {
        devices_.restart(static_cast<Device>(i));
    }
    for (int i = 0; i < 200; ++i) {
        (void)tick();
    }
    const auto measured = tick();
    for (int s = 0; s < plant::sensor_count; ++s) {
        EXPECT_TRUE(measured.fresh(static_cast<plant::Sensor>(s))) << s;
    }
}

TEST_F(NetworkLoop, SilentNodeAgesAndIsMissedAfterTheConsumerTime) {
    start();
    (void)tick();
    devices_.set_silent(Device::load_pin, true);
    (void)tick();
    for (std::uint32_t i = 1; i <= 80; ++i) {
        const auto measured = tick();
        ASSERT_EQ(measured.age_ticks[plant::line_tension_N], i);
        ASSERT_TRUE(measured.fresh(plant::boom_angle_rad));
    }
    EXPECT_FALSE(controller_.node(Device::load_pin).alive);
    EXPECT_TRUE(controller_.node(Device::servo_valve).alive);
    devices_.set_silent(Device::load_pin, false);
    for (int i = 0; i < 100; ++i) {
        (void)tick();
    }
    EXPECT_TRUE(tick().fresh(plant::line_tension_N));
}

TEST_F(NetworkLoop, OverflowOfASensorArrivesAsInvalid) {
    start();
    sensors_[plant::strain_lower_microstrain] = 1.0e6;
    sensors_[plant::boom_angle_rad] = 100.0;
    sensors_[plant::line_angle_rad] = std::nan("");
    for (int i = 0; i < 3; ++i) {
        (void)tick();
    }
    const auto measured = tick();
    EXPECT_FALSE(measured.valid[plant::strain_lower_microstrain]);
    EXPECT_FALSE(measured.valid[plant::boom_angle_rad]);
    EXPECT_FALSE(measured.valid[plant::line_angle_rad]);
    EXPECT_TRUE(measured.valid[plant::strain_upper_microstrain]);
    EXPECT_TRUE(measured.value.allFinite());
}

}  // namespace
}  // namespace steadyboom::drivers
