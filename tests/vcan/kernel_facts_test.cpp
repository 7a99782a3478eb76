// What the kernel does with CAN sockets, where the product relies on it or must know better. A kernel that comes to
// behave otherwise fails here, before it surprises anybody.
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/socketcan_bus.hpp"
#include "tests/vcan/interfaces.hpp"

namespace steadyboom {
namespace {

using drivers::BusError;
using drivers::CanFrame;
using drivers::LinkState;
using drivers::SocketCanBus;
using test_support::await;
using test_support::eventually;
using test_support::run;

/// A CAN_RAW socket as anybody opens it, with the kernel's defaults. Negative with errno when the kernel refuses.
int plain_socket(const std::string& interface) {
    const int fd = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    ifreq request{};
    std::strncpy(request.ifr_name, interface.c_str(), sizeof request.ifr_name - 1);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    if (fd < 0 || ::ioctl(fd, SIOCGIFINDEX, &request) != 0) {
        return -1;
    }
    address.can_ifindex = request.ifr_ifindex;
    return ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? fd : -1;
}

/// `work` in a process of a user that is nobody and has no capability; its return value is the exit status.
template <class Work>
int as_nobody(const Work& work) {
    const pid_t child = fork();
    if (child == 0) {
        const bool dropped = setgid(65534) == 0 && setuid(65534) == 0 && geteuid() == 65534;
        _exit(dropped ? work() : 99);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 98;
}

class KernelFacts : public testing::Test {
  protected:
    void SetUp() override { run("ip link add steady0 type vcan && ip link set steady0 up"); }
    void TearDown() override { (void)std::system("ip link del steady0; ip netns del far 2>/dev/null"); }

    static std::vector<CanFrame> numbered(std::size_t count) {
        std::vector<CanFrame> frames(count, CanFrame{.id = 0x190, .length = 2});
        for (std::size_t i = 0; i < count; ++i) {
            frames[i].data = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8U)};
        }
        return frames;
    }

    std::array<CanFrame, 2048> frames;
};

TEST_F(KernelFacts, DefaultReceiveBufferHolds278FramesAndKeepsTheOldest) {
    const int fd = plain_socket("steady0");
    ASSERT_GE(fd, 0);
    SocketCanBus sender("steady0");
    SocketCanBus witness("steady0", {.receive_buffer_frames = 8192});
    ASSERT_EQ(sender.send(numbered(1500)).sent, 1500U);
    ASSERT_EQ(await(witness, frames, 1500), 1500U);  // so the other has what it can hold
    can_frame raw{};
    int count = 0;
    while (::read(fd, &raw, sizeof raw) == sizeof raw) {
        EXPECT_EQ(raw.data[0] + 256 * raw.data[1], count) << "the oldest are kept";
        ++count;
    }
    EXPECT_EQ(count, 278);
    ::close(fd);
}

TEST_F(KernelFacts, AnyUserMaySendAnyIdentifierAndFakeErrorMessages) {
    SocketCanBus bus("steady0", {.filters = {{0x220}}});
    EXPECT_EQ(as_nobody([] {
                  const int fd = plain_socket("steady0");
                  can_frame order{.can_id = 0x220, .len = 4};
                  can_frame lie{.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF, .len = 8};
                  return fd >= 0 && ::write(fd, &order, sizeof order) == sizeof order &&
                                 ::write(fd, &lie, sizeof lie) == sizeof lie
                             ? 0
                             : 1;
              }),
              0);
    ASSERT_EQ(await(bus, frames, 2), 2U);
    EXPECT_EQ(frames[0].id, 0x220U);
    EXPECT_TRUE(frames[1].error);
    EXPECT_EQ(bus.status().link, LinkState::bus_off) << "believed, where all senders are on this machine";
}

TEST_F(KernelFacts, ANetworkNamespaceOfItsOwnKeepsEverybodyElseOut) {
    run("ip netns add far && ip link set steady0 netns far");
    EXPECT_EQ(as_nobody([] { return plain_socket("steady0") < 0 && errno == ENODEV ? 0 : 1; }), 0);
    run("ip -n far link del steady0 && ip link add steady0 type vcan");
}

TEST_F(KernelFacts, NineBytesAndCutFramesAreRefused) {
    const int fd = plain_socket("steady0");
    can_frame raw{.can_id = 0x100, .len = 9};
    EXPECT_EQ(::write(fd, &raw, sizeof raw), -1);
    EXPECT_EQ(errno, EINVAL);
    raw.len = 8;
    EXPECT_EQ(::write(fd, &raw, 15), -1);
    EXPECT_EQ(errno, EINVAL);
    EXPECT_EQ(::write(fd, &raw, sizeof raw), static_cast<ssize_t>(sizeof raw));
    ::close(fd);
}

TEST_F(KernelFacts, AVcanHasNoQueueToFillAndNoLinkToRestart) {
    SocketCanBus bus("steady0");
    for (int burst = 0; burst < 20; ++burst) {
        ASSERT_EQ(bus.send(numbered(500)).dropped, 0U);
    }
    EXPECT_NE(std::system("ip link set steady0 type can restart-ms 100 2>/dev/null"), 0);
    EXPECT_NE(std::system("ip link set steady0 type can restart 2>/dev/null"), 0);
    EXPECT_NE(std::system("ip link set steady0 type can bitrate 500000 2>/dev/null"), 0);
}

TEST_F(KernelFacts, NetemDoesNothingToTheListenersOfAVcan) {
    run("tc qdisc add dev steady0 root netem loss 100%");
    SocketCanBus sender("steady0");
    SocketCanBus listener("steady0");
    (void)sender.send(numbered(100));
    EXPECT_EQ(await(listener, frames, 100), 100U);
}

TEST_F(KernelFacts, CangwChangesPayloadsOnTheWay) {
    run("ip link add steady1 type vcan && ip link set steady1 up && modprobe can-gw 2>/dev/null; "
        "cangw -A -s steady0 -d steady1 -e -m SET:D:190.8.1122334455667788");
    SocketCanBus sender("steady0");
    SocketCanBus listener("steady1");
    (void)sender.send(std::array{CanFrame{.id = 0x190, .length = 8}});
    ASSERT_EQ(await(listener, frames, 1), 1U);
    EXPECT_EQ(frames[0].data, (std::array<std::uint8_t, 8>{0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}));
    run("cangw -F; ip link del steady1");
}

/// A wire whose other end is in another network namespace: steady1 here, steady2 there.
class KernelFactsOnAWire : public KernelFacts {
  protected:
    void SetUp() override {
        KernelFacts::SetUp();
        run("ip netns add far && ip link add steady1 type vxcan peer name steady2 netns far && "
            "ip link set steady1 up && ip -n far link set steady2 up");
    }
    void TearDown() override {
        (void)std::system("ip link del steady1");
        KernelFacts::TearDown();
    }

