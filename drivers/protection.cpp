#include "drivers/protection.hpp"

#include <bit>

namespace steadyboom::drivers {
namespace {

constexpr std::uint8_t polynomial = 0x2F;
constexpr std::uint8_t initial = 0xFF;
constexpr std::uint8_t final_xor = 0xFF;

constexpr std::array<std::uint8_t, 256> crc_table() {
    std::array<std::uint8_t, 256> table{};
    for (unsigned byte = 0; byte < table.size(); ++byte) {
        unsigned crc = byte;
        for (int bit = 0; bit < 8; ++bit) {
            crc = (crc & 0x80U) != 0 ? (crc << 1U) ^ polynomial : crc << 1U;
        }
        table[byte] = static_cast<std::uint8_t>(crc);
    }
    return table;
}
constexpr auto table = crc_table();

constexpr std::uint8_t update(std::uint8_t crc, std::uint8_t byte) noexcept {
    return table[static_cast<std::uint8_t>(crc ^ byte)];
}

std::uint8_t frame_crc(const CanFrame& frame, std::uint16_t data_id) noexcept {
    auto crc = update(initial, static_cast<std::uint8_t>(data_id));
    crc = update(crc, static_cast<std::uint8_t>(data_id >> 8U));
    for (std::size_t i = 0; i + 1 < frame.length; ++i) {
        crc = update(crc, frame.data[i]);
    }
    return crc ^ final_xor;
}

constexpr bool has_room(const CanFrame& frame) noexcept {
    return frame.length >= protection_bytes && frame.length <= longest_frame_bytes;
}

}  // namespace

std::uint8_t crc8(std::span<const std::uint8_t> bytes) noexcept {
    auto crc = initial;
    for (const auto byte : bytes) {
        crc = update(crc, byte);
    }
    return crc ^ final_xor;
}

void protect(CanFrame& frame, std::uint16_t data_id, std::uint8_t counter, std::uint8_t quality) noexcept {
    if (!has_room(frame)) {
        return;
    }
    frame.data[frame.length - 2U] = static_cast<std::uint8_t>((quality << 4U) | (counter & 0x0FU));
    frame.data[frame.length - 1U] = frame_crc(frame, data_id);
}

FrameVerdict ProtectedReceiver::check(const CanFrame& frame) noexcept {
    const auto verdict = judge(frame);
    ++frames_this_tick_;
    switch (verdict) {
        case FrameVerdict::good:
            ++status_.good_frames;
            good_this_tick_ = true;
            break;
        case FrameVerdict::repeated:
            ++status_.repeated_frames;
            break;
        case FrameVerdict::wrong_sequence:
            ++status_.wrong_sequence_frames;
            wrong_this_tick_ = true;
            break;
        case FrameVerdict::wrong_checksum:
            ++status_.wrong_checksum_frames;
            wrong_this_tick_ = true;
            break;
        case FrameVerdict::poor_quality:
            ++status_.poor_quality_frames;
            wrong_this_tick_ = true;
            break;
    }
    return verdict;
}

FrameVerdict ProtectedReceiver::judge(const CanFrame& frame) noexcept {
    if (!has_room(frame) || frame.data[frame.length - 1U] != frame_crc(frame, data_id_)) {
        return FrameVerdict::wrong_checksum;
    }
    const std::uint8_t counter = frame.data[frame.length - 2U] & 0x0FU;
    const std::uint8_t quality = frame.data[frame.length - 2U] >> 4U;
    if (counter >= protection_counters) {
        return FrameVerdict::wrong_sequence;
    }
    const bool first = counter_ == never;
    const int step = first ? 1 : (counter + protection_counters - counter_) % protection_counters;
    // The new place in the sequence is taken over even after a jump: a sender that restarted costs one error, not all.
    counter_ = counter;
    if (step == 0) {
        return FrameVerdict::repeated;
    }
    if (step > largest_counter_step) {
        return FrameVerdict::wrong_sequence;
    }
    status_.lost_frames += static_cast<std::uint64_t>(step - 1);
    return quality == protection_quality_good ? FrameVerdict::good : FrameVerdict::poor_quality;
}

void ProtectedReceiver::close_tick() noexcept {
    const bool too_many = good_this_tick_ && frames_this_tick_ > 1 + owed_frames_;
    const bool erroneous = wrong_this_tick_ || too_many;
    const bool good = good_this_tick_ && !erroneous;
    owed_frames_ = good || erroneous ? 0 : owed_frames_ + 1;
    frames_this_tick_ = 0;
    good_this_tick_ = wrong_this_tick_ = false;
    status_.erroneous_ticks += erroneous ? 1U : 0U;
    if (state_ == ReceiverState::no_data) {
        if (counter_ == never) {
            return;
        }
        state_ = ReceiverState::init;
    }
    status_.silent_ticks += !good && !erroneous ? 1U : 0U;

    errors_in_a_row_ = erroneous ? errors_in_a_row_ + 1 : 0;
    good_in_a_row_ = good ? good_in_a_row_ + 1 : 0;
    bad_ticks_ = ((bad_ticks_ << 1U) | (good ? 0U : 1U)) & ((1U << window_ticks) - 1U);
    if (errors_in_a_row_ > most_errors_in_a_row || std::popcount(bad_ticks_) > static_cast<int>(most_bad_in_window)) {
        status_.times_invalid += state_ != ReceiverState::invalid ? 1U : 0U;
        state_ = ReceiverState::invalid;
    } else if (good_in_a_row_ >= good_in_a_row_for_valid) {
        state_ = ReceiverState::valid;
    }
}

std::uint8_t ProtectedReceiver::lag_ticks(std::uint8_t sync_counter) const noexcept {
    if (counter_ == never) {
        return 0;
    }
    return static_cast<std::uint8_t>((protection_counter(sync_counter) + protection_counters - counter_) %
                                     protection_counters);
}

}  // namespace steadyboom::drivers
