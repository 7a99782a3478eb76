#pragma once

#include <bitset>
#include <cstdint>

namespace steadyboom::runtime {

/// Tells when a schedule is no longer kept: two or more deadlines passed over at once, or three ticks with one passed
/// over within the last 200. Less than that is counted elsewhere and tolerated.
class OverrunMonitor {
  public:
    /// Once a tick, with the deadlines passed over before it.
    [[nodiscard]] bool broken(std::uint64_t skipped_ticks) noexcept {
        window_[next_] = skipped_ticks > 0;
        next_ = (next_ + 1) % window_ticks;
        return skipped_ticks >= 2 || window_.count() >= 3;
    }

  private:
    static constexpr std::size_t window_ticks = 200;
    std::bitset<window_ticks> window_;
    std::size_t next_ = 0;
};

}  // namespace steadyboom::runtime
