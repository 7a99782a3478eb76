#include "runtime/network_file.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/device_table.hpp"
#include "runtime/toml_reader.hpp"
#include "toml_text.hpp"

namespace steadyboom::runtime {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string shipped() {
    return text_of(STEADYBOOM_TEST_NETWORK_FILE);
}

drivers::NetworkConfig loaded(const std::string& toml, const drivers::NetworkConfig& base = {}) {
    const TemporaryFile file("network.toml", toml);
    return load_network_file(file.path(), base);
}

std::string error_of(const std::string& toml, const drivers::NetworkConfig& base = {}) {
    try {
        (void)loaded(toml, base);
    } catch (const ConfigError& error) {
        return error.what();
    }
    return "none";
}

std::string with(std::string text, const std::string& old, const std::string& replacement) {
    const auto at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return text.replace(at, old.size(), replacement);
}

TEST(NetworkFile, ShippedFileAndNoFileAtAllDescribeTheSameDevices) {
    EXPECT_EQ(to_toml(loaded(shipped())), to_toml(drivers::NetworkConfig{}));
    EXPECT_EQ(to_toml(loaded("")), to_toml(drivers::NetworkConfig{}));
}

TEST(NetworkFile, ShippedFileNamesEveryRowThereIs) {
    const std::string text = shipped();
    const drivers::DeviceTable table{drivers::NetworkConfig{}};
    for (std::size_t i = 0; i < drivers::device_count; ++i) {
        EXPECT_THAT(text, HasSubstr("\n" + std::string(name_of(static_cast<drivers::Device>(i)))));
    }
    for (std::size_t i = 0; i < drivers::pdo_count; ++i) {
        EXPECT_THAT(text, HasSubstr("\n" + std::string(name_of(static_cast<drivers::Pdo>(i)))));
    }
    for (const auto& row : table.signals()) {
        EXPECT_THAT(text, HasSubstr("\n" + std::string(row.name)));
    }
}

TEST(NetworkFile, WhatIsWrittenReadsBackTheSame) {
    drivers::NetworkConfig config;
    config[drivers::Device::load_pin] = {.node_id = 0x33,
                                         .protection = drivers::Protection::e2e,
                                         .required = false,
                                         .configure = false,
                                         .heartbeat_ms = 0,
                                         .device_type = 0x8002'0194,
                                         .vendor_id = 0xFFFF'FFFF,
                                         .product_code = 7};
    config[drivers::Pdo::drum] = {.device = drivers::Device::load_pin,
                                  .number = 3,
                                  .length_bytes = 5,
                                  .data_id = 0xFFFF,
                                  .transmission = drivers::Transmission::event,
                                  .event_ms = 5};
    config[drivers::Pdo::valve_piston].device = drivers::Device::strain_link;
    config[drivers::Signal::line_angle].byte_order = drivers::ByteOrder::big_endian;
    config[drivers::Signal::line_angle].scale = -0.1 / 3.0;
    config[drivers::Signal::line_length].unit = drivers::Unit::mm;
    config[drivers::Signal::line_length].scale = 0.1;
    config[drivers::Signal::line_length].highest = 5e5;
    config[drivers::Signal::line_tension_status].mapped = false;
    EXPECT_EQ(to_toml(loaded(to_toml(config))), to_toml(config));
    EXPECT_NE(to_toml(config), to_toml(drivers::NetworkConfig{}));
}

TEST(NetworkFile, TickBitRateAndTravelComeFromElsewhere) {
    const auto config = loaded(shipped(), {.spool_travel_m = 5e-3, .period_ns = 10'000'000, .bit_rate_bit_s = 250'000});
    EXPECT_EQ(config.spool_travel_m, 5e-3);
    EXPECT_EQ(config.period_ns, 10'000'000);
    EXPECT_EQ(config.bit_rate_bit_s, 250'000U);
}

TEST(NetworkFile, BadRowIsOneLineWithFileLineKeyValueAndRemedy) {
    EXPECT_THAT(error_of(with(shipped(), "node_id = 0x14", "node_id = 128")),
                AllOf(HasSubstr("network.toml:"),
                      HasSubstr("device.boom_inclinometer.node_id = 128: must be an integer in [1, 127]")));
    EXPECT_THAT(error_of(with(shipped(), "type = \"i32\"", "type = \"f32\"")),
                HasSubstr("signal.boom_angle.type = \"f32\": must be \"bit\", \"u8\""));
    EXPECT_THAT(error_of(with(shipped(), ", vendor_id = 0", "")),
                HasSubstr("device.strain_link.vendor_id: is missing"));
    EXPECT_THAT(error_of(with(shipped(), ", vendor_id =", ", vendor =")),
                HasSubstr("device.strain_link.vendor = 0: unknown key; did you mean device.strain_link.vendor_id?"));
    EXPECT_THAT(error_of(with(shipped(), "device = \"drum_encoder\"", "device = \"drum\"")),
                HasSubstr("pdo.drum.device = \"drum\": must be \"strain_link\", "));
    EXPECT_THAT(error_of("[device.strain]\nnode_id = 1\n"),
                HasSubstr("network.toml:1: [device.strain]: unknown section"));
    EXPECT_THAT(error_of("[devices]\n"), HasSubstr("[devices]: unknown section"));
    EXPECT_THAT(error_of("device = 3\n"), HasSubstr("device = 3: must be a section [device]"));
    EXPECT_THAT(error_of("[device]\nload_pin = 3\n"), HasSubstr("must be a section [device.load_pin]"));
    EXPECT_THAT(error_of("[device]\nnode_id = 3\n"), HasSubstr("device.node_id = 3: unknown key"));
}

TEST(NetworkFile, RowsThatDoNotFitTogetherAreRefusedWithFileAndKey) {
    EXPECT_THAT(
        error_of(with(shipped(), "node_id = 0x14", "node_id = 0x10")),
        AllOf(HasSubstr("network.toml: "), HasSubstr("device.boom_inclinometer.node_id = 16: strain_link has")));
    EXPECT_THAT(error_of(shipped(), {.bit_rate_bit_s = 125'000}), HasSubstr("%: allowed is 70 %"));
}

}  // namespace
}  // namespace steadyboom::runtime
