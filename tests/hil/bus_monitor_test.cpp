#include "hil/bus_monitor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "drivers/pdo_codec.hpp"
#include "drivers/sdo_abort.hpp"
#include "hil/bus_monitor_view.hpp"
#include "tests/hil/sample_networks.hpp"

namespace steadyboom::hil {
namespace {

using drivers::CanFrame;
using drivers::Device;
using drivers::DeviceTable;
using drivers::Message;
using drivers::Pdo;
using drivers::Signal;
using testing::HasSubstr;

constexpr std::int64_t tick_ns = 5'000'000;

CanFrame angle_frame(const DeviceTable& table, double angle_rad, std::int64_t stamp_ns) {
    auto frame = table.blank(message_of(Pdo::boom_angle), stamp_ns);
    encode_value(table.row(Signal::boom_angle), angle_rad, frame);
    return frame;
}

TEST(BusMonitor, RatesAgesAndValuesAreOfTheFramesStamps) {
    const DeviceTable table(unprotected_network());
    BusMonitor monitor(table);
    for (int i = 0; i <= 200; ++i) {
        monitor.take(angle_frame(table, 1.0, i * tick_ns));
    }
    EXPECT_DOUBLE_EQ(monitor.traffic(message_of(Pdo::boom_angle)).mean_rate_Hz(), 200.0);
    const auto json = nlohmann::json::parse(monitor_json(monitor, {.source = "x", .now_ns = 201 * tick_ns}));
    const auto& message = json.at("devices").at(2).at("messages").at(0);
    EXPECT_EQ(message.at("name"), "boom_inclinometer_tpdo1");
    EXPECT_EQ(message.at("frames"), 201);
    EXPECT_NEAR(message.at("age_s").get<double>(), 0.005, 1e-12);
    EXPECT_NEAR(message.at("values").at("boom_angle").at("value").get<double>(), 57.296, 0.0005);
    EXPECT_EQ(message.at("values").at("boom_angle").at("unit"), "deg");
    EXPECT_TRUE(json.at("devices").at(2).at("state").is_null());
    EXPECT_TRUE(json.at("devices").at(2).at("heartbeat_age_s").is_null());
    // 79 bits a frame at 200 Hz of 500 000 bit/s; one frame more than intervals.
    EXPECT_NEAR(json.at("bus_load").get<double>(), 201.0 * 79.0 / 500'000.0, 1e-9);
}

TEST(BusMonitor, AWindowsRateIsOfThatWindowAlone) {
    const DeviceTable table(unprotected_network());
    BusMonitor monitor(table);
    monitor.take(angle_frame(table, 1.0, 0));
    monitor.close_window(0);
    for (int i = 1; i <= 50; ++i) {
        monitor.take(angle_frame(table, 1.0, i * 10'000'000));
    }
    monitor.close_window(500'000'000);
    EXPECT_DOUBLE_EQ(monitor.traffic(message_of(Pdo::boom_angle)).recent_rate_Hz, 100.0);
    monitor.close_window(1'000'000'000);
    EXPECT_DOUBLE_EQ(monitor.traffic(message_of(Pdo::boom_angle)).recent_rate_Hz, 0.0);
}

TEST(BusMonitor, WhatIsNotOursIsCountedByReason) {
    const DeviceTable table(unprotected_network());
    BusMonitor monitor(table);
    monitor.take({.id = 0x123, .length = 2, .stamp_ns = 1});
    monitor.take({.id = 0x194, .length = 4, .extended = true, .stamp_ns = 2});
    monitor.take({.id = 0x194, .length = 4, .remote = true, .stamp_ns = 3});
    monitor.take({.id = 0x194, .length = 3, .stamp_ns = 4});
    monitor.take({.id = 0x04, .length = 8, .error = true, .stamp_ns = 5});
    monitor.take_fd_frame(6);
    EXPECT_EQ(monitor.unknown_id_frames(), 2U);
    EXPECT_EQ(monitor.unknown_ids().at({false, 0x123}), 1U);
    EXPECT_EQ(monitor.unknown_ids().at({true, 0x194}), 1U);
    EXPECT_EQ(monitor.remote_frames(), 1U);
    EXPECT_EQ(monitor.traffic(message_of(Pdo::boom_angle)).wrong_length_frames, 1U);
    EXPECT_EQ(monitor.traffic(message_of(Pdo::boom_angle)).frames, 0U);
    EXPECT_EQ(monitor.error_frames(), 1U);
    EXPECT_EQ(monitor.fd_frames(), 1U);
    EXPECT_EQ(monitor.frames(), 4U);
    EXPECT_EQ(monitor.last_ns(), 6);
    const auto text = monitor_text(monitor, {.source = "can0", .now_ns = 6});
    EXPECT_THAT(text, HasSubstr("unknown identifier 2, remote 1, CAN FD 1, error messages 1, lost 0"));
    EXPECT_THAT(text, HasSubstr("123 x 1"));
    EXPECT_THAT(text, HasSubstr("[wrong length 1]"));
}

TEST(BusMonitor, AFloodOfUnknownIdentifiersTakesBoundedMemory) {
    BusMonitor monitor{DeviceTable(drivers::NetworkConfig{})};
    for (std::uint32_t id = 0; id < 5000; ++id) {
        monitor.take({.id = 0x1000'0000U + id, .extended = true});
    }
    EXPECT_EQ(monitor.unknown_id_frames(), 5000U);
    EXPECT_EQ(monitor.unknown_ids().size(), BusMonitor::most_unknown_ids);
}

TEST(BusMonitor, BadValuesAndBadStatusBytesAreCounted) {
    const DeviceTable table(unprotected_network());
    BusMonitor monitor(table);
    auto angle = table.blank(message_of(Pdo::boom_angle), 0);
    write_raw(table.row(Signal::boom_angle), 120'001, angle);
    monitor.take(angle);
    EXPECT_EQ(monitor.traffic(message_of(Pdo::boom_angle)).out_of_range_values, 1U);
    auto load = table.blank(message_of(Pdo::load_pin), 0);
    write_raw(table.row(Signal::line_tension_status), 3, load);
    monitor.take(load);
    EXPECT_EQ(monitor.traffic(message_of(Pdo::load_pin)).out_of_range_values, 0U);
    EXPECT_EQ(monitor.traffic(message_of(Pdo::load_pin)).faulty_values, 1U);
    EXPECT_THAT(monitor_text(monitor, {}),
                HasSubstr("[called faulty 1]  line_tension 0 N  line_tension_status overflow\n"));
}

TEST(BusMonitor, NodeStatesBootUpsAndEmergenciesAreTold) {
    const DeviceTable table(unprotected_network());
    BusMonitor monitor(table);
    auto heartbeat = table.blank(heartbeat_of(Device::load_pin), 0);
    monitor.take(heartbeat);
    heartbeat.data[0] = 0x05;
    heartbeat.stamp_ns = 100'000'000;
    monitor.take(heartbeat);
    monitor.take(drivers::emergency_frame({.node = 0x18, .code = 0x8130, .error_register = 0x11}, 150'000'000));
    EXPECT_EQ(monitor.traffic(Device::load_pin).boot_ups, 1U);
    const auto text = monitor_text(monitor, {.now_ns = 400'000'000});
    EXPECT_THAT(text, HasSubstr("load_pin 0x18: operational, heartbeat 300 ms ago: lost, boot-ups 1"));
    EXPECT_THAT(text, HasSubstr("emergency 0x8130 " + std::string(drivers::emergency_text(0x8130)) +
                                ", register 0x11, 250 ms ago, 1 in all"));
    EXPECT_THAT(text, HasSubstr("drum_encoder 0x1c: never heard"));
}

TEST(BusMonitor, TheLastSdoTransferIsToldInWords) {
    const DeviceTable table(unprotected_network());
    const auto shown_after = [&table](std::uint32_t id, std::array<std::uint8_t, 8> data) {
        BusMonitor monitor(table);
        monitor.take({.id = id, .length = 8, .data = data});
        return monitor_text(monitor, {});
    };
    EXPECT_THAT(shown_after(0x614, {0x40, 0x18, 0x10, 1}), HasSubstr("reads 1018h:01\n"));
    EXPECT_THAT(shown_after(0x594, {0x43, 0x18, 0x10, 1, 0x95, 1}), HasSubstr("1018h:01 is 0x195\n"));
    EXPECT_THAT(shown_after(0x614, {0x2B, 0x17, 0x10, 0, 0x64}), HasSubstr("writes 1017h:00 = 0x64\n"));
    EXPECT_THAT(shown_after(0x594, {0x60, 0x17, 0x10, 0}), HasSubstr("1017h:00 is written\n"));
    EXPECT_THAT(
        shown_after(0x594, {0x80, 0x17, 0x10, 0, 0, 0, 0x04, 0x05}),
        HasSubstr("aborts 1017h:00: 0x05040000 " + std::string(text_of(static_cast<drivers::SdoAbort>(0x0504'0000)))));
}

/// A protected boom angle on each SYNC, of which `damage` may change what leaves.
BusMonitor protected_second(const std::function<void(int tick, CanFrame&, BusMonitor&)>& damage) {
    const DeviceTable table{drivers::NetworkConfig{}};
    BusMonitor monitor(table);
    for (int tick = 0; tick < 200; ++tick) {
        auto sync = table.blank(Message::sync, tick * tick_ns);
        sync.data[0] = static_cast<std::uint8_t>(1 + tick % 240);
        monitor.take(sync);
        auto frame = angle_frame(table, 1.0, tick * tick_ns);
        protect(frame, table.row(Pdo::boom_angle).data_id, drivers::protection_counter(sync.data[0]), 0);
        damage(tick, frame, monitor);
        monitor.take(frame);
    }
    return monitor;
}

TEST(BusMonitor, ProtectedFramesAreCheckedAndTheirDamageCounted) {
    const auto& sound = protected_second([](int, CanFrame&, BusMonitor&) {});
    const auto& receiver = *sound.traffic(message_of(Pdo::boom_angle)).receiver;
    EXPECT_EQ(receiver.status().good_frames, 200U);
    EXPECT_EQ(receiver.state(), drivers::ReceiverState::valid);

    const auto& damaged = protected_second([](int tick, CanFrame& frame, BusMonitor&) {
        if (tick == 100) {
            frame.data[0] ^= 1;
        }
    });
    EXPECT_EQ(damaged.traffic(message_of(Pdo::boom_angle)).receiver->status().wrong_checksum_frames, 1U);
    EXPECT_THAT(monitor_text(damaged, {}), HasSubstr("[CRC 1"));
}

TEST(BusMonitor, AReplayBesideTheLiveSenderShowsAsRepeatedFramesAndTwiceTheRate) {
    const auto& replayed = protected_second([](int, CanFrame& frame, BusMonitor& monitor) { monitor.take(frame); });
    const auto& traffic = replayed.traffic(message_of(Pdo::boom_angle));
    EXPECT_EQ(traffic.receiver->status().repeated_frames, 200U);
    EXPECT_EQ(traffic.receiver->state(), drivers::ReceiverState::invalid);
    EXPECT_NEAR(traffic.mean_rate_Hz(), 400.0, 3.0);
    EXPECT_THAT(monitor_text(replayed, {}), HasSubstr("repeated 200"));
}

TEST(BusMonitorView, FitsTheTerminalAndSaysWhatIsLeftOut) {
    EXPECT_EQ(fit_to_terminal("abcdef\nxy\n", 4, 5), "abcd\nxy");
    EXPECT_EQ(fit_to_terminal("\033[1mabcdef\033[0m\nxy\n", 4, 5), "\033[1mabcd\033[0m\nxy");
    EXPECT_EQ(fit_to_terminal("a\nb\nc\nd\n", 80, 3), "a\nb\n... 2 more lines");
    EXPECT_EQ(fit_to_terminal("a\nb\nc\n", 80, 3), "a\nb\nc");
}

}  // namespace
}  // namespace steadyboom::hil
