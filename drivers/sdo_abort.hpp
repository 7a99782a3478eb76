#pragma once

#include <cstdint>
#include <string_view>

namespace steadyboom::drivers {

/// Why an SDO transfer ended without success (CiA 301). Devices may send others; a code is just a number.
enum class SdoAbort : std::uint32_t {
    none = 0,
    toggle_bit = 0x0503'0000,
    timeout = 0x0504'0000,
    command_unknown = 0x0504'0001,
    block_size = 0x0504'0002,
    sequence_number = 0x0504'0003,
    crc = 0x0504'0004,
    out_of_memory = 0x0504'0005,
    unsupported_access = 0x0601'0000,
    write_only = 0x0601'0001,
    read_only = 0x0601'0002,
    no_such_object = 0x0602'0000,
    not_mappable = 0x0604'0041,
    mapping_too_long = 0x0604'0042,
    parameter_incompatible = 0x0604'0043,
    device_incompatible = 0x0604'0047,
    hardware = 0x0606'0000,
    wrong_size = 0x0607'0010,
    size_too_long = 0x0607'0012,
    size_too_short = 0x0607'0013,
    no_such_subindex = 0x0609'0011,
    value_invalid = 0x0609'0030,
    value_too_high = 0x0609'0031,
    value_too_low = 0x0609'0032,
    maximum_below_minimum = 0x0609'0036,
    resource_not_available = 0x060A'0023,
    general = 0x0800'0000,
    cannot_store = 0x0800'0020,
    local_control = 0x0800'0021,
    device_state = 0x0800'0022,
    no_dictionary = 0x0800'0023,
    no_data = 0x0800'0024,
};

/// In words; "unknown abort code" for a code that CiA 301 does not have.
[[nodiscard]] std::string_view text_of(SdoAbort code) noexcept;

}  // namespace steadyboom::drivers
