#include "drivers/j1939_valve.hpp"

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/pdo_codec.hpp"
#include "tests/support/j1939_network.hpp"

namespace steadyboom::drivers {
namespace {

using plant::ValveMode;
using plant::ValveState;

/// Valve 2 at address 0x20, led from address 0x26.
NetworkConfig j1939_config(double direction = 1.0, bool extended = false) {
    NetworkConfig config;
    test_support::make_valve_j1939(config);
    config[Pdo::valve_command].extended_id = 0x0CFE3226;
    config[Pdo::valve_status].extended_id = 0x0CFE1220;
    auto& set_point = config[Signal::valve_set_point];
    set_point.type = extended ? RawType::u16 : RawType::u8;
    set_point.byte_offset = extended ? 3 : 0;
    set_point.scale = direction * (extended ? 0.0015625 : 0.4);
    config[Signal::spool].scale = direction;
    config[Signal::spool].offset = -125.0 * direction;
    return config;
}

class J1939DriverTest : public ::testing::TestWithParam<double> {
  protected:
    CanFrame sent(double opening_m, ValveMode mode = ValveMode::active) {
        CommandGuard guard({.max_opening_m = travel_m, .max_step_m = travel_m});
        const plant::Permission permit{.mode = mode, .authority = mode == ValveMode::active ? 1.0 : 0.0};
        const auto frames = driver_.encode(guard.pass({opening_m}, permit), 1, 5);
        EXPECT_EQ(frames.size(), 1U);
        return frames[0];
    }

    ValveState heard(const AuxiliaryValveFlow& flow) {
        CanFrame frame;
        write_flow(flow, frame);
        driver_.decode(frame);
        return driver_.status().state;
    }

