#include "drivers/device_table.hpp"

#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/crane_network.hpp"

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

TEST(DeviceTable, SignalsFillTheirMessagesWithoutOverlapAndLeaveRoomForProtection) {
    constexpr std::size_t protection_bytes = 2;
    const DeviceTable table{NetworkConfig{}};
    const auto size_bytes = [](RawType type) -> std::size_t {
        return type == RawType::u8 ? 1 : type == RawType::u16 || type == RawType::i16 ? 2 : 4;
    };
    for (const auto& message : table.messages()) {
        std::set<std::size_t> used;
        for (const auto& row : table.signals()) {
            if (row.message == message.message) {
                for (std::size_t i = 0; i < size_bytes(row.type); ++i) {
                    EXPECT_TRUE(used.insert(row.byte_offset + i).second) << row.name;
                }
            }
        }
        if (!used.empty()) {
            EXPECT_EQ(used.size(), message.length_bytes) << message.name;
            EXPECT_EQ(*used.rbegin() + 1, message.length_bytes) << message.name;
            EXPECT_LE(message.length_bytes + protection_bytes, longest_frame_bytes) << message.name;
        }
    }
}

TEST(DeviceTable, NodeIdsMoveTheIdentifiersAndNothingElse) {
    NetworkConfig config;
    config.node_ids[index_of(Device::load_pin)] = 0x55;
    const DeviceTable table(config);
    EXPECT_EQ(table.message_with(0x1D5), Message::load_pin_tpdo1);
    EXPECT_EQ(table.message_with(0x755), Message::load_pin_heartbeat);
    EXPECT_EQ(table.message_with(0x198), Message::none);
    EXPECT_EQ(table.message_with(0x190), Message::strain_tpdo1);
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

TEST(DeviceTable, BadConfigurationIsRejectedWithFieldValueAndWhatIsAllowed) {
    using ::testing::HasSubstr;
    NetworkConfig config;
    config.node_ids[index_of(Device::drum_encoder)] = 0x10;
    EXPECT_THAT(complaint(config), HasSubstr("drum_encoder = 16: another device"));
    config = {};
    config.node_ids[index_of(Device::safety_io)] = 0;
    EXPECT_THAT(complaint(config), HasSubstr("safety_io = 0: allowed is 1 to 127"));
    config.node_ids[index_of(Device::safety_io)] = 128;
    EXPECT_THAT(complaint(config), HasSubstr("128"));
    config = {};
    config.bit_rate_bit_s = 800'000;
    EXPECT_THAT(complaint(config), HasSubstr("bit_rate_bit_s = 800000"));
    for (const double travel_m : {0.0, -1.0, std::nan(""), 2.0}) {
        config = {};
        config.spool_travel_m = travel_m;
        EXPECT_THAT(complaint(config), HasSubstr("spool_travel_m"));
    }
    for (const std::int64_t period_ns : {std::int64_t{0}, std::int64_t{-5}, std::int64_t{2'000'000'000}}) {
        config = {};
        config.period_ns = period_ns;
        EXPECT_THAT(complaint(config), HasSubstr("period_ns"));
    }
}

TEST(BusLoad, FrameLengthsAreTheKnownOnes) {
    EXPECT_EQ(worst_case_frame_bits(8), 135U);
    EXPECT_EQ(worst_case_frame_bits(0), 55U);
    EXPECT_EQ(worst_case_frame_bits(4), 95U);
    EXPECT_EQ(nominal_frame_bits(8), 111U);
}

TEST(BusLoad, DefaultsTakeAThirdOfTheBusAndTwoFifthsWhenEveryBitIsStuffed) {
    const auto load = bus_load({});
    RecordProperty("nominal_percent", std::to_string(100.0 * load.nominal_share));
    RecordProperty("worst_case_percent", std::to_string(100.0 * load.worst_case_share));
    // By hand, data bytes of a tick: SYNC 1; TPDOs 6 4 5 4 4 4 6 1; RPDOs 1 4. Eight heartbeats of 1 byte each 100 ms.
    EXPECT_NEAR(load.nominal_share, (200.0 * (11 * 47 + 8 * 40) + 80.0 * 55) / 500'000.0, 1.0e-12);
    EXPECT_NEAR(load.worst_case_share, (200.0 * 1005 + 80.0 * 65) / 500'000.0, 1.0e-12);
    EXPECT_NEAR(load.nominal_share, 0.35, 0.01);
}

TEST(BusLoad, ConfigurationAboveSeventyPercentIsRefusedByTheController) {
    NetworkConfig config;
    config.bit_rate_bit_s = 250'000;
    EXPECT_GT(bus_load(config).worst_case_share, largest_bus_load_share);
    try {
        const CraneNetwork network(config);
        FAIL() << "accepted";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("82 %: allowed is 70 %"));
    }
    config.period_ns = 10'000'000;
    EXPECT_NO_THROW(CraneNetwork{config});
}

}  // namespace
}  // namespace steadyboom::drivers
