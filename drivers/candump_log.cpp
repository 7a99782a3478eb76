#include "drivers/candump_log.hpp"

#include <algorithm>
#include <cstdint>

namespace steadyboom::drivers {
namespace {

constexpr std::string_view digits = "0123456789ABCDEF";
constexpr std::uint32_t error_flag = 0x2000'0000U;  // CAN_ERR_FLAG of linux/can.h, part of the printed identifier
constexpr std::uint32_t largest_extended_id = 0x1FFF'FFFFU;
constexpr std::size_t longest_interface_name = 15;
constexpr std::size_t longest_fd_frame_bytes = 64;

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

/// Takes a line apart from the left. The first complaint stays.
class Reader {
  public:
    explicit Reader(std::string_view line) : line_(line) {}

    [[nodiscard]] bool good() const noexcept { return problem_.empty(); }
    [[nodiscard]] bool at_end() const noexcept { return at_ == line_.size(); }
    [[nodiscard]] std::size_t column() const noexcept { return at_ + 1; }
    [[nodiscard]] std::size_t problem_column() const noexcept { return problem_column_; }
    [[nodiscard]] std::string_view problem() const noexcept { return problem_; }

    void complain(std::string_view problem, std::size_t column) noexcept {
        if (good()) {
            problem_ = problem;
            problem_column_ = column;
        }
    }
    bool take(char character) noexcept {
        const bool there = !at_end() && line_[at_] == character;
        at_ += there ? 1U : 0U;
        return there;
    }
    void demand(char character, std::string_view problem) noexcept {
        if (!take(character)) {
            complain(problem, column());
        }
    }
    [[nodiscard]] std::string_view take_word() noexcept {
        const auto begin = at_;
        while (!at_end() && line_[at_] != ' ') {
            ++at_;
        }
        return line_.substr(begin, at_ - begin);
    }
    /// Value of the next digit of `base`, or -1 and nothing is taken.
    int take_digit(int base) noexcept {
        if (at_end()) {
            return -1;
        }
        const char character = line_[at_];
        const int value = character >= '0' && character <= '9'   ? character - '0'
                          : character >= 'A' && character <= 'F' ? character - 'A' + 10
                          : character >= 'a' && character <= 'f' ? character - 'a' + 10
                                                                 : -1;
        if (value < 0 || value >= base) {
            return -1;
        }
        ++at_;
        return value;
    }

  private:
    std::string_view line_;
    std::size_t at_ = 0;
    std::string_view problem_;
    std::size_t problem_column_ = 0;
};

std::int64_t read_stamp(Reader& in) noexcept {
    constexpr std::int64_t largest_s = INT64_MAX / 1'000'000'000 - 1;
    in.demand('(', "no '(' before the stamp");
    const auto column = in.column();
    std::int64_t seconds = 0;
    int digit_count = 0;
    for (int digit = 0; (digit = in.take_digit(10)) >= 0; ++digit_count) {
        seconds = std::min(10 * seconds + digit, largest_s + 1);
    }
    if (digit_count == 0) {
        in.complain("no seconds in the stamp", column);
    } else if (seconds > largest_s) {
        in.complain("the stamp is beyond what 64 bits of nanoseconds hold", column);
    }
    in.demand('.', "no '.' in the stamp");
    std::int64_t microseconds = 0;
    for (int i = 0; i < 6; ++i) {
        const int digit = in.take_digit(10);
        if (digit < 0) {
            in.complain("the stamp has not six decimals", in.column());
            break;
        }
        microseconds = 10 * microseconds + digit;
    }
    in.demand(')', "no ')' after the stamp's sixth decimal");
    return in.good() ? seconds * 1'000'000'000 + microseconds * 1'000 : 0;
}

std::string_view read_interface(Reader& in) noexcept {
    in.demand(' ', "no space after the stamp");
    while (in.take(' ')) {
    }
    const auto column = in.column();
    const auto name = in.take_word();
    if (name.empty()) {
        in.complain("no interface", column);
    } else if (name.size() > longest_interface_name) {
        in.complain("an interface's name has at most 15 characters", column);
    }
    in.demand(' ', "no frame after the interface");
    return name;
}

void read_identifier(Reader& in, CanFrame& frame) noexcept {
    const auto column = in.column();
    std::uint32_t id = 0;
    int digit_count = 0;
    for (int digit = 0; digit_count < 8 && (digit = in.take_digit(16)) >= 0; ++digit_count) {
        id = 16U * id + static_cast<std::uint32_t>(digit);
    }
    if (digit_count != 3 && digit_count != 8) {
        in.complain("an identifier has 3 or 8 hexadecimal digits", column);
    }
    in.demand('#', "no '#' after the identifier");
    frame.error = digit_count == 8 && (id & ~largest_extended_id) == error_flag;
    frame.extended = digit_count == 8 && !frame.error;
    frame.id = frame.error ? id & largest_extended_id : id;
    if (frame.id > (digit_count == 8 ? largest_extended_id : standard_id_count - 1U)) {
        in.complain("the identifier is beyond its 11 or 29 bits", column);
    }
}

/// Reads byte after byte into `into`, which may be shorter than `most_bytes`, and returns how many there were.
std::size_t read_bytes(Reader& in, std::size_t most_bytes, std::array<std::uint8_t, 8>* into) noexcept {
    std::size_t count = 0;
    while (in.good() && !in.at_end()) {
        const auto column = in.column();
        const int high = in.take_digit(16);
        const int low = high < 0 ? -1 : in.take_digit(16);
        if (low < 0) {
            in.complain(high < 0 ? "not a hexadecimal digit" : "half a byte", high < 0 ? column : in.column());
        } else if (count == most_bytes) {
            in.complain("more bytes than a frame has", column);
        } else {
            if (into != nullptr) {
                (*into)[count] = static_cast<std::uint8_t>(16 * high + low);
            }
            ++count;
        }
    }
    return count;
}

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
    out.put(interface.substr(0, longest_interface_name));
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

CandumpEntry read_candump_line(std::string_view line) noexcept {
    Reader in(line);
    CandumpEntry entry;
    auto& frame = entry.frame;
    frame.stamp_ns = read_stamp(in);
    entry.interface = read_interface(in);
    read_identifier(in, frame);
    const bool fd = in.good() && in.take('#');
    if (fd) {
        if (in.take_digit(16) < 0) {
            in.complain("no flags after '##'", in.column());
        }
        read_bytes(in, longest_fd_frame_bytes, nullptr);
    } else if (in.good() && in.take('R')) {
        frame.remote = true;
        const auto column = in.column();
        const int length = in.take_digit(10);
        if (length > longest_frame_bytes) {
            in.complain("a frame has at most 8 bytes", column);
        }
        if (!in.at_end()) {
            in.complain("something after the frame", in.column());
        }
        frame.length = static_cast<std::uint8_t>(std::max(length, 0));
    } else {
        frame.length = static_cast<std::uint8_t>(read_bytes(in, longest_frame_bytes, &frame.data));
    }
    if (!in.good()) {
        return {.problem = in.problem(), .column = in.problem_column()};
    }
    entry.kind = fd ? CandumpKind::fd_frame : CandumpKind::frame;
    return entry;
}

}  // namespace steadyboom::drivers
