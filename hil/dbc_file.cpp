#include "hil/dbc_file.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/message_fields.hpp"

namespace steadyboom::hil {

namespace {

using drivers::Device;
using drivers::DeviceTable;
using drivers::MessageKind;
using drivers::MessageRow;

constexpr std::uint32_t extended_flag = 0x8000'0000U;  // how a DBC file tells a 29-bit identifier

std::uint32_t dbc_id(const MessageRow& row) noexcept {
    return row.extended ? row.id | extended_flag : row.id;
}

Device sender_of(const MessageRow& row) noexcept {
    return row.from_controller ? Device::controller : row.device;
}

std::string receivers_of(const MessageRow& row) {
    if (!row.from_controller) {
        return std::string(name_of(Device::controller));
    }
    if (row.device != Device::controller) {
        return std::string(name_of(row.device));
    }
    std::vector<std::string_view> everyone;
    for (std::size_t i = index_of(Device::controller) + 1; i < drivers::device_count; ++i) {
        everyone.push_back(name_of(static_cast<Device>(i)));
    }
    return fmt::format("{}", fmt::join(everyone, ","));
}

/// Time between two of a cyclic message, in whole milliseconds as the attribute has it; 0 of those sent on demand.
std::int64_t cycle_ms(const DeviceTable& table, const MessageRow& row) {
    switch (row.cycle) {
        case drivers::Cycle::every_tick:
        case drivers::Cycle::on_sync:
            return std::max(1L, std::lround(1.0e-6 * static_cast<double>(table.config().period_ns)));
        case drivers::Cycle::timer:
            return row.interval_ns / 1'000'000;
        case drivers::Cycle::on_demand:
            break;
    }
    return 0;
}

std::string comment_of(const MessageRow& row) {
    switch (row.kind) {
        case MessageKind::nmt:
            return "CiA 301 network management";
        case MessageKind::sync:
            return "CiA 301 SYNC with counter: devices sample on it";
        case MessageKind::heartbeat:
            return "CiA 301 heartbeat and boot-up";
        case MessageKind::emergency:
            return "CiA 301 emergency message";
        case MessageKind::sdo_request:
            return "CiA 301 SDO, client to server";
        case MessageKind::sdo_answer:
            return "CiA 301 SDO, server to client";
        case MessageKind::pdo:
            break;
    }
    if (row.pdo == drivers::Pdo::valve_twin) {
        return fmt::format("{}: {} with every bit inverted", name_of(row.pdo), name_of(drivers::Pdo::valve_command));
    }
    return fmt::format("{}, {}", name_of(row.pdo),
                       row.protection == drivers::Protection::e2e
                           ? fmt::format("protected, data id {:#06x}", row.data_id)
                           : std::string("not protected"));
}

class DbcWriter {
  public:
    explicit DbcWriter(const DeviceTable& table) : table_(table) {
        for (const auto& row : table.messages()) {
            if (row.present) {
                messages_.push_back({&row, fields_of(table, row.message)});
            }
        }
    }

    std::string write() {
        put("VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_:");
        for (std::size_t i = 0; i < drivers::device_count; ++i) {
            put(" {}", name_of(static_cast<Device>(i)));
        }
        put("\n\n");
        for (const auto& message : messages_) {
            put_message(message);
        }
        for (const auto& message : messages_) {
            put_comments(message);
        }
        put("\n");
        put_attributes();
        put("\n");
        for (const auto& message : messages_) {
            put_words(message);
        }
        return std::move(text_);
    }

  private:
    struct DbcMessage {
        const MessageRow* row;
        std::vector<MessageField> fields;
    };

    template <typename... Values>
    void put(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    }

    void put_message(const DbcMessage& message) {
        const auto& row = *message.row;
        put("BO_ {} {}: {} {}\n", dbc_id(row), row.name, row.length_bytes, name_of(sender_of(row)));
        for (const auto& field : message.fields) {
            put(" SG_ {} : {}|{}@{}{} ({},{}) [{}|{}] \"{}\" {}\n", field.name, field.start_bit, field.size_bits,
                field.big_endian ? 0 : 1, field.is_signed ? '-' : '+', field.scale, field.offset, field.lowest,
                field.highest, field.unit, receivers_of(row));
        }
        put("\n");
    }

    void put_comments(const DbcMessage& message) {
        put("CM_ BO_ {} \"{}\";\n", dbc_id(*message.row), comment_of(*message.row));
        for (const auto& field : message.fields) {
            if (!field.comment.empty()) {
                put("CM_ SG_ {} {} \"{}\";\n", dbc_id(*message.row), field.name, field.comment);
            }
        }
    }

    void put_attributes() {
        for (std::size_t i = 0; i < drivers::device_count; ++i) {
            const auto device = static_cast<Device>(i);
            put("CM_ BU_ {} \"node {:#04x}, {}\";\n", name_of(device), table_.node_id(device),
                profile_of(table_.config(), device));
        }
        put("\nBA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\nBA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n");
        for (const auto& message : messages_) {
            if (const auto cycle = cycle_ms(table_, *message.row); cycle > 0) {
                put("BA_ \"GenMsgCycleTime\" BO_ {} {};\n", dbc_id(*message.row), cycle);
            }
        }
    }

    void put_words(const DbcMessage& message) {
        for (const auto& field : message.fields) {
            if (field.words.empty()) {
                continue;
            }
            put("VAL_ {} {}", dbc_id(*message.row), field.name);
            for (const auto& word : field.words) {
                put(" {} \"{}\"", word.raw, word.word);
            }
            put(" ;\n");
        }
    }

    const DeviceTable& table_;
    std::vector<DbcMessage> messages_;
    std::string text_;
};

}  // namespace

std::string dbc_of(const DeviceTable& table) {
    return DbcWriter(table).write();
}

}  // namespace steadyboom::hil
