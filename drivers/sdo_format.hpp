#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/can_frame.hpp"

namespace steadyboom::drivers {

inline constexpr std::uint32_t sdo_request_code = 0x600;   ///< + node: from client to server
inline constexpr std::uint32_t sdo_response_code = 0x580;  ///< + node: from server to client

/// An entry of a node's object dictionary.
struct ObjectAddress {
    std::uint16_t index = 0;
    std::uint8_t subindex = 0;
    bool operator==(const ObjectAddress&) const = default;
};

}  // namespace steadyboom::drivers

/// The bytes of an SDO frame, for both its ends: command, index low, index high, sub-index, four of data.
namespace steadyboom::drivers::sdo {

inline constexpr std::uint8_t largest_expedited_bytes = 4;

// Command bytes with no other bit set. Bits 7..5 are the specifier, different for requests and responses.
inline constexpr std::uint8_t download_request = 0x20;
inline constexpr std::uint8_t upload_request = 0x40;
inline constexpr std::uint8_t upload_response = 0x40;
inline constexpr std::uint8_t download_response = 0x60;
inline constexpr std::uint8_t abort_command = 0x80;
inline constexpr std::uint8_t expedited_bit = 0x02;
inline constexpr std::uint8_t size_indicated_bit = 0x01;

[[nodiscard]] constexpr std::uint8_t specifier_of(std::uint8_t command) noexcept {
    return command & 0xE0U;
}

/// `size_bytes` is 1 to 4.
[[nodiscard]] constexpr std::uint8_t expedited(std::uint8_t specifier, std::uint8_t size_bytes) noexcept {
    return static_cast<std::uint8_t>(specifier | ((largest_expedited_bytes - size_bytes) << 2U) | expedited_bit |
                                     size_indicated_bit);
}

/// Of an expedited command; nothing if it does not say.
[[nodiscard]] constexpr std::optional<std::uint8_t> size_of(std::uint8_t command) noexcept {
    if ((command & size_indicated_bit) == 0) {
        return std::nullopt;
    }
    return static_cast<std::uint8_t>(largest_expedited_bytes - ((command >> 2U) & 0x03U));
}

[[nodiscard]] constexpr std::uint32_t low_bytes(std::uint32_t value, std::uint8_t size_bytes) noexcept {
    return size_bytes >= largest_expedited_bytes ? value : value & ((1U << (8U * size_bytes)) - 1U);
}

[[nodiscard]] constexpr CanFrame frame(std::uint32_t id, std::uint8_t command, ObjectAddress object,
                                       std::uint32_t payload, std::int64_t now_ns) noexcept {
    CanFrame frame{.id = id, .length = longest_frame_bytes, .stamp_ns = now_ns};
    frame.data[0] = command;
    frame.data[1] = static_cast<std::uint8_t>(object.index);
    frame.data[2] = static_cast<std::uint8_t>(object.index >> 8U);
    frame.data[3] = object.subindex;
    for (std::size_t i = 0; i < largest_expedited_bytes; ++i) {
        frame.data[4 + i] = static_cast<std::uint8_t>(payload >> (8U * i));
    }
    return frame;
}

/// A whole SDO data frame of some node, to (`sdo_request_code`) or from (`sdo_response_code`) it.
[[nodiscard]] constexpr bool is_sdo(const CanFrame& frame, std::uint32_t code) noexcept {
    return !frame.error && !frame.extended && !frame.remote && frame.length == longest_frame_bytes && frame.id > code &&
           frame.id <= code + 127;
}

[[nodiscard]] constexpr ObjectAddress object_of(const CanFrame& frame) noexcept {
    return {static_cast<std::uint16_t>(frame.data[1] | (frame.data[2] << 8U)), frame.data[3]};
}

[[nodiscard]] constexpr std::uint32_t payload_of(const CanFrame& frame) noexcept {
    std::uint32_t payload = 0;
    for (std::size_t i = 0; i < largest_expedited_bytes; ++i) {
        payload |= static_cast<std::uint32_t>(frame.data[4 + i]) << (8U * i);
    }
    return payload;
}

}  // namespace steadyboom::drivers::sdo
