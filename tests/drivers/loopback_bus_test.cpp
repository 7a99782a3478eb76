#include "drivers/loopback_bus.hpp"

#include <array>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace steadyboom::drivers {
namespace {

std::vector<CanFrame> numbered(std::uint32_t first, std::uint32_t count) {
    std::vector<CanFrame> frames;
    for (std::uint32_t i = 0; i < count; ++i) {
        frames.push_back({.id = first + i, .length = 1, .data = {7}, .stamp_ns = i});
    }
    return frames;
}

TEST(LoopbackBus, EveryOtherEndpointReceivesEachFrameInOrder) {
    LoopbackBus bus(3);
    EXPECT_EQ(bus.endpoint(0).send(numbered(10, 3)).sent, 3U);
    EXPECT_EQ(bus.endpoint(2).send(numbered(20, 2)).sent, 2U);
    std::array<CanFrame, 16> into;
    ASSERT_EQ(bus.endpoint(1).receive(into), 5U);
    for (const auto& [index, id] : {std::pair{0U, 10U}, {1U, 11U}, {2U, 12U}, {3U, 20U}, {4U, 21U}}) {
        EXPECT_EQ(into[index].id, id);
    }
    EXPECT_EQ(into[2].stamp_ns, 2);
    EXPECT_EQ(into[2].data[0], 7);
    EXPECT_EQ(bus.endpoint(0).receive(into), 2U) << "its own frames do not come back";
    EXPECT_EQ(bus.endpoint(2).receive(into), 3U);
    EXPECT_EQ(bus.endpoint(1).receive(into), 0U);
    EXPECT_EQ(bus.endpoint(0).status().sent_frames, 3U);
    EXPECT_EQ(bus.endpoint(1).status().received_frames, 5U);
}

TEST(LoopbackBus, FullBufferDropsWhatComesInAndCountsIt) {
    LoopbackBus bus(2, 4);
    std::array<CanFrame, 16> into;
    (void)bus.endpoint(0).send(numbered(0, 3));
    ASSERT_EQ(bus.endpoint(1).receive(into), 3U);
    (void)bus.endpoint(0).send(numbered(100, 7));
    ASSERT_EQ(bus.endpoint(1).receive(into), 4U);
    EXPECT_EQ(into[0].id, 100U);
    EXPECT_EQ(into[3].id, 103U);
    EXPECT_EQ(bus.endpoint(1).status().receive_overflow_frames, 3U);
    EXPECT_EQ(bus.endpoint(0).status().receive_overflow_frames, 0U);
}

TEST(LoopbackBus, FramesBeyondTheCallersRoomWait) {
    LoopbackBus bus;
    (void)bus.endpoint(0).send(numbered(0, 5));
    std::array<CanFrame, 2> into;
    EXPECT_EQ(bus.endpoint(1).receive(into), 2U);
    EXPECT_EQ(bus.endpoint(1).receive(into), 2U);
    EXPECT_EQ(into[1].id, 3U);
    EXPECT_EQ(bus.endpoint(1).receive(into), 1U);
    EXPECT_EQ(into[0].id, 4U);
}

TEST(LoopbackBus, TapSeesEveryFrameOnce) {
    LoopbackBus bus(3, 1);
    std::vector<std::uint32_t> seen;
    bus.set_tap([&seen](const CanFrame& frame) { seen.push_back(frame.id); });
    (void)bus.endpoint(0).send(numbered(1, 2));
    (void)bus.endpoint(1).send(numbered(9, 1));
    EXPECT_EQ(seen, (std::vector<std::uint32_t>{1, 2, 9}));
}

TEST(LoopbackBus, BusOfOneOrWithoutRoomIsRejected) {
    EXPECT_THROW(LoopbackBus(1), std::invalid_argument);
    EXPECT_THROW(LoopbackBus(2, 0), std::invalid_argument);
    LoopbackBus bus;
    EXPECT_THROW((void)bus.endpoint(2), std::out_of_range);
}

TEST(LoopbackBus, WireMayChangeAndLoseFrames) {
    LoopbackBus bus;
    int tapped = 0;
    bus.set_tap([&](const CanFrame&) { ++tapped; });
    bus.set_wire([](CanFrame& frame) {
        frame.data[0] = 7;
        return frame.id != 2;
    });
    const std::array frames = {CanFrame{.id = 1, .length = 1}, CanFrame{.id = 2, .length = 1}};
    EXPECT_EQ(bus.endpoint(0).send(frames).sent, 2U);
    std::array<CanFrame, 4> arrived;
    ASSERT_EQ(bus.endpoint(1).receive(arrived), 1U);
    EXPECT_EQ(arrived[0].id, 1U);
    EXPECT_EQ(arrived[0].data[0], 7);
    EXPECT_EQ(tapped, 1);
}

}  // namespace
}  // namespace steadyboom::drivers
