#include "drivers/sdo_abort.hpp"

namespace steadyboom::drivers {

std::string_view text_of(SdoAbort code) noexcept {
    switch (code) {
        case SdoAbort::none:
            return "no error";
        case SdoAbort::toggle_bit:
            return "toggle bit not alternated";
        case SdoAbort::timeout:
            return "timed out";
        case SdoAbort::command_unknown:
            return "command specifier not valid or unknown";
        case SdoAbort::block_size:
            return "invalid block size";
        case SdoAbort::sequence_number:
            return "invalid sequence number";
        case SdoAbort::crc:
            return "CRC error";
        case SdoAbort::out_of_memory:
            return "out of memory";
        case SdoAbort::unsupported_access:
            return "unsupported access to an object";
        case SdoAbort::write_only:
            return "object cannot be read";
        case SdoAbort::read_only:
            return "object cannot be written";
        case SdoAbort::no_such_object:
            return "object does not exist";
        case SdoAbort::not_mappable:
            return "object cannot be mapped to a PDO";
        case SdoAbort::mapping_too_long:
            return "mapped objects exceed the PDO's length";
        case SdoAbort::parameter_incompatible:
            return "parameters are incompatible";
        case SdoAbort::device_incompatible:
            return "incompatible inside the device";
        case SdoAbort::hardware:
            return "access failed, hardware error";
        case SdoAbort::wrong_size:
            return "data type or length does not match";
        case SdoAbort::size_too_long:
            return "data too long for the object";
        case SdoAbort::size_too_short:
            return "data too short for the object";
        case SdoAbort::no_such_subindex:
            return "sub-index does not exist";
        case SdoAbort::value_invalid:
            return "value not allowed";
        case SdoAbort::value_too_high:
            return "value too high";
        case SdoAbort::value_too_low:
            return "value too low";
        case SdoAbort::maximum_below_minimum:
            return "maximum is less than minimum";
        case SdoAbort::resource_not_available:
            return "resource not available";
        case SdoAbort::general:
            return "general error";
        case SdoAbort::cannot_store:
            return "data cannot be stored";
        case SdoAbort::local_control:
            return "data cannot be stored, device is under local control";
        case SdoAbort::device_state:
            return "data cannot be stored in the device's present state";
        case SdoAbort::no_dictionary:
            return "device has no object dictionary";
        case SdoAbort::no_data:
            return "no data available";
    }
    return "unknown abort code";
}

}  // namespace steadyboom::drivers
