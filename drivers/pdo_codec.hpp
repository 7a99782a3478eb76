#pragma once

#include <cstdint>
#include <optional>

#include "drivers/can_frame.hpp"
#include "drivers/device_table.hpp"

namespace steadyboom::drivers {

/// The signal's bits in `frame`, sign-extended. The frame must be of the signal's message and length.
[[nodiscard]] std::int64_t read_raw(const SignalRow& row, const CanFrame& frame) noexcept;

/// Puts `raw` there, saturated to the signal's type.
void write_raw(const SignalRow& row, std::int64_t raw, CanFrame& frame) noexcept;

/// The signal's value in `row.unit`; nothing if it is outside the row's limits (a half step is granted to rounding), as
/// the codes that devices use for "no value" (0x8000, 0x7FFFFFFF, 0xFFFF, ...) all are.
[[nodiscard]] std::optional<double> decode_value(const SignalRow& row, const CanFrame& frame) noexcept;

/// Rounds `value_unit` to the nearest raw step and writes it, saturated to the type. Returns overflow or underflow when
/// the value is beyond the row's limits. Not a number becomes the type's "no value" code and overflow.
SampleStatus encode_value(const SignalRow& row, double value_unit, CanFrame& frame) noexcept;

}  // namespace steadyboom::drivers
