#pragma once

#include <cstdint>

#include "drivers/can_bus.hpp"

namespace steadyboom::runtime {

/// Weighs what a bus went through since the previous tick. Two failed sends in a row are the interlock's own matter.
class BusMonitor {
  public:
    /// controllers::InterlockReason bits that hold in this tick; once a tick, after receiving.
    [[nodiscard]] std::uint32_t reasons(const drivers::BusStatus& status) noexcept;

  private:
    drivers::BusStatus last_;
};

}  // namespace steadyboom::runtime
