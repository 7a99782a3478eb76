#pragma once

#include <array>
#include <cstddef>
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

}  // namespace steadyboom::drivers
