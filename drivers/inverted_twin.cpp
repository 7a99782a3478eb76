#include "drivers/inverted_twin.hpp"

#include <algorithm>

namespace steadyboom::drivers {

void InvertedTwin::take_plain(const CanFrame& frame, std::int64_t now_ns) noexcept {
    forget();
    plain_ = frame;
    plain_ns_ = now_ns;
    waiting_ = true;
}

bool InvertedTwin::take_inverted(const CanFrame& frame, std::int64_t now_ns) noexcept {
    if (!waiting_) {
        ++status_.lone_frames;
        return false;
    }
    waiting_ = false;
    const auto age_ns = now_ns - plain_ns_;
    if (age_ns < 0 || age_ns > limit_ns) {
        ++status_.late_pairs;
        return false;
    }
    const auto length = std::min(plain_.length, longest_frame_bytes);
    const bool opposite = frame.length == plain_.length &&
                          std::equal(plain_.data.begin(), plain_.data.begin() + length, frame.data.begin(),
                                     [](std::uint8_t a, std::uint8_t b) { return (a ^ b) == 0xFF; });
    ++(opposite ? status_.matched_pairs : status_.mismatched_pairs);
    return opposite;
}

void InvertedTwin::forget() noexcept {
    status_.lone_frames += waiting_ ? 1U : 0U;
    waiting_ = false;
}

void invert(CanFrame& frame) noexcept {
    const auto length = std::min(frame.length, longest_frame_bytes);
    std::transform(frame.data.begin(), frame.data.begin() + length, frame.data.begin(),
                   [](std::uint8_t byte) { return static_cast<std::uint8_t>(~byte); });
}

}  // namespace steadyboom::drivers
