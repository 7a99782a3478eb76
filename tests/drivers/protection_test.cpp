#include "drivers/protection.hpp"

#include <array>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace steadyboom::drivers {
namespace {

constexpr std::uint16_t data_id = 0x0190;

CanFrame protected_frame(int counter, std::uint8_t quality = 0, std::uint16_t id = data_id, std::uint8_t length = 8) {
    CanFrame frame{.id = 0x190, .length = length, .data = {0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE, 0xF0}};
    protect(frame, id, static_cast<std::uint8_t>(counter), quality);
    return frame;
}

void flip(CanFrame& frame, unsigned bit) {
    frame.data[bit / 8] = static_cast<std::uint8_t>(frame.data[bit / 8] ^ (1U << bit % 8));
}

FrameVerdict verdict_of(const CanFrame& frame) {
    return ProtectedReceiver(data_id).check(frame);
}

class ProtectedReceiverTest : public ::testing::Test {
  protected:
    FrameVerdict good() { return receiver_.check(protected_frame(next_++ % 15)); }
    void good_ticks(int ticks) {
        for (int i = 0; i < ticks; ++i) {
            ASSERT_EQ(good(), FrameVerdict::good);
            receiver_.close_tick();
        }
    }
    void bad_ticks(int ticks) {
        for (int i = 0; i < ticks; ++i) {
            auto frame = protected_frame(next_++ % 15);
            flip(frame, 5);
            ASSERT_EQ(receiver_.check(frame), FrameVerdict::wrong_checksum);
            receiver_.close_tick();
        }
    }
    void silent_ticks(int ticks) {
        for (int i = 0; i < ticks; ++i) {
            ++next_;
            receiver_.close_tick();
        }
    }
    void become_valid() {
        good_ticks(10);
        ASSERT_EQ(receiver_.state(), ReceiverState::valid);
    }

