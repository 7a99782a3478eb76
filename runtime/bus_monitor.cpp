#include "runtime/bus_monitor.hpp"

#include "controllers/interlock.hpp"

namespace steadyboom::runtime {

using drivers::BusError;
using drivers::BusStatus;
using drivers::LinkState;

std::uint32_t BusMonitor::reasons(const BusStatus& status) noexcept {
    // A state that came and went between two ticks shows in its counter.
    const auto grew = [&](std::uint64_t BusStatus::*counter) { return status.*counter != last_.*counter; };
    const auto told = [&](BusError error) { return status.receive_error == error || status.send_error == error; };
    std::uint32_t reasons = controllers::reason_none;
    const auto add_if = [&](bool holds, controllers::InterlockReason reason) {
        reasons |= holds ? std::uint32_t{reason} : 0U;
    };
    add_if(told(BusError::down), controllers::reason_interface_down);
    add_if(told(BusError::gone), controllers::reason_interface_gone);
    add_if(status.link == LinkState::bus_off || grew(&BusStatus::bus_offs), controllers::reason_bus_off);
    add_if(status.link == LinkState::passive || grew(&BusStatus::passives), controllers::reason_error_passive);
    add_if(status.link == LinkState::warning || grew(&BusStatus::warnings), controllers::reason_error_warning);
    add_if(grew(&BusStatus::floods) || grew(&BusStatus::receive_overflow_frames), controllers::reason_flood);
    add_if(grew(&BusStatus::spoofed_frames), controllers::reason_spoof);
    add_if(grew(&BusStatus::controller_overruns), controllers::reason_frames_lost);
    last_ = status;
    return reasons;
}

}  // namespace steadyboom::runtime
