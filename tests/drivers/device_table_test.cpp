#include "drivers/device_table.hpp"

#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/crane_network.hpp"
#include "drivers/pdo_codec.hpp"

namespace steadyboom::drivers {
namespace {

TEST(DeviceTable, RowsStandAtTheirOwnIndex) {
    const DeviceTable table{NetworkConfig{}};
    for (std::size_t i = 0; i < message_count; ++i) {
        EXPECT_EQ(index_of(table.messages()[i].message), i) << table.messages()[i].name;
    }
    for (std::size_t i = 0; i < signal_count; ++i) {
        EXPECT_EQ(index_of(table.signals()[i].signal), i) << table.signals()[i].name;
    }
}

TEST(DeviceTable, EverySensorChannelHasExactlyOneSignal) {
    const DeviceTable table{NetworkConfig{}};
    std::multiset<int> sensors;
    for (const auto& row : table.signals()) {
        if (row.sensor != plant::sensor_count) {
            sensors.insert(row.sensor);
        }
    }
    EXPECT_EQ(sensors.size(), static_cast<std::size_t>(plant::sensor_count));
    EXPECT_EQ(std::set<int>(sensors.begin(), sensors.end()).size(), static_cast<std::size_t>(plant::sensor_count));
}

TEST(DeviceTable, SignalsLieInTheirMessagesAndLeaveRoomForProtection) {
    for (const auto protection : {Protection::none, Protection::e2e}) {
        NetworkConfig config;
        config.protect_all(protection);
        const DeviceTable table(config);
        const std::size_t ends_bytes = protection == Protection::e2e ? protection_bytes : 0;
        for (const auto& message : table.messages()) {
            std::set<std::size_t> used_bits;
            for (const auto& row : table.signals()) {
                if (row.message == message.message) {
                    for (std::size_t bit = 0; bit < size_bits(row.type); ++bit) {
                        EXPECT_TRUE(used_bits.insert(8U * row.byte_offset + row.bit + bit).second) << row.name;
                    }
                }
            }
            if (!used_bits.empty()) {
                EXPECT_EQ(*used_bits.rbegin() / 8 + 1 + ends_bytes, message.length_bytes) << message.name;
            }
            EXPECT_LE(message.length_bytes, longest_frame_bytes) << message.name;
        }
        EXPECT_EQ(table.row(Pdo::valve_twin).present, protection == Protection::e2e);
        EXPECT_EQ(table.row(Pdo::valve_twin).length_bytes, table.row(Pdo::valve_command).length_bytes);
        EXPECT_EQ(table.most_frames_a_tick(), protection == Protection::e2e ? 5U : 4U);
    }
}

TEST(DeviceTable, ADeviceIsDescribedByItsRows) {
    NetworkConfig config;
    config[Pdo::boom_angle] = {.device = Device::boom_inclinometer,
                               .number = 2,
                               .length_bytes = 6,
                               .data_id = 9,
                               .transmission = Transmission::event,
                               .event_ms = 4};
    config[Signal::boom_angle] = {.object = 0x6010,
                                  .type = RawType::i16,
                                  .byte_offset = 2,
                                  .byte_order = ByteOrder::big_endian,
                                  .unit = Unit::deg,
                                  .scale = -0.01,
                                  .offset = 90.0,
                                  .lowest = -80.0,
                                  .highest = 170.0,
                                  .fastest_1_s = 100.0};
    const DeviceTable table(config);
    const auto& message = table.row(Pdo::boom_angle);
    EXPECT_EQ(message.name, "boom_inclinometer_tpdo2");
    EXPECT_EQ(message.id, 0x294U);
    EXPECT_EQ(message.length_bytes, 8);
    EXPECT_EQ(message.cycle, Cycle::timer);
    EXPECT_EQ(message.interval_ns, 4'000'000);
    const auto& row = table.row(Signal::boom_angle);
    constexpr double rad_per_deg = 0.017453292519943295;
    EXPECT_NEAR(row.largest_step_unit, 0.5 * rad_per_deg, 1e-12);
    auto frame = table.blank(message.message, 0);
    EXPECT_EQ(encode_value(row, 60.0 * rad_per_deg, frame), SampleStatus::ok);
    EXPECT_EQ(frame.data, (std::array<std::uint8_t, 8>{0, 0, 0x0B, 0xB8}));  // (60 - 90) / -0.01 = 3000
    EXPECT_NEAR(*decode_value(row, frame), 60.0 * rad_per_deg, 1e-9);
}

TEST(DeviceTable, APdoIsOfTheDeviceThatSendsItAndOfNoneIfNothingIsInIt) {
    NetworkConfig config;
    config[Signal::line_length].mapped = false;
    config[Pdo::valve_piston].device = Device::drum_encoder;
    config[Device::drum_encoder].protection = Protection::none;
    const DeviceTable table(config);
    EXPECT_FALSE(table.row(Pdo::drum).present);
    const auto& piston = table.row(Pdo::valve_piston);
    EXPECT_EQ(piston.name, "drum_encoder_tpdo2");
    EXPECT_EQ(piston.id, 0x29CU);
    EXPECT_EQ(piston.protection, Protection::none);
    EXPECT_EQ(piston.length_bytes, 6U);
    EXPECT_EQ(table.message_with(0x29C), message_of(Pdo::valve_piston));
    EXPECT_EQ(table.message_with(0x2A0), Message::none);
    EXPECT_EQ(table.message_with(0x19C), Message::none);
}

TEST(DeviceTable, NodeIdsMoveTheIdentifiersAndNothingElse) {
    NetworkConfig config;
    config[Device::load_pin].node_id = 0x55;
    const DeviceTable table(config);
    EXPECT_EQ(table.message_with(0x1D5), message_of(Pdo::load_pin));
    EXPECT_EQ(table.message_with(0x755), heartbeat_of(Device::load_pin));
    EXPECT_EQ(table.message_with(0x198), Message::none);
    EXPECT_EQ(table.message_with(0x190), message_of(Pdo::strain));
    EXPECT_EQ(table.message_with(0x1000'0190), Message::none);
}

std::string complaint(const NetworkConfig& config) {
    try {
        const DeviceTable table(config);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "none";
}

/// The complaint about the default network changed by `change`.
template <typename Change>
std::string complaint_after(const Change& change) {
    NetworkConfig config;
    change(config);
    return complaint(config);
}

using ::testing::HasSubstr;

TEST(DeviceTable, BadBusOrTickIsRejectedWithKeyValueAndWhatIsAllowed) {
    EXPECT_THAT(complaint_after([](auto& c) { c.bit_rate_bit_s = 800'000; }), HasSubstr("bit_rate_bit_s = 800000"));
    for (const double travel_m : {0.0, -1.0, std::nan(""), 2.0}) {
        EXPECT_THAT(complaint_after([=](auto& c) { c.spool_travel_m = travel_m; }), HasSubstr("spool_travel_m"));
    }
    for (const std::int64_t period_ns : {std::int64_t{0}, std::int64_t{-5}, std::int64_t{2'000'000'000}}) {
        EXPECT_THAT(complaint_after([=](auto& c) { c.period_ns = period_ns; }), HasSubstr("period_ns"));
    }
}

TEST(DeviceTable, BadDeviceIsRejectedWithKeyValueAndWhatIsAllowed) {
    EXPECT_THAT(complaint_after([](auto& c) { c[Device::drum_encoder].node_id = 0x10; }),
                HasSubstr("device.drum_encoder.node_id = 16: strain_link has this node id"));
    for (const int node_id : {0, 128}) {
        EXPECT_THAT(
            complaint_after([=](auto& c) { c[Device::safety_io].node_id = static_cast<std::uint8_t>(node_id); }),
            HasSubstr("device.safety_io.node_id = " + std::to_string(node_id) + ": allowed is 1 to 127"));
    }
    EXPECT_THAT(complaint_after([](auto& c) { c[Device::load_pin].heartbeat_ms = 250; }),
                HasSubstr("device.load_pin.heartbeat_timeout_ms = 250: allowed is more than heartbeat_ms"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Device::load_pin].heartbeat_ms = 0; }),
                HasSubstr("device.load_pin.heartbeat_timeout_ms = 250: allowed is 0"));
}

TEST(DeviceTable, BadPdoIsRejectedWithKeyValueAndWhatIsAllowed) {
    EXPECT_THAT(complaint_after([](auto& c) { c[Pdo::drum].number = 5; }), HasSubstr("pdo.drum.number = 5"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Pdo::valve_piston].number = 1; }),
                HasSubstr("servo_valve_tpdo1 and servo_valve_tpdo1 would both be identifier 0x1a0"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Pdo::drum].data_id = c[Pdo::strain].data_id; }),
                HasSubstr("pdo.drum.data_id = 23296: pdo.strain has this data id"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Pdo::drum].event_ms = 5; }), HasSubstr("pdo.drum.event_ms = 5"));
    for (const int event_ms : {0, 6}) {
        EXPECT_THAT(complaint_after([=](auto& c) {
                        c[Pdo::drum].transmission = Transmission::event;
                        c[Pdo::drum].event_ms = event_ms;
                    }),
                    HasSubstr("pdo.drum.event_ms = " + std::to_string(event_ms) + ": allowed is at least 1"));
    }
    // A message without counter may leave out ticks, but neither the valve's state nor the emergency stop.
    const auto on_timer = [](Pdo pdo, int event_ms) {
        return complaint_after([=](auto& c) {
            c.protect_all(Protection::none);
            c[pdo].transmission = Transmission::event;
            c[pdo].event_ms = event_ms;
        });
    };
    EXPECT_EQ(on_timer(Pdo::drum, 15), "none");
    EXPECT_THAT(on_timer(Pdo::drum, 16), HasSubstr("pdo.drum.event_ms = 16: allowed is at least 1 and at most three"));
    for (const auto pdo : {Pdo::valve_status, Pdo::safety_inputs}) {
        EXPECT_EQ(on_timer(pdo, 5), "none");
        EXPECT_THAT(on_timer(pdo, 6), HasSubstr(".event_ms = 6: allowed is at least 1 and at most one tick"));
    }
    EXPECT_THAT(complaint_after([](auto& c) { c[Pdo::drum].device = Device::controller; }),
                HasSubstr("pdo.drum.device = controller: allowed is any device but the controller"));
    for (const auto pdo : {Pdo::valve_status, Pdo::safety_inputs, Pdo::valve_command, Pdo::valve_twin}) {
        EXPECT_THAT(complaint_after([=](auto& c) { c[pdo].device = Device::load_pin; }),
                    HasSubstr(".device = load_pin: allowed is s"))
            << name_of(pdo);
    }
    EXPECT_THAT(complaint_after([](auto& c) { c[Pdo::strain].length_bytes = 5; }),
                HasSubstr("pdo.strain.length_bytes = 5: allowed is 6"));
    EXPECT_THAT(complaint_after([](auto& c) {
                    c[Pdo::strain].length_bytes = 7;
                    c[Device::strain_link].protection = Protection::e2e;
                }),
                HasSubstr("device.strain_link.protection = e2e: counter and CRC need two bytes"));
}

TEST(DeviceTable, BadSignalIsRejectedWithKeyValueAndWhatIsAllowed) {
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::boom_angle].unit = Unit::bar; }),
                HasSubstr("signal.boom_angle.unit = bar"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::boom_angle].scale = 0.0; }),
                HasSubstr("signal.boom_angle.scale = 0"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::boom_angle].offset = std::nan(""); }),
                HasSubstr("signal.boom_angle.offset"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::boom_angle].lowest = 120.0; }),
                HasSubstr("signal.boom_angle.lowest = 120"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::boom_angle].fastest_1_s = -1.0; }),
                HasSubstr("signal.boom_angle.fastest_1_s = -1"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::boom_angle].byte_offset = 5; }),
                HasSubstr("signal.boom_angle.byte_offset = 5"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::strain_upper].byte_offset = 1; }),
                HasSubstr("signal.strain_upper.byte_offset = 1: strain_lower lies there"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::boom_angle].bit = 1; }),
                HasSubstr("signal.boom_angle.bit = 1"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::cutoff_open].type = RawType::u8; }),
                HasSubstr("signal.cutoff_open.type"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::valve_status_word].type = RawType::u8; }),
                HasSubstr("signal.valve_status_word.type"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::emergency_stop_healthy].mapped = false; }),
                HasSubstr("signal.emergency_stop_healthy.mapped = false"));
    EXPECT_THAT(complaint_after([](auto& c) { c[Signal::load_pressure].highest = 655.35; }),
                HasSubstr("signal.load_pressure.highest = 655.35: the raw code 65534"));
}

