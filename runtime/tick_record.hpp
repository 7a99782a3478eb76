#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "drivers/network_config.hpp"
#include "plant/crane_measurement.hpp"
#include "plant/crane_state.hpp"

namespace steadyboom::runtime {

/// Everything one control tick saw, thought and did. Plain bytes: it is copied through shared memory to other
/// processes.
///
/// Set-point, measurement, estimate and command are four records, and wanted, limited and applied are three fields:
/// none is ever derived from another by a reader. Times are CLOCK_MONOTONIC; in lockstep they are the simulated time
/// and every duration is zero, so that two runs of one seed are the same bytes. Counters count since the program's
/// start.
struct TickRecord {
    /// Raised whenever the layout or a meaning below changes; readers refuse any other.
    static constexpr std::uint32_t layout_version = 3;

    std::uint64_t tick = 0;             ///< index k of the schedule; skipped ticks leave gaps
    std::int64_t time_ns = 0;           ///< when tick k was due, t0 + k T
    std::int64_t samples_stamp_ns = 0;  ///< steady time of the SYNC on which the samples below were taken

    // What the bus brought (plant::CraneMeasurement).
    std::array<double, plant::sensor_count> measured{};  ///< indexed by plant::Sensor, which names each unit
    std::array<std::uint32_t, plant::sensor_count> measured_age_ticks{};
    std::uint32_t measured_valid_bits = 0;  ///< bit i is CraneMeasurement::valid[i]
    std::uint32_t safety_inputs_age_ticks = 0;
    std::uint32_t skipped_ticks = 0;  ///< deadlines passed over between the previous tick and this one

    // What the observer made of it and what is wanted of the crane, both plant::CraneState.
    std::array<double, plant::state_count> estimate{};
    std::array<double, plant::state_count> setpoint{};
    double observer_nis = 0.0;  ///< normalised innovation squared of this tick's correction

    // The command on its way to the valve.
    double wanted_opening_m = 0.0;   ///< from the law
    double limited_opening_m = 0.0;  ///< after the performance limits
    double applied_opening_m = 0.0;  ///< after the guard: what was sent
    double authority = 0.0;          ///< of the interlock's permission, 0 to 1

    std::uint32_t limit_reasons = 0;       ///< plant::LimitReason bits of the limited command
    std::uint32_t guard_reasons = 0;       ///< plant::LimitReason bits of the applied command
    std::uint32_t permission_reasons = 0;  ///< InterlockReason bits

    std::uint8_t interlock_state = 0;
    std::uint8_t valve_state = 0;       ///< plant::ValveState heard
    std::uint8_t permitted_mode = 0;    ///< plant::ValveMode of the permission
    std::uint8_t applied_mode = 0;      ///< plant::ValveMode sent
    std::uint8_t cutoff_permitted = 0;  ///< 1: the interlock lets the cut-off valve open
    std::uint8_t cutoff_energised = 0;  ///< 1: the guard's last word opened it
    std::uint8_t cutoff_open = 0;       ///< 1: the safety input reports it open
    std::uint8_t emergency_stop_healthy = 0;
    std::uint8_t link_state = 0;            ///< drivers::LinkState of the CAN controller
    std::uint8_t transmit_error_count = 0;  ///< of the CAN controller
    std::uint8_t receive_error_count = 0;
    std::uint8_t reserved = 0;

    // The network; all indexed as drivers::Device and drivers::Pdo are.
    std::array<std::uint8_t, drivers::device_count> device_state{};     ///< drivers::DeviceState; [0] means nothing
    std::array<std::uint16_t, drivers::device_count> emergency_code{};  ///< in force, 0: none
    std::array<std::uint8_t, drivers::tpdo_count> message_state{};      ///< drivers::ReceiverState
    std::array<std::uint8_t, drivers::tpdo_count> message_lag_ticks{};  ///< behind the SYNC, of protected messages
    std::uint32_t valve_flag_bits = 0;  ///< bits 8 to 11 of the CiA 408 status word, the others 0
    std::uint32_t network_reserved = 0;
    std::uint64_t rejected_frames = 0;     ///< wrong checksum, counter, late, not believed, of a device not started
    std::uint64_t implausible_values = 0;  ///< out of range or faster than physics allows

    // Health of bus and schedule.
    std::int64_t newest_frame_kernel_stamp_ns = 0;  ///< wall clock; recorded, never used for an age
    std::uint64_t received_frames = 0;
    std::uint64_t dropped_frames = 0;
    std::uint64_t send_errors = 0;
    std::int64_t wake_up_latency_ns = 0;
    std::int64_t receive_duration_ns = 0;
    std::int64_t decode_duration_ns = 0;
    std::int64_t observe_duration_ns = 0;
    std::int64_t interlock_duration_ns = 0;
    std::int64_t law_duration_ns = 0;
    std::int64_t limit_duration_ns = 0;  ///< limiter and guard
    std::int64_t send_duration_ns = 0;
    std::int64_t predict_duration_ns = 0;  ///< the observer's prediction from the samples' instant to this tick
};

static_assert(std::is_trivially_copyable_v<TickRecord>);
static_assert(sizeof(TickRecord) % sizeof(std::uint64_t) == 0);

}  // namespace steadyboom::runtime