    static constexpr double travel_m = 7.6e-3;
    DeviceTable table_{j1939_config(GetParam())};
    J1939Driver driver_{table_};
    J1939Port port_{table_};
};

TEST_P(J1939DriverTest, OpeningBecomesPortAndFlowOnTheGroupsIdentifier) {
    const bool turned = GetParam() < 0.0;
    const auto positive = sent(0.25 * travel_m);
    EXPECT_EQ(positive.id, 0x0CFE3226U);
    EXPECT_TRUE(positive.extended);
    EXPECT_EQ(positive.length, 8);
    EXPECT_EQ(positive.stamp_ns, 5);
    EXPECT_EQ(positive.data[0], 63);
    EXPECT_EQ(positive.data[2], turned ? 0x32 : 0x31);
    const auto negative = sent(-travel_m);
    EXPECT_EQ(negative.data[0], 250);
    EXPECT_EQ(negative.data[2], turned ? 0x31 : 0x32);
}

TEST_P(J1939DriverTest, NothingButAnActiveValveIsToldToMove) {
    for (const auto mode : {ValveMode::disabled, ValveMode::hold}) {
        const auto frame = sent(0.0, mode);
        EXPECT_EQ(frame.data[0], 0);
        EXPECT_EQ(frame.data[2], 0x30) << "blocked, and blocked when we fall silent";
    }
    EXPECT_EQ(sent(0.0).data[2], 0x30);
    EXPECT_EQ(sent(0.0019 * travel_m).data[2], 0x30) << "less than half a step";
    EXPECT_NE(sent(0.0021 * travel_m).data[2], 0x30);
}

TEST_P(J1939DriverTest, BothEndsAgreeOnEveryOpeningWithinHalfAStep) {
    for (const bool extended : {false, true}) {
        const DeviceTable table(j1939_config(GetParam(), extended));
        J1939Driver driver(table);
        J1939Port port(table);
        CommandGuard guard({.max_opening_m = travel_m, .max_step_m = travel_m});
        const double half_step_m = travel_m * (extended ? 0.0000078125 : 0.002) + 1e-12;
        for (int i = -1000; i <= 1000; ++i) {
            const double opening_m = i / 1000.0 * travel_m;
            const plant::Permission permit{.mode = ValveMode::active, .authority = 1.0};
            (void)guard.neutral();
            const auto order = port.take(driver.encode(guard.pass({opening_m}, permit), 1, 0)[0]);
            ASSERT_TRUE(order.has_value());
            ASSERT_NEAR(order->set_point_m, opening_m, half_step_m);
            ASSERT_EQ((order->control_word & control_active) != 0, order->set_point_m != 0.0);
        }
    }
}

TEST_P(J1939DriverTest, SoundValveReportsWhatItWasAskedFor) {
    EXPECT_EQ(driver_.status().state, ValveState::not_ready) << "before it was heard";
    (void)sent(0.0, ValveMode::disabled);
    EXPECT_EQ(heard({.state = PortState::blocked}), ValveState::disabled);
    (void)sent(0.0, ValveMode::hold);
    EXPECT_EQ(heard({.state = PortState::blocked}), ValveState::hold);
    (void)sent(0.0);
    EXPECT_EQ(heard({.state = PortState::blocked}), ValveState::active);
    (void)sent(1e-3);
    EXPECT_EQ(heard({.extend_flow = 0.1, .state = PortState::extend}), ValveState::active);
}

TEST_P(J1939DriverTest, ValveThatMovesUnaskedFloatsOrFailsIsSeen) {
    for (const auto mode : {ValveMode::disabled, ValveMode::hold}) {
        (void)sent(0.0, mode);
        EXPECT_EQ(heard({.state = PortState::extend}), ValveState::active);
        EXPECT_EQ(heard({.state = PortState::retract}), ValveState::active);
    }
    (void)sent(1e-3);
    EXPECT_EQ(heard({.state = PortState::floating}), ValveState::fault_disabled);
    EXPECT_EQ(heard({.state = PortState::error}), ValveState::fault_disabled);
    EXPECT_EQ(heard({.state = PortState::extend, .limit = FlowLimit::fault}), ValveState::fault_disabled);
    EXPECT_EQ(heard({.state = PortState::not_available}), ValveState::not_ready);
    EXPECT_EQ(heard({.state = PortState::extend, .limit = FlowLimit::operator_controlled}), ValveState::hold);
    EXPECT_EQ(heard({.state = PortState::extend, .limit = FlowLimit::limited_high}), ValveState::active);
    EXPECT_TRUE(driver_.status().limit_touched);
    driver_.decode({.length = 8, .data = {0xFF, 0xFF, 0x30, 0x1F}});
    EXPECT_EQ(driver_.status().state, ValveState::not_ready) << "no flow, no report";
}

TEST_P(J1939DriverTest, ReportTellsStateAndSpoolAsTheTableReadsThem) {
    const auto& spool = table_.row(Signal::spool);
    for (int percent = -125; percent <= 125; ++percent) {
        const double spool_m = 0.01 * percent * travel_m;
        auto frame = table_.blank(message_of(Pdo::valve_status), 0);
        port_.report({.state = ValveState::active}, spool_m, frame);
        EXPECT_EQ(frame.id, 0x0CFE1220U);
        const auto value = decode_value(spool, frame);
        ASSERT_TRUE(value.has_value());
        ASSERT_NEAR(*value, spool_m, 1e-9);
        const auto flow = read_flow(frame).value();
        ASSERT_NEAR(flow.extend_flow, -flow.retract_flow, 1e-12);
    }
}

TEST_P(J1939DriverTest, EveryFaultOfTheValveReachesTheController) {
    (void)sent(1e-3);
    for (const auto state : {ValveState::fault_hold, ValveState::fault_reaction, ValveState::fault_disabled}) {
        CanFrame frame;
        port_.report({.state = state}, 0.0, frame);
        driver_.decode(frame);
        EXPECT_EQ(driver_.status().state, ValveState::fault_disabled);
    }
    CanFrame frame;
    port_.report({.state = ValveState::not_ready}, 0.0, frame);
    driver_.decode(frame);
    EXPECT_EQ(driver_.status().state, ValveState::not_ready);
}

TEST_P(J1939DriverTest, PortNeverFloatsAndRefusesWhatIsNoCommand) {
    CanFrame frame;
    write_command({.state = PortState::floating, .flow = 1.0}, FlowResolution::standard, frame);
    const auto order = port_.take(frame);
    ASSERT_TRUE(order.has_value());
    EXPECT_EQ(order->control_word & control_active, 0);
    EXPECT_EQ(order->set_point_m, 0.0);
    frame.data[0] = 251;
    EXPECT_FALSE(port_.take(frame).has_value());
    frame.length = 7;
    EXPECT_FALSE(port_.take(frame).has_value());
}

TEST_P(J1939DriverTest, BlockingResetsAFaultThatIsOverAndMovingDoesNot) {
    Cia408Valve valve;
    const auto step = [&](double opening_m, ValveFault fault) {
        const auto order = port_.take(sent(opening_m));
        return valve.step({.control_word_raw = order->control_word, .fault = fault});
    };
    EXPECT_EQ(step(1e-3, ValveFault::none), ValveState::active);
    EXPECT_EQ(step(1e-3, ValveFault::holds), ValveState::fault_hold);
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(step(i % 2 == 0 ? 1e-3 : 2e-3, ValveFault::none), ValveState::fault_hold);
    }
    (void)step(0.0, ValveFault::none);
    (void)step(0.0, ValveFault::none);
    EXPECT_EQ(step(0.0, ValveFault::none), ValveState::hold);
}

INSTANTIATE_TEST_SUITE_P(Direction, J1939DriverTest, ::testing::Values(1.0, -1.0), [](const auto& chosen) {
    return std::string(chosen.param > 0.0 ? "ExtendTakesIn" : "ExtendPaysOut");
});

TEST(J1939Config, WhatIso11783SaysOtherwiseIsRefusedByKey) {
    const auto complaint = [](const std::function<void(NetworkConfig&)>& change) -> std::string {
        auto config = j1939_config();
        change(config);
        try {
            const DeviceTable table(config);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "accepted";
    };
    using ::testing::HasSubstr;
    EXPECT_EQ(complaint([](auto&) {}), "accepted");
    EXPECT_THAT(complaint([](auto& c) { c[Device::servo_valve].canopen = true; }), HasSubstr("servo_valve.canopen"));
    EXPECT_THAT(complaint([](auto& c) { c[Device::servo_valve].protection = Protection::e2e; }),
                HasSubstr("servo_valve.protection"));
    EXPECT_THAT(complaint([](auto& c) { c[Pdo::valve_command].extended_id = 0x0CFE1026; }),
                HasSubstr("pdo.valve_command.extended_id"));
    EXPECT_THAT(complaint([](auto& c) { c[Pdo::valve_status].extended_id = 0; }),
                HasSubstr("pdo.valve_status.extended_id"));
    EXPECT_THAT(complaint([](auto& c) { c[Pdo::valve_status].length_bytes = 4; }),
                HasSubstr("pdo.valve_status.length_bytes"));
    EXPECT_THAT(complaint([](auto& c) {
                    c[Signal::valve_status_word].mapped = true;
                    c[Signal::valve_status_word].byte_offset = 4;
                }),
                HasSubstr("signal.valve_status_word.mapped"));
    EXPECT_THAT(complaint([](auto& c) { c[Signal::valve_set_point].scale = 0.5; }),
                HasSubstr("signal.valve_set_point.scale"));
    EXPECT_THAT(complaint([](auto& c) { c[Signal::spool].scale = -1.0; }), HasSubstr("signal.spool.scale"));
    EXPECT_THAT(complaint([](auto& c) { c[Signal::valve_control_word].mapped = true; }), HasSubstr("signal."));
}

}  // namespace
}  // namespace steadyboom::drivers
