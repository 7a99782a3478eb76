#pragma once

#include <cstdint>
#include <string>

#include "runtime/can_link/link_message.hpp"

namespace steadyboom::runtime {

/// What the configuration asks of an interface.
struct LinkSetUp {
    std::uint32_t bit_rate_bit_s = 500'000;
    std::uint32_t queue_frames = 5;  ///< one tick's frames, DeviceTable::most_frames_a_tick()
};

/// One interface as the kernel shows it by libsocketcan, whose calls take milliseconds: not for the tick. A virtual
/// interface has neither state nor bit rate and is as it must be.
class CanLink {
  public:
    CanLink(std::string interface, LinkSetUp wanted);

    [[nodiscard]] LinkReport read() noexcept;

    /// Restarts a link that is bus-off, by the driver's own restart or else by taking it down and up. Needs
    /// CAP_NET_ADMIN.
    [[nodiscard]] bool restart() noexcept;

    /// One line: "can0: error-active, 500000 bit/s, queue 4 frames, ...", with a remedy for each problem.
    [[nodiscard]] std::string in_words(const LinkReport& report) const;

  private:
    std::string interface_;
    LinkSetUp wanted_;
    bool has_error_counts_ = true;  ///< until the driver turns out not to tell: libsocketcan complains at each try
};

}  // namespace steadyboom::runtime
