#pragma once

#include <cstdint>
#include <type_traits>

namespace steadyboom::runtime {

inline constexpr std::uint32_t link_magic = 0x314B'4C53;  // "SLK1"; another layout takes another number

/// Where a CAN controller stands, as the kernel's netlink interface tells.
enum class LinkCondition : std::uint8_t {
    unknown,  ///< a virtual interface has none
    absent,   ///< no such interface
    stopped,
    active,
    warning,
    passive,
    bus_off,
};

/// How an interface differs from what the configuration asks for. Bits.
enum LinkProblem : std::uint8_t {
    link_problem_none = 0,
    link_problem_bit_rate = 1U << 0,
    link_problem_restart_ms = 1U << 1,  ///< the kernel restarts the link by itself, and refuses to be asked
    link_problem_queue = 1U << 2,       ///< the send queue holds more or less than one tick's frames
};

/// One packet from the link daemon to the controller, about ten a second.
struct LinkReport {
    std::uint32_t magic = link_magic;
    LinkCondition condition = LinkCondition::unknown;
    std::uint8_t problems = link_problem_none;
    bool given_up = false;             ///< bus-off, and as many restarts as are allowed did not help
    bool virtual_bus = false;          ///< vcan or vxcan
    std::uint32_t bit_rate_bit_s = 0;  ///< 0: none, or not known
    std::uint32_t restart_ms = 0;
    std::uint32_t queue_frames = 0;
    std::uint32_t restarts = 0;              ///< by the daemon, since it runs
    std::uint16_t transmit_error_count = 0;  ///< 0 where the driver does not tell
    std::uint16_t receive_error_count = 0;
};
static_assert(std::is_trivially_copyable_v<LinkReport> && sizeof(LinkReport) == 28);

/// One packet from the controller to the link daemon: the machine is safe, restart the link when it may be.
struct LinkRequest {
    std::uint32_t magic = link_magic;
};

}  // namespace steadyboom::runtime
