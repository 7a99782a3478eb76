#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "drivers/can_frame.hpp"

namespace steadyboom::drivers {

/// One line of text without a line end, in a buffer of its own.
struct CandumpLine {
    std::array<char, 80> text{};
    std::size_t length = 0;
    [[nodiscard]] std::string_view view() const noexcept { return {text.data(), length}; }
};

/// The frame as `candump -L` of can-utils writes it: "(1436509052.249713) vcan0 044#2A366C2BBA". Its stamp is cut to
/// microseconds, a stamp below zero reads as zero, an interface name is cut to 15 characters. Allocates nothing.
[[nodiscard]] CandumpLine candump_line(const CanFrame& frame, std::string_view interface) noexcept;

/// What a line of a log holds.
enum class CandumpKind : std::uint8_t {
    frame,      ///< a classic frame or an error message
    fd_frame,   ///< a CAN FD frame ("123##0..."): whole, but none of ours
    malformed,  ///< anything else
};

struct CandumpEntry {
    CandumpKind kind = CandumpKind::malformed;
    CanFrame frame = {};              ///< of an fd_frame only identifier and stamp
    std::string_view interface = {};  ///< part of the line that was read
    std::string_view problem = {};    ///< what is wrong with a malformed line
    std::size_t column = 0;           ///< where, counted from 1
};

/// Reads a line of `candump -L` without its line end; spaces before the interface's name are what candump aligns names
/// with. The stamp is the log's, to the microsecond. Reads back all that candump_line() writes. Allocates nothing.
[[nodiscard]] CandumpEntry read_candump_line(std::string_view line) noexcept;

}  // namespace steadyboom::drivers
