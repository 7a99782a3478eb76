#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/can_frame.hpp"

namespace steadyboom::drivers {

inline constexpr std::uint32_t emergency_code = 0x080;  ///< + node: identifier of its EMCY message

/// Bits of object 1001h, the error register.
enum ErrorRegister : std::uint8_t {
    error_generic = 1U << 0,
    error_current = 1U << 1,
    error_voltage = 1U << 2,
    error_temperature = 1U << 3,
    error_communication = 1U << 4,
    error_device_profile = 1U << 5,
    error_manufacturer = 1U << 7,
};

/// What a node says is wrong with it (CiA 301 EMCY). Code 0x00xx: an error is over, or all are when the register is 0.
struct Emergency {
    std::uint8_t node = 0;
    std::uint16_t code = 0;
    std::uint8_t error_register = 0;
    std::array<std::uint8_t, 5> vendor{};
    bool operator==(const Emergency&) const = default;

    [[nodiscard]] bool is_reset() const noexcept { return code < 0x0100; }
};

// The codes that this product itself sends.
inline constexpr std::uint16_t emergency_none = 0x0000;
inline constexpr std::uint16_t emergency_can_overrun = 0x8110;
inline constexpr std::uint16_t emergency_error_passive = 0x8120;
inline constexpr std::uint16_t emergency_heartbeat = 0x8130;
inline constexpr std::uint16_t emergency_bus_off_recovered = 0x8140;
inline constexpr std::uint16_t emergency_pdo_length = 0x8210;
inline constexpr std::uint16_t emergency_sync_length = 0x8240;
inline constexpr std::uint16_t emergency_rpdo_timeout = 0x8250;

[[nodiscard]] CanFrame emergency_frame(const Emergency& emergency, std::int64_t now_ns) noexcept;

/// Nothing if the frame is no EMCY message of a node 1 to 127.
[[nodiscard]] std::optional<Emergency> decode_emergency(const CanFrame& frame) noexcept;

/// The code in words: its own name, or else that of its class. Never empty.
[[nodiscard]] std::string_view emergency_text(std::uint16_t code) noexcept;

/// Name of one bit of the error register, 0 to 7.
[[nodiscard]] std::string_view error_register_text(unsigned bit) noexcept;

}  // namespace steadyboom::drivers
