// CAN FD frames on the wire never come as far as the receive gate: a frame that holds other bytes than it seems to is
// none.

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>

#include <gtest/gtest.h>

#include "drivers/socketcan_bus.hpp"

namespace steadyboom::drivers {
namespace {

constexpr std::array<std::uint8_t, 16> fd_lengths = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};

/// Someone else's socket, which speaks CAN FD.
class FdSocket {
  public:
    explicit FdSocket(const char* interface) : fd_(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)) {
        const int on = 1;
        EXPECT_EQ(::setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on), 0) << std::strerror(errno);
        sockaddr_can address{};
        address.can_family = AF_CAN;
        address.can_ifindex = static_cast<int>(::if_nametoindex(interface));
        EXPECT_EQ(::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0) << std::strerror(errno);
    }
    ~FdSocket() { ::close(fd_); }
    FdSocket(const FdSocket&) = delete;
    FdSocket& operator=(const FdSocket&) = delete;

    template <typename Frame>
    [[nodiscard]] bool send(const Frame& frame) const {
        return ::write(fd_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame);
    }

  private:
    int fd_;
};

TEST(FdFrames, OfEveryIdentifierAndLengthNoneReachesTheBus) {
    ASSERT_EQ(
        std::system("ip link add steadyfd0 type vcan && ip link set steadyfd0 mtu 72 && ip link set steadyfd0 up"), 0);
    {
        SocketCanBus bus("steadyfd0");
        const FdSocket other("steadyfd0");
        for (std::uint32_t id = 0; id < standard_id_count; ++id) {
            for (const auto length : fd_lengths) {
                canfd_frame frame{};
                frame.can_id = id;
                frame.len = length;
                ASSERT_TRUE(other.send(frame)) << id << " " << int{length} << ": " << std::strerror(errno);
            }
        }
        can_frame classic{};
        classic.can_id = 0x190;
        classic.can_dlc = 1;
        ASSERT_TRUE(other.send(classic));

        pollfd ready{.fd = bus.fd(), .events = POLLIN, .revents = 0};
        ASSERT_EQ(::poll(&ready, 1, 10'000), 1) << "the classic frame comes";
        std::array<CanFrame, 16> frames;
        ASSERT_EQ(bus.receive(frames), 1U);
        EXPECT_EQ(frames[0].id, 0x190U);
        EXPECT_EQ(bus.receive(frames), 0U);
        EXPECT_EQ(bus.status().received_frames, 1U) << "and it alone";
        EXPECT_EQ(bus.status().receive_overflow_frames, 0U);
    }
    EXPECT_EQ(std::system("ip link del steadyfd0"), 0);
}

}  // namespace
}  // namespace steadyboom::drivers
