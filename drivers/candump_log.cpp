#include "drivers/candump_log.hpp"

#include <algorithm>
#include <cstdint>

namespace steadyboom::drivers {
namespace {

constexpr std::string_view digits = "0123456789ABCDEF";
constexpr std::uint32_t error_flag = 0x2000'0000U;  // CAN_ERR_FLAG of linux/can.h, part of the printed identifier

class Writer {
  public:
    explicit Writer(CandumpLine& line) : line_(line) {}
    void put(char character) noexcept { line_.text[line_.length++] = character; }
    void put(std::string_view text) noexcept {
        for (const char character : text) {
            put(character);
        }
    }
    void put_number(std::uint64_t value, std::uint64_t base, std::size_t width) noexcept {
        for (std::size_t i = width; i > 0; --i) {
            line_.text[line_.length + i - 1] = digits[value % base];
            value /= base;
        }
        line_.length += width;
    }

  private:
    CandumpLine& line_;
};

}  // namespace

CandumpLine candump_line(const CanFrame& frame, std::string_view interface) noexcept {
    CandumpLine line;
    Writer out(line);
    const auto stamp_us = static_cast<std::uint64_t>(std::max<std::int64_t>(frame.stamp_ns, 0)) / 1000U;
    out.put('(');
    out.put_number(stamp_us / 1'000'000U, 10, 10);
    out.put('.');
    out.put_number(stamp_us % 1'000'000U, 10, 6);
    out.put(") ");
    out.put(interface.substr(0, 15));
    out.put(' ');
    if (frame.error) {
        out.put_number(frame.id | error_flag, 16, 8);
    } else {
        out.put_number(frame.id, 16, frame.extended ? 8 : 3);
    }
    out.put('#');
    const auto length = std::min(frame.length, longest_frame_bytes);
    if (frame.remote) {
        out.put('R');
        if (length > 0) {
            out.put(static_cast<char>('0' + length));
        }
    } else {
        for (std::size_t i = 0; i < length; ++i) {
            out.put_number(frame.data[i], 16, 2);
        }
    }
    return line;
}

}  // namespace steadyboom::drivers
