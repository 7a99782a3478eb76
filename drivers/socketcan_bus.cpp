#include "drivers/socketcan_bus.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/ethtool.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <system_error>
#include <tuple>
#include <utility>

#include "drivers/error_message.hpp"

namespace steadyboom::drivers {
namespace {

constexpr std::size_t batch_frames = 64;

BusError bus_error(int error) noexcept {
    switch (error) {
        case ENOBUFS:
        case EAGAIN:
            return BusError::no_room;
        case ENETDOWN:
            return BusError::down;
        case ENXIO:
        case ENODEV:
            return BusError::gone;
        default:
            return BusError::other;
    }
}

std::int64_t steady_now_ns() noexcept {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

/// Of the frame read last. One question for all that a call has read costs less than SO_TIMESTAMPNS, which adds a
/// control message to each frame.
std::int64_t newest_kernel_stamp_ns(int fd) noexcept {
    timespec stamp{};
    return ::ioctl(fd, SIOCGSTAMPNS, &stamp) == 0 ? std::int64_t{stamp.tv_sec} * 1'000'000'000 + stamp.tv_nsec : 0;
}

CanFrame from_kernel(const can_frame& raw, std::int64_t stamp_ns) noexcept {
    CanFrame frame;
    frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
    frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
    frame.error = (raw.can_id & CAN_ERR_FLAG) != 0;
    frame.id = raw.can_id & (frame.error ? CAN_ERR_MASK : frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame.length = std::min<std::uint8_t>(raw.can_dlc, CAN_MAX_DLEN);
    std::copy_n(std::begin(raw.data), frame.length, frame.data.begin());
    frame.stamp_ns = stamp_ns;
    return frame;
}

can_frame to_kernel(const CanFrame& frame) noexcept {
    can_frame raw{};
    raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U) |
                 (frame.error ? CAN_ERR_FLAG : 0U);
    raw.can_dlc = frame.length;
    std::copy_n(frame.data.begin(), std::min<std::size_t>(frame.length, frame.data.size()), std::begin(raw.data));
    return raw;
}

/// A socket that closes itself until released.
class Socket {
  public:
    Socket() : fd_(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)) {}
    ~Socket() {
        if (fd_ >= 0) {
            ::close(fd_);
        }
    }
    Socket(const Socket&) = delete;
    Socket& operator=(const Socket&) = delete;
    [[nodiscard]] int fd() const noexcept { return fd_; }
    [[nodiscard]] int release() noexcept { return std::exchange(fd_, -1); }

    template <typename T>
    [[nodiscard]] bool set(int level, int option, const T& value) noexcept {
        return ::setsockopt(fd_, level, option, &value, sizeof value) == 0;
    }

  private:
    int fd_;
};

[[noreturn]] void fail(const std::string& interface, const std::string& why) {
    throw std::runtime_error("CAN interface '" + interface + "': " + why);
}

std::string reason(int error) {
    return std::generic_category().message(error);
}

ifreq request_for(const std::string& interface) {
    ifreq request{};
    if (interface.empty() || interface.size() >= sizeof request.ifr_name) {
        fail(interface, "not an interface name: allowed is 1 to 15 characters");
    }
    std::copy(interface.begin(), interface.end(), std::begin(request.ifr_name));
    return request;
}

int interface_index(const Socket& socket, const std::string& interface) {
    ifreq request = request_for(interface);
    if (socket.fd() < 0) {
        fail(interface, "this kernel opens no CAN socket (" + reason(errno) + "): modprobe can-raw");
    }
    if (::ioctl(socket.fd(), SIOCGIFINDEX, &request) != 0) {
        fail(interface, "there is none (" + reason(errno) + "): plug the adapter in, or ip link add " + interface +
                            " type vcan && ip link set " + interface + " up");
    }
    return request.ifr_ifindex;
}

can_filter kernel_filter(const CanFilter& filter) noexcept {
    if (filter.extended) {
        return {.can_id = filter.id | CAN_EFF_FLAG, .can_mask = CAN_EFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG};
    }
    return {.can_id = filter.id, .can_mask = CAN_SFF_MASK};
}

/// Opens, sets up and binds a socket, and says how large a receive buffer it got. Throws std::runtime_error.
std::pair<int, int> open_socket(const std::string& interface, const SocketCanOptions& options) {
    Socket socket;
    const int index = interface_index(socket, interface);
    std::vector<can_filter> filters(options.filters.size());
    std::ranges::transform(options.filters, filters.begin(), kernel_filter);
    if (!filters.empty() && ::setsockopt(socket.fd(), SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                                         static_cast<socklen_t>(filters.size() * sizeof(can_filter))) != 0) {
        fail(interface, "the kernel refuses " + std::to_string(filters.size()) + " filters (" + reason(errno) + ")");
    }
    // Own frames do not come back (CAN_RAW_RECV_OWN_MSGS is off by default): an echo is no proof of transmission.
    const can_err_mask_t errors = options.error_messages ? CAN_ERR_MASK : 0U;
    if (!socket.set(SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors) || !socket.set(SOL_SOCKET, SO_RXQ_OVFL, 1)) {
        fail(interface, "the kernel refuses a socket option (" + reason(errno) + "): Linux 5.10 or newer is needed");
    }
    (void)newest_kernel_stamp_ns(socket.fd());  // the first question makes the kernel note them
    const int asked_bytes = options.receive_buffer_frames * kernel_bytes_per_frame / 2;  // the kernel doubles it
    if (!socket.set(SOL_SOCKET, SO_RCVBUFFORCE, asked_bytes) && !socket.set(SOL_SOCKET, SO_RCVBUF, asked_bytes)) {
        fail(interface, "the kernel refuses a receive buffer (" + reason(errno) + ")");
    }
    int granted_bytes = 0;
    socklen_t size = sizeof granted_bytes;
    ::getsockopt(socket.fd(), SOL_SOCKET, SO_RCVBUF, &granted_bytes, &size);

    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = index;
    if (::bind(socket.fd(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        fail(interface,
             "cannot be bound (" + reason(errno) + "): is it a CAN interface? see ip -details link show " + interface);
    }
    return {socket.release(), granted_bytes};
}

}  // namespace

std::string interface_driver(const std::string& interface) {
    ifreq request = request_for(interface);
    ethtool_drvinfo info{};
    info.cmd = ETHTOOL_GDRVINFO;
    request.ifr_data = reinterpret_cast<char*>(&info);
    // Any socket may ask, and not everyone who asks may open CAN sockets.
    const int any = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const bool told = ::ioctl(any, SIOCETHTOOL, &request) == 0;
    ::close(any);
    return told ? std::string(std::begin(info.driver), std::ranges::find(info.driver, '\0')) : std::string();
}

bool is_virtual_driver(const std::string& driver) noexcept {
    return driver == "vcan" || driver == "vxcan";
}

/// What recvmmsg and sendmmsg point into; wired once.
struct SocketCanBus::Buffers {
    struct Control {
        alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(std::uint32_t))> bytes;
    };

    Buffers() {
        for (std::size_t i = 0; i < batch_frames; ++i) {
            receive_vectors[i] = {.iov_base = &receive_frames[i], .iov_len = sizeof(can_frame)};
            send_vectors[i] = {.iov_base = &send_frames[i], .iov_len = sizeof(can_frame)};
            receive_messages[i].msg_hdr.msg_iov = &receive_vectors[i];
            receive_messages[i].msg_hdr.msg_iovlen = 1;
            receive_messages[i].msg_hdr.msg_control = controls[i].bytes.data();
            send_messages[i].msg_hdr.msg_iov = &send_vectors[i];
            send_messages[i].msg_hdr.msg_iovlen = 1;
        }
    }

    std::array<can_frame, batch_frames> receive_frames{};
    std::array<iovec, batch_frames> receive_vectors{};
    std::array<Control, batch_frames> controls{};
    std::array<mmsghdr, batch_frames> receive_messages{};
    std::array<can_frame, batch_frames> send_frames{};
    std::array<iovec, batch_frames> send_vectors{};
    std::array<mmsghdr, batch_frames> send_messages{};
};

SocketCanBus::SocketCanBus(std::string interface, SocketCanOptions options)
    : interface_(std::move(interface)), options_(std::move(options)), buffers_(std::make_unique<Buffers>()) {
    expects_remote_ = options_.expect_remote.value_or(!is_virtual_driver(interface_driver(interface_)));
    std::tie(fd_, granted_buffer_bytes_) = open_socket(interface_, options_);
}

SocketCanBus::~SocketCanBus() {
    for (const int fd : {fd_, fresh_fd_.load(), retired_fd_.load()}) {
        if (fd >= 0) {
            ::close(fd);
        }
    }
}

std::size_t SocketCanBus::receive(std::span<CanFrame> into) noexcept {
    take_over_fresh_socket();
    std::size_t filled = 0;
    std::size_t found = 0;
    std::int64_t stamp_ns = 0;
    while (filled < into.size()) {
        const auto wanted = std::min(batch_frames, into.size() - filled);
        for (std::size_t i = 0; i < wanted; ++i) {
            buffers_->receive_messages[i].msg_hdr.msg_controllen = sizeof(Buffers::Control);
        }
        const int count =
            ::recvmmsg(fd_, buffers_->receive_messages.data(), static_cast<unsigned>(wanted), MSG_DONTWAIT, nullptr);
        if (count < 0) {
            if (errno != EAGAIN && errno != EINTR) {
                note_receive_error(errno);
            }
            break;
        }
        if (found == 0) {
            stamp_ns = steady_now_ns();  // one for all: where there is no vDSO a clock costs as much as a batch
        }
        found += static_cast<std::size_t>(count);
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            filled += accept(i, stamp_ns, into[filled]) ? 1U : 0U;
        }
        status_.receive_error = BusError::none;
        if (static_cast<std::size_t>(count) < wanted) {
            break;
        }
    }
    if (found > 0) {
        status_.newest_kernel_stamp_ns = newest_kernel_stamp_ns(fd_);
    }
    status_.floods += found > flood_frames ? 1U : 0U;
    return filled;
}

bool SocketCanBus::accept(std::size_t index, std::int64_t stamp_ns, CanFrame& into) noexcept {
    auto& message = buffers_->receive_messages[index];
    for (auto* control = CMSG_FIRSTHDR(&message.msg_hdr); control != nullptr;
         control = CMSG_NXTHDR(&message.msg_hdr, control)) {
        if (control->cmsg_level == SOL_SOCKET && control->cmsg_type == SO_RXQ_OVFL) {
            std::uint32_t socket_total = 0;
            std::memcpy(&socket_total, CMSG_DATA(control), sizeof socket_total);
            note_overflow(socket_total);
        }
    }
    ++status_.received_frames;
    if (message.msg_len != CAN_MTU) {
        ++status_.malformed_frames;
        return false;
    }
    const bool local = (message.msg_hdr.msg_flags & MSG_DONTROUTE) != 0;
    status_.local_frames += local ? 1U : 0U;
    if (local && expects_remote_) {
        ++status_.spoofed_frames;
        return false;
    }
    into = from_kernel(buffers_->receive_frames[index], stamp_ns);
    if (into.error) {
        note_error_message(into, status_);
    } else if (status_.link == LinkState::bus_off) {
        status_.link = LinkState::active;  // nothing comes in while a controller is off the bus
    }
    return true;
}

SendResult SocketCanBus::send(std::span<const CanFrame> frames) noexcept {
    take_over_fresh_socket();
    SendResult result;
    while (result.sent < frames.size() && result.error == BusError::none) {
        const auto wanted = std::min(batch_frames, frames.size() - result.sent);
        for (std::size_t i = 0; i < wanted; ++i) {
            buffers_->send_frames[i] = to_kernel(frames[result.sent + i]);
        }
        const int count = ::sendmmsg(fd_, buffers_->send_messages.data(), static_cast<unsigned>(wanted), MSG_DONTWAIT);
        if (count < 0) {
            result.error = bus_error(errno);
            status_.last_errno = errno;
            note_interface(result.error);
        } else {
            result.sent += static_cast<std::size_t>(count);
            if (static_cast<std::size_t>(count) < wanted) {
                // The kernel keeps to itself why it stopped midway; a queue that has filled up is the usual reason.
                result.error = BusError::no_room;
                status_.last_errno = ENOBUFS;
            }
        }
    }
    result.dropped = frames.size() - result.sent;
    status_.sent_frames += result.sent;
    status_.send_dropped_frames += result.dropped;
    status_.send_error = result.error;
    if (result.error != BusError::none) {
        ++status_.send_errors;
    } else if (result.sent > 0) {
        status_.receive_error = BusError::none;
    }
    return result;
}

void SocketCanBus::tend() noexcept {
    if (const int retired = retired_fd_.exchange(-1); retired >= 0) {
        ::close(retired);
    }
    if (!gone_.load() || fresh_fd_.load() >= 0) {
        return;
    }
    try {
        fresh_fd_.store(open_socket(interface_, options_).first);
    } catch (const std::exception&) {
        // Still gone: the next call tries again, and receive() and send() go on saying so.
    }
}

void SocketCanBus::take_over_fresh_socket() noexcept {
    if (fresh_fd_.load(std::memory_order_relaxed) < 0 || retired_fd_.load(std::memory_order_relaxed) >= 0) {
        return;
    }
    gone_.store(false);
    retired_fd_.store(std::exchange(fd_, fresh_fd_.exchange(-1)));
    socket_overflow_frames_ = 0;
    status_.receive_error = BusError::none;
    status_.send_error = BusError::none;
    status_.link = LinkState::active;
    ++status_.reopens;
}

void SocketCanBus::note_interface(BusError error) noexcept {
    if (error == BusError::down || error == BusError::gone) {
        status_.link = LinkState::active;  // a controller starts anew with its interface
    }
    if (error == BusError::gone) {
        gone_.store(true, std::memory_order_relaxed);
    }
}

void SocketCanBus::note_receive_error(int error) noexcept {
    status_.receive_error = bus_error(error);
    status_.last_errno = error;
    ++status_.receive_errors;
    note_interface(status_.receive_error);
}

void SocketCanBus::note_overflow(std::uint32_t socket_total) noexcept {
    // Unsigned, so that the socket's 32-bit counter may wrap.
    status_.receive_overflow_frames += socket_total - socket_overflow_frames_;
    socket_overflow_frames_ = socket_total;
}

}  // namespace steadyboom::drivers
