#include "drivers/loopback_bus.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "drivers/error_message.hpp"

namespace steadyboom::drivers {

class LoopbackBus::Endpoint final : public CanBus {
  public:
    Endpoint(LoopbackBus& bus, std::size_t capacity_frames) : bus_(bus), ring_(capacity_frames) {}

    std::size_t receive(std::span<CanFrame> into) noexcept override {
        const std::size_t count = std::min(into.size(), waiting_frames_);
        for (std::size_t i = 0; i < count; ++i) {
            into[i] = ring_[oldest_];
            oldest_ = (oldest_ + 1) % ring_.size();
            if (into[i].error) {
                note_error_message(into[i], status_);
            } else if (status_.link == LinkState::bus_off) {
                status_.link = LinkState::active;
            }
        }
        waiting_frames_ -= count;
        status_.received_frames += count;
        status_.floods += count > flood_frames ? 1U : 0U;
        return count;
    }

    SendResult send(std::span<const CanFrame> frames) noexcept override {
        for (const auto& frame : frames) {
            bus_.deliver(frame, *this);
        }
        status_.sent_frames += frames.size();
        return {.sent = frames.size()};
    }

    [[nodiscard]] BusStatus status() const noexcept override { return status_; }

    void take(const CanFrame& frame) noexcept {
        if (waiting_frames_ == ring_.size()) {
            ++status_.receive_overflow_frames;
            return;
        }
        ring_[(oldest_ + waiting_frames_) % ring_.size()] = frame;
        ++waiting_frames_;
    }

  private:
    LoopbackBus& bus_;
    std::vector<CanFrame> ring_;
    std::size_t oldest_ = 0;
    std::size_t waiting_frames_ = 0;
    BusStatus status_;
};

LoopbackBus::LoopbackBus(std::size_t endpoint_count, std::size_t capacity_frames) {
    if (endpoint_count < 2 || capacity_frames == 0) {
        throw std::invalid_argument("a loopback bus needs at least two endpoints and room for one frame");
    }
    for (std::size_t i = 0; i < endpoint_count; ++i) {
        endpoints_.push_back(std::make_unique<Endpoint>(*this, capacity_frames));
    }
}

LoopbackBus::~LoopbackBus() = default;

CanBus& LoopbackBus::endpoint(std::size_t index) {
    return *endpoints_.at(index);
}

void LoopbackBus::set_tap(Tap tap) {
    tap_ = std::move(tap);
}

void LoopbackBus::set_wire(Wire wire) {
    wire_ = std::move(wire);
}

void LoopbackBus::deliver(CanFrame frame, const Endpoint& sender) noexcept {
    if (wire_ && !wire_(frame)) {
        return;
    }
    if (tap_) {
        tap_(frame);
    }
    for (const auto& endpoint : endpoints_) {
        if (endpoint.get() != &sender) {
            endpoint->take(frame);
        }
    }
}

}  // namespace steadyboom::drivers
