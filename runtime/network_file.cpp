#include "runtime/network_file.hpp"

#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/crane_network.hpp"
#include "runtime/toml_reader.hpp"

namespace steadyboom::runtime {
namespace {

using drivers::ByteOrder;
using drivers::Device;
using drivers::DeviceConfig;
using drivers::NetworkConfig;
using drivers::Pdo;
using drivers::PdoConfig;
using drivers::Protection;
using drivers::RawType;
using drivers::Signal;
using drivers::SignalConfig;
using drivers::Transmission;
using drivers::Unit;
using drivers::ValveProfile;

template <class Value, std::size_t count>
using Words = std::array<std::pair<std::string_view, Value>, count>;

constexpr Words<Protection, 2> protection_words = {{{"none", Protection::none}, {"e2e", Protection::e2e}}};
constexpr Words<ValveProfile, 2> profile_words = {{{"cia408", ValveProfile::cia408}, {"j1939", ValveProfile::j1939}}};
constexpr Words<Transmission, 2> transmission_words = {{{"sync", Transmission::sync}, {"event", Transmission::event}}};
constexpr Words<ByteOrder, 2> byte_order_words = {
    {{"little", ByteOrder::little_endian}, {"big", ByteOrder::big_endian}}};
constexpr Words<RawType, 6> type_words = {{{"bit", RawType::bit},
                                           {"u8", RawType::u8},
                                           {"u16", RawType::u16},
                                           {"i16", RawType::i16},
                                           {"u32", RawType::u32},
                                           {"i32", RawType::i32}}};
const auto device_words = [] {  // all but the controller
    Words<Device, drivers::device_count - 1> words;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const auto device = static_cast<Device>(i + 1);
        words[i] = {drivers::name_of(device), device};
    }
    return words;
}();
const auto unit_words = [] {
    Words<Unit, 12> words;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const auto unit = static_cast<Unit>(i + 1);
        words[i] = {drivers::name_of(unit), unit};
    }
    return words;
}();

void declare_device(TomlSchema& schema, Device device, DeviceConfig& config) {
    schema.optional_section("device." + std::string(drivers::name_of(device)));
    schema.integer("node_id", config.node_id, 1, 127);
    if (device == Device::controller) {
        schema.integer("heartbeat_ms", config.heartbeat_ms, 1, 65'535, "ms");
        return;
    }
    if (device == Device::servo_valve) {
        schema.word<ValveProfile>("profile", config.profile, profile_words);
    }
    schema.word<Protection>("protection", config.protection, protection_words);
    schema.boolean("canopen", config.canopen);
    schema.boolean("required", config.required);
    schema.boolean("configure", config.configure);
    schema.integer("heartbeat_ms", config.heartbeat_ms, 0, 65'535, "ms");
    schema.integer("heartbeat_timeout_ms", config.heartbeat_timeout_ms, 0, 65'535, "ms");
    schema.integer("device_type", config.device_type, 0, 0xFFFF'FFFF);
    schema.integer("vendor_id", config.vendor_id, 0, 0xFFFF'FFFF);
    schema.integer("product_code", config.product_code, 0, 0xFFFF'FFFF);
}

void declare_pdo(TomlSchema& schema, Pdo pdo, PdoConfig& config) {
    schema.optional_section("pdo." + std::string(drivers::name_of(pdo)));
    if (drivers::carries_sensors_alone(pdo)) {
        schema.word<Device>("device", config.device, device_words);
    }
    schema.integer("number", config.number, 1, 4);
    schema.integer("extended_id", config.extended_id, 0, 0x1FFF'FFFF);
    if (pdo != Pdo::valve_twin) {  // it repeats the command, bit for bit
        schema.integer("data_id", config.data_id, 0, 0xFFFF);
        schema.integer("length_bytes", config.length_bytes, 0, 8);
    }
    if (!drivers::from_controller(pdo)) {
        schema.word<Transmission>("transmission", config.transmission, transmission_words);
        schema.integer("event_ms", config.event_ms, 0, 65'535, "ms");
    }
}

void declare_signal(TomlSchema& schema, Signal signal, SignalConfig& config) {
    constexpr double largest = 1.0e12;
    schema.optional_section("signal." + std::string(drivers::name_of(signal)));
    schema.boolean("mapped", config.mapped);
    schema.integer("object", config.object, 0, 0xFFFF);
    schema.integer("subindex", config.subindex, 0, 0xFF);
    schema.word<RawType>("type", config.type, type_words);
    schema.integer("byte_offset", config.byte_offset, 0, 7);
    schema.integer("bit", config.bit, 0, 7);
    schema.word<ByteOrder>("byte_order", config.byte_order, byte_order_words);
    if (drivers::measures(Unit::none, signal)) {
        return;  // a word, a status byte or a bit: its raw value is its meaning
    }
    schema.word<Unit>("unit", config.unit, unit_words);
    schema.number("scale", config.scale, closed(-largest, largest), "unit/step");
    schema.number("offset", config.offset, closed(-largest, largest), "unit");
    schema.number("lowest", config.lowest, closed(-largest, largest), "unit");
    schema.number("highest", config.highest, closed(-largest, largest), "unit");
    schema.number("fastest_1_s", config.fastest_1_s, closed(0, largest), "unit/s");
}

void declare_network(TomlSchema& schema, NetworkConfig& config) {
    for (std::size_t i = 0; i < drivers::device_count; ++i) {
        declare_device(schema, static_cast<Device>(i), config.devices[i]);
    }
    schema.optional_section("valve_timeout");
    schema.integer("object", config.valve_timeout.object, 0, 0xFFFF);
    schema.integer("subindex", config.valve_timeout.subindex, 0, 0xFF);
    schema.integer("longest_raw", config.valve_timeout.longest_raw, 1, 0xFFFF'FFFF);
    for (std::size_t i = 0; i < drivers::pdo_count; ++i) {
        declare_pdo(schema, static_cast<Pdo>(i), config.pdos[i]);
    }
    for (std::size_t i = 0; i < drivers::signal_count; ++i) {
        declare_signal(schema, static_cast<Signal>(i), config.signals[i]);
    }
}

}  // namespace

NetworkConfig load_network_file(const std::filesystem::path& path, const NetworkConfig& base) {
    NetworkConfig config = base;
    TomlSchema schema;
    declare_network(schema, config);
    schema.read_file(path);
    try {
        const drivers::CraneNetwork network(config);
    } catch (const std::invalid_argument& error) {
        throw ConfigError(path.string() + ": " + error.what());
    }
    return config;
}

std::string to_toml(const NetworkConfig& config) {
    NetworkConfig copy = config;
    TomlSchema schema;
    declare_network(schema, copy);
    return schema.write();
}

}  // namespace steadyboom::runtime
