#include "drivers/error_message.hpp"

#include <linux/can/error.h>

#include <array>

#include <gtest/gtest.h>

#include "drivers/loopback_bus.hpp"

namespace steadyboom::drivers {
namespace {

CanFrame message(std::uint32_t error_class, std::uint8_t controller = 0, std::uint8_t transmit = 0,
                 std::uint8_t receive = 0) {
    return {.id = error_class, .length = 8, .data = {0, controller, 0, 0, 0, 0, transmit, receive}, .error = true};
}

TEST(ErrorMessage, EachStateOfTheControllerIsAValueAndACounter) {
    BusStatus status;
    note_error_message(message(CAN_ERR_CRTL | CAN_ERR_CNT, CAN_ERR_CRTL_TX_WARNING, 100, 96), status);
    EXPECT_EQ(status.link, LinkState::warning);
    EXPECT_EQ(status.warnings, 1U);
    EXPECT_EQ(status.transmit_error_count, 100);
    EXPECT_EQ(status.receive_error_count, 96);
    note_error_message(message(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE, 7, 7), status);
    EXPECT_EQ(status.link, LinkState::passive);
    EXPECT_EQ(status.passives, 1U);
    EXPECT_EQ(status.transmit_error_count, 100) << "counters count only where CAN_ERR_CNT says they are there";
    note_error_message(message(CAN_ERR_BUSOFF), status);
    EXPECT_EQ(status.link, LinkState::bus_off);
    EXPECT_EQ(status.bus_offs, 1U);
    note_error_message(message(CAN_ERR_RESTARTED), status);
    EXPECT_EQ(status.link, LinkState::active);
    note_error_message(message(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING), status);
    note_error_message(message(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE), status);
    EXPECT_EQ(status.link, LinkState::active);
    note_error_message(message(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW), status);
    EXPECT_EQ(status.controller_overruns, 1U);
    EXPECT_EQ(status.error_frames, 7U);
}

TEST(ErrorMessage, TheWorstOfSeveralStatesInOneMessageCounts) {
    BusStatus status;
    note_error_message(message(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING | CAN_ERR_CRTL_TX_PASSIVE), status);
    EXPECT_EQ(status.link, LinkState::passive);
    note_error_message(message(CAN_ERR_BUSOFF | CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE), status);
    EXPECT_EQ(status.link, LinkState::bus_off);
}

TEST(ErrorMessage, BusErrorsWithoutAStateAndShortMessagesChangeNoState) {
    BusStatus status;
    note_error_message(message(CAN_ERR_ACK), status);
    note_error_message(message(CAN_ERR_PROT | CAN_ERR_BUSERROR, 0xFF), status);
    CanFrame cut = message(CAN_ERR_CRTL | CAN_ERR_CNT, CAN_ERR_CRTL_TX_PASSIVE, 9, 9);
    cut.length = 1;
    note_error_message(cut, status);
    EXPECT_EQ(status.link, LinkState::active);
    EXPECT_EQ(status.transmit_error_count, 0);
    EXPECT_EQ(status.error_frames, 3U);
}

TEST(LoopbackBus, ErrorMessagesAndFloodsAreValuesAsOnARealBus) {
    LoopbackBus bus;
    std::array<CanFrame, 100> frames;
    (void)bus.endpoint(1).send(std::array{message(CAN_ERR_BUSOFF)});
    EXPECT_EQ(bus.endpoint(0).receive(frames), 1U);
    EXPECT_EQ(bus.endpoint(0).status().link, LinkState::bus_off);
    (void)bus.endpoint(1).send(std::span(frames).first(0));
    for (std::size_t i = 0; i < flood_frames; ++i) {
        (void)bus.endpoint(1).send(std::array{CanFrame{.id = 0x190}});
    }
    EXPECT_EQ(bus.endpoint(0).receive(frames), flood_frames);
    EXPECT_EQ(bus.endpoint(0).status().link, LinkState::active) << "frames come in: not off the bus any more";
    EXPECT_EQ(bus.endpoint(0).status().floods, 0U);
    for (std::size_t i = 0; i <= flood_frames; ++i) {
        (void)bus.endpoint(1).send(std::array{CanFrame{.id = 0x190}});
    }
    (void)bus.endpoint(0).receive(frames);
    EXPECT_EQ(bus.endpoint(0).status().floods, 1U);
}

}  // namespace
}  // namespace steadyboom::drivers
