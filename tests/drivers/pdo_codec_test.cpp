#include "drivers/pdo_codec.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace steadyboom::drivers {
namespace {

NetworkConfig without_protection() {
    NetworkConfig config;
    config.protect_all(Protection::none);
    return config;
}

const DeviceTable& table() {
    static const DeviceTable instance{without_protection()};
    return instance;
}

CanFrame encoded(Signal signal, double value) {
    const auto& row = table().row(signal);
    auto frame = table().blank(row.message, 0);
    EXPECT_EQ(encode_value(row, value, frame), SampleStatus::ok);
    return frame;
}

std::vector<std::uint8_t> bytes(const CanFrame& frame) {
    return {frame.data.begin(), frame.data.begin() + frame.length};
}

using Bytes = std::vector<std::uint8_t>;

TEST(PdoCodec, BytesOnTheBusAreTheOnesOfTheDeviceProfiles) {
    constexpr double rad_per_deg = 0.017453292519943295;
    EXPECT_EQ(bytes(encoded(Signal::strain_lower, -123.4)), (Bytes{0x2E, 0xFB, 0, 0, 0, 0}));
    EXPECT_EQ(bytes(encoded(Signal::strain_upper, 1301.0)), (Bytes{0, 0, 0xD2, 0x32, 0, 0}));
    EXPECT_EQ(bytes(encoded(Signal::boom_angle, 60.0 * rad_per_deg)), (Bytes{0x60, 0xEA, 0, 0}));
    EXPECT_EQ(bytes(encoded(Signal::line_angle, -0.001 * rad_per_deg)), (Bytes{0xFF, 0xFF, 0xFF, 0xFF}));
    EXPECT_EQ(bytes(encoded(Signal::line_tension, 133'416.0)), (Bytes{0x28, 0x09, 0x02, 0, 0}));
    EXPECT_EQ(bytes(encoded(Signal::line_length, 12.2)), (Bytes{0x90, 0xDC, 0x01, 0}));
    EXPECT_EQ(bytes(encoded(Signal::spool, -7.6e-3)), (Bytes{0, 0, 0x00, 0xC0}));
    EXPECT_EQ(bytes(encoded(Signal::valve_set_point, 3.8e-3)), (Bytes{0, 0, 0x00, 0x20}));
    EXPECT_EQ(bytes(encoded(Signal::piston, -0.001234)), (Bytes{0x2E, 0xFB, 0xFF, 0xFF, 0, 0}));
    EXPECT_EQ(bytes(encoded(Signal::load_pressure, 6.8e6)), (Bytes{0, 0, 0, 0, 0xA8, 0x02}));
}

TEST(PdoCodec, EverySignalComesBackWithinHalfAStepOverItsWholeRange) {
    for (const auto& row : table().signals()) {
        EXPECT_TRUE(rc::check("round trip", [&row] {
            const double share = *rc::gen::inRange(0, 1'000'001) / 1.0e6;
            const double value_unit = row.lowest_unit + share * (row.highest_unit - row.lowest_unit);
            auto frame = table().blank(row.message, 0);
            RC_ASSERT(encode_value(row, value_unit, frame) == SampleStatus::ok);
            const auto decoded_unit = decode_value(row, frame);
            RC_ASSERT(decoded_unit.has_value());
            RC_ASSERT(std::abs(*decoded_unit - value_unit) <= 0.500001 * row.scale_unit);
        })) << row.name;
        for (const double value_unit : {row.lowest_unit, row.highest_unit}) {
            auto frame = table().blank(row.message, 0);
            EXPECT_EQ(encode_value(row, value_unit, frame), SampleStatus::ok) << row.name;
            const auto decoded_unit = decode_value(row, frame);
            ASSERT_TRUE(decoded_unit.has_value()) << row.name;
            EXPECT_NEAR(*decoded_unit, value_unit, 0.500001 * row.scale_unit) << row.name;
        }
    }
}

TEST(PdoCodec, EveryRawCodeOfEverySixteenBitSignalSurvives) {
    for (const auto& row : table().signals()) {
        if (row.type != RawType::i16 && row.type != RawType::u16) {
            continue;
        }
        const int first = row.type == RawType::i16 ? -32768 : 0;
        for (int raw = first; raw < first + 65536; ++raw) {
            auto frame = table().blank(row.message, 0);
            write_raw(row, raw, frame);
            ASSERT_EQ(read_raw(row, frame), raw) << row.name;
        }
    }
}

TEST(PdoCodec, SignalTouchesOnlyItsOwnBits) {
    for (const auto& row : table().signals()) {
        auto zeros = table().blank(row.message, 0);
        auto ones = zeros;
        ones.data.fill(0xFF);
        write_raw(row, 0x5A5A'5A5A, zeros);
        write_raw(row, 0x5A5A'5A5A, ones);
        EXPECT_EQ(read_raw(row, zeros), read_raw(row, ones)) << row.name;
        const unsigned first_bit = 8U * row.byte_offset + row.bit;
        for (unsigned bit = 0; bit < 64; ++bit) {
            if (bit < first_bit || bit >= first_bit + size_bits(row.type)) {
                EXPECT_EQ(zeros.data[bit / 8] >> (bit % 8) & 1, 0) << row.name << " bit " << bit;
                EXPECT_EQ(ones.data[bit / 8] >> (bit % 8) & 1, 1) << row.name << " bit " << bit;
            }
        }
    }
}

TEST(PdoCodec, OneStepBeyondALimitIsRejected) {
    for (const auto& row : table().signals()) {
        if (row.sensor == plant::sensor_count) {
            continue;
        }
        for (const double beyond_unit : {row.lowest_unit - row.scale_unit, row.highest_unit + row.scale_unit}) {
            if (row.lowest_unit == 0.0 && beyond_unit < 0.0) {
                continue;  // unsigned: there is no such code
            }
            auto frame = table().blank(row.message, 0);
            (void)encode_value(row, beyond_unit, frame);
            EXPECT_FALSE(decode_value(row, frame).has_value()) << row.name << " " << beyond_unit;
        }
    }
}

TEST(PdoCodec, NoValueCodesAreRejectedOnEverySensorChannel) {
    for (const auto& row : table().signals()) {
        if (row.sensor == plant::sensor_count) {
            continue;
        }
        std::vector<std::int64_t> codes;
        switch (row.type) {
            case RawType::i16:
                codes = {-0x8000, 0x7FFF};
                break;
            case RawType::i32:
                codes = {-0x8000'0000LL, 0x7FFF'FFFF};
                break;
            case RawType::u16:
                codes = {0xFFFE, 0xFFFF};
                break;
            case RawType::u32:
                codes = {0xFFFF'FFFE, 0xFFFF'FFFF};
                break;
            case RawType::u8:
            case RawType::bit:
                FAIL() << row.name;
        }
        for (const auto raw : codes) {
            auto frame = table().blank(row.message, 0);
            write_raw(row, raw, frame);
            EXPECT_FALSE(decode_value(row, frame).has_value()) << row.name << " " << raw;
        }
    }
}

TEST(PdoCodec, BeyondTheRangeTheStatusSaysWhichWayAndTheValueIsRejected) {
    const auto& row = table().row(Signal::strain_lower);
    auto frame = table().blank(row.message, 0);
    EXPECT_EQ(encode_value(row, 5000.0, frame), SampleStatus::overflow);
    EXPECT_EQ(read_raw(row, frame), 32767);
    EXPECT_FALSE(decode_value(row, frame).has_value());
    EXPECT_EQ(encode_value(row, -std::numeric_limits<double>::infinity(), frame), SampleStatus::underflow);
    EXPECT_EQ(read_raw(row, frame), -32768);
}

TEST(PdoCodec, NotANumberNeverBecomesAValue) {
    for (const auto& row : table().signals()) {
        if (row.sensor != plant::sensor_count) {
            auto frame = table().blank(row.message, 0);
            EXPECT_EQ(encode_value(row, std::nan(""), frame), SampleStatus::overflow) << row.name;
            EXPECT_FALSE(decode_value(row, frame).has_value()) << row.name;
        }
    }
}

}  // namespace
}  // namespace steadyboom::drivers