TEST(BusLoad, FrameLengthsAreTheKnownOnes) {
    EXPECT_EQ(worst_case_frame_bits(8), 135U);
    EXPECT_EQ(worst_case_frame_bits(0), 55U);
    EXPECT_EQ(worst_case_frame_bits(4), 95U);
    EXPECT_EQ(nominal_frame_bits(8), 111U);
}

BusLoad load_of(Protection protection, std::int64_t period_ns = 5'000'000, std::uint32_t bit_rate_bit_s = 500'000) {
    NetworkConfig config{.period_ns = period_ns, .bit_rate_bit_s = bit_rate_bit_s};
    config.protect_all(protection);
    return bus_load(DeviceTable(config));
}

// By hand, data bytes of a tick without protection: SYNC 1; TPDOs 6 4 5 4 4 4 6 1; RPDOs 1 4. With it two more in each
// of ten PDOs, and the valve's twin of 6. Eight heartbeats of 1 byte each 100 ms. In the worst case an SDO request and
// its answer, 135 bits each, come on top in every tick.
TEST(BusLoad, DefaultsTakeAThirdOfTheBusAndNineTwentiethsWithProtectionAndTwin) {
    const auto plain = load_of(Protection::none);
    EXPECT_NEAR(plain.nominal_share, (200.0 * (11 * 47 + 8 * 40) + 80.0 * 55) / 500'000.0, 1.0e-12);
    EXPECT_NEAR(plain.worst_case_share, (200.0 * (1005 + 270) + 80.0 * 65) / 500'000.0, 1.0e-12);
    EXPECT_NEAR(plain.nominal_share, 0.35, 0.01);
    const auto guarded = load_of(Protection::e2e);
    EXPECT_NEAR(guarded.nominal_share, (200.0 * (12 * 47 + 8 * 66) + 80.0 * 55) / 500'000.0, 1.0e-12);
    EXPECT_NEAR(guarded.worst_case_share, (200.0 * (1320 + 270) + 80.0 * 65) / 500'000.0, 1.0e-12);
    EXPECT_NEAR(guarded.nominal_share, 0.45, 0.01);
}

TEST(BusLoad, ExtendedFramesAreTwentyBitsLonger) {
    EXPECT_EQ(nominal_frame_bits(8, true), 131U);
    EXPECT_EQ(worst_case_frame_bits(8, true), 160U);
}

TEST(BusLoad, ConfigurationAboveSeventyPercentIsRefusedByTheController) {
    EXPECT_GT(load_of(Protection::none, 5'000'000, 250'000).worst_case_share, largest_bus_load_share);
    NetworkConfig config{.bit_rate_bit_s = 250'000};
    try {
        const CraneNetwork network(config);
        FAIL() << "accepted";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("%: allowed is 70 %"));
    }
    config.period_ns = 10'000'000;
    EXPECT_NO_THROW(CraneNetwork{config});
}

}  // namespace
}  // namespace steadyboom::drivers
