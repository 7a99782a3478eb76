#include "hil/benchmark/peers/bare_can_socket.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>

namespace steadyboom::hil::benchmark {

namespace {

constexpr std::size_t batch_frames = 64;

std::uint32_t number_of(const can_frame& frame) noexcept {
    return frame.data[0] + 256U * frame.data[1];
}

}  // namespace

BareCanSocket::BareCanSocket(const std::string& interface) noexcept
    : fd_(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)) {
    ifreq request{};
    std::strncpy(request.ifr_name, interface.c_str(), sizeof request.ifr_name - 1);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    const int room_bytes = 512 * 768 / 2;
    const bool bound = fd_ >= 0 && ::ioctl(fd_, SIOCGIFINDEX, &request) == 0 &&
                       ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &room_bytes, sizeof room_bytes) == 0 &&
                       (address.can_ifindex = request.ifr_ifindex,
                        ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    if (!bound && fd_ >= 0) {
        ::close(fd_);
        fd_ = -1;
    }
}

BareCanSocket::~BareCanSocket() {
    if (fd_ >= 0) {
        ::close(fd_);
    }
}

std::size_t BareCanSocket::drain() noexcept {
    std::array<can_frame, batch_frames> frames;
    std::array<iovec, batch_frames> vectors;
    std::array<mmsghdr, batch_frames> messages{};
    for (std::size_t i = 0; i < batch_frames; ++i) {
        vectors[i] = {.iov_base = &frames[i], .iov_len = sizeof(can_frame)};
        messages[i].msg_hdr.msg_iov = &vectors[i];
        messages[i].msg_hdr.msg_iovlen = 1;
    }
    std::size_t total = 0;
    for (;;) {
        const int count = ::recvmmsg(fd_, messages.data(), batch_frames, MSG_DONTWAIT, nullptr);
        if (count <= 0) {
            return total;
        }
        total += static_cast<std::size_t>(count);
        newest_ = number_of(frames[static_cast<std::size_t>(count) - 1]);
        if (static_cast<std::size_t>(count) < batch_frames) {
            return total;
        }
    }
}

std::size_t BareCanSocket::read_one_by_one() noexcept {
    can_frame frame{};
    std::size_t total = 0;
    while (::read(fd_, &frame, sizeof frame) == sizeof frame) {
        newest_ = number_of(frame);
        ++total;
    }
    return total;
}

std::size_t BareCanSocket::write_one_by_one(std::size_t frames) noexcept {
    std::size_t total = 0;
    for (std::size_t i = 0; i < frames; ++i) {
        can_frame frame{.can_id = 0x190, .len = 8};
        frame.data[0] = static_cast<std::uint8_t>(i);
        frame.data[1] = static_cast<std::uint8_t>(i >> 8U);
        total += ::write(fd_, &frame, sizeof frame) == sizeof frame ? 1U : 0U;
    }
    return total;
}

}  // namespace steadyboom::hil::benchmark
