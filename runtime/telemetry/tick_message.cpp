#include "runtime/telemetry/tick_message.hpp"

#include <algorithm>

namespace steadyboom::runtime {

namespace {

sensor_values_t to_message(const std::array<double, plant::sensor_count>& values) {
    sensor_values_t message;
    message.strain_lower_microstrain = values[plant::strain_lower_microstrain];
    message.strain_upper_microstrain = values[plant::strain_upper_microstrain];
    message.boom_angle_rad = values[plant::boom_angle_rad];
    message.line_tension_N = values[plant::line_tension_N];
    message.line_angle_rad = values[plant::line_angle_rad];
    message.line_length_m = values[plant::line_length_m];
    message.piston_m = values[plant::piston_m];
    message.spool_m = values[plant::spool_m];
    message.load_pressure_Pa = values[plant::load_pressure_Pa];
    return message;
}

sensor_ages_t to_message(const std::array<std::uint32_t, plant::sensor_count>& ages) {
    const auto age = [&](plant::Sensor sensor) { return static_cast<std::int32_t>(ages[sensor]); };
    sensor_ages_t message;
    message.strain_lower_ticks = age(plant::strain_lower_microstrain);
    message.strain_upper_ticks = age(plant::strain_upper_microstrain);
    message.boom_angle_ticks = age(plant::boom_angle_rad);
    message.line_tension_ticks = age(plant::line_tension_N);
    message.line_angle_ticks = age(plant::line_angle_rad);
    message.line_length_ticks = age(plant::line_length_m);
    message.piston_ticks = age(plant::piston_m);
    message.spool_ticks = age(plant::spool_m);
    message.load_pressure_ticks = age(plant::load_pressure_Pa);
    return message;
}

crane_state_t to_message(const std::array<double, plant::state_count>& state) {
    const auto velocity = [&](plant::Coordinate coordinate) { return state[plant::velocity_offset + coordinate]; };
    crane_state_t message;
    message.R1_m = state[plant::R1_m];
    message.phi2_rad = state[plant::phi2_rad];
    message.R9_m = state[plant::R9_m];
    message.q1_m = state[plant::q1_m];
    message.q2_m = state[plant::q2_m];
    message.phi6_rad = state[plant::phi6_rad];
    message.phi9_rad = state[plant::phi9_rad];
    message.R1dot_m_s = velocity(plant::R1_m);
    message.phi2dot_rad_s = velocity(plant::phi2_rad);
    message.R9dot_m_s = velocity(plant::R9_m);
    message.q1dot_m_s = velocity(plant::q1_m);
    message.q2dot_m_s = velocity(plant::q2_m);
    message.phi6dot_rad_s = velocity(plant::phi6_rad);
    message.phi9dot_rad_s = velocity(plant::phi9_rad);
    message.piston_m = state[plant::piston_index];
    return message;
}

}  // namespace

steadyboom::tick_t to_message(const TickRecord& record) {
    steadyboom::tick_t message;
    message.tick = static_cast<std::int64_t>(record.tick);
    message.time_ns = record.time_ns;
    message.samples_stamp_ns = record.samples_stamp_ns;
    message.measured = to_message(record.measured);
    message.measured_age = to_message(record.measured_age_ticks);
    message.measured_valid_bits = static_cast<std::int32_t>(record.measured_valid_bits);
    message.safety_inputs_age_ticks = static_cast<std::int32_t>(record.safety_inputs_age_ticks);
    message.skipped_ticks = static_cast<std::int32_t>(record.skipped_ticks);
    message.estimate = to_message(record.estimate);
    message.setpoint = to_message(record.setpoint);
    message.observer_nis = record.observer_nis;
    message.wanted_opening_m = record.wanted_opening_m;
    message.limited_opening_m = record.limited_opening_m;
    message.applied_opening_m = record.applied_opening_m;
    message.authority = record.authority;
    message.limit_reasons_bits = static_cast<std::int32_t>(record.limit_reasons);
    message.guard_reasons_bits = static_cast<std::int32_t>(record.guard_reasons);
    message.permission_reasons_bits = static_cast<std::int32_t>(record.permission_reasons);
    message.interlock_state = record.interlock_state;
    message.valve_state = record.valve_state;
    message.permitted_mode = record.permitted_mode;
    message.applied_mode = record.applied_mode;
    message.cutoff_permitted = static_cast<std::int8_t>(record.cutoff_permitted);
    message.cutoff_energised = static_cast<std::int8_t>(record.cutoff_energised);
    message.cutoff_open = static_cast<std::int8_t>(record.cutoff_open);
    message.emergency_stop_healthy = static_cast<std::int8_t>(record.emergency_stop_healthy);
    static_assert(sizeof(message.device_state) == drivers::device_count);
    static_assert(sizeof(message.message_state) == drivers::tpdo_count);
    std::ranges::copy(record.device_state, message.device_state);
    std::ranges::copy(record.emergency_code, message.emergency_code_bits);
    std::ranges::copy(record.message_state, message.message_state);
    std::ranges::copy(record.message_lag_ticks, message.message_lag_ticks);
    message.valve_flag_bits = static_cast<std::int32_t>(record.valve_flag_bits);
    message.rejected_frames = static_cast<std::int64_t>(record.rejected_frames);
    message.implausible_values = static_cast<std::int64_t>(record.implausible_values);
    message.link_state = record.link_state;
    message.transmit_error_count = record.transmit_error_count;
    message.receive_error_count = record.receive_error_count;
    message.newest_frame_kernel_stamp_ns = record.newest_frame_kernel_stamp_ns;
    message.received_frames = static_cast<std::int64_t>(record.received_frames);
    message.dropped_frames = static_cast<std::int64_t>(record.dropped_frames);
    message.send_errors = static_cast<std::int64_t>(record.send_errors);
    message.wake_up_latency_ns = record.wake_up_latency_ns;
    message.receive_duration_ns = record.receive_duration_ns;
    message.decode_duration_ns = record.decode_duration_ns;
    message.observe_duration_ns = record.observe_duration_ns;
    message.interlock_duration_ns = record.interlock_duration_ns;
    message.law_duration_ns = record.law_duration_ns;
    message.limit_duration_ns = record.limit_duration_ns;
    message.send_duration_ns = record.send_duration_ns;
    message.predict_duration_ns = record.predict_duration_ns;
    return message;
}

}  // namespace steadyboom::runtime
