#pragma once

#include <array>
#include <cstdint>

namespace steadyboom::drivers {

/// One classic CAN 2.0 frame (ISO 11898-1), or an error message of the interface.
struct CanFrame {
    std::uint32_t id = 0;                ///< 11 or 29 bits; for an error message the error class (linux/can/error.h)
    std::uint8_t length = 0;             ///< data bytes, 0 to 8
    std::array<std::uint8_t, 8> data{};  ///< only the first `length` bytes mean anything
    bool extended = false;               ///< 29-bit identifier
    bool remote = false;                 ///< remote transmission request
    bool error = false;                  ///< not a frame on the bus: the interface reports an error
    std::int64_t stamp_ns = 0;           ///< steady time of receipt; on frames to be sent, steady time of encoding
};

inline constexpr std::uint32_t standard_id_count = 2048;  ///< 11-bit identifiers
inline constexpr std::uint8_t longest_frame_bytes = 8;

}  // namespace steadyboom::drivers
