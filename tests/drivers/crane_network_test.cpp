#include "drivers/crane_network.hpp"

#include <array>
#include <cmath>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/pdo_codec.hpp"

namespace steadyboom::drivers {
namespace {

/// Nothing but process data: no protection, no network management.
NetworkConfig bare() {
    NetworkConfig config;
    config.protect_all(Protection::none);
    for (std::size_t i = 1; i < device_count; ++i) {
        config.devices[i].canopen = false;
        config.devices[i].heartbeat_ms = 0;
        config.devices[i].heartbeat_timeout_ms = 0;
    }
    return config;
}

static_assert(std::is_trivially_copyable_v<NetworkStatus>);

constexpr std::int64_t tick_ns = 5'000'000;
constexpr auto never = plant::CraneMeasurement::never;

class CraneNetworkTest : public ::testing::Test {
  protected:
    plant::CraneMeasurement decode(const std::vector<CanFrame>& frames) {
        now_ns_ += tick_ns;
        return network_.decode(frames, now_ns_);
    }

    std::vector<CanFrame> encode(const GuardedCommand& command) {
        const auto frames = network_.encode(command, now_ns_);
        return {frames.begin(), frames.end()};
    }

    [[nodiscard]] CanFrame with_value(Signal signal, double value_unit) const {
        const auto& row = network_.table().row(signal);
        auto frame = network_.table().blank(row.message, 0);
        (void)encode_value(row, value_unit, frame);
        return frame;
    }

    /// The valve says that it is in this state.
    void valve_reports(plant::ValveState state) {
        auto frame = network_.table().blank(message_of(Pdo::valve_status), 0);
        write_raw(network_.table().row(Signal::valve_status_word), static_cast<std::int64_t>(state), frame);
        (void)decode({frame});
    }

    /// Until the valve, which follows, is in command.
    void activate(CommandGuard& guard) {
        for (const auto state : {plant::ValveState::disabled, plant::ValveState::hold, plant::ValveState::active}) {
            valve_reports(state);
            (void)encode(guard.pass({0.0}, {.mode = plant::ValveMode::active, .authority = 1.0}));
        }
    }

    /// Encodes until the controller's own boot-up and its call to all nodes are out.
    void settle() {
        (void)encode(guard_.neutral());
        (void)encode(guard_.neutral());
    }