    /// What cansend sends at the far end, once for each word.
    static void far_sends(const std::string& words) {
        run("for frame in " + words + "; do ip netns exec far cansend steady2 $frame; done");
    }
    static void disturb(const std::string& how) { run("ip netns exec far tc qdisc add dev steady2 root netem " + how); }
};

TEST_F(KernelFactsOnAWire, NetemLosesDuplicatesDelaysAndCorrupts) {
    SocketCanBus here("steady1", {.receive_buffer_frames = 4096});
    const auto arrived_of_200 = [&](const std::string& how) {
        disturb(how);
        run("ip netns exec far cangen steady2 -g 0 -n 200 -I 190 -L 8 -D i");
        ::usleep(300'000);
        std::size_t count = 0;
        for (std::size_t more = 1; more > 0; count += more) {
            more = here.receive(std::span(frames).subspan(count));
        }
        run("ip netns exec far tc qdisc del dev steady2 root");
        return count;
    };
    EXPECT_EQ(arrived_of_200("limit 1000"), 200U);
    EXPECT_EQ(arrived_of_200("limit 1000 loss 100%"), 0U);
    const std::size_t some = arrived_of_200("limit 1000 loss 30%");
    EXPECT_GT(some, 80U);
    EXPECT_LT(some, 190U);
    EXPECT_EQ(arrived_of_200("limit 1000 duplicate 100%"), 400U);
    EXPECT_EQ(arrived_of_200("limit 1000 delay 20ms"), 200U);
    EXPECT_EQ(arrived_of_200("limit 1000 delay 60s"), 0U);
    const std::size_t corrupt = arrived_of_200("limit 1000 corrupt 100%");
    int as_sent = 0;
    for (std::size_t i = 0; i < corrupt; ++i) {
        as_sent += !frames[i].error && frames[i].id == 0x190 && frames[i].length == 8 && !frames[i].extended &&
                           !frames[i].remote &&
                           frames[i].data == std::array<std::uint8_t, 8>{static_cast<std::uint8_t>(i)}
                       ? 1
                       : 0;
    }
    EXPECT_GT(corrupt, 0U);
    EXPECT_LT(as_sent, 100) << "of " << corrupt;
}

TEST_F(KernelFactsOnAWire, ALocalEchoIsNoProofOfTransmission) {
    run("tc qdisc add dev steady1 root netem loss 100%");
    SocketCanBus sender("steady1");
    SocketCanBus neighbour("steady1");
    EXPECT_EQ(sender.send(numbered(10)).error, BusError::none);
    EXPECT_EQ(await(neighbour, frames, 10), 10U) << "the echo is seen here";
    EXPECT_EQ(neighbour.status().local_frames, 10U);
    EXPECT_EQ(sender.receive(frames), 0U) << "and not by the sender";
    const auto far_received = [] {
        std::array<char, 64> text{};
        FILE* pipe = ::popen("ip netns exec far cat /sys/class/net/steady2/statistics/rx_packets", "r");
        (void)std::fgets(text.data(), text.size(), pipe);
        ::pclose(pipe);
        return std::atoi(text.data());
    };
    EXPECT_EQ(far_received(), 0) << "nothing has left";
    run("tc qdisc del dev steady1 root");
    (void)sender.send(numbered(1));
    EXPECT_TRUE(eventually([&] { return far_received() == 1; }));
}

TEST_F(KernelFactsOnAWire, ADeadFarEndIsNoErrorAtThisOne) {
    SocketCanBus sender("steady1");
    run("ip -n far link set steady2 down");
    EXPECT_EQ(sender.send(numbered(1)).error, BusError::none) << "only silence tells";
}

}  // namespace
}  // namespace steadyboom
