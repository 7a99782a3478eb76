#include "drivers/auxiliary_valve.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace steadyboom::drivers {
namespace {

using Bytes = std::array<std::uint8_t, 8>;

Bytes bytes_of(const AuxiliaryValveCommand& command, FlowResolution resolution = FlowResolution::standard) {
    CanFrame frame;
    write_command(command, resolution, frame);
    EXPECT_EQ(frame.length, 8);
    return frame.data;
}

CanFrame frame_of(const Bytes& bytes) {
    return {.length = 8, .data = bytes};
}

TEST(AuxiliaryValve, IdentifiersAreOfPriorityThreeAndTheBroadcastGroups) {
    EXPECT_EQ(j1939_id(auxiliary_valve_priority, auxiliary_valve_command_pgn, 0x26), 0x0CFE3026U);
    EXPECT_EQ(j1939_id(auxiliary_valve_priority, auxiliary_valve_flow_pgn + 15, 0x20), 0x0CFE1F20U);
}

TEST(AuxiliaryValve, CommandLiesInItsBytesAndTheRestSaysNotAvailable) {
    EXPECT_EQ(bytes_of({}), (Bytes{0, 0xFC, 0x30, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}));
    EXPECT_EQ(bytes_of({.state = PortState::extend, .flow = 0.5}),
              (Bytes{125, 0xFC, 0x31, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}));
    EXPECT_EQ(bytes_of({.state = PortState::retract, .flow = 1.0, .fail_safe = FailSafeMode::floating}),
              (Bytes{250, 0xFC, 0x72, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}));
    EXPECT_EQ(bytes_of({.state = PortState::extend, .flow = 0.5}, FlowResolution::extended),
              (Bytes{125, 0xFD, 0x31, 0x00, 0x7D, 0xFF, 0xFF, 0xFF}));
}

TEST(AuxiliaryValve, FlowOfACommandIsCutAndNeverNotANumber) {
    EXPECT_EQ(bytes_of({.flow = 1.5})[0], 250);
    EXPECT_EQ(bytes_of({.flow = -0.5})[0], 0);
    EXPECT_EQ(bytes_of({.flow = std::nan("")})[0], 0);
    EXPECT_EQ(bytes_of({.flow = std::numeric_limits<double>::infinity()})[0], 250);
    EXPECT_EQ(bytes_of({.flow = std::numeric_limits<double>::infinity()}, FlowResolution::extended)[4], 0xFA);
}

TEST(AuxiliaryValve, EveryCommandSurvivesTheBusWithinHalfAStep) {
    for (const auto state : {PortState::blocked, PortState::extend, PortState::retract, PortState::floating}) {
        for (const auto fail_safe : {FailSafeMode::block, FailSafeMode::floating, FailSafeMode::not_available}) {
            for (int i = 0; i <= 4000; ++i) {
                const AuxiliaryValveCommand sent{.state = state, .flow = i / 4000.0, .fail_safe = fail_safe};
                const auto coarse = read_command(frame_of(bytes_of(sent)));
                const auto fine = read_command(frame_of(bytes_of(sent, FlowResolution::extended)));
                ASSERT_TRUE(coarse && fine);
                ASSERT_NEAR(coarse->flow, sent.flow, 0.002 + 1e-12);
                ASSERT_NEAR(fine->flow, sent.flow, 0.0000078125 + 1e-12);
                ASSERT_EQ(coarse->state, state);
                ASSERT_EQ(fine->fail_safe, fail_safe);
            }
        }
    }
}

TEST(AuxiliaryValve, OfAllFirstThreeBytesOnlyWholeCommandsAreTaken) {
    for (unsigned flow = 0; flow < 256; ++flow) {
        for (unsigned state = 0; state < 256; ++state) {
            const auto command = read_command(frame_of(
                {static_cast<std::uint8_t>(flow), 0xFC, static_cast<std::uint8_t>(state), 0xFF, 0xFF, 0, 0, 0}));
            const auto nibble = state & 0x0FU;
            ASSERT_EQ(command.has_value(), flow <= 250 && (nibble <= 3 || nibble == 15)) << flow << " " << state;
        }
    }
    EXPECT_FALSE(read_command(frame_of({0, 0xFD, 1, 0x01, 0xFA, 0, 0, 0}))) << "64001 is above 100 %";
    EXPECT_TRUE(read_command(frame_of({0, 0xFD, 1, 0x00, 0xFA, 0, 0, 0})));
    EXPECT_FALSE(read_command({.length = 7}));
}

TEST(AuxiliaryValve, EveryReportSurvivesTheBus) {
    for (int extend = -125; extend <= 125; ++extend) {
        for (const auto state : {PortState::blocked, PortState::extend, PortState::retract, PortState::floating,
                                 PortState::error, PortState::not_available}) {
            for (const auto limit : {FlowLimit::not_limited, FlowLimit::operator_controlled, FlowLimit::limited_high,
                                     FlowLimit::limited_low, FlowLimit::fault, FlowLimit::not_available}) {
                CanFrame frame;
                write_flow(
                    {.extend_flow = 0.01 * extend, .retract_flow = -0.01 * extend, .state = state, .limit = limit},
                    frame);
                const auto flow = read_flow(frame);
                ASSERT_TRUE(flow.has_value());
                ASSERT_NEAR(flow->extend_flow, 0.01 * extend, 1e-12);
                ASSERT_NEAR(flow->retract_flow, -0.01 * extend, 1e-12);
                ASSERT_EQ(flow->state, state);
                ASSERT_EQ(flow->limit, limit);
            }
        }
    }
}

TEST(AuxiliaryValve, ReportWithoutAValueIsNoneAndReservedCodesAreFaults) {
    EXPECT_FALSE(read_flow(frame_of({0xFF, 125, 0x30, 0x1F, 0, 0, 0, 0})));
    EXPECT_FALSE(read_flow(frame_of({125, 251, 0x30, 0x1F, 0, 0, 0, 0})));
    EXPECT_FALSE(read_flow({.length = 6}));
    for (std::uint8_t state = 4; state < 14; ++state) {
        EXPECT_EQ(read_flow(frame_of({125, 125, state, 0x1F, 0, 0, 0, 0}))->state, PortState::error);
    }
    EXPECT_EQ(read_flow(frame_of({125, 125, 0, 0x9F, 0, 0, 0, 0}))->limit, FlowLimit::fault);
    EXPECT_EQ(read_flow(frame_of({125, 125, 0, 0xBF, 0, 0, 0, 0}))->limit, FlowLimit::fault);
}

}  // namespace
}  // namespace steadyboom::drivers
