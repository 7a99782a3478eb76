#include "hil/message_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "drivers/cia408.hpp"
#include "drivers/emcy.hpp"
#include "drivers/protection.hpp"
#include "plant/crane_measurement.hpp"

namespace steadyboom::hil {

namespace {

using drivers::Device;
using drivers::DeviceTable;
using drivers::Message;
using drivers::MessageKind;
using drivers::MessageRow;
using drivers::Signal;

template <typename Enum>
constexpr RawWord word(Enum value, std::string_view text) {
    return {static_cast<std::int64_t>(value), text};
}

constexpr std::array node_states = {
    word(drivers::NodeState::boot_up, "boot_up"),
    word(drivers::NodeState::stopped, "stopped"),
    word(drivers::NodeState::operational, "operational"),
    word(drivers::NodeState::pre_operational, "pre_operational"),
};
constexpr std::array nmt_commands = {
    word(drivers::NmtCommand::start, "start"),
    word(drivers::NmtCommand::stop, "stop"),
    word(drivers::NmtCommand::enter_pre_operational, "enter_pre_operational"),
    word(drivers::NmtCommand::reset_node, "reset_node"),
    word(drivers::NmtCommand::reset_communication, "reset_communication"),
};
constexpr std::array sample_states = {
    word(drivers::SampleStatus::ok, "ok"),
    word(drivers::SampleStatus::overflow, "overflow"),
    word(drivers::SampleStatus::underflow, "underflow"),
};
constexpr std::array valve_states = {
    word(plant::ValveState::not_ready, "not_ready"),
    word(plant::ValveState::init, "init"),
    word(plant::ValveState::disabled, "disabled"),
    word(plant::ValveState::hold, "hold"),
    word(plant::ValveState::active, "active"),
    word(plant::ValveState::fault_hold, "fault_hold"),
    word(plant::ValveState::fault_reaction, "fault_reaction"),
    word(plant::ValveState::fault_disabled, "fault_disabled"),
};
// Bits D, H and M of the control word; R, whose rising edge resets faults, is a field of its own.
constexpr std::array valve_modes = {
    RawWord{drivers::control_disabled, "disabled"},
    RawWord{drivers::control_disabled | drivers::control_hold, "hold"},
    RawWord{drivers::control_disabled | drivers::control_hold | drivers::control_active, "active"},
};
constexpr std::array no_yes = {RawWord{0, "no"}, RawWord{1, "yes"}};
constexpr std::array port_commands = {RawWord{0, "block"}, RawWord{1, "extend"}, RawWord{2, "retract"},
                                      RawWord{3, "float"}};
constexpr std::array port_states = {RawWord{0, "blocked"},  RawWord{1, "extend"}, RawWord{2, "retract"},
                                    RawWord{3, "floating"}, RawWord{14, "error"}, RawWord{15, "not_available"}};
constexpr std::array qualities = {RawWord{0, "good"}};
constexpr std::array all_nodes = {RawWord{0, "all"}};

/// Part of a CiA 408 word that is a field of its own.
struct WordPart {
    std::string_view name;
    unsigned shift_bits;
    unsigned size_bits;
    std::span<const RawWord> words;
};
constexpr std::array status_parts = {
    WordPart{"valve_state", 0, 4, valve_states},
    WordPart{"pressure_control_effective", 8, 1, no_yes},
    WordPart{"ramp_running", 9, 1, no_yes},
    WordPart{"limit_touched", 10, 1, no_yes},
    WordPart{"control_deviation_exceeded", 11, 1, no_yes},
};
constexpr std::array control_parts = {WordPart{"valve_mode", 0, 3, valve_modes}, WordPart{"valve_reset", 3, 1, no_yes}};

std::span<const WordPart> parts_of(Signal signal) noexcept {
    switch (signal) {
        case Signal::valve_status_word:
            return status_parts;
        case Signal::valve_control_word:
            return control_parts;
        default:
            return {};
    }
}

std::span<const RawWord> words_of(Signal signal) noexcept {
    switch (signal) {
        case Signal::strain_lower_status:
        case Signal::strain_upper_status:
        case Signal::line_tension_status:
            return sample_states;
        case Signal::cutoff_open:
        case Signal::emergency_stop_healthy:
        case Signal::cutoff_energised:
            return no_yes;
        default:
            return {};
    }
}

double largest_raw(unsigned size_bits) noexcept {
    return std::ldexp(1.0, static_cast<int>(size_bits)) - 1.0;
}

MessageField plain_field(std::string name, unsigned start_bit, unsigned size_bits, std::span<const RawWord> words = {},
                         std::string comment = {}) {
    return {.name = std::move(name),
            .start_bit = start_bit,
            .size_bits = size_bits,
            .highest = largest_raw(size_bits),
            .words = words,
            .comment = std::move(comment)};
}

bool is_signed(drivers::RawType type) noexcept {
    return type == drivers::RawType::i16 || type == drivers::RawType::i32;
}

void append_signal(const DeviceTable& table, Signal signal, std::vector<MessageField>& fields) {
    const auto& config = table.config()[signal];
    const unsigned size_bits = drivers::size_bits(config.type);
    const bool big_endian = config.byte_order == drivers::ByteOrder::big_endian && size_bits > 8;
    const std::string object = fmt::format("object {:04X}h:{:02X}", config.object, config.subindex);
    for (const auto& part : parts_of(signal)) {
        // Each part lies within one byte, where both byte orders count alike.
        const unsigned byte = big_endian ? size_bits / 8U - 1U - part.shift_bits / 8U : part.shift_bits / 8U;
        auto field = plain_field(std::string(part.name), 8U * (config.byte_offset + byte) + part.shift_bits % 8U,
                                 part.size_bits, part.words, object);
        field.signal = signal;
        field.shift_bits = part.shift_bits;
        fields.push_back(std::move(field));
    }
    if (parts_of(signal).empty()) {
        fields.push_back({.name = std::string(name_of(signal)),
                          .start_bit = 8U * config.byte_offset + config.bit + (big_endian ? 7U : 0U),
                          .size_bits = size_bits,
                          .big_endian = big_endian,
                          .is_signed = is_signed(config.type),
                          .scale = config.scale,
                          .offset = config.offset,
                          .lowest = config.lowest,
                          .highest = config.highest,
                          .unit = name_of(config.unit),
                          .words = words_of(signal),
                          .comment = object,
                          .signal = signal});
    }
}

void append_protection(const MessageRow& row, std::vector<MessageField>& fields) {
    const unsigned counter_bit = 8U * (row.length_bytes - drivers::protection_bytes);
    auto counter = plain_field("COUNTER", counter_bit, 4, {}, "SYNC counter mod 15; 15 is reserved");
    counter.highest = drivers::protection_counters - 1;
    fields.push_back(std::move(counter));
    fields.push_back(plain_field("QUALITY", counter_bit + 4U, 4, qualities, "sender's own opinion of its data"));
    fields.push_back(plain_field(
        "CHECKSUM", counter_bit + 8U, 8, {},
        fmt::format("CRC-8 0x2F over the data id's bytes {:02X} {:02X} (low byte first) and all bytes before",
                    row.data_id & 0xFFU, row.data_id >> 8U)));
}

/// The same values from a frame with all bits inverted: ~raw is -1 - raw, or the largest - raw if unsigned.
void invert(MessageField& field) {
    const double inverted_zero = field.is_signed ? -1.0 : largest_raw(field.size_bits);
    field.offset += inverted_zero * field.scale;
    field.scale = -field.scale;
    field.name += "_inverted";
    field.words = {};
    field.comment += (field.comment.empty() ? "" : ", ") + std::string("every bit inverted");
    field.signal = Signal::none;
}

/// What an auxiliary valve's messages carry beside the flow (docs/j1939-valve.md).
void append_port(const MessageRow& row, std::vector<MessageField>& fields) {
    if (row.pdo == drivers::Pdo::valve_command) {
        fields.push_back(plain_field("port_command", 16, 4, port_commands, "its direction; the set-point has no sign"));
    } else if (row.pdo == drivers::Pdo::valve_status) {
        fields.push_back(plain_field("port_state", 16, 4, port_states));
    }
}

std::vector<MessageField> pdo_fields(const DeviceTable& table, const MessageRow& row) {
    const bool twin = row.pdo == drivers::Pdo::valve_twin;
    const MessageRow& plain = twin ? table.row(drivers::Pdo::valve_command) : row;
    std::vector<MessageField> fields;
    for (const auto& signal : table.signals()) {
        if (signal.present && signal.message == plain.message) {
            append_signal(table, signal.signal, fields);
        }
    }
    if (table.config()[row.device].profile == drivers::ValveProfile::j1939) {
        append_port(row, fields);
    }
    if (plain.protection == drivers::Protection::e2e) {
        append_protection(plain, fields);
    }
    if (twin) {
        std::ranges::for_each(fields, invert);
    }
    return fields;
}

/// The codes that have a text of their own, each class once.
std::span<const RawWord> emergency_words() {
    constexpr unsigned no_such_code = 0x0F00;
    static const std::vector<RawWord> words = [] {
        std::vector<RawWord> list;
        for (unsigned code = 0; code <= 0xFFFFU; ++code) {
            const auto text_of = [](unsigned other) {
                return drivers::emergency_text(static_cast<std::uint16_t>(other));
            };
            const auto text = text_of(code);
            const unsigned class_code = code & 0xFF00U;
            const unsigned group_code = code & 0xF000U;
            const bool opens_group = code == group_code;
            const bool opens_class = code == class_code && text != text_of(group_code);
            const bool known = text != text_of(no_such_code);
            if (known && (opens_group || opens_class || text != text_of(class_code))) {
                list.push_back({code, text});
            }
        }
        return list;
    }();
    return words;
}

}  // namespace

std::string_view word_for(std::span<const RawWord> words, std::int64_t raw) noexcept {
    const auto found = std::ranges::find(words, raw, &RawWord::raw);
    return found == words.end() ? std::string_view() : found->word;
}

std::span<const RawWord> node_state_words() noexcept {
    return node_states;
}

std::vector<MessageField> fields_of(const DeviceTable& table, Message message) {
    const auto& row = table.row(message);
    switch (row.kind) {
        case MessageKind::nmt:
            return {plain_field("nmt_command", 0, 8, nmt_commands), plain_field("nmt_node", 8, 8, all_nodes)};
        case MessageKind::sync: {
            auto counter = plain_field("sync_counter", 0, 8, {}, "object 1019h");
            counter.lowest = 1.0;
            counter.highest = drivers::sync_counter_last;
            return {counter};
        }
        case MessageKind::heartbeat:
            return {plain_field("nmt_state", 0, 8, node_states)};
        case MessageKind::emergency:
            return {plain_field("emergency_code", 0, 16, emergency_words()),
                    plain_field("error_register", 16, 8, {}, "object 1001h"), plain_field("vendor_bytes", 24, 40)};
        case MessageKind::sdo_request:
        case MessageKind::sdo_answer:
            return {plain_field("sdo_command", 0, 8), plain_field("sdo_index", 8, 16),
                    plain_field("sdo_subindex", 24, 8), plain_field("sdo_data", 32, 32)};
        case MessageKind::pdo:
            break;
    }
    return pdo_fields(table, row);
}

std::string_view profile_of(const drivers::NetworkConfig& config, Device device) noexcept {
    switch (device) {
        case Device::controller:
            return "CiA 301";
        case Device::strain_link:
        case Device::load_pin:
            return "CiA 404";
        case Device::boom_inclinometer:
        case Device::hook_inclinometer:
            return "CiA 410";
        case Device::drum_encoder:
            return "CiA 406";
        case Device::servo_valve:
            return config[device].profile == drivers::ValveProfile::j1939 ? "ISO 11783-7" : "CiA 408";
        case Device::safety_io:
            return "CiA 401";
    }
    return "";
}

}  // namespace steadyboom::hil
