#include "hil/virtual_valve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace steadyboom::hil {

using plant::ValveState;

namespace {

constexpr double centred_share = 0.01;  ///< of the travel: a spool within it is at its closed centre

}  // namespace

VirtualValve::VirtualValve(const plant::ActuatorParameters& actuator, double step_s)
    : omega_rad_s_(2.0 * std::numbers::pi * actuator.spool_bandwidth_Hz),
      damping_ratio_(actuator.spool_damping_ratio),
      travel_m_(actuator.spool_travel_m),
      delayed_m_(static_cast<std::size_t>(std::lround(actuator.spool_delay_s / step_s)) + 1, 0.0) {}

void VirtualValve::obey(const drivers::ValveOrder& order, double spool_m, std::int64_t now_ns) noexcept {
    const bool heard = order.ever && now_ns - order.stamp_ns < command_timeout_ns;
    const bool timed_out = order.ever && !heard;
    timeouts_ += timed_out && !timed_out_ ? 1U : 0U;
    timed_out_ = timed_out;
    device_.step({.control_word_raw = order.control_word,
                  .fault = timed_out ? drivers::ValveFault::holds : drivers::ValveFault::none,
                  .reaction_done = std::abs(spool_m) <= centred_share * travel_m_});
    commanded_m_ = state() == ValveState::active ? std::clamp(order.set_point_m, -travel_m_, travel_m_) : 0.0;
    const bool cutoff_heard = order.cutoff_ever && now_ns - order.cutoff_stamp_ns < command_timeout_ns;
    cutoff_open_ = cutoff_heard && order.cutoff_energised && !timed_out && !drivers::is_fault(state());
}

drivers::ValveStatus VirtualValve::status(double spool_m) const noexcept {
    constexpr double deviation_share = 0.1;
    return {.state = state(),
            .limit_touched = std::abs(spool_m) >= travel_m_,
            .control_deviation = std::abs(spool_m - commanded_m_) > deviation_share * travel_m_};
}

double VirtualValve::next_target_m() noexcept {
    delayed_m_[next_] = commanded_m_;
    next_ = (next_ + 1) % delayed_m_.size();
    return delayed_m_[next_];
}

}  // namespace steadyboom::hil
