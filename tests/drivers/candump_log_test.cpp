#include "drivers/candump_log.hpp"

#include <gtest/gtest.h>

namespace steadyboom::drivers {
namespace {

TEST(CandumpLine, StandardFrameReadsAsInTheManualOfCanUtils) {
    const CanFrame frame{
        .id = 0x044, .length = 5, .data = {0x2A, 0x36, 0x6C, 0x2B, 0xBA, 0xFF}, .stamp_ns = 1'436'509'052'249'713'999};
    EXPECT_EQ(candump_line(frame, "vcan0").view(), "(1436509052.249713) vcan0 044#2A366C2BBA");
}

TEST(CandumpLine, SmallStampsAndEmptyFramesKeepTheirWidth) {
    EXPECT_EQ(candump_line({.id = 0x7, .length = 0, .stamp_ns = 5'000'000}, "can0").view(),
              "(0000000000.005000) can0 007#");
    EXPECT_EQ(candump_line({.id = 0x7, .length = 0, .stamp_ns = -5}, "can0").view(), "(0000000000.000000) can0 007#");
}

TEST(CandumpLine, ExtendedRemoteAndErrorFramesAreTold) {
    EXPECT_EQ(candump_line({.id = 0x123, .length = 1, .data = {0x0F}, .extended = true}, "can0").view(),
              "(0000000000.000000) can0 00000123#0F");
    EXPECT_EQ(candump_line({.id = 0x123, .length = 0, .remote = true}, "can0").view(),
              "(0000000000.000000) can0 123#R");
    EXPECT_EQ(candump_line({.id = 0x123, .length = 4, .remote = true}, "can0").view(),
              "(0000000000.000000) can0 123#R4");
    EXPECT_EQ(candump_line({.id = 0x40, .length = 8, .error = true}, "can0").view(),
              "(0000000000.000000) can0 20000040#0000000000000000");
}

TEST(CandumpLine, LongestLineFits) {
    CanFrame frame{.id = 0x1FFF'FFFF, .length = 255, .extended = true, .stamp_ns = INT64_MAX};
    frame.data.fill(0xAB);
    EXPECT_EQ(candump_line(frame, "a-name-much-too-long-for-linux").view(),
              "(9223372036.854775) a-name-much-too 1FFFFFFF#ABABABABABABABAB");
}

}  // namespace
}  // namespace steadyboom::drivers
