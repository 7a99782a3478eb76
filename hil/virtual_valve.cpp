#include "hil/virtual_valve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace steadyboom::hil {

using plant::ValveMode;
using plant::ValveState;

VirtualValve::VirtualValve(const plant::ActuatorParameters& actuator, double step_s)
    : omega_rad_s_(2.0 * std::numbers::pi * actuator.spool_bandwidth_Hz),
      damping_ratio_(actuator.spool_damping_ratio),
      travel_m_(actuator.spool_travel_m),
      delayed_m_(static_cast<std::size_t>(std::lround(actuator.spool_delay_s / step_s)) + 1, 0.0) {}

void VirtualValve::obey(const drivers::ValveOrder& order, std::int64_t now_ns) noexcept {
    const bool heard = order.ever && now_ns - order.stamp_ns < command_timeout_ns;
    if (!heard) {
        if (order.ever && state_ != ValveState::fault_hold) {
            state_ = ValveState::fault_hold;
            ++timeouts_;
        }
    } else if (state_ != ValveState::fault_hold || order.mode == ValveMode::disabled) {
        switch (order.mode) {
            case ValveMode::disabled:
                state_ = ValveState::disabled;
                break;
            case ValveMode::hold:
                state_ = ValveState::hold;
                break;
            case ValveMode::active:
                state_ = ValveState::active;
                break;
        }
    }
    commanded_m_ = state_ == ValveState::active ? std::clamp(order.set_point_m, -travel_m_, travel_m_) : 0.0;
    const bool cutoff_heard = order.cutoff_ever && now_ns - order.cutoff_stamp_ns < command_timeout_ns;
    cutoff_open_ = cutoff_heard && order.cutoff_energised && state_ != ValveState::fault_hold;
}

double VirtualValve::next_target_m() noexcept {
    delayed_m_[next_] = commanded_m_;
    next_ = (next_ + 1) % delayed_m_.size();
    return delayed_m_[next_];
}

}  // namespace steadyboom::hil
