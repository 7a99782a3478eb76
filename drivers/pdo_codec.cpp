#include "drivers/pdo_codec.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace steadyboom::drivers {
namespace {

struct Layout {
    std::uint8_t size_bytes;
    std::int64_t lowest_raw;
    std::int64_t highest_raw;
    std::int64_t no_value_raw;
};

template <typename T>
constexpr Layout layout_as() noexcept {
    using Limits = std::numeric_limits<T>;
    return {sizeof(T), Limits::min(), Limits::max(), Limits::is_signed ? Limits::min() : Limits::max()};
}

constexpr Layout layout_of(RawType type) noexcept {
    switch (type) {
        case RawType::u16:
            return layout_as<std::uint16_t>();
        case RawType::i16:
            return layout_as<std::int16_t>();
        case RawType::u32:
            return layout_as<std::uint32_t>();
        case RawType::i32:
            return layout_as<std::int32_t>();
        case RawType::bit:
            return {1, 0, 1, 0};
        case RawType::u8:
            break;
    }
    return layout_as<std::uint8_t>();
}

/// Place in the frame of the value's byte `i`, 0 being the least significant.
std::size_t byte_at(const SignalRow& row, std::size_t size_bytes, std::size_t i) noexcept {
    return row.byte_offset + (row.byte_order == ByteOrder::little_endian ? i : size_bytes - 1 - i);
}

}  // namespace

std::int64_t read_raw(const SignalRow& row, const CanFrame& frame) noexcept {
    if (row.type == RawType::bit) {
        return (frame.data[row.byte_offset] >> row.bit) & 1;
    }
    const auto size_bytes = layout_of(row.type).size_bytes;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size_bytes; ++i) {
        bits |= static_cast<std::uint64_t>(frame.data[byte_at(row, size_bytes, i)]) << (8U * i);
    }
    switch (row.type) {
        case RawType::i16:
            return static_cast<std::int16_t>(bits);
        case RawType::i32:
            return static_cast<std::int32_t>(bits);
        default:
            return static_cast<std::int64_t>(bits);
    }
}

void write_raw(const SignalRow& row, std::int64_t raw, CanFrame& frame) noexcept {
    const auto layout = layout_of(row.type);
    const auto bits = static_cast<std::uint64_t>(std::clamp(raw, layout.lowest_raw, layout.highest_raw));
    if (row.type == RawType::bit) {
        const auto mask = static_cast<std::uint8_t>(1U << row.bit);
        auto& byte = frame.data[row.byte_offset];
        byte = static_cast<std::uint8_t>(bits != 0 ? byte | mask : byte & ~mask);
        return;
    }
    for (std::size_t i = 0; i < layout.size_bytes; ++i) {
        frame.data[byte_at(row, layout.size_bytes, i)] = static_cast<std::uint8_t>(bits >> (8U * i));
    }
}

std::optional<double> decode_value(const SignalRow& row, const CanFrame& frame) noexcept {
    const double value_unit = static_cast<double>(read_raw(row, frame)) * row.scale_unit + row.offset_unit;
    const double half_step_unit = 0.5 * std::abs(row.scale_unit);
    if (value_unit < row.lowest_unit - half_step_unit || value_unit > row.highest_unit + half_step_unit) {
        return std::nullopt;
    }
    return value_unit;
}

SampleStatus encode_value(const SignalRow& row, double value_unit, CanFrame& frame) noexcept {
    const auto layout = layout_of(row.type);
    if (std::isnan(value_unit)) {
        write_raw(row, layout.no_value_raw, frame);
        return SampleStatus::overflow;
    }
    const double saturated_raw =
        std::clamp((value_unit - row.offset_unit) / row.scale_unit, static_cast<double>(layout.lowest_raw),
                   static_cast<double>(layout.highest_raw));
    write_raw(row, std::llround(saturated_raw), frame);
    if (value_unit > row.highest_unit) {
        return SampleStatus::overflow;
    }
    return value_unit < row.lowest_unit ? SampleStatus::underflow : SampleStatus::ok;
}

}  // namespace steadyboom::drivers
