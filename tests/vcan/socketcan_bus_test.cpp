#include "drivers/socketcan_bus.hpp"

#include <linux/can/error.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/realtime_section.hpp"

namespace steadyboom::drivers {
namespace {

using ::testing::HasSubstr;

void run(const std::string& command) {
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

/// Interfaces of this test's own, so that taking them down disturbs nobody.
class SocketCanBusTest : public ::testing::Test {
  protected:
    void SetUp() override { add_interface(); }
    void TearDown() override { (void)std::system("ip link del steady0 2>/dev/null"); }

    void add_interface() { run("ip link add steady0 type vcan && ip link set steady0 up"); }

    std::size_t receive(SocketCanBus& bus) {
        const runtime::RealtimeSection no_allocation;
        return bus.receive(frames_);
    }

    static SendResult send(SocketCanBus& bus, const std::vector<CanFrame>& frames) {
        const runtime::RealtimeSection no_allocation;
        return bus.send(frames);
    }

    static std::vector<CanFrame> numbered(std::size_t count) {
        std::vector<CanFrame> frames(count);
        for (std::size_t i = 0; i < count; ++i) {
            frames[i].id = 0x100;
            frames[i].length = 2;
            frames[i].data = {static_cast<std::uint8_t>(i & 0xFFU), static_cast<std::uint8_t>(i >> 8U)};
        }
        return frames;
    }

    std::array<CanFrame, 2048> frames_;
};

std::int64_t steady_ns() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

TEST_F(SocketCanBusTest, FramesArriveInOrderWithTheirContentAndASteadyStamp) {
    SocketCanBus one("steady0");
    SocketCanBus other("steady0");
    const auto before_ns = steady_ns();
    const auto result = send(one, {{.id = 0x7FF, .length = 8, .data = {1, 2, 3, 4, 5, 6, 7, 8}},
                                   {.id = 0x000, .length = 0},
                                   {.id = 0x1ABCDEF0, .length = 1, .data = {9}, .extended = true},
                                   {.id = 0x123, .length = 4, .remote = true}});
    EXPECT_EQ(result.sent, 4U);
    EXPECT_EQ(result.dropped, 0U);
    EXPECT_EQ(result.error, BusError::none);
    ASSERT_EQ(receive(other), 4U);
    EXPECT_EQ(frames_[0].id, 0x7FFU);
    EXPECT_EQ(frames_[0].length, 8);
    EXPECT_EQ(frames_[0].data, (std::array<std::uint8_t, 8>{1, 2, 3, 4, 5, 6, 7, 8}));
    EXPECT_EQ(frames_[1].id, 0U);
    EXPECT_EQ(frames_[1].length, 0);
    EXPECT_FALSE(frames_[1].extended || frames_[1].remote || frames_[1].error);
    EXPECT_EQ(frames_[2].id, 0x1ABCDEF0U);
    EXPECT_TRUE(frames_[2].extended);
    EXPECT_EQ(frames_[3].id, 0x123U);
    EXPECT_TRUE(frames_[3].remote);
    EXPECT_GE(frames_[0].stamp_ns, before_ns);
    EXPECT_LE(frames_[0].stamp_ns, steady_ns());
    EXPECT_EQ(receive(one), 0U) << "own frames do not come back";
    EXPECT_EQ(one.status().sent_frames, 4U);
    EXPECT_EQ(other.status().received_frames, 4U);
    EXPECT_EQ(other.status().local_frames, 4U) << "sent on this machine";
    EXPECT_EQ(other.status().receive_errors, 0U);
}

TEST_F(SocketCanBusTest, EmptyBusGivesNothingAtOnceAndIsNoError) {
    SocketCanBus bus("steady0");
    EXPECT_EQ(receive(bus), 0U);
    EXPECT_EQ(bus.status().receive_error, BusError::none);
    EXPECT_EQ(send(bus, {}).error, BusError::none);
    pollfd ready{.fd = bus.fd(), .events = POLLIN, .revents = 0};
    EXPECT_EQ(::poll(&ready, 1, 0), 0);
    SocketCanBus other("steady0");
    (void)send(other, numbered(1));
    EXPECT_EQ(::poll(&ready, 1, 1000), 1);
}

TEST_F(SocketCanBusTest, MoreFramesThanOneKernelCallTakesAreDrainedAndSentWhole) {
    SocketCanBus one("steady0");
    SocketCanBus other("steady0");
    EXPECT_EQ(send(one, numbered(1000)).sent, 1000U);
    ASSERT_EQ(receive(other), 1000U);
    for (std::size_t i = 0; i < 1000; ++i) {
        ASSERT_EQ(frames_[i].data[0] + 256U * frames_[i].data[1], i);
    }
    EXPECT_EQ(other.status().receive_overflow_frames, 0U) << "the buffer is larger than the kernel's default";
}

TEST_F(SocketCanBusTest, ReceiveIsBoundedByTheCallersRoom) {
    SocketCanBus one("steady0");
    SocketCanBus other("steady0");
    (void)send(one, numbered(150));
    std::array<CanFrame, 100> little;
    EXPECT_EQ(other.receive(little), 100U);
    EXPECT_EQ(other.receive(little), 50U);
    EXPECT_EQ(little[49].data[0], 149);
}

TEST_F(SocketCanBusTest, KernelFiltersLetOnlyListedIdentifiersThroughInAnyForm) {
    SocketCanBus sender("steady0");
    SocketCanBus filtered("steady0", {.filters = {{0x190}, {0x710}}});
    (void)send(sender, {{.id = 0x18F, .length = 1},
                        {.id = 0x190, .length = 1},
                        {.id = 0x191, .length = 1},
                        {.id = 0x710, .length = 1},
                        {.id = 0x190, .length = 1, .extended = true},
                        {.id = 0x190, .length = 1, .remote = true}});
    ASSERT_EQ(receive(filtered), 4U);
    EXPECT_EQ(frames_[0].id, 0x190U);
    EXPECT_EQ(frames_[1].id, 0x710U);
    EXPECT_TRUE(frames_[2].extended);
    EXPECT_TRUE(frames_[3].remote);
}

TEST_F(SocketCanBusTest, ErrorMessageIsAValuePastAnyFilter) {
    SocketCanBus sender("steady0");
    SocketCanBus listening("steady0", {.filters = {{0x190}}});
    SocketCanBus deaf("steady0", {.error_messages = false});
    (void)send(sender, {{.id = CAN_ERR_BUSOFF, .length = 8, .error = true}});
    ASSERT_EQ(receive(listening), 1U);
    EXPECT_TRUE(frames_[0].error);
    EXPECT_EQ(frames_[0].id, static_cast<std::uint32_t>(CAN_ERR_BUSOFF));
    EXPECT_EQ(listening.status().error_frames, 1U);
    EXPECT_EQ(receive(deaf), 0U);
}

TEST_F(SocketCanBusTest, InterfaceDownIsAValueAndTheSameSocketComesBack) {
    SocketCanBus bus("steady0");
    SocketCanBus other("steady0");
    run("ip link set steady0 down");
    EXPECT_EQ(receive(bus), 0U);
    EXPECT_EQ(bus.status().receive_error, BusError::down);
    EXPECT_EQ(bus.status().last_errno, ENETDOWN);
    EXPECT_EQ(receive(bus), 0U);
    EXPECT_EQ(bus.status().receive_error, BusError::down) << "stays told although the kernel says it once";
    EXPECT_EQ(bus.status().receive_errors, 1U);
    const auto result = send(bus, numbered(3));
    EXPECT_EQ(result.sent, 0U);
    EXPECT_EQ(result.dropped, 3U);
    EXPECT_EQ(result.error, BusError::down);
    EXPECT_EQ(bus.status().send_dropped_frames, 3U);

    run("ip link set steady0 up");
    (void)receive(other);  // takes the error that waits in this socket
    EXPECT_EQ(send(bus, numbered(1)).error, BusError::none);
    EXPECT_EQ(bus.status().send_error, BusError::none);
    EXPECT_EQ(bus.status().receive_error, BusError::none);
    EXPECT_EQ(receive(other), 1U);
    EXPECT_EQ(other.status().receive_error, BusError::none);
}

TEST_F(SocketCanBusTest, DeletedInterfaceIsGoneUntilReopened) {
    SocketCanBus bus("steady0");
    (void)send(bus, numbered(2));
    run("ip link del steady0");
    EXPECT_EQ(receive(bus), 0U);
    EXPECT_EQ(bus.status().receive_error, BusError::gone);
    EXPECT_EQ(send(bus, numbered(1)).error, BusError::gone);
    EXPECT_FALSE(bus.reopen()) << "there is nothing to open yet";
    EXPECT_EQ(send(bus, numbered(1)).error, BusError::gone);

    add_interface();
    EXPECT_EQ(send(bus, numbered(1)).error, BusError::gone) << "the old socket stays dead";
    ASSERT_TRUE(bus.reopen());
    EXPECT_EQ(bus.status().receive_error, BusError::none);
    SocketCanBus other("steady0");
    EXPECT_EQ(send(bus, numbered(1)).sent, 1U);
    EXPECT_EQ(receive(other), 1U);
    EXPECT_EQ(send(other, numbered(5)).sent, 5U);
    EXPECT_EQ(receive(bus), 5U);
    EXPECT_EQ(bus.status().sent_frames, 3U) << "counters go on";
    EXPECT_EQ(bus.status().send_dropped_frames, 3U);
}

TEST_F(SocketCanBusTest, FloodBeyondTheReceiveBufferIsCountedToTheFrame) {
    SocketCanBus sender("steady0");
    SocketCanBus small("steady0", {.receive_buffer_bytes = 2048});
    EXPECT_LE(small.receive_buffer_bytes(), 8192);
    std::uint64_t sent = send(sender, numbered(1000)).sent;
    std::uint64_t received = receive(small);
    EXPECT_LT(received, 1000U);
    EXPECT_GT(received, 0U);
    // The kernel tells the count with the next frame only.
    sent += send(sender, numbered(1)).sent;
    received += receive(small);
    EXPECT_EQ(received + small.status().receive_overflow_frames, sent);
    sent += send(sender, numbered(500)).sent;
    received += receive(small);
    sent += send(sender, numbered(1)).sent;
    received += receive(small);
    EXPECT_EQ(received + small.status().receive_overflow_frames, sent) << "the kernel's running total is not added up";
}

TEST_F(SocketCanBusTest, OverflowCountOfANewSocketStartsAnew) {
    SocketCanBus sender("steady0");
    SocketCanBus small("steady0", {.receive_buffer_bytes = 2048});
    std::uint64_t sent = send(sender, numbered(1000)).sent;
    std::uint64_t received = receive(small);
    sent += send(sender, numbered(1)).sent;
    received += receive(small);
    ASSERT_TRUE(small.reopen());
    sent += send(sender, numbered(1000)).sent;
    received += receive(small);
    sent += send(sender, numbered(1)).sent;
    received += receive(small);
    EXPECT_EQ(received + small.status().receive_overflow_frames, sent);
}

TEST_F(SocketCanBusTest, FullTransmitQueueDropsTheRestAndCountsIt) {
    run("ip link add steady1 type vxcan peer name steady2 && ip link set steady1 up && ip link set steady2 up && "
        "tc qdisc add dev steady1 root netem limit 5 delay 60s");
    {
        SocketCanBus bus("steady1");
        const auto result = send(bus, numbered(50));
        EXPECT_EQ(result.sent, 5U);
        EXPECT_EQ(result.dropped, 45U);
        EXPECT_EQ(result.error, BusError::no_room);
        const auto again = send(bus, numbered(4));
        EXPECT_EQ(again.sent, 0U);
        EXPECT_EQ(again.error, BusError::no_room);
        EXPECT_EQ(bus.status().send_dropped_frames, 49U);
        EXPECT_EQ(bus.status().send_errors, 2U);
        EXPECT_EQ(bus.status().last_errno, ENOBUFS);
    }
    run("ip link del steady1");
}

TEST_F(SocketCanBusTest, FrameTheKernelRefusesIsAnErrorNotASilence) {
    SocketCanBus bus("steady0");
    const auto result = send(bus, {{.id = 0x100, .length = 9}});
    EXPECT_EQ(result.sent, 0U);
    EXPECT_EQ(result.error, BusError::other);
    EXPECT_EQ(bus.status().last_errno, EINVAL);
}

TEST_F(SocketCanBusTest, MissingInterfaceIsRejectedWithItsNameAndTheRemedy) {
    const auto complaint = [](const std::string& interface) -> std::string {
        try {
            const SocketCanBus bus(interface);
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return "none";
    };
    EXPECT_THAT(complaint("steady9"), HasSubstr("'steady9'"));
    EXPECT_THAT(complaint("steady9"), HasSubstr("ip link add steady9 type vcan"));
    EXPECT_THAT(complaint("lo"), HasSubstr("is it a CAN interface"));
    EXPECT_THAT(complaint(""), HasSubstr("1 to 15 characters"));
    EXPECT_THAT(complaint("sixteen-letters-"), HasSubstr("1 to 15 characters"));
}

TEST_F(SocketCanBusTest, ReceiveBufferHoldsFarMoreThanTheKernelsDefault) {
    EXPECT_GT(SocketCanBus("steady0").receive_buffer_bytes(), 1'000'000);
}

}  // namespace
}  // namespace steadyboom::drivers