    std::int64_t now_ns_ = 1'000'000'000;
    CraneNetwork network_{bare()};
    CommandGuard guard_{{.max_opening_m = 7.6e-3, .max_step_m = 7.6e-3}};
};

TEST_F(CraneNetworkTest, FrameOfTheWrongKindLeavesTheMeasurementUntouched) {
    auto good = with_value(Signal::boom_angle, 1.0);
    for (auto change : std::vector<void (*)(CanFrame&)>{
             [](CanFrame& f) { f.extended = true; }, [](CanFrame& f) { f.remote = true; },
             [](CanFrame& f) { f.error = true; }, [](CanFrame& f) { f.length = 3; }, [](CanFrame& f) { f.length = 5; },
             [](CanFrame& f) { f.id |= 0x0800'0000; }}) {
        auto bad = good;
        change(bad);
        const auto measured = decode({bad});
        EXPECT_EQ(measured.age_ticks[plant::boom_angle_rad], never);
        EXPECT_EQ(measured.value[plant::boom_angle_rad], 0.0);
    }
    EXPECT_TRUE(decode({good}).fresh(plant::boom_angle_rad));
}

TEST_F(CraneNetworkTest, AgesCountTheTicksOfSilenceAndTheValueStays) {
    EXPECT_EQ(decode({}).age_ticks[plant::line_length_m], never);
    EXPECT_NEAR(decode({with_value(Signal::line_length, 12.2)}).value[plant::line_length_m], 12.2, 1e-9);
    for (std::uint32_t silent_ticks = 1; silent_ticks < 300; ++silent_ticks) {
        const auto measured = decode({});
        ASSERT_EQ(measured.age_ticks[plant::line_length_m], silent_ticks);
        ASSERT_EQ(measured.age_ticks[plant::boom_angle_rad], never);
        ASSERT_FALSE(measured.fresh(plant::line_length_m));
        ASSERT_NEAR(measured.value[plant::line_length_m], 12.2, 1e-9);
    }
    EXPECT_EQ(decode({with_value(Signal::line_length, 12.0)}).age_ticks[plant::line_length_m], 0U);
}

TEST_F(CraneNetworkTest, NewestOfSeveralSamplesWinsAndTheOthersAreCounted) {
    const auto measured = decode({with_value(Signal::boom_angle, 1.0), with_value(Signal::line_length, 5.0),
                                  with_value(Signal::boom_angle, 1.1), with_value(Signal::boom_angle, 1.2)});
    EXPECT_NEAR(measured.value[plant::boom_angle_rad], 1.2, 2e-5);
    EXPECT_TRUE(measured.fresh(plant::line_length_m));
    EXPECT_EQ(network_.status().superseded_frames, 2U);
}

TEST_F(CraneNetworkTest, TwoSamplesOutOfRangeAreHeldAndTheThirdMakesTheChannelInvalid) {
    (void)decode({with_value(Signal::boom_angle, 1.0)});
    for (std::uint32_t bad = 1; bad <= 3; ++bad) {
        const auto measured = decode({with_value(Signal::boom_angle, 2.5)});
        EXPECT_EQ(measured.valid[plant::boom_angle_rad], bad <= 2) << bad;
        EXPECT_FALSE(measured.fresh(plant::boom_angle_rad));
        EXPECT_EQ(measured.age_ticks[plant::boom_angle_rad], bad <= 2 ? bad : 0U);
        EXPECT_NEAR(measured.value[plant::boom_angle_rad], 1.0, 2e-5);
        EXPECT_EQ(network_.status().out_of_range_values, bad);
    }
    EXPECT_FALSE(decode({}).valid[plant::boom_angle_rad]) << "silence after a bad sample does not make it good";
    for (int good = 1; good <= 10; ++good) {
        EXPECT_EQ(decode({with_value(Signal::boom_angle, 1.0)}).fresh(plant::boom_angle_rad), good == 10) << good;
    }
}

TEST_F(CraneNetworkTest, JumpThatPhysicsForbidsIsHeldTwiceAndThenTheChannelIsInvalid) {
    const double step_rad = network_.table().row(Signal::boom_angle).largest_step_unit;
    ASSERT_GT(step_rad, 0.0);
    EXPECT_TRUE(decode({with_value(Signal::boom_angle, 1.0)}).fresh(plant::boom_angle_rad));
    EXPECT_TRUE(decode({with_value(Signal::boom_angle, 1.0 + 0.99 * step_rad)}).fresh(plant::boom_angle_rad));
    // The allowance grows with the silence before.
    (void)decode({});
    EXPECT_TRUE(decode({with_value(Signal::boom_angle, 1.0 + 2.98 * step_rad)}).fresh(plant::boom_angle_rad));
    const double level_rad = 1.0 + 2.98 * step_rad;
    for (int bad = 1; bad <= 3; ++bad) {
        const auto measured = decode({with_value(Signal::boom_angle, level_rad + 5.0 * step_rad)});
        EXPECT_EQ(measured.valid[plant::boom_angle_rad], bad <= 2);
        EXPECT_NEAR(measured.value[plant::boom_angle_rad], level_rad, 2e-5);
    }
    EXPECT_EQ(network_.status().implausible_values, 3U);
    for (int settled = 1; settled <= 10; ++settled) {
        EXPECT_EQ(decode({with_value(Signal::boom_angle, level_rad + 5.0 * step_rad)}).fresh(plant::boom_angle_rad),
                  settled == 10)
            << "a new level is one if it stays";
    }
}

TEST_F(CraneNetworkTest, StatusByteOfTheDeviceDecidesValidityOfItsOwnChannelOnly) {
    for (const std::uint8_t status_raw : std::vector<std::uint8_t>{1, 3, 5, 255}) {
        auto strain = with_value(Signal::strain_lower, 100.0);
        strain.data[5] = status_raw;  // the upper joint's
        auto pin = with_value(Signal::line_tension, 1000.0);
        pin.data[4] = status_raw;
        const auto measured = decode({strain, pin});
        EXPECT_TRUE(measured.fresh(plant::strain_lower_microstrain));
        EXPECT_FALSE(measured.valid[plant::strain_upper_microstrain]);
        EXPECT_FALSE(measured.valid[plant::line_tension_N]);
        EXPECT_EQ(measured.value[plant::line_tension_N], 0.0);
    }
    EXPECT_EQ(network_.status().faulty_values, 8U);
}

TEST_F(CraneNetworkTest, ValveStateIsTheLowNibbleOfTheStatusWordAndGibberishIsNotReady) {
    auto frame = network_.table().blank(message_of(Pdo::valve_status), 0);
    for (const int nibble : {0b0000, 0b1000, 0b1001, 0b1011, 0b1111, 0b0011, 0b0111, 0b0001}) {
        write_raw(network_.table().row(Signal::valve_status_word), 0x0700 | nibble, frame);
        EXPECT_EQ(static_cast<int>(decode({frame}).valve_state), nibble);
    }
    for (const int nibble : {0b0010, 0b0100, 0b0101, 0b0110, 0b1010, 0b1100, 0b1101, 0b1110}) {
        write_raw(network_.table().row(Signal::valve_status_word), nibble, frame);
        EXPECT_EQ(decode({frame}).valve_state, plant::ValveState::not_ready);
    }
}

TEST_F(CraneNetworkTest, SafetyInputsAreUnhealthyUntilHeardAndAge) {
    auto measured = decode({});
    EXPECT_FALSE(measured.emergency_stop_healthy);
    EXPECT_FALSE(measured.cutoff_open);
    EXPECT_EQ(measured.safety_inputs_age_ticks, never);
    auto frame = network_.table().blank(message_of(Pdo::safety_inputs), 0);
    frame.data[0] = 0x02;
    measured = decode({frame});
    EXPECT_TRUE(measured.emergency_stop_healthy);
    EXPECT_FALSE(measured.cutoff_open);
    EXPECT_EQ(measured.safety_inputs_age_ticks, 0U);
    frame.data[0] = 0x01;
    EXPECT_TRUE(decode({frame}).cutoff_open);
    measured = decode({});
    EXPECT_FALSE(measured.emergency_stop_healthy);
    EXPECT_EQ(measured.safety_inputs_age_ticks, 1U);
}

TEST_F(CraneNetworkTest, CommandLeavesAsCutOffThenValveThenSync) {
    settle();
    activate(guard_);
    const plant::Permission engaged{.mode = plant::ValveMode::active, .cutoff_energised = true, .authority = 1.0};
    const auto frames = encode(guard_.pass({3.8e-3}, engaged));
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_EQ(frames[0].id, 0x228U);
    EXPECT_EQ(frames[0].length, 1);
    EXPECT_EQ(frames[0].data[0], 1);
    EXPECT_EQ(frames[1].id, 0x220U);
    EXPECT_EQ(frames[1].length, 4);
    EXPECT_EQ(frames[1].data, (std::array<std::uint8_t, 8>{0x07, 0, 0x00, 0x20}));
    EXPECT_EQ(frames[2].id, 0x080U);
    EXPECT_EQ(frames[2].length, 1);
    const auto negative = encode(guard_.pass({-3.8e-3}, engaged));
    EXPECT_EQ(negative[1].data, (std::array<std::uint8_t, 8>{0x07, 0, 0x00, 0xE0}));
    const auto hold = encode(guard_.pass({0.0}, {.mode = plant::ValveMode::hold, .cutoff_energised = true}));
    EXPECT_EQ(hold[1].data, (std::array<std::uint8_t, 8>{0x03, 0, 0, 0}));
    const auto refused = encode(guard_.pass({std::nan("")}, engaged));
    EXPECT_EQ(refused[0].data[0], 0);
    EXPECT_EQ(refused[1].data, (std::array<std::uint8_t, 8>{0x01, 0, 0, 0}));
}

TEST_F(CraneNetworkTest, SetPointNeverLeavesTheValvesFullScale) {
    CommandGuard generous({.max_opening_m = 1.0, .max_step_m = 1.0});
    const plant::Permission engaged{.mode = plant::ValveMode::active, .authority = 1.0};
    settle();
    activate(generous);
    EXPECT_EQ(encode(generous.pass({0.5}, engaged))[1].data, (std::array<std::uint8_t, 8>{0x07, 0, 0x00, 0x40}));
    EXPECT_EQ(encode(generous.pass({-0.5}, engaged))[1].data, (std::array<std::uint8_t, 8>{0x07, 0, 0x00, 0xC0}));
}

TEST_F(CraneNetworkTest, OpeningIsSentToNoValveThatIsNotAskedToBeActive) {
    settle();
    const plant::Permission engaged{.mode = plant::ValveMode::active, .authority = 1.0};
    valve_reports(plant::ValveState::disabled);
    const auto raising = encode(guard_.pass({3.8e-3}, engaged));
    EXPECT_EQ(raising[1].data, (std::array<std::uint8_t, 8>{0x03, 0, 0, 0}));
    activate(guard_);
    for (int tick = 0; tick < 10; ++tick) {
        valve_reports(plant::ValveState::fault_hold);
        (void)encode(guard_.pass({3.8e-3}, engaged));
    }
    EXPECT_EQ(encode(guard_.pass({3.8e-3}, engaged))[1].data, (std::array<std::uint8_t, 8>{0x01, 0, 0, 0}));
}

TEST_F(CraneNetworkTest, ValveIsAskedToLeaveAFaultOnlyByADisabledCommandThatLetsIt) {
    settle();
    const auto reset_bit_came = [&](const plant::Permission& permit) {
        bool came = false;
        for (int tick = 0; tick < 10; ++tick) {
            valve_reports(plant::ValveState::fault_disabled);
            came |= (encode(guard_.pass({0.0}, permit))[1].data[0] & 0x08) != 0;
        }
        return came;
    };
    EXPECT_FALSE(reset_bit_came({.mode = plant::ValveMode::disabled}));
    EXPECT_FALSE(reset_bit_came({.mode = plant::ValveMode::hold, .valve_reset = true}));
    EXPECT_TRUE(reset_bit_came({.mode = plant::ValveMode::disabled, .valve_reset = true}));
}

TEST_F(CraneNetworkTest, SyncComesLastAndCountsFromOneToTwoHundredAndFortyAndOn) {
    for (int tick = 0; tick < 1000; ++tick) {
        now_ns_ += tick_ns;
        const auto frames = encode(guard_.neutral());
        ASSERT_LE(frames.size(), 4U);
        ASSERT_EQ(frames.back().id, 0x080U);
        ASSERT_EQ(frames.back().data[0], tick % 240 + 1);
    }
}

TEST_F(CraneNetworkTest, MeasurementIsStampedWithTheSyncThatAskedForIt) {
    EXPECT_EQ(decode({}).stamp_ns, 0);
    (void)encode(guard_.neutral());
    const auto sync_ns = now_ns_;
    const auto measured = decode({with_value(Signal::boom_angle, 1.0)});
    EXPECT_EQ(measured.stamp_ns, sync_ns);
    EXPECT_NE(now_ns_, sync_ns);
}

TEST_F(CraneNetworkTest, ErrorMessageOfTheInterfaceIsKept) {
    (void)decode({{.id = 0x40, .length = 8, .error = true}});
    EXPECT_EQ(network_.status().error_frames, 1U);
    EXPECT_EQ(network_.status().last_error_class, 0x40U);
}

}  // namespace
}  // namespace steadyboom::drivers
