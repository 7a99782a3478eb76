#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/device_table.hpp"

namespace steadyboom::hil {

/// What one raw number means.
struct RawWord {
    std::int64_t raw = 0;
    std::string_view word;
};

/// The word for `raw`, or nothing.
[[nodiscard]] std::string_view word_for(std::span<const RawWord> words, std::int64_t raw) noexcept;

[[nodiscard]] std::span<const RawWord> node_state_words() noexcept;

/// One field of a message as tools see it: the table's signals in the unit of the network file, CiA 408's words taken
/// apart, counter and checksum of a protected frame, and what the messages of network management carry.
struct MessageField {
    std::string name;
    unsigned start_bit = 0;  ///< byte * 8 + bit, of the least significant bit; if big_endian of the most significant
    unsigned size_bits = 0;
    bool big_endian = false;
    bool is_signed = false;
    double scale = 1.0;  ///< value = raw * scale + offset
    double offset = 0.0;
    double lowest = 0.0;  ///< of the value
    double highest = 0.0;
    std::string_view unit = {};
    std::span<const RawWord> words = {};
    std::string comment = {};
    drivers::Signal signal = drivers::Signal::none;  ///< that it is, or is a part of
    unsigned shift_bits = 0;                         ///< place in that signal's raw value
};

/// Fields of a message, in the order of their bytes.
[[nodiscard]] std::vector<MessageField> fields_of(const drivers::DeviceTable& table, drivers::Message message);

/// "CiA 404", the profile of a device.
[[nodiscard]] std::string_view profile_of(const drivers::NetworkConfig& config, drivers::Device device) noexcept;

}  // namespace steadyboom::hil
