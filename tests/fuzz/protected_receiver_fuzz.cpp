// The receiver of one protected message against a second, slower writing of its rules.

#include <deque>

#include "drivers/protection.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace steadyboom {
namespace {

using namespace drivers;
using tests::require;

constexpr std::uint16_t data_id = 0x1234;

/// The same rules over the whole history.
class Model {
  public:
    FrameVerdict check(const CanFrame& frame, bool intact) {
        const auto verdict = judge(frame, intact);
        frames_ += 1;
        good_ += verdict == FrameVerdict::good ? 1 : 0;
        wrong_ += verdict != FrameVerdict::good && verdict != FrameVerdict::repeated ? 1 : 0;
        return verdict;
    }

    void close_tick() {
        const bool surplus = good_ > 0 && frames_ > 1 + silent_in_a_row_;
        const char tick = wrong_ > 0 || surplus ? 'e' : good_ > 0 ? 'g' : 's';
        frames_ = good_ = wrong_ = 0;
        silent_in_a_row_ = tick == 's' ? silent_in_a_row_ + 1 : 0;
        if (last_ < 0) {
            return;
        }
        history_.push_back(tick);
        if (history_.size() > 10) {
            history_.pop_front();
        }
        int bad = 0;
        int good_in_a_row = 0;
        int errors_in_a_row = 0;
        for (const char past : history_) {
            bad += past != 'g' ? 1 : 0;
            good_in_a_row = past == 'g' ? good_in_a_row + 1 : 0;
            errors_in_a_row = past == 'e' ? errors_in_a_row + 1 : 0;
        }
        if (bad > 3 || errors_in_a_row >= 3) {
            state_ = ReceiverState::invalid;
        } else if (good_in_a_row == 10) {
            state_ = ReceiverState::valid;
        } else if (state_ == ReceiverState::no_data) {
            state_ = ReceiverState::init;
        }
    }

    [[nodiscard]] ReceiverState state() const { return state_; }

  private:
    FrameVerdict judge(const CanFrame& frame, bool intact) {
        if (!intact) {
            return FrameVerdict::wrong_checksum;
        }
        const int trailer = frame.data[frame.length - 2U];
        if (trailer % 16 == 15) {
            return FrameVerdict::wrong_sequence;
        }
        const int last = last_;
        last_ = trailer % 16;
        if (last == last_) {
            return FrameVerdict::repeated;
        }
        if (last >= 0 && last_ != (last + 1) % 15 && last_ != (last + 2) % 15) {
            return FrameVerdict::wrong_sequence;
        }
        return trailer / 16 == 0 ? FrameVerdict::good : FrameVerdict::poor_quality;
    }

    int last_ = -1;
    int frames_ = 0;
    int good_ = 0;
    int wrong_ = 0;
    int silent_in_a_row_ = 0;
    std::deque<char> history_;
    ReceiverState state_ = ReceiverState::no_data;
};

void run(tests::FuzzInput input) {
    ProtectedReceiver receiver(data_id);
    Model model;
    std::uint8_t counter = 0;
    while (!input.empty()) {
        const auto choice = input.byte();
        if (choice < 96) {
            receiver.close_tick();
            model.close_tick();
            require(receiver.state() == model.state(), "both writings of the rules agree on the state");
            continue;
        }
        CanFrame frame{.length = 8};
        frame.data[0] = input.byte();
        counter = static_cast<std::uint8_t>(choice < 192 ? (counter + 1) % 15 : input.byte() % 16);
        protect(frame, data_id, counter, static_cast<std::uint8_t>(choice % 16U == 0 ? input.byte() % 16 : 0));
        const bool intact = choice % 16U != 1;
        if (!intact) {
            frame.data[input.below(8)] ^= static_cast<std::uint8_t>(1U << input.below(8));
        }
        require(receiver.check(frame) == model.check(frame, intact), "and on each frame");
        require(receiver.lag_ticks(input.byte()) < 15, "a lag is a step of the counter");
    }
}

}  // namespace
}  // namespace steadyboom

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    steadyboom::run({data, size});
    return 0;
}
