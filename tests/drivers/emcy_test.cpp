#include "drivers/emcy.hpp"

#include <random>

#include <gtest/gtest.h>

namespace steadyboom::drivers {
namespace {

TEST(Emergency, FrameIsCodeRegisterAndVendorBytes) {
    const auto frame =
        emergency_frame({.node = 0x20, .code = 0x8250, .error_register = 0x11, .vendor = {1, 2, 3, 4, 5}}, 42);
    EXPECT_EQ(frame.id, 0x0A0U);
    EXPECT_EQ(frame.length, 8);
    EXPECT_EQ(frame.stamp_ns, 42);
    EXPECT_EQ(frame.data, (std::array<std::uint8_t, 8>{0x50, 0x82, 0x11, 1, 2, 3, 4, 5}));
}

TEST(Emergency, SurvivesTheBusForEveryNodeAndCode) {
    std::mt19937 random(1);
    for (unsigned code = 0; code <= 0xFFFF; ++code) {
        Emergency sent{.node = static_cast<std::uint8_t>(1 + code % 127),
                       .code = static_cast<std::uint16_t>(code),
                       .error_register = static_cast<std::uint8_t>(random())};
        for (auto& byte : sent.vendor) {
            byte = static_cast<std::uint8_t>(random());
        }
        ASSERT_EQ(decode_emergency(emergency_frame(sent, 0)), sent);
    }
}

TEST(Emergency, OfAllFramesOnlyEightBytesFromANodeAreOne) {
    for (std::uint32_t id = 0; id < standard_id_count; ++id) {
        for (std::uint8_t length = 0; length <= 8; ++length) {
            for (int kind = 0; kind < 4; ++kind) {
                const CanFrame frame{
                    .id = id, .length = length, .extended = kind == 1, .remote = kind == 2, .error = kind == 3};
                const bool expected = kind == 0 && length == 8 && id >= 0x081 && id <= 0x0FF;
                ASSERT_EQ(decode_emergency(frame).has_value(), expected) << id << " " << int{length} << " " << kind;
            }
        }
    }
}

TEST(Emergency, CodesSayTheirNameOrTheirClass) {
    EXPECT_EQ(emergency_text(0x0000), "no error, or error reset");
    EXPECT_EQ(emergency_text(0x8110), "CAN overrun, messages lost");
    EXPECT_EQ(emergency_text(0x8120), "CAN error passive");
    EXPECT_EQ(emergency_text(0x8130), "life guard or heartbeat missed");
    EXPECT_EQ(emergency_text(0x8140), "recovered from bus-off");
    EXPECT_EQ(emergency_text(0x8210), "PDO not processed, wrong length");
    EXPECT_EQ(emergency_text(0x8250), "RPDO timeout");
    EXPECT_EQ(emergency_text(0x8199), "communication");
    EXPECT_EQ(emergency_text(0x2310), "current, device output side");
    EXPECT_EQ(emergency_text(0x2410), "current") << "between the classes: the group";
    EXPECT_EQ(emergency_text(0x5280), "device hardware");
    EXPECT_EQ(emergency_text(0xFF42), "device specific");
    EXPECT_EQ(emergency_text(0xA000), "unknown error");
    EXPECT_EQ(emergency_text(0x0142), "unknown error");
    for (unsigned code = 0; code <= 0xFFFF; ++code) {
        ASSERT_FALSE(emergency_text(static_cast<std::uint16_t>(code)).empty());
    }
}

TEST(Emergency, ResetIsTheFirstClassAlone) {
    EXPECT_TRUE(Emergency{.code = 0x0000}.is_reset());
    EXPECT_TRUE(Emergency{.code = 0x00FF}.is_reset());
    EXPECT_FALSE(Emergency{.code = 0x0100}.is_reset());
}

TEST(Emergency, ErrorRegisterBitsHaveNames) {
    EXPECT_EQ(error_register_text(0), "generic");
    EXPECT_EQ(error_register_text(4), "communication");
    EXPECT_EQ(error_register_text(7), "manufacturer");
    EXPECT_EQ(error_register_text(8), "none");
}

}  // namespace
}  // namespace steadyboom::drivers