    ProtectedReceiver receiver_{data_id};
    int next_ = 0;
};

TEST(Protection, Crc8HasThePublishedCheckValue) {
    constexpr std::string_view text = "123456789";
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    EXPECT_EQ(crc8(bytes), 0xDF);
}

TEST(Protection, TrailerHoldsCounterQualityAndCrcOverDataIdAndTheBytesBefore) {
    const auto frame = protected_frame(11, 4);
    EXPECT_EQ(frame.data[5], 0xBC) << "the last byte of the payload stays";
    EXPECT_EQ(frame.data[6], 0x4B);
    const std::array<std::uint8_t, 9> covered = {0x90, 0x01, 0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0x4B};
    EXPECT_EQ(frame.data[7], crc8(covered));
}

TEST(Protection, FramesTooShortForATrailerAreLeftAloneAndNeverBelieved) {
    for (const std::uint8_t length : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{9}, std::uint8_t{255}}) {
        CanFrame frame{.length = length, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
        const auto before = frame.data;
        protect(frame, data_id, 3, 0);
        EXPECT_EQ(frame.data, before);
        EXPECT_EQ(verdict_of(frame), FrameVerdict::wrong_checksum);
    }
}

TEST(Protection, EveryFlipOfOneTwoOrThreeBitsIsDetectedAtEveryLength) {
    std::mt19937 random(1);
    for (std::uint8_t length = 2; length <= 8; ++length) {
        for (int content = 0; content < 3; ++content) {
            CanFrame sent{.id = 0x190, .length = length};
            for (auto& byte : sent.data) {
                byte = static_cast<std::uint8_t>(random());
            }
            protect(sent, data_id, static_cast<std::uint8_t>(content), 0);
            ASSERT_EQ(verdict_of(sent), FrameVerdict::good);
            const unsigned bits = 8U * length;
            for (unsigned i = 0; i < bits; ++i) {
                auto one = sent;
                flip(one, i);
                ASSERT_EQ(verdict_of(one), FrameVerdict::wrong_checksum) << int{length} << ": " << i;
                for (unsigned j = i + 1; j < bits; ++j) {
                    auto two = one;
                    flip(two, j);
                    ASSERT_EQ(verdict_of(two), FrameVerdict::wrong_checksum) << int{length} << ": " << i << " " << j;
                    for (unsigned k = j + 1; k < bits; ++k) {
                        auto three = two;
                        flip(three, k);
                        ASSERT_EQ(verdict_of(three), FrameVerdict::wrong_checksum)
                            << int{length} << ": " << i << " " << j << " " << k;
                    }
                }
            }
        }
    }
}

TEST(Protection, OfAllFourBitFlipsOfEightBytesOneIn125Passes) {
    const auto sent = protected_frame(0);
    int all = 0;
    int passed = 0;
    for (unsigned i = 0; i < 64; ++i) {
        for (unsigned j = i + 1; j < 64; ++j) {
            for (unsigned k = j + 1; k < 64; ++k) {
                for (unsigned l = k + 1; l < 64; ++l) {
                    auto frame = sent;
                    for (const auto bit : {i, j, k, l}) {
                        flip(frame, bit);
                    }
                    ++all;
                    passed += verdict_of(frame) != FrameVerdict::wrong_checksum ? 1 : 0;
                }
            }
        }
    }
    EXPECT_EQ(all, 635'376);
    EXPECT_EQ(passed, 5'066);
}

TEST(Protection, OddNumbersOfFlippedBitsNeverPass) {
    std::mt19937 random(2);
    const auto sent = protected_frame(7);
    for (int trial = 0; trial < 200'000; ++trial) {
        const auto pattern = (static_cast<std::uint64_t>(random()) << 32U) | random();
        if (__builtin_popcountll(pattern) % 2 == 0) {
            continue;
        }
        auto frame = sent;
        for (unsigned bit = 0; bit < 64; ++bit) {
            if ((pattern >> bit & 1U) != 0) {
                flip(frame, bit);
            }
        }
        ASSERT_EQ(verdict_of(frame), FrameVerdict::wrong_checksum);
    }
}

TEST(Protection, AnyOtherDataIdThatDiffersInUpToThreeBitsOrInOneByteIsDetected) {
    for (unsigned other = 0; other <= 0xFFFF; ++other) {
        const unsigned difference = other ^ data_id;
        const bool one_byte = (difference & 0xFFU) == 0 || (difference & 0xFF00U) == 0;
        if (difference != 0 && (one_byte || __builtin_popcount(difference) <= 3)) {
            ASSERT_EQ(verdict_of(protected_frame(3, 0, static_cast<std::uint16_t>(other))),
                      FrameVerdict::wrong_checksum)
                << other;
        }
    }
}

TEST(Protection, EveryPairOfCountersIsJudgedByItsStepModuloFifteen) {
    for (int last = 0; last < 16; ++last) {
        for (int next = 0; next < 16; ++next) {
            ProtectedReceiver receiver(data_id);
            const auto first = receiver.check(protected_frame(last));
            const auto verdict = receiver.check(protected_frame(next));
            auto expected = FrameVerdict::wrong_sequence;
            if (last == 15) {
                EXPECT_EQ(first, FrameVerdict::wrong_sequence);
                expected = next == 15 ? FrameVerdict::wrong_sequence : FrameVerdict::good;
            } else {
                EXPECT_EQ(first, FrameVerdict::good);
                for (const int step : {1, 2}) {
                    expected = next == (last + step) % 15 ? FrameVerdict::good : expected;
                }
                expected = next == last ? FrameVerdict::repeated : expected;
            }
            EXPECT_EQ(verdict, expected) << last << " then " << next;
            const bool one_lost = last < 15 && next < 15 && next == (last + 2) % 15;
            EXPECT_EQ(receiver.status().lost_frames, one_lost ? 1U : 0U) << last << " then " << next;
        }
    }
}

TEST(Protection, AfterAJumpTheNextFrameInTheNewSequenceIsGood) {
    ProtectedReceiver receiver(data_id);
    (void)receiver.check(protected_frame(3));
    EXPECT_EQ(receiver.check(protected_frame(9)), FrameVerdict::wrong_sequence);
    EXPECT_EQ(receiver.check(protected_frame(10)), FrameVerdict::good);
    EXPECT_EQ(receiver.check(protected_frame(15)), FrameVerdict::wrong_sequence);
    EXPECT_EQ(receiver.check(protected_frame(11)), FrameVerdict::good) << "a reserved counter moves nothing";
    auto broken = protected_frame(1);
    flip(broken, 0);
    EXPECT_EQ(receiver.check(broken), FrameVerdict::wrong_checksum);
    EXPECT_EQ(receiver.check(protected_frame(12)), FrameVerdict::good) << "nor does a broken frame";
}

TEST(Protection, EveryQualityButGoodIsTheSendersDistrust) {
    for (std::uint8_t quality = 0; quality < 16; ++quality) {
        EXPECT_EQ(verdict_of(protected_frame(4, quality)),
                  quality == 0 ? FrameVerdict::good : FrameVerdict::poor_quality);
    }
}

TEST(Protection, CounterOfTheSyncNeverJumps) {
    int last = protection_counter(1);
    for (int round = 0; round < 2; ++round) {
        for (int sync = round == 0 ? 2 : 1; sync <= 240; ++sync) {
            const int counter = protection_counter(static_cast<std::uint8_t>(sync));
            ASSERT_EQ(counter, (last + 1) % 15) << sync;
            last = counter;
        }
    }
}

TEST(Protection, LagIsHowManySyncsTheNewestFrameIsBehind) {
    ProtectedReceiver receiver(data_id);
    EXPECT_EQ(receiver.lag_ticks(7), 0);
    (void)receiver.check(protected_frame(protection_counter(238)));
    EXPECT_EQ(receiver.lag_ticks(238), 0);
    EXPECT_EQ(receiver.lag_ticks(240), 2);
    EXPECT_EQ(receiver.lag_ticks(3), 5);
}

TEST_F(ProtectedReceiverTest, SilenceBeforeTheFirstFrameIsNoFault) {
    for (int tick = 0; tick < 100; ++tick) {
        receiver_.close_tick();
    }
    EXPECT_EQ(receiver_.state(), ReceiverState::no_data);
    EXPECT_EQ(receiver_.status().silent_ticks, 0U);
    bad_ticks(5);
    EXPECT_EQ(receiver_.state(), ReceiverState::no_data) << "noise is no message";
}

TEST_F(ProtectedReceiverTest, BecomesValidAfterTenGoodTicksInARow) {
    good_ticks(1);
    EXPECT_EQ(receiver_.state(), ReceiverState::init);
    good_ticks(8);
    EXPECT_EQ(receiver_.state(), ReceiverState::init);
    good_ticks(1);
    EXPECT_EQ(receiver_.state(), ReceiverState::valid);
}

TEST_F(ProtectedReceiverTest, ThreeErrorsInARowMakeItInvalidAndTwoDoNot) {
    const auto poor_tick = [this] {
        EXPECT_EQ(receiver_.check(protected_frame(next_++ % 15, 1)), FrameVerdict::poor_quality);
        receiver_.close_tick();
    };
    become_valid();
    poor_tick();
    poor_tick();
    good_ticks(10);
    EXPECT_EQ(receiver_.state(), ReceiverState::valid);
    poor_tick();
    poor_tick();
    EXPECT_EQ(receiver_.state(), ReceiverState::valid);
    poor_tick();
    EXPECT_EQ(receiver_.state(), ReceiverState::invalid);
    EXPECT_EQ(receiver_.status().times_invalid, 1U);
    poor_tick();
    EXPECT_EQ(receiver_.status().times_invalid, 1U);
}

TEST_F(ProtectedReceiverTest, TwoBrokenFramesInARowMakeTheNextOneAJump) {
    become_valid();
    bad_ticks(1);
    good_ticks(10);
    bad_ticks(2);
    EXPECT_EQ(receiver_.state(), ReceiverState::valid);
    EXPECT_EQ(good(), FrameVerdict::wrong_sequence);
    receiver_.close_tick();
    EXPECT_EQ(receiver_.state(), ReceiverState::invalid);
}

TEST_F(ProtectedReceiverTest, SilenceAmongErrorsIsAFourthBadTick) {
    become_valid();
    bad_ticks(1);
    silent_ticks(1);
    bad_ticks(1);
    EXPECT_EQ(receiver_.state(), ReceiverState::valid);
    bad_ticks(1);
    EXPECT_EQ(receiver_.state(), ReceiverState::invalid);
}

TEST_F(ProtectedReceiverTest, FourthSilentTickMakesItInvalid) {
    become_valid();
    silent_ticks(3);
    EXPECT_EQ(receiver_.state(), ReceiverState::valid);
    silent_ticks(1);
    EXPECT_EQ(receiver_.state(), ReceiverState::invalid);
    EXPECT_EQ(receiver_.status().silent_ticks, 4U);
}

TEST_F(ProtectedReceiverTest, FrozenFrameIsSilence) {
    become_valid();
    for (int tick = 0; tick < 4; ++tick) {
        EXPECT_EQ(receiver_.state(), ReceiverState::valid);
        EXPECT_EQ(receiver_.check(protected_frame((next_ - 1) % 15)), FrameVerdict::repeated);
        receiver_.close_tick();
    }
    EXPECT_EQ(receiver_.state(), ReceiverState::invalid);
    EXPECT_EQ(receiver_.status().erroneous_ticks, 0U);
}

TEST_F(ProtectedReceiverTest, EveryPatternOfTenTicksIsJudgedByCountAndRow) {
    for (unsigned pattern = 0; pattern < 1024; ++pattern) {
        receiver_ = ProtectedReceiver(data_id);
        next_ = 0;
        become_valid();
        unsigned bad = 0;
        int in_a_row = 0;
        bool invalid = false;
        for (int tick = 0; tick < 10; ++tick) {
            if ((pattern >> tick & 1U) != 0) {
                bad_ticks(1);
                ++bad;
                ++in_a_row;
            } else {
                // After two lost in a row the counter has run on by three: that frame is an error of sequence itself.
                const bool jump = in_a_row >= 2;
                ASSERT_EQ(good(), jump ? FrameVerdict::wrong_sequence : FrameVerdict::good);
                receiver_.close_tick();
                bad += jump ? 1 : 0;
                in_a_row = jump ? in_a_row + 1 : 0;
                invalid = invalid || in_a_row >= 3;
                in_a_row = jump ? -1 : in_a_row;  // the next in sequence is good again
            }
            invalid = invalid || bad > 3 || in_a_row >= 3;
            ASSERT_EQ(receiver_.state() == ReceiverState::invalid, invalid) << std::hex << pattern << " tick " << tick;
            if (invalid) {
                break;
            }
        }
    }
}

TEST_F(ProtectedReceiverTest, ErrorsLeaveTheWindowAfterTenTicks) {
    become_valid();
    for (int round = 0; round < 20; ++round) {  // three in any ten
        bad_ticks(1);
        good_ticks(3);
        bad_ticks(1);
        good_ticks(2);
        bad_ticks(1);
        good_ticks(2);
    }
    EXPECT_EQ(receiver_.state(), ReceiverState::valid);
}

TEST_F(ProtectedReceiverTest, OneGoodFrameClearsNoFaultTenInARowDo) {
    become_valid();
    bad_ticks(3);
    ASSERT_EQ(receiver_.state(), ReceiverState::invalid);
    next_ -= 3;
    good_ticks(9);
    EXPECT_EQ(receiver_.state(), ReceiverState::invalid);
    silent_ticks(1);
    good_ticks(9);
    EXPECT_EQ(receiver_.state(), ReceiverState::invalid);
    good_ticks(1);
    EXPECT_EQ(receiver_.state(), ReceiverState::valid);
    EXPECT_EQ(receiver_.status().times_invalid, 1U);
}

TEST_F(ProtectedReceiverTest, LateFrameBesideItsSuccessorCostsOneSilentTickOnly) {
    become_valid();
    receiver_.close_tick();
    EXPECT_EQ(good(), FrameVerdict::good);
    EXPECT_EQ(good(), FrameVerdict::good);
    receiver_.close_tick();
    EXPECT_EQ(receiver_.state(), ReceiverState::valid);
    EXPECT_EQ(receiver_.status().erroneous_ticks, 0U);
}

TEST_F(ProtectedReceiverTest, ReplayBesideTheLiveSenderIsFoundWithinThreeTicksAtAnyOffset) {
    for (int offset = 0; offset < 15; ++offset) {
        receiver_ = ProtectedReceiver(data_id);
        next_ = 0;
        become_valid();
        int ticks = 0;
        while (receiver_.state() == ReceiverState::valid && ticks < 100) {
            (void)receiver_.check(protected_frame(next_ % 15));
            (void)receiver_.check(protected_frame((next_ + offset) % 15));
            ++next_;
            ++ticks;
            receiver_.close_tick();
        }
        EXPECT_LE(ticks, 3) << offset;
    }
}

TEST_F(ProtectedReceiverTest, SwappedSensorsAreFoundInThreeTicks) {
    become_valid();
    for (int tick = 0; tick < 3; ++tick) {
        EXPECT_EQ(receiver_.state(), ReceiverState::valid);
        EXPECT_EQ(receiver_.check(protected_frame(next_++ % 15, 0, 0x0194)), FrameVerdict::wrong_checksum);
        receiver_.close_tick();
    }
    EXPECT_EQ(receiver_.state(), ReceiverState::invalid);
}

TEST_F(ProtectedReceiverTest, EveryFrameIsCountedOnce) {
    std::mt19937 random(3);
    std::uint64_t frames = 0;
    for (int tick = 0; tick < 20'000; ++tick) {
        for (unsigned i = random() % 4; i > 0; --i) {
            auto frame = protected_frame(static_cast<int>(random() % 16), random() % 8 == 0 ? 3 : 0);
            if (random() % 8 == 0) {
                flip(frame, random() % 64);
            }
            (void)receiver_.check(frame);
            ++frames;
        }
        receiver_.close_tick();
    }
    const auto& status = receiver_.status();
    EXPECT_EQ(status.good_frames + status.repeated_frames + status.wrong_sequence_frames +
                  status.wrong_checksum_frames + status.poor_quality_frames,
              frames);
}

}  // namespace
}  // namespace steadyboom::drivers
