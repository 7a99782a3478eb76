#pragma once

#include <cstdint>

#include "drivers/can_frame.hpp"

namespace steadyboom::drivers {

/// Counters since construction.
struct TwinStatus {
    std::uint64_t matched_pairs = 0;
    std::uint64_t mismatched_pairs = 0;  ///< some bit is the same in both
    std::uint64_t late_pairs = 0;        ///< further apart than the limit
    std::uint64_t lone_frames = 0;       ///< a frame whose twin never came
};

/// A frame and its bit-inverted twin, as CiA 304 sends safety-relevant data: the receiver acts only when both came, the
/// plain one first, with all data bits opposite, at most `limit_ns` apart. A twin serves once.
class InvertedTwin {
  public:
    static constexpr std::int64_t limit_ns = 2'000'000;

    /// Holds the plain frame until its twin comes.
    void take_plain(const CanFrame& frame, std::int64_t now_ns) noexcept;

    /// True if this completes a pair: then plain() may be acted on.
    [[nodiscard]] bool take_inverted(const CanFrame& frame, std::int64_t now_ns) noexcept;

    /// The plain frame of the last call of take_plain().
    [[nodiscard]] const CanFrame& plain() const noexcept { return plain_; }
    [[nodiscard]] const TwinStatus& status() const noexcept { return status_; }

    /// Forgets a plain frame that waits, as a node does that restarts.
    void forget() noexcept;

  private:
    CanFrame plain_;
    std::int64_t plain_ns_ = 0;
    bool waiting_ = false;
    TwinStatus status_;
};

/// Inverts the frame's data bits; identifier and length stay.
void invert(CanFrame& frame) noexcept;

}  // namespace steadyboom::drivers
