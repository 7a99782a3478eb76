#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "drivers/can_bus.hpp"

namespace steadyboom::drivers {

/// A bus inside one process, for one thread: what an endpoint sends, all others receive, in order, at once. Frames keep
/// their stamp. Each endpoint's receive buffer has a fixed capacity; like the kernel's, it drops what comes in while it
/// is full and counts it. Nothing is allocated after construction.
class LoopbackBus {
  public:
    using Tap = std::function<void(const CanFrame&)>;
    using Wire = std::function<bool(CanFrame&)>;

    /// Throws std::invalid_argument for fewer than two endpoints or no capacity.
    explicit LoopbackBus(std::size_t endpoint_count = 2, std::size_t capacity_frames = 1024);
    ~LoopbackBus();
    LoopbackBus(const LoopbackBus&) = delete;
    LoopbackBus& operator=(const LoopbackBus&) = delete;

    /// Throws std::out_of_range. The endpoint lives as long as the bus.
    [[nodiscard]] CanBus& endpoint(std::size_t index);

    /// What happens to a frame on its way: it may be changed; false loses it. For fault injection; the same holds for
    /// it as for the tap. An empty one carries every frame as it is.
    void set_wire(Wire wire);

    /// Sees every frame once, as it arrives. The tap must neither throw nor, if the sender must not, allocate.
    void set_tap(Tap tap);

  private:
    class Endpoint;
    void deliver(CanFrame frame, const Endpoint& sender) noexcept;

    std::vector<std::unique_ptr<Endpoint>> endpoints_;
    Tap tap_;
    Wire wire_;
};

}  // namespace steadyboom::drivers
