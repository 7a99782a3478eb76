#include "drivers/j1939_valve.hpp"

#include <cmath>

namespace steadyboom::drivers {

using plant::ValveMode;
using plant::ValveState;

J1939Scale::J1939Scale(const DeviceTable& table) noexcept {
    const auto& set_point = table.row(Signal::valve_set_point);
    extend_travel_m_ = std::copysign(table.config().spool_travel_m, set_point.scale_unit);
    resolution_ = set_point.type == RawType::u16 ? FlowResolution::extended : FlowResolution::standard;
}

AuxiliaryValveCommand J1939Scale::command(double opening_m) const noexcept {
    const double steps = resolution_ == FlowResolution::extended ? extended_flow_steps : standard_flow_steps;
    const double flow = std::abs(extend_flow(opening_m));
    if (!(std::round(flow * steps) > 0.0)) {
        return {};
    }
    return {.state = extend_flow(opening_m) > 0.0 ? PortState::extend : PortState::retract, .flow = flow};
}

double J1939Scale::opening_m(const AuxiliaryValveCommand& command) const noexcept {
    switch (command.state) {
        case PortState::extend:
            return command.flow * extend_travel_m_;
        case PortState::retract:
            return -command.flow * extend_travel_m_;
        default:
            return 0.0;
    }
}

std::span<const CanFrame> J1939Driver::encode(const GuardedCommand& command, std::uint8_t /*sync_counter*/,
                                              std::int64_t now_ns) noexcept {
    asked_ = command.mode();
    frame_ = table_.blank(message_of(Pdo::valve_command), now_ns);
    write_command(asked_ == ValveMode::active ? scale_.command(command.opening_m()) : AuxiliaryValveCommand{},
                  scale_.resolution(), frame_);
    return {&frame_, 1};
}

void J1939Driver::decode(const CanFrame& status) noexcept {
    const auto flow = read_flow(status);
    status_ = {};
    if (!flow || flow->state == PortState::not_available) {
        return;
    }
    status_.limit_touched = flow->limit == FlowLimit::limited_high || flow->limit == FlowLimit::limited_low;
    if (flow->state == PortState::error || flow->state == PortState::floating || flow->limit == FlowLimit::fault) {
        status_.state = ValveState::fault_disabled;
    } else if (flow->limit == FlowLimit::operator_controlled) {
        status_.state = ValveState::hold;  // sound, but deaf to the bus
    } else if (asked_ == ValveMode::active || flow->state != PortState::blocked) {
        status_.state = ValveState::active;
    } else {
        status_.state = asked_ == ValveMode::hold ? ValveState::hold : ValveState::disabled;
    }
}

std::optional<J1939Port::Order> J1939Port::take(const CanFrame& frame) noexcept {
    const auto command = read_command(frame);
    if (!command) {
        return std::nullopt;
    }
    constexpr std::uint16_t holds = control_hold | control_disabled;
    if (command->state == PortState::extend || command->state == PortState::retract) {
        reset_ = false;
        return Order{.control_word = holds | control_active, .set_point_m = scale_.opening_m(*command)};
    }
    reset_ = !reset_;  // an edge in every second blocking command
    return Order{.control_word = reset_ ? std::uint16_t{holds | control_reset} : holds};
}

void J1939Port::report(const ValveStatus& status, double spool_m, CanFrame& frame) const noexcept {
    AuxiliaryValveFlow flow{.extend_flow = scale_.extend_flow(spool_m), .retract_flow = -scale_.extend_flow(spool_m)};
    if (is_fault(status.state)) {
        flow.state = PortState::error;
    } else if (status.state == ValveState::not_ready) {
        flow.state = PortState::not_available;
    } else if (status.state == ValveState::active) {
        flow.state = flow.extend_flow > 0.0 ? PortState::extend : PortState::retract;
    }
    if (status.limit_touched) {
        flow.limit = FlowLimit::limited_high;
    }
    write_flow(flow, frame);
}

}  // namespace steadyboom::drivers
