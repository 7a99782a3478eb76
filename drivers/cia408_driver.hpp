#pragma once

#include <array>

#include "drivers/valve_driver.hpp"

namespace steadyboom::drivers {

/// A CiA 408 valve: control word and set-point in one RPDO, and its bit-inverted twin in a second one if the valve is
/// protected. Steps the control word through the valve's states (Cia408Controller).
class Cia408Driver final : public ValveDriver {
  public:
    explicit Cia408Driver(const DeviceTable& table) noexcept : table_(table) {}

    [[nodiscard]] std::span<const CanFrame> encode(const GuardedCommand& command, std::uint8_t sync_counter,
                                                   std::int64_t now_ns) noexcept override;
    void decode(const CanFrame& status) noexcept override;
    [[nodiscard]] const ValveStatus& status() const noexcept override { return status_; }
    void restarted() noexcept override;

  private:
    const DeviceTable& table_;
    Cia408Controller control_;
    ValveStatus status_;
    std::array<CanFrame, 2> frames_;
};

}  // namespace steadyboom::drivers
