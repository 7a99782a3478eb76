#include "drivers/inverted_twin.hpp"

#include <gtest/gtest.h>

#include "drivers/protection.hpp"

namespace steadyboom::drivers {
namespace {

constexpr std::int64_t now_ns = -1'000'000'000;  // the clock may start below zero

CanFrame plain_frame(std::uint8_t length = 6) {
    return {.id = 0x220, .length = length, .data = {0x0F, 0x00, 0x12, 0x34, 0x05, 0xA7, 0x55, 0xAA}};
}

CanFrame twin_of(CanFrame frame) {
    invert(frame);
    frame.id = 0x320;
    return frame;
}

TEST(InvertedTwin, PairOfPlainAndInvertedIsTakenOnce) {
    InvertedTwin twin;
    twin.take_plain(plain_frame(), now_ns);
    EXPECT_TRUE(twin.take_inverted(twin_of(plain_frame()), now_ns));
    EXPECT_EQ(twin.plain().data, plain_frame().data);
    EXPECT_FALSE(twin.take_inverted(twin_of(plain_frame()), now_ns));
    EXPECT_EQ(twin.status().matched_pairs, 1U);
    EXPECT_EQ(twin.status().lone_frames, 1U);
}

TEST(InvertedTwin, EveryBitThatIsNotInvertedIsFound) {
    for (std::uint8_t length = 1; length <= 8; ++length) {
        for (unsigned bit = 0; bit < 8U * length; ++bit) {
            InvertedTwin twin;
            auto inverted = twin_of(plain_frame(length));
            inverted.data[bit / 8] = static_cast<std::uint8_t>(inverted.data[bit / 8] ^ (1U << bit % 8));
            twin.take_plain(plain_frame(length), now_ns);
            EXPECT_FALSE(twin.take_inverted(inverted, now_ns)) << int{length} << ": " << bit;
            EXPECT_EQ(twin.status().mismatched_pairs, 1U);
        }
    }
}

TEST(InvertedTwin, CopyInsteadOfInverseAndOtherLengthAreFound) {
    InvertedTwin twin;
    twin.take_plain(plain_frame(), now_ns);
    EXPECT_FALSE(twin.take_inverted(plain_frame(), now_ns));
    twin.take_plain(plain_frame(6), now_ns);
    EXPECT_FALSE(twin.take_inverted(twin_of(plain_frame(5)), now_ns));
    twin.take_plain(plain_frame(5), now_ns);
    EXPECT_FALSE(twin.take_inverted(twin_of(plain_frame(6)), now_ns));
    EXPECT_EQ(twin.status().mismatched_pairs, 3U);
}

TEST(InvertedTwin, TwinMayBeTwoMillisecondsLateAndNotLonger) {
    for (const auto& [late_ns, taken] :
         {std::pair{0, true}, {2'000'000, true}, {2'000'001, false}, {-1, false}, {1'000'000'000, false}}) {
        InvertedTwin twin;
        twin.take_plain(plain_frame(), now_ns);
        EXPECT_EQ(twin.take_inverted(twin_of(plain_frame()), now_ns + late_ns), taken) << late_ns;
        EXPECT_EQ(twin.status().late_pairs, taken ? 0U : 1U);
    }
}

TEST(InvertedTwin, TwinOfAnEarlierFrameDoesNotMatchAndTheLostOneIsCounted) {
    InvertedTwin twin;
    auto first = plain_frame();
    protect(first, 0x220, 1, 0);
    auto second = plain_frame();
    protect(second, 0x220, 2, 0);
    twin.take_plain(first, now_ns);
    twin.take_plain(second, now_ns);
    EXPECT_FALSE(twin.take_inverted(twin_of(first), now_ns));
    EXPECT_EQ(twin.status().lone_frames, 1U);
    EXPECT_EQ(twin.status().mismatched_pairs, 1U);
}

TEST(InvertedTwin, InvertedBeforePlainIsNoPair) {
    InvertedTwin twin;
    EXPECT_FALSE(twin.take_inverted(twin_of(plain_frame()), now_ns));
    twin.take_plain(plain_frame(), now_ns);
    twin.forget();
    EXPECT_FALSE(twin.take_inverted(twin_of(plain_frame()), now_ns));
    EXPECT_EQ(twin.status().lone_frames, 3U);
}

}  // namespace
}  // namespace steadyboom::drivers
