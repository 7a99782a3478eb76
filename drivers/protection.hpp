#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "drivers/can_frame.hpp"

namespace steadyboom::drivers {

/// CRC-8 with polynomial 0x2F, initial value 0xFF, final XOR 0xFF, most significant bit first (the CRC of AUTOSAR E2E
/// profiles 2 and 22). Over a frame of 8 bytes its Hamming distance is 4.
[[nodiscard]] std::uint8_t crc8(std::span<const std::uint8_t> bytes) noexcept;

inline constexpr std::uint8_t protection_bytes = 2;         ///< that end a protected frame
inline constexpr std::uint8_t protection_counters = 15;     ///< the counter runs from 0 to 14; 15 is reserved
inline constexpr std::uint8_t largest_counter_step = 2;     ///< MaxDelta: one frame may be lost unnoticed
inline constexpr std::uint8_t protection_quality_good = 0;  ///< any other says that the sender distrusts its data

/// The counter that belongs to a SYNC counter of 1 to 240, a multiple of 15.
[[nodiscard]] constexpr std::uint8_t protection_counter(std::uint8_t sync_counter) noexcept {
    return sync_counter % protection_counters;
}

/// Writes the last two of the frame's `length` bytes. Second last: counter in bits 3..0, quality in bits 7..4. Last:
/// CRC-8 over the data id's low byte, its high byte and all bytes before the CRC. The data id is not sent; it tells
/// frames apart that stray under another's identifier. A frame of fewer than two bytes is left as it is.
void protect(CanFrame& frame, std::uint16_t data_id, std::uint8_t counter, std::uint8_t quality) noexcept;

/// What one frame is worth.
enum class FrameVerdict : std::uint8_t {
    good,            ///< new data
    repeated,        ///< the counter of the last frame: no new data
    wrong_sequence,  ///< the counter jumped, ran backwards or is the reserved one
    wrong_checksum,  ///< or too short to have one
    poor_quality,    ///< arrived well, but its sender distrusts it
};

/// How far a message as a whole is believed.
enum class ReceiverState : std::uint8_t {
    no_data,  ///< nothing with a right checksum came yet
    init,     ///< frames come, not enough good ones in a row yet
    valid,
    invalid,  ///< too many errors, not enough good ticks in a row since
};

/// Counters since construction.
struct ReceiverStatus {
    std::uint64_t good_frames = 0;
    std::uint64_t repeated_frames = 0;
    std::uint64_t wrong_sequence_frames = 0;
    std::uint64_t wrong_checksum_frames = 0;
    std::uint64_t poor_quality_frames = 0;
    std::uint64_t lost_frames = 0;      ///< as gaps of the counter tell that were small enough to be good
    std::uint64_t silent_ticks = 0;     ///< ticks after the first frame that brought nothing new
    std::uint64_t erroneous_ticks = 0;  ///< ticks with a wrong frame, or with a frame too many
    std::uint32_t times_invalid = 0;    ///< entries into ReceiverState::invalid
};

/// Receives one protected message. check() for each of its frames, then close_tick() once a tick.
///
/// The score counts ticks, as the message comes once in each. A tick is good if it brought a good frame and no wrong
/// one; erroneous if it brought a wrong frame, or a repeated one beside a good one (then two senders are at work);
/// silent if it brought nothing new. Three erroneous ticks in a row, or more than three of the last ten that were not
/// good, make the message invalid. Ten good ticks in a row make it valid, at first as well as again: never does one
/// good checksum clear a fault. A replay of recorded frames in place of the live ones cannot be seen here.
class ProtectedReceiver {
  public:
    static constexpr std::uint32_t most_errors_in_a_row = 2;
    static constexpr std::uint32_t window_ticks = 10;
    static constexpr std::uint32_t most_bad_in_window = 3;
    static constexpr std::uint32_t good_in_a_row_for_valid = 10;

    explicit ProtectedReceiver(std::uint16_t data_id) noexcept : data_id_(data_id) {}

    FrameVerdict check(const CanFrame& frame) noexcept;
    void close_tick() noexcept;

    [[nodiscard]] ReceiverState state() const noexcept { return state_; }
    [[nodiscard]] const ReceiverStatus& status() const noexcept { return status_; }

    /// How many SYNCs the newest frame lies behind the SYNC of `sync_counter`, 0 to 14; 0 before the first frame.
    [[nodiscard]] std::uint8_t lag_ticks(std::uint8_t sync_counter) const noexcept;

  private:
    static constexpr std::uint8_t never = 0xFF;

    [[nodiscard]] FrameVerdict judge(const CanFrame& frame) noexcept;

    std::uint16_t data_id_;
    ReceiverState state_ = ReceiverState::no_data;
    ReceiverStatus status_;
    std::uint8_t counter_ = never;  ///< of the newest frame with a right checksum
    std::uint32_t frames_this_tick_ = 0;
    bool good_this_tick_ = false;
    bool wrong_this_tick_ = false;
    std::uint32_t owed_frames_ = 0;  ///< silent ticks in a row until now
    std::uint32_t errors_in_a_row_ = 0;
    std::uint32_t good_in_a_row_ = 0;
    std::uint32_t bad_ticks_ = 0;  ///< bit i: the tick i ticks ago was not good
};

}  // namespace steadyboom::drivers
