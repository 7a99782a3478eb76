#include "runtime/telemetry/tick_message.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace steadyboom::runtime {
namespace {

TEST(TickMessage, EachFieldOfTheRecordArrivesUnderItsOwnName) {
    TickRecord record;
    record.tick = 1;
    record.time_ns = 2;
    record.samples_stamp_ns = 3;
    for (std::size_t i = 0; i < record.measured.size(); ++i) {
        record.measured[i] = 10.5 + static_cast<double>(i);
        record.measured_age_ticks[i] = 20 + static_cast<std::uint32_t>(i);
    }
    record.measured_age_ticks[plant::spool_m] = plant::CraneMeasurement::never;
    record.measured_valid_bits = 0x1FF;
    record.safety_inputs_age_ticks = 4;
    record.skipped_ticks = 5;
    for (std::size_t i = 0; i < record.estimate.size(); ++i) {
        record.estimate[i] = 30.5 + static_cast<double>(i);
        record.setpoint[i] = 50.5 + static_cast<double>(i);
    }
    record.observer_nis = 6.5;
    record.wanted_opening_m = 7.5;
    record.limited_opening_m = 8.5;
    record.applied_opening_m = 9.5;
    record.authority = 0.25;
    record.limit_reasons = 0x8000'0001U;
    record.guard_reasons = 12;
    record.permission_reasons = 13;
    record.interlock_state = 14;
    record.valve_state = 15;
    record.permitted_mode = 11;
    record.applied_mode = 9;
    record.cutoff_permitted = 1;
    record.cutoff_open = 1;
    for (std::size_t i = 0; i < record.device_state.size(); ++i) {
        record.device_state[i] = static_cast<std::uint8_t>(70 + i);
        record.emergency_code[i] = static_cast<std::uint16_t>(0x8200 + i);
        record.message_state[i] = static_cast<std::uint8_t>(80 + i);
        record.message_lag_ticks[i] = static_cast<std::uint8_t>(90 + i);
    }
    record.valve_flag_bits = 0x0800;
    record.rejected_frames = 32;
    record.implausible_values = 33;
    record.link_state = 3;
    record.transmit_error_count = 255;
    record.receive_error_count = 29;
    record.newest_frame_kernel_stamp_ns = 28;
    record.received_frames = 16;
    record.dropped_frames = 17;
    record.send_errors = 18;
    record.wake_up_latency_ns = 19;
    record.receive_duration_ns = 20;
    record.decode_duration_ns = 21;
    record.observe_duration_ns = 22;
    record.interlock_duration_ns = 23;
    record.law_duration_ns = 24;
    record.limit_duration_ns = 25;
    record.send_duration_ns = 26;
    record.predict_duration_ns = 27;

    const steadyboom::tick_t message = to_message(record);
    EXPECT_EQ(message.tick, 1);
    EXPECT_EQ(message.time_ns, 2);
    EXPECT_EQ(message.samples_stamp_ns, 3);
    EXPECT_EQ(message.measured.strain_lower_microstrain, 10.5);
    EXPECT_EQ(message.measured.strain_upper_microstrain, 11.5);
    EXPECT_EQ(message.measured.boom_angle_rad, 12.5);
    EXPECT_EQ(message.measured.line_tension_N, 13.5);
    EXPECT_EQ(message.measured.line_angle_rad, 14.5);
    EXPECT_EQ(message.measured.line_length_m, 15.5);
    EXPECT_EQ(message.measured.piston_m, 16.5);
    EXPECT_EQ(message.measured.spool_m, 17.5);
    EXPECT_EQ(message.measured.load_pressure_Pa, 18.5);
    EXPECT_EQ(message.measured_age.strain_lower_ticks, 20);
    EXPECT_EQ(message.measured_age.strain_upper_ticks, 21);
    EXPECT_EQ(message.measured_age.boom_angle_ticks, 22);
    EXPECT_EQ(message.measured_age.line_tension_ticks, 23);
    EXPECT_EQ(message.measured_age.line_angle_ticks, 24);
    EXPECT_EQ(message.measured_age.line_length_ticks, 25);
    EXPECT_EQ(message.measured_age.piston_ticks, 26);
    EXPECT_EQ(message.measured_age.spool_ticks, -1);
    EXPECT_EQ(message.measured_age.load_pressure_ticks, 28);
    EXPECT_EQ(message.measured_valid_bits, 0x1FF);
    EXPECT_EQ(message.safety_inputs_age_ticks, 4);
    EXPECT_EQ(message.skipped_ticks, 5);
    EXPECT_EQ(message.estimate.R1_m, 30.5);
    EXPECT_EQ(message.estimate.phi2_rad, 31.5);
    EXPECT_EQ(message.estimate.R9_m, 32.5);
    EXPECT_EQ(message.estimate.q1_m, 33.5);
    EXPECT_EQ(message.estimate.q2_m, 34.5);
    EXPECT_EQ(message.estimate.phi6_rad, 35.5);
    EXPECT_EQ(message.estimate.phi9_rad, 36.5);
    EXPECT_EQ(message.estimate.R1dot_m_s, 37.5);
    EXPECT_EQ(message.estimate.phi2dot_rad_s, 38.5);
    EXPECT_EQ(message.estimate.R9dot_m_s, 39.5);
    EXPECT_EQ(message.estimate.q1dot_m_s, 40.5);
    EXPECT_EQ(message.estimate.q2dot_m_s, 41.5);
    EXPECT_EQ(message.estimate.phi6dot_rad_s, 42.5);
    EXPECT_EQ(message.estimate.phi9dot_rad_s, 43.5);
    EXPECT_EQ(message.estimate.piston_m, 44.5);
    EXPECT_EQ(message.setpoint.R1_m, 50.5);
    EXPECT_EQ(message.setpoint.piston_m, 64.5);
    EXPECT_EQ(message.observer_nis, 6.5);
    EXPECT_EQ(message.wanted_opening_m, 7.5);
    EXPECT_EQ(message.limited_opening_m, 8.5);
    EXPECT_EQ(message.applied_opening_m, 9.5);
    EXPECT_EQ(message.authority, 0.25);
    EXPECT_EQ(static_cast<std::uint32_t>(message.limit_reasons_bits), 0x8000'0001U);
    EXPECT_EQ(message.guard_reasons_bits, 12);
    EXPECT_EQ(message.permission_reasons_bits, 13);
    EXPECT_EQ(message.interlock_state, 14);
    EXPECT_EQ(message.valve_state, 15);
    EXPECT_EQ(message.permitted_mode, 11);
    EXPECT_EQ(message.applied_mode, 9);
    EXPECT_EQ(message.cutoff_permitted, 1);
    EXPECT_EQ(message.cutoff_energised, 0);
    EXPECT_EQ(message.cutoff_open, 1);
    EXPECT_EQ(message.emergency_stop_healthy, 0);
    for (int i = 0; i < 8; ++i) {
        EXPECT_EQ(message.device_state[i], 70 + i);
        EXPECT_EQ(static_cast<std::uint16_t>(message.emergency_code_bits[i]), 0x8200 + i);
        EXPECT_EQ(message.message_state[i], 80 + i);
        EXPECT_EQ(message.message_lag_ticks[i], 90 + i);
    }
    EXPECT_EQ(message.valve_flag_bits, 0x0800);
    EXPECT_EQ(message.rejected_frames, 32);
    EXPECT_EQ(message.implausible_values, 33);
    EXPECT_EQ(message.link_state, 3);
    EXPECT_EQ(message.transmit_error_count, 255);
    EXPECT_EQ(message.receive_error_count, 29);
    EXPECT_EQ(message.newest_frame_kernel_stamp_ns, 28);
    EXPECT_EQ(message.received_frames, 16);
    EXPECT_EQ(message.dropped_frames, 17);
    EXPECT_EQ(message.send_errors, 18);
    EXPECT_EQ(message.wake_up_latency_ns, 19);
    EXPECT_EQ(message.receive_duration_ns, 20);
    EXPECT_EQ(message.decode_duration_ns, 21);
    EXPECT_EQ(message.observe_duration_ns, 22);
    EXPECT_EQ(message.interlock_duration_ns, 23);
    EXPECT_EQ(message.law_duration_ns, 24);
    EXPECT_EQ(message.limit_duration_ns, 25);
    EXPECT_EQ(message.send_duration_ns, 26);
    EXPECT_EQ(message.predict_duration_ns, 27);
}

}  // namespace
}  // namespace steadyboom::runtime
