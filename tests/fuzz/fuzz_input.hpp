#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>

#include "drivers/can_frame.hpp"
#include "drivers/device_table.hpp"
#include "tests/support/j1939_network.hpp"

namespace steadyboom::tests {

/// The fuzzer's bytes, taken from the front; zeros when they are used up.
class FuzzInput {
  public:
    FuzzInput(const std::uint8_t* data, std::size_t size) : bytes_(data, size) {}

    [[nodiscard]] bool empty() const { return bytes_.empty(); }

    std::uint8_t byte() {
        if (bytes_.empty()) {
            return 0;
        }
        const auto first = bytes_.front();
        bytes_ = bytes_.subspan(1);
        return first;
    }

    template <typename T>
    T number() {
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < sizeof(T); ++i) {
            bits |= static_cast<std::uint64_t>(byte()) << (8U * i);
        }
        return static_cast<T>(bits);
    }

    std::uint32_t below(std::uint32_t limit) { return number<std::uint16_t>() % limit; }

    /// Anything that a bus can bring in.
    drivers::CanFrame any_frame() {
        drivers::CanFrame frame;
        const auto kind = byte();
        frame.extended = (kind & 0x01U) != 0;
        frame.remote = (kind & 0x02U) != 0;
        frame.error = (kind & 0x04U) != 0;
        frame.id = number<std::uint32_t>() & (frame.extended || frame.error ? 0x1FFF'FFFFU : 0x7FFU);
        frame.length = byte() % 9;
        fill(frame);
        return frame;
    }

    /// A frame of the table's message, so that the gate lets it through; its content is arbitrary.
    drivers::CanFrame table_frame(const drivers::DeviceTable& table) {
        auto frame = table.blank(static_cast<drivers::Message>(below(drivers::message_count)), 0);
        fill(frame);
        return frame;
    }

  private:
    void fill(drivers::CanFrame& frame) {
        for (std::size_t i = 0; i < frame.length; ++i) {
            frame.data[i] = byte();
        }
    }

    std::span<const std::uint8_t> bytes_;
};

/// Bits 0 to 6: which devices are protected. Bit 7: a J1939 valve.
inline drivers::NetworkConfig network_config(std::uint8_t choice) {
    using namespace drivers;
    NetworkConfig config;
    for (std::size_t i = 1; i < device_count; ++i) {
        const bool is_protected = (choice >> (i - 1) & 1U) != 0;
        config.devices[i].protection = is_protected ? Protection::e2e : Protection::none;
    }
    config.bit_rate_bit_s = 1'000'000;
    if ((choice & 0x80U) != 0) {
        test_support::make_valve_j1939(config);
    }
    return config;
}

/// Ends the run with a finding unless `holds`.
inline void require(bool holds, const char* claim) {
    if (!holds) {
        std::fprintf(stderr, "claim does not hold: %s\n", claim);
        std::abort();
    }
}

}  // namespace steadyboom::tests
