#pragma once

#include <array>
#include <optional>

#include "drivers/auxiliary_valve.hpp"
#include "drivers/valve_driver.hpp"

namespace steadyboom::drivers {

/// How openings lie in the two messages, as the table's rows for set-point and spool say.
class J1939Scale {
  public:
    explicit J1939Scale(const DeviceTable& table) noexcept;

    /// Opening to port and flow; an opening that rounds to no flow blocks.
    [[nodiscard]] AuxiliaryValveCommand command(double opening_m) const noexcept;
    /// Opening that a command asks for, m; 0 unless it extends or retracts.
    [[nodiscard]] double opening_m(const AuxiliaryValveCommand& command) const noexcept;
    /// What a spool at `spool_m` lets through, as a share of full flow out of the extend port.
    [[nodiscard]] double extend_flow(double spool_m) const noexcept { return spool_m / extend_travel_m_; }
    [[nodiscard]] FlowResolution resolution() const noexcept { return resolution_; }

  private:
    double extend_travel_m_;  ///< opening at full flow out of the extend port; negative if that pays the pendent out
    FlowResolution resolution_;
};

/// An auxiliary valve of ISO 11783-7. It knows no HOLD and no DISABLED: for both it is told to block. What it reports
/// is therefore the state it was last asked for, as long as it says that it is sound and follows.
class J1939Driver final : public ValveDriver {
  public:
    explicit J1939Driver(const DeviceTable& table) noexcept : table_(table), scale_(table) {}

    [[nodiscard]] std::span<const CanFrame> encode(const GuardedCommand& command, std::uint8_t sync_counter,
                                                   std::int64_t now_ns) noexcept override;
    void decode(const CanFrame& status) noexcept override;
    [[nodiscard]] const ValveStatus& status() const noexcept override { return status_; }
    void restarted() noexcept override { status_ = {}; }

  private:
    const DeviceTable& table_;
    J1939Scale scale_;
    plant::ValveMode asked_ = plant::ValveMode::disabled;
    ValveStatus status_;
    CanFrame frame_;
};

/// The valve's end of it, for a valve that is a CiA 408 state machine inside.
class J1939Port {
  public:
    struct Order {
        std::uint16_t control_word = 0;
        double set_point_m = 0.0;
    };

    explicit J1939Port(const DeviceTable& table) noexcept : scale_(table) {}

    /// Nothing if the frame is no command. A port that is to float is blocked instead: a floating cylinder lets the
    /// boom fall. A blocking command also resets a fault that is over, as this protocol has no word for that.
    [[nodiscard]] std::optional<Order> take(const CanFrame& frame) noexcept;

    /// Fills in the report of the estimated flow.
    void report(const ValveStatus& status, double spool_m, CanFrame& frame) const noexcept;

  private:
    J1939Scale scale_;
    bool reset_ = false;
};

}  // namespace steadyboom::drivers
