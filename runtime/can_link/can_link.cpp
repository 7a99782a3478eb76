#include "runtime/can_link/can_link.hpp"

#include <libsocketcan.h>
#include <linux/can/netlink.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "drivers/socketcan_bus.hpp"
#include "runtime/file_descriptor.hpp"

namespace steadyboom::runtime {

namespace {

std::optional<ifreq> ask_interface(const std::string& interface, unsigned long what) noexcept {
    const FileDescriptor any(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    ifreq request{};
    if (interface.size() >= sizeof request.ifr_name) {
        return {};
    }
    std::ranges::copy(interface, std::begin(request.ifr_name));
    return ioctl(any.get(), what, &request) == 0 ? std::optional(request) : std::nullopt;
}

LinkCondition condition_of(const std::string& interface) noexcept {
    int state = 0;
    if (can_get_state(interface.c_str(), &state) != 0) {
        return LinkCondition::unknown;
    }
    switch (state) {
        case CAN_STATE_ERROR_ACTIVE:
            return LinkCondition::active;
        case CAN_STATE_ERROR_WARNING:
            return LinkCondition::warning;
        case CAN_STATE_ERROR_PASSIVE:
            return LinkCondition::passive;
        case CAN_STATE_BUS_OFF:
            return LinkCondition::bus_off;
        case CAN_STATE_STOPPED:
        case CAN_STATE_SLEEPING:
            return LinkCondition::stopped;
        default:
            return LinkCondition::unknown;
    }
}

const char* words(LinkCondition condition) {
    switch (condition) {
        case LinkCondition::unknown:
            return "state not known";
        case LinkCondition::absent:
            return "there is no such interface";
        case LinkCondition::stopped:
            return "stopped";
        case LinkCondition::active:
            return "error-active";
        case LinkCondition::warning:
            return "error-warning";
        case LinkCondition::passive:
            return "error-passive";
        case LinkCondition::bus_off:
            return "bus-off";
    }
    return "?";
}

}  // namespace

CanLink::CanLink(std::string interface, LinkSetUp wanted) : interface_(std::move(interface)), wanted_(wanted) {}

LinkReport CanLink::read() noexcept {
    LinkReport report;
    const auto queue = ask_interface(interface_, SIOCGIFTXQLEN);
    if (!queue) {
        report.condition = LinkCondition::absent;
        return report;
    }
    report.queue_frames = static_cast<std::uint32_t>(queue->ifr_qlen);
    report.virtual_bus = drivers::is_virtual_driver(drivers::interface_driver(interface_));
    if (report.virtual_bus) {
        return report;
    }
    report.condition = condition_of(interface_);
    can_bittiming timing{};
    if (can_get_bittiming(interface_.c_str(), &timing) == 0) {
        report.bit_rate_bit_s = timing.bitrate;
    }
    if (can_get_restart_ms(interface_.c_str(), &report.restart_ms) != 0) {
        report.restart_ms = 0;
    }
    can_berr_counter errors{};
    has_error_counts_ = has_error_counts_ && can_get_berr_counter(interface_.c_str(), &errors) == 0;
    if (has_error_counts_) {
        report.transmit_error_count = errors.txerr;
        report.receive_error_count = errors.rxerr;
    }
    const auto note = [&](bool is_one, LinkProblem problem) {
        report.problems = static_cast<std::uint8_t>(report.problems | (is_one ? problem : 0));
    };
    note(report.bit_rate_bit_s != wanted_.bit_rate_bit_s, link_problem_bit_rate);
    note(report.restart_ms != 0, link_problem_restart_ms);
    note(report.queue_frames != wanted_.queue_frames, link_problem_queue);
    return report;
}

bool CanLink::restart() noexcept {
    return can_do_restart(interface_.c_str()) == 0 ||
           (can_do_stop(interface_.c_str()) == 0 && can_do_start(interface_.c_str()) == 0);
}

std::string CanLink::in_words(const LinkReport& report) const {
    const std::string name = interface_ + ": ";
    if (report.condition == LinkCondition::absent) {
        return name + words(report.condition);
    }
    if (report.virtual_bus) {
        return name + "a virtual bus, without state or bit rate";
    }
    std::string text = name + words(report.condition) + ", " + std::to_string(report.bit_rate_bit_s) +
                       " bit/s, queue " + std::to_string(report.queue_frames) + " frames, restart-ms " +
                       std::to_string(report.restart_ms) + ", error counts " +
                       std::to_string(report.transmit_error_count) + " sending and " +
                       std::to_string(report.receive_error_count) + " receiving";
    if ((report.problems & link_problem_bit_rate) != 0) {
        text += "; the configuration says " + std::to_string(wanted_.bit_rate_bit_s) + " bit/s: ip link set " +
                interface_ + " down && ip link set " + interface_ + " type can bitrate " +
                std::to_string(wanted_.bit_rate_bit_s);
    }
    if ((report.problems & link_problem_restart_ms) != 0) {
        text += "; the kernel must not restart it by itself: ip link set " + interface_ + " type can restart-ms 0";
    }
    if ((report.problems & link_problem_queue) != 0) {
        text += "; the queue must hold one tick's frames: ip link set " + interface_ + " txqueuelen " +
                std::to_string(wanted_.queue_frames);
    }
    if (report.given_up) {
        text += "; restarts did not help: given up until it is seen well again";
    }
    return text;
}

}  // namespace steadyboom::runtime
