#include "drivers/socketcan_bus.hpp"

#include <linux/can/error.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/realtime_section.hpp"
#include "tests/vcan/interfaces.hpp"

namespace steadyboom::drivers {
namespace {

using test_support::run;
using ::testing::HasSubstr;

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

    std::size_t await(SocketCanBus& bus, std::size_t expected) {
        const runtime::RealtimeSection no_allocation;
        return test_support::await(bus, frames_, expected);
    }

    static SendResult send(SocketCanBus& bus, const std::vector<CanFrame>& frames) {
        const runtime::RealtimeSection no_allocation;
        return bus.send(frames);
    }

    /// Sends, and returns when every socket on the bus has the frames: a witness has them all, and the kernel gives
    /// each frame to all sockets at once.
    void deliver(SocketCanBus& sender, const std::vector<CanFrame>& frames) {
        SocketCanBus witness("steady0", {.receive_buffer_frames = 8192});
        ASSERT_EQ(send(sender, frames).sent, frames.size());
        std::vector<CanFrame> seen(frames.size());
        ASSERT_EQ(test_support::await(witness, seen, frames.size()), frames.size());
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
    ASSERT_EQ(await(other, 4), 4U);
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
    (void)send(other, {{.id = 0x055, .length = 0}});
    ASSERT_EQ(await(one, 1), 1U);
    EXPECT_EQ(frames_[0].id, 0x055U) << "own frames do not come back";
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
    EXPECT_EQ(::poll(&ready, 1, 10'000), 1);
}

TEST_F(SocketCanBusTest, MoreFramesThanOneKernelCallTakesAreDrainedAndSentWhole) {
    SocketCanBus one("steady0");
    SocketCanBus other("steady0");
    EXPECT_EQ(send(one, numbered(500)).sent, 500U);
    ASSERT_EQ(await(other, 500), 500U);
    for (std::size_t i = 0; i < 500; ++i) {
        ASSERT_EQ(frames_[i].data[0] + 256U * frames_[i].data[1], i);
    }
    EXPECT_EQ(other.status().receive_overflow_frames, 0U);
}

TEST_F(SocketCanBusTest, WhateverPiledUpDuringAStallIsGoneAfterOneTicksReadAndTheNextFrameIsTheNewest) {
    SocketCanBus device("steady0");
    SocketCanBus stalled("steady0");
    EXPECT_EQ(stalled.receive_buffer_frames(), static_cast<int>(most_frames_a_tick));
    deliver(device, numbered(1000));  // a second at 1000 frames/s
    EXPECT_EQ(stalled.receive(std::span(frames_).first(most_frames_a_tick)), most_frames_a_tick);
    EXPECT_EQ(frames_[0].data[0], 0) << "the oldest come first";
    EXPECT_EQ(stalled.status().floods, 1U);
    EXPECT_EQ(receive(stalled), 0U) << "nothing stale is left for a second tick";
    (void)send(device, {{.id = 0x100, .length = 1, .data = {77}}});
    ASSERT_EQ(await(stalled, 1), 1U);
    EXPECT_EQ(frames_[0].data[0], 77);
    EXPECT_EQ(stalled.status().receive_overflow_frames, 1000 - most_frames_a_tick);
    EXPECT_EQ(stalled.status().floods, 1U);
}

TEST_F(SocketCanBusTest, SixtyFourFramesAtOnceAreNoFloodAndOneMoreIs) {
    SocketCanBus device("steady0");
    SocketCanBus bus("steady0");
    deliver(device, numbered(flood_frames));
    EXPECT_EQ(receive(bus), flood_frames);
    EXPECT_EQ(bus.status().floods, 0U);
    deliver(device, numbered(flood_frames + 1));
    EXPECT_EQ(receive(bus), flood_frames + 1);
    EXPECT_EQ(bus.status().floods, 1U);
}

TEST_F(SocketCanBusTest, KernelsStampIsWallClockTimeOfTheReceiptBesideTheSteadyStamp) {
    SocketCanBus one("steady0");
    SocketCanBus other("steady0");
    timespec before{};
    clock_gettime(CLOCK_REALTIME, &before);
    (void)send(one, numbered(1));
    timespec after{};
    clock_gettime(CLOCK_REALTIME, &after);
    ASSERT_EQ(await(other, 1), 1U);
    EXPECT_GE(other.status().newest_kernel_stamp_ns, before.tv_sec * 1'000'000'000 + before.tv_nsec);
    EXPECT_LE(other.status().newest_kernel_stamp_ns, after.tv_sec * 1'000'000'000 + after.tv_nsec);
    EXPECT_LE(frames_[0].stamp_ns, steady_ns());
}

TEST_F(SocketCanBusTest, ReceiveIsBoundedByTheCallersRoom) {
    SocketCanBus one("steady0");
    SocketCanBus other("steady0");
    (void)send(one, numbered(150));
    std::array<CanFrame, 100> little;
    std::size_t received = 0;
    pollfd ready{.fd = other.fd(), .events = POLLIN, .revents = 0};
    while (received < 150 && ::poll(&ready, 1, 10'000) == 1) {
        const auto count = other.receive(std::span(little).first(7));
        ASSERT_LE(count, 7U);
        for (std::size_t i = 0; i < count; ++i) {
            ASSERT_EQ(little[i].data[0], received + i);
        }
        received += count;
    }
    EXPECT_EQ(received, 150U);
    EXPECT_EQ(little[7].length, 0) << "written past the caller's room";
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
    ASSERT_EQ(await(filtered, 4), 4U);
    EXPECT_EQ(frames_[0].id, 0x190U);
    EXPECT_EQ(frames_[1].id, 0x710U);
    EXPECT_TRUE(frames_[2].extended);
    EXPECT_TRUE(frames_[3].remote);
}

TEST_F(SocketCanBusTest, ExtendedFilterLetsExactlyItsDataFramesThrough) {
    SocketCanBus sender("steady0");
    SocketCanBus filtered("steady0", {.filters = {{.id = 0x0CFE3022, .extended = true}, {0x190}}});
    (void)send(sender, {{.id = 0x0CFE3023, .length = 1, .extended = true},
                        {.id = 0x022, .length = 1},
                        {.id = 0x0CFE3022, .length = 1, .extended = true, .remote = true},
                        {.id = 0x0CFE3022, .length = 2, .extended = true},
                        {.id = 0x190, .length = 1}});
    ASSERT_EQ(await(filtered, 2), 2U);
    EXPECT_EQ(frames_[0].id, 0x0CFE3022U);
    EXPECT_EQ(frames_[0].length, 2);
    EXPECT_EQ(frames_[1].id, 0x190U);
    EXPECT_EQ(receive(filtered), 0U);
}

TEST_F(SocketCanBusTest, FrameOfThisMachineIsASpoofWhereEverySenderIsElsewhere) {
    SocketCanBus local("steady0");
    SocketCanBus strict("steady0", {.filters = {{0x190}}, .expect_remote = true});
    SocketCanBus lenient("steady0");
    EXPECT_TRUE(strict.expects_remote());
    EXPECT_FALSE(lenient.expects_remote()) << "on vcan all senders are on this machine";
    (void)send(
        local,
        {{.id = 0x190, .length = 1}, {.id = CAN_ERR_BUSOFF, .length = 8, .error = true}, {.id = 0x191, .length = 1}});
    EXPECT_EQ(await(lenient, 3), 3U);
    EXPECT_EQ(receive(strict), 0U) << "dropped";
    EXPECT_EQ(strict.status().spoofed_frames, 2U) << "what the filter keeps out is nobody's spoof";
    EXPECT_EQ(strict.status().link, LinkState::active) << "a fake error message is not believed";
    EXPECT_EQ(lenient.status().spoofed_frames, 0U);
    EXPECT_EQ(lenient.status().local_frames, 3U);
    EXPECT_EQ(lenient.status().bus_offs, 1U);
}

TEST_F(SocketCanBusTest, FrameFromTheOtherEndOfTheWireIsNoSpoof) {
    // The far end in a network namespace of its own is as far as another machine.
    run("ip netns add far && ip link add steady1 type vxcan peer name steady2 netns far && ip link set steady1 up && "
        "ip -n far link set steady2 up");
    {
        SocketCanBus strict("steady1", {.expect_remote = true});
        run("ip netns exec far cansend steady2 190#01");
        EXPECT_EQ(await(strict, 1), 1U);
        EXPECT_EQ(strict.status().local_frames, 0U);
        EXPECT_EQ(strict.status().spoofed_frames, 0U);
        run("cansend steady1 190#02");
        EXPECT_TRUE(test_support::eventually([&] {
            EXPECT_EQ(receive(strict), 0U);
            return strict.status().spoofed_frames == 1;
        }));
    }
    run("ip link del steady1 && ip netns del far");
}

TEST_F(SocketCanBusTest, ErrorMessageIsAValuePastAnyFilter) {
    SocketCanBus sender("steady0");
    SocketCanBus listening("steady0", {.filters = {{0x190}}});
    SocketCanBus deaf("steady0", {.error_messages = false});
    (void)send(sender, {{.id = CAN_ERR_BUSOFF, .length = 8, .error = true}});
    ASSERT_EQ(await(listening, 1), 1U);
    EXPECT_TRUE(frames_[0].error);
    EXPECT_EQ(frames_[0].id, static_cast<std::uint32_t>(CAN_ERR_BUSOFF));
    EXPECT_EQ(listening.status().error_frames, 1U);
    EXPECT_EQ(listening.status().link, LinkState::bus_off);
    (void)send(sender, {{.id = 0x055, .length = 0}});
    ASSERT_EQ(await(deaf, 1), 1U);
    EXPECT_EQ(frames_[0].id, 0x055U);
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
    EXPECT_EQ(await(other, 1), 1U);
    EXPECT_EQ(other.status().receive_error, BusError::none);
}

TEST_F(SocketCanBusTest, DeletedInterfaceIsGoneUntilAnotherThreadHasOpenedASocketAnew) {
    SocketCanBus bus("steady0");
    (void)send(bus, numbered(2));
    run("ip link del steady0");
    EXPECT_EQ(receive(bus), 0U);
    EXPECT_EQ(bus.status().receive_error, BusError::gone);
    EXPECT_EQ(send(bus, numbered(1)).error, BusError::gone);
    bus.tend();
    EXPECT_EQ(send(bus, numbered(1)).error, BusError::gone) << "there is nothing to open yet";

    add_interface();
    EXPECT_EQ(send(bus, numbered(1)).error, BusError::gone) << "the old socket stays dead";
    std::thread(&SocketCanBus::tend, &bus).join();
    EXPECT_EQ(bus.status().receive_error, BusError::gone) << "until the one who receives takes it over";
    EXPECT_EQ(receive(bus), 0U);
    EXPECT_EQ(bus.status().receive_error, BusError::none);
    EXPECT_EQ(bus.status().reopens, 1U);
    SocketCanBus other("steady0");
    EXPECT_EQ(send(bus, numbered(1)).sent, 1U);
    EXPECT_EQ(await(other, 1), 1U);
    EXPECT_EQ(send(other, numbered(5)).sent, 5U);
    EXPECT_EQ(await(bus, 5), 5U);
    EXPECT_EQ(bus.status().sent_frames, 3U) << "counters go on";
    EXPECT_EQ(bus.status().send_dropped_frames, 3U);
}

TEST_F(SocketCanBusTest, EverySocketThatWasReplacedIsClosed) {
    const auto open_descriptors = [] {
        const std::filesystem::directory_iterator entries("/proc/self/fd");
        return std::distance(begin(entries), end(entries));
    };
    const auto before = open_descriptors();
    {
        SocketCanBus bus("steady0");
        for (std::uint64_t round = 1; round <= 3; ++round) {
            run("ip link del steady0");
            (void)receive(bus);
            add_interface();
            bus.tend();
            bus.tend();
            (void)receive(bus);
            EXPECT_EQ(bus.status().reopens, round);
        }
        bus.tend();
        EXPECT_EQ(open_descriptors(), before + 1);
    }
    EXPECT_EQ(open_descriptors(), before);
}

/// A receiver whose buffer holds a few frames, and the sum of what it got.
class FloodedSocketCanBus : public SocketCanBusTest {
  protected:
    void flood() {
        sent_ += send(*sender_, numbered(1000)).sent;
        settle();
    }

    /// The kernel tells its count with the next frame only: sends single frames until one has brought it.
    void settle() {
        for (int attempt = 0; attempt < 1000 && accounted() != sent_; ++attempt) {
            received_ += receive(*small_);
            sent_ += send(*sender_, numbered(1)).sent;
            received_ += await(*small_, 1);
        }
    }

    [[nodiscard]] std::uint64_t accounted() const { return received_ + small_->status().receive_overflow_frames; }

    void SetUp() override {
        SocketCanBusTest::SetUp();
        sender_ = std::make_unique<SocketCanBus>("steady0");
        small_ = std::make_unique<SocketCanBus>("steady0", SocketCanOptions{.receive_buffer_frames = 5});
        ASSERT_LE(small_->receive_buffer_frames(), 10);
    }

    std::unique_ptr<SocketCanBus> sender_;
    std::unique_ptr<SocketCanBus> small_;
    std::uint64_t sent_ = 0;
    std::uint64_t received_ = 0;
};

TEST_F(FloodedSocketCanBus, EveryFrameLostInTheReceiveBufferIsCounted) {
    for (int round = 0; round < 3; ++round) {
        flood();
        ASSERT_EQ(accounted(), sent_) << "round " << round;
        ASSERT_GT(small_->status().receive_overflow_frames, 100U * static_cast<unsigned>(round));
        ASSERT_GT(received_, 0U);
    }
}

TEST_F(FloodedSocketCanBus, CountGoesOnAfterReopening) {
    flood();
    ASSERT_EQ(accounted(), sent_);
    sender_.reset();
    run("ip link del steady0");
    EXPECT_EQ(receive(*small_), 0U);
    add_interface();
    small_->tend();
    (void)receive(*small_);
    sender_ = std::make_unique<SocketCanBus>("steady0");
    flood();
    EXPECT_EQ(accounted(), sent_);
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

TEST_F(SocketCanBusTest, ReceiveBufferIsReportedAsTheKernelGrantsIt) {
    EXPECT_EQ(SocketCanBus("steady0").receive_buffer_frames(), 512);
    EXPECT_EQ(SocketCanBus("steady0", {.receive_buffer_frames = 20'000}).receive_buffer_frames(), 20'000)
        << "as root beyond net.core.rmem_max";
    EXPECT_EQ(SocketCanBus("steady0", {.receive_buffer_frames = 555}).receive_buffer_frames(), 555)
        << "the most that anybody else gets";
}

}  // namespace
}  // namespace steadyboom::drivers
