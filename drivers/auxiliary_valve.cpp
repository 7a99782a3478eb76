#include "drivers/auxiliary_valve.hpp"

#include <algorithm>
#include <cmath>

namespace steadyboom::drivers {
namespace {

constexpr std::uint8_t flow_offset_raw = 125;   // 0 % in steps of 1 %
constexpr std::uint8_t flow_highest_raw = 250;  // 125 %
constexpr std::uint8_t reserved = 0xFF;

constexpr std::uint8_t resolution_bits = 0b11;
constexpr std::uint8_t extended_valid = 0b01;

double cut(double share, double lowest, double highest) noexcept {
    return std::isnan(share) ? 0.0 : std::clamp(share, lowest, highest);
}

/// State in bits 1 to 4, fail-safe mode in bits 7 and 8; the two between are reserved.
std::uint8_t state_byte(PortState state, FailSafeMode fail_safe) noexcept {
    return static_cast<std::uint8_t>(static_cast<unsigned>(fail_safe) << 6U | 0b11U << 4U |
                                     static_cast<unsigned>(state));
}

FailSafeMode fail_safe_of(std::uint8_t byte) noexcept {
    switch (byte >> 6U) {
        case 0:
            return FailSafeMode::block;
        case 1:
            return FailSafeMode::floating;
        default:
            return FailSafeMode::not_available;
    }
}

std::uint8_t flow_raw(double share) noexcept {
    return static_cast<std::uint8_t>(std::lround(100.0 * cut(share, -1.25, 1.25)) + flow_offset_raw);
}

double flow_share(std::uint8_t raw) noexcept {
    return 0.01 * (raw - flow_offset_raw);
}

}  // namespace

void write_command(const AuxiliaryValveCommand& command, FlowResolution resolution, CanFrame& frame) noexcept {
    const double share = cut(command.flow, 0.0, 1.0);
    frame.length = auxiliary_valve_bytes;
    frame.data.fill(reserved);
    frame.data[0] = static_cast<std::uint8_t>(std::lround(share * standard_flow_steps));
    frame.data[1] = static_cast<std::uint8_t>(reserved & ~resolution_bits);
    frame.data[2] = state_byte(command.state, command.fail_safe);
    if (resolution == FlowResolution::extended) {
        const auto extended_raw = static_cast<std::uint16_t>(std::lround(share * extended_flow_steps));
        frame.data[1] |= extended_valid;
        frame.data[3] = static_cast<std::uint8_t>(extended_raw);
        frame.data[4] = static_cast<std::uint8_t>(extended_raw >> 8U);
    }
}

std::optional<AuxiliaryValveCommand> read_command(const CanFrame& frame) noexcept {
    if (frame.length != auxiliary_valve_bytes) {
        return std::nullopt;
    }
    AuxiliaryValveCommand command;
    const unsigned extended_raw = frame.data[3] | frame.data[4] << 8U;
    if ((frame.data[1] & resolution_bits) == extended_valid) {
        command.flow = static_cast<double>(extended_raw) / extended_flow_steps;
    } else {
        command.flow = static_cast<double>(frame.data[0]) / standard_flow_steps;
    }
    const auto state_raw = frame.data[2] & 0x0FU;
    const bool known = state_raw <= static_cast<unsigned>(PortState::floating) ||
                       state_raw == static_cast<unsigned>(PortState::not_available);
    if (command.flow > 1.0 || !known) {
        return std::nullopt;
    }
    command.state = static_cast<PortState>(state_raw);
    command.fail_safe = fail_safe_of(frame.data[2]);
    return command;
}

void write_flow(const AuxiliaryValveFlow& flow, CanFrame& frame) noexcept {
    frame.length = auxiliary_valve_bytes;
    frame.data.fill(reserved);
    frame.data[0] = flow_raw(flow.extend_flow);
    frame.data[1] = flow_raw(flow.retract_flow);
    frame.data[2] = state_byte(flow.state, flow.fail_safe);
    frame.data[3] = static_cast<std::uint8_t>(static_cast<unsigned>(flow.limit) << 5U | 0x1FU);
}

std::optional<AuxiliaryValveFlow> read_flow(const CanFrame& frame) noexcept {
    if (frame.length != auxiliary_valve_bytes || frame.data[0] > flow_highest_raw || frame.data[1] > flow_highest_raw) {
        return std::nullopt;
    }
    AuxiliaryValveFlow flow{
        .extend_flow = flow_share(frame.data[0]),
        .retract_flow = flow_share(frame.data[1]),
        .state = static_cast<PortState>(frame.data[2] & 0x0FU),
        .fail_safe = fail_safe_of(frame.data[2]),
        .limit = static_cast<FlowLimit>(frame.data[3] >> 5U),
    };
    if (flow.state > PortState::floating && flow.state < PortState::error) {
        flow.state = PortState::error;
    }
    if (flow.limit > FlowLimit::limited_low && flow.limit < FlowLimit::fault) {
        flow.limit = FlowLimit::fault;
    }
    return flow;
}

}  // namespace steadyboom::drivers
