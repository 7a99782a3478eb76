#pragma once

#include <cstdint>
#include <optional>

#include "drivers/can_frame.hpp"

/// The two messages of ISO 11783-7 by which an auxiliary valve is led, on SAE J1939's 29-bit identifiers. What of this
/// could not be verified, docs/j1939-valve.md says.
namespace steadyboom::drivers {

inline constexpr std::uint32_t auxiliary_valve_flow_pgn = 0xFE10;     ///< + valve number: estimated flow, 65040
inline constexpr std::uint32_t auxiliary_valve_command_pgn = 0xFE30;  ///< + valve number: command, 65072
inline constexpr std::uint8_t auxiliary_valve_priority = 3;
inline constexpr std::uint8_t auxiliary_valve_bytes = 8;

/// 29-bit identifier of a broadcast parameter group.
[[nodiscard]] constexpr std::uint32_t j1939_id(std::uint8_t priority, std::uint32_t pgn, std::uint8_t source) noexcept {
    return static_cast<std::uint32_t>(priority & 7U) << 26U | (pgn & 0x3'FFFFU) << 8U | source;
}

/// What a port of the valve does; four bits on the bus.
enum class PortState : std::uint8_t {
    blocked = 0,
    extend = 1,
    retract = 2,
    floating = 3,
    error = 14,         ///< in a report only
    not_available = 15  ///< in a command: leave it as it is
};

/// What the valve does when its commander falls silent.
enum class FailSafeMode : std::uint8_t { block = 0, floating = 1, not_available = 3 };

/// Whether a valve's estimated flow is limited.
enum class FlowLimit : std::uint8_t {
    not_limited = 0,
    operator_controlled = 1,  ///< the request cannot be carried out
    limited_high = 2,         ///< only lower commands change anything
    limited_low = 3,
    fault = 6,  ///< not recoverable
    not_available = 7,
};

inline constexpr std::uint16_t standard_flow_steps = 250;     ///< in 100 %, 0.4 % each
inline constexpr std::uint16_t extended_flow_steps = 64'000;  ///< in 100 %, 0.0015625 % each

enum class FlowResolution : std::uint8_t {
    standard,  ///< 0.4 %
    extended,  ///< 0.0015625 %, and the standard value beside it
};

/// Flow through one port as a share of full flow, 0 to 1; through which, the state says.
struct AuxiliaryValveCommand {
    PortState state = PortState::blocked;
    double flow = 0.0;
    FailSafeMode fail_safe = FailSafeMode::block;
};

/// Flows out of the ports as shares of full flow, -1.25 to 1.25, in steps of 1 %.
struct AuxiliaryValveFlow {
    double extend_flow = 0.0;
    double retract_flow = 0.0;
    PortState state = PortState::blocked;
    FailSafeMode fail_safe = FailSafeMode::block;
    FlowLimit limit = FlowLimit::not_limited;
};

/// Writes all eight bytes. The flow is rounded to the nearest step; beyond 0 to 1 it is cut, and NaN is 0.
void write_command(const AuxiliaryValveCommand& command, FlowResolution resolution, CanFrame& frame) noexcept;

/// The extended value if the frame has one. Nothing if the frame is not of eight bytes, its flow is above 100 % (which
/// the codes for "error" and "not available" are), or its state is reserved.
[[nodiscard]] std::optional<AuxiliaryValveCommand> read_command(const CanFrame& frame) noexcept;

/// Writes all eight bytes, as above; beyond -1.25 to 1.25 a flow is cut.
void write_flow(const AuxiliaryValveFlow& flow, CanFrame& frame) noexcept;

/// Nothing if the frame is not of eight bytes or a flow is above 125 %. A state or limit that is reserved reads as
/// error or fault.
[[nodiscard]] std::optional<AuxiliaryValveFlow> read_flow(const CanFrame& frame) noexcept;

}  // namespace steadyboom::drivers
