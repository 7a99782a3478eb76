#include "drivers/emcy.hpp"

#include <algorithm>

namespace steadyboom::drivers {
namespace {

struct CodeName {
    std::uint16_t code;
    std::string_view text;
};

constexpr std::array named_codes = {
    CodeName{0x8110, "CAN overrun, messages lost"},
    CodeName{0x8120, "CAN error passive"},
    CodeName{0x8130, "life guard or heartbeat missed"},
    CodeName{0x8140, "recovered from bus-off"},
    CodeName{0x8150, "CAN identifier collision"},
    CodeName{0x8210, "PDO not processed, wrong length"},
    CodeName{0x8220, "PDO length exceeded"},
    CodeName{0x8230, "multiplexed PDO not processed, no such object"},
    CodeName{0x8240, "SYNC has an unexpected length"},
    CodeName{0x8250, "RPDO timeout"},
};

/// By the code's high byte.
constexpr std::array code_classes = {
    CodeName{0x00, "no error, or error reset"},
    CodeName{0x10, "generic error"},
    CodeName{0x20, "current"},
    CodeName{0x21, "current, device input side"},
    CodeName{0x22, "current inside the device"},
    CodeName{0x23, "current, device output side"},
    CodeName{0x30, "voltage"},
    CodeName{0x31, "mains voltage"},
    CodeName{0x32, "voltage inside the device"},
    CodeName{0x33, "output voltage"},
    CodeName{0x40, "temperature"},
    CodeName{0x41, "ambient temperature"},
    CodeName{0x42, "device temperature"},
    CodeName{0x50, "device hardware"},
    CodeName{0x60, "device software"},
    CodeName{0x61, "internal software"},
    CodeName{0x62, "user software"},
    CodeName{0x63, "data set"},
    CodeName{0x70, "additional modules"},
    CodeName{0x80, "monitoring"},
    CodeName{0x81, "communication"},
    CodeName{0x82, "protocol error"},
    CodeName{0x90, "external error"},
    CodeName{0xF0, "additional functions"},
    CodeName{0xFF, "device specific"},
};

template <typename Names>
const CodeName* find(const Names& names, unsigned code) noexcept {
    const auto found = std::ranges::find(names, code, &CodeName::code);
    return found == names.end() ? nullptr : &*found;
}

}  // namespace

CanFrame emergency_frame(const Emergency& emergency, std::int64_t now_ns) noexcept {
    CanFrame frame{.id = emergency_code + emergency.node, .length = longest_frame_bytes, .stamp_ns = now_ns};
    frame.data[0] = static_cast<std::uint8_t>(emergency.code);
    frame.data[1] = static_cast<std::uint8_t>(emergency.code >> 8U);
    frame.data[2] = emergency.error_register;
    std::ranges::copy(emergency.vendor, frame.data.begin() + 3);
    return frame;
}

std::optional<Emergency> decode_emergency(const CanFrame& frame) noexcept {
    if (frame.error || frame.extended || frame.remote || frame.length != longest_frame_bytes ||
        frame.id <= emergency_code || frame.id > emergency_code + 127) {
        return std::nullopt;
    }
    Emergency emergency{
        .node = static_cast<std::uint8_t>(frame.id - emergency_code),
        .code = static_cast<std::uint16_t>(frame.data[0] | (frame.data[1] << 8U)),
        .error_register = frame.data[2],
    };
    std::copy(frame.data.begin() + 3, frame.data.end(), emergency.vendor.begin());
    return emergency;
}

std::string_view emergency_text(std::uint16_t code) noexcept {
    if (const auto* named = find(named_codes, code)) {
        return named->text;
    }
    if (const auto* class_ = find(code_classes, code >> 8U)) {
        return class_->text;
    }
    // A code between the classes is of the group that its first digit opens.
    if (const auto* group = find(code_classes, (code >> 8U) & 0xF0U); group != nullptr && code >= 0x1000) {
        return group->text;
    }
    return "unknown error";
}

std::string_view error_register_text(unsigned bit) noexcept {
    constexpr std::array<std::string_view, 8> texts = {
        "generic", "current", "voltage", "temperature", "communication", "device profile", "reserved", "manufacturer",
    };
    return bit < texts.size() ? texts[bit] : "none";
}

}  // namespace steadyboom::drivers
