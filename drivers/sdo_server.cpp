#include "drivers/sdo_server.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace steadyboom::drivers {
namespace {

void check(std::span<const ObjectEntry> dictionary) {
    for (auto entry = dictionary.begin(); entry != dictionary.end(); ++entry) {
        const auto refuse = [&](const std::string& why) {
            std::array<char, 16> name{};
            std::snprintf(name.data(), name.size(), "%04Xh:%02X", entry->object.index, entry->object.subindex);
            throw std::invalid_argument("object " + std::string(name.data()) + ": " + why);
        };
        if (entry->size_bytes < 1 || entry->size_bytes > sdo::largest_expedited_bytes) {
            refuse("size_bytes = " + std::to_string(entry->size_bytes) + ": allowed is 1 to 4");
        }
        const auto largest = sdo::low_bytes(0xFFFF'FFFFU, entry->size_bytes);
        if (entry->value_raw > largest || entry->lowest_raw > largest) {
            refuse("a value does not fit into " + std::to_string(entry->size_bytes) + " bytes");
        }
        if (entry->lowest_raw > entry->highest_raw) {
            refuse("lowest_raw is above highest_raw");
        }
        if (std::any_of(dictionary.begin(), entry, [&](const auto& other) { return other.object == entry->object; })) {
            refuse("it is there twice");
        }
    }
}

}  // namespace

SdoServer::SdoServer(std::uint8_t node, std::span<ObjectEntry> dictionary) : node_(node), dictionary_(dictionary) {
    check(dictionary);
}

std::optional<CanFrame> SdoServer::answer(const CanFrame& frame, std::int64_t now_ns) noexcept {
    const std::uint8_t command = frame.data[0];
    const auto specifier = sdo::specifier_of(command);
    if (!sdo::is_sdo(frame, sdo_request_code) || frame.id != sdo_request_code + node_ ||
        specifier == sdo::abort_command) {
        return std::nullopt;
    }
    const auto object = sdo::object_of(frame);
    const auto id = sdo_response_code + node_;
    auto abort = SdoAbort::command_unknown;
    const bool expedited_write = specifier == sdo::download_request && (command & sdo::expedited_bit) != 0;
    if (expedited_write || specifier == sdo::upload_request) {
        const auto [entry, missing] = find(object);
        if (entry == nullptr) {
            abort = missing;
        } else if (expedited_write) {
            abort = write(*entry, frame);
            if (abort == SdoAbort::none) {
                ++status_.writes;
                return sdo::frame(id, sdo::download_response, object, 0, now_ns);
            }
        } else if (entry->access == ObjectAccess::write_only) {
            abort = SdoAbort::write_only;
        } else {
            ++status_.reads;
            return sdo::frame(id, sdo::expedited(sdo::upload_response, entry->size_bytes), object, entry->value_raw,
                              now_ns);
        }
    }
    ++status_.aborts;
    return sdo::frame(id, sdo::abort_command, object, static_cast<std::uint32_t>(abort), now_ns);
}

SdoServer::Found SdoServer::find(ObjectAddress object) noexcept {
    auto missing = SdoAbort::no_such_object;
    for (auto& entry : dictionary_) {
        if (entry.object == object) {
            return {&entry, SdoAbort::none};
        }
        if (entry.object.index == object.index) {
            missing = SdoAbort::no_such_subindex;
        }
    }
    return {nullptr, missing};
}

SdoAbort SdoServer::write(ObjectEntry& entry, const CanFrame& frame) noexcept {
    if (entry.access == ObjectAccess::read_only) {
        return SdoAbort::read_only;
    }
    const auto size_bytes = sdo::size_of(frame.data[0]).value_or(entry.size_bytes);
    if (size_bytes != entry.size_bytes) {
        return size_bytes > entry.size_bytes ? SdoAbort::size_too_long : SdoAbort::size_too_short;
    }
    const auto value_raw = sdo::low_bytes(sdo::payload_of(frame), size_bytes);
    if (value_raw > entry.highest_raw) {
        return SdoAbort::value_too_high;
    }
    if (value_raw < entry.lowest_raw) {
        return SdoAbort::value_too_low;
    }
    entry.value_raw = value_raw;
    return SdoAbort::none;
}

}  // namespace steadyboom::drivers
