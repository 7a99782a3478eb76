#include "runtime/tick_ring.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "runtime/realtime_section.hpp"
#include "runtime/tick_record.hpp"

namespace steadyboom::runtime {
namespace {

using testing::HasSubstr;
using testing::Property;
using testing::Throws;

// Every word says the same number: a copy torn by the writer shows at once.
template <std::size_t word_count>
struct Words {
    static constexpr std::uint32_t layout_version = 7;
    std::array<std::uint64_t, word_count> words{};
};

template <std::size_t word_count>
bool whole(const Words<word_count>& record) {
    return std::all_of(record.words.begin(), record.words.end(), [&](std::uint64_t w) { return w == record.words[0]; });
}

using Numbered = Words<60>;

Numbered numbered(std::uint64_t number) {
    Numbered record;
    record.words.fill(number);
    return record;
}

class TickRing : public testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path folder_ = [] {
        std::string name = testing::TempDir() + "steadyboom-ring-XXXXXX";
        return std::filesystem::path(mkdtemp(name.data()));
    }();
    std::filesystem::path path_ = folder_ / "ticks";
    TickRingOptions small_{.capacity_records = 8, .period_ns = 5'000'000, .crane_hash = 0xABCD, .file_mode = 0640};
};

TEST_F(TickRing, RecordsArriveInOrderThroughTheFile) {
    TickRingWriter<Numbered> writer(path_, small_);
    TickRingReader<Numbered> reader(path_);
    EXPECT_EQ(reader.period_ns(), 5'000'000);
    EXPECT_EQ(reader.crane_hash(), 0xABCDU);
    Numbered record;
    EXPECT_FALSE(reader.read(record));
    for (std::uint64_t i = 0; i < 1000; ++i) {
        writer.push(numbered(i));
        ASSERT_TRUE(reader.read(record));
        ASSERT_EQ(record.words[0], i);
        ASSERT_TRUE(whole(record));
        ASSERT_FALSE(reader.read(record));
    }
    EXPECT_EQ(reader.lost(), 0U);
}

TEST_F(TickRing, ASlowReaderIsToldExactlyHowManyItLost) {
    TickRingWriter<Numbered> writer(path_, small_);
    TickRingReader<Numbered> reader(path_);
    for (std::uint64_t i = 0; i < 8; ++i) {
        writer.push(numbered(i));
    }
    Numbered record;
    ASSERT_TRUE(reader.read(record));
    EXPECT_EQ(record.words[0], 0U);
    for (std::uint64_t i = 8; i < 30; ++i) {
        writer.push(numbered(i));
    }
    std::vector<std::uint64_t> got;
    while (reader.read(record)) {
        got.push_back(record.words[0]);
    }
    EXPECT_THAT(got, testing::ElementsAre(22, 23, 24, 25, 26, 27, 28, 29));
    EXPECT_EQ(reader.lost(), 21U);
}

TEST_F(TickRing, AReaderThatOpensLateBeginsWhereItAskedAndHasLostNothing) {
    TickRingWriter<Numbered> writer(path_, small_);
    for (std::uint64_t i = 0; i < 20; ++i) {
        writer.push(numbered(i));
    }
    TickRingReader<Numbered> from_oldest(path_, RingStart::oldest);
    TickRingReader<Numbered> from_newest(path_, RingStart::newest);
    writer.push(numbered(20));
    TickRingReader<Numbered> later(path_, RingStart::oldest);
    Numbered record;
    ASSERT_TRUE(from_newest.read(record));
    EXPECT_EQ(record.words[0], 20U);
    EXPECT_EQ(from_newest.lost(), 0U);
    ASSERT_TRUE(later.read(record));
    EXPECT_EQ(record.words[0], 13U);
    EXPECT_EQ(later.lost(), 0U);
    // Between opening and reading the writer took the oldest slot away.
    ASSERT_TRUE(from_oldest.read(record));
    EXPECT_EQ(record.words[0], 13U);
    EXPECT_EQ(from_oldest.lost(), 1U);
}

TEST_F(TickRing, EveryReaderHasItsOwnPlace) {
    TickRingWriter<Numbered> writer(small_);
    TickRingReader<Numbered> first(writer);
    TickRingReader<Numbered> second(writer);
    writer.push(numbered(1));
    Numbered record;
    EXPECT_TRUE(first.read(record));
    EXPECT_FALSE(first.read(record));
    EXPECT_TRUE(second.read(record));
}

// On a ring this short, with records that take this long to copy, most reads meet a slot that is being written.
TEST_F(TickRing, HammeredByTwoReadersNoRecordIsTornAndEachIsDeliveredOrCounted) {
    using Long = Words<1000>;
    constexpr std::uint64_t records = 200'000;
    TickRingOptions options = small_;
    options.capacity_records = 2;
    TickRingWriter<Long> writer(path_, options);

    struct Outcome {
        std::uint64_t delivered = 0;
        std::uint64_t lost = 0;
        std::uint64_t torn = 0;
        std::uint64_t out_of_order = 0;
    };
    std::array<Outcome, 2> outcomes;
    std::atomic<int> ready{0};
    const auto read_all = [&](Outcome& outcome) {
        TickRingReader<Long> reader(path_);
        ++ready;
        Long record;
        std::uint64_t last = 0;
        while (outcome.delivered + reader.lost() < records) {
            if (!reader.read(record)) {
                std::this_thread::yield();
                continue;
            }
            ++outcome.delivered;
            outcome.torn += whole(record) ? 0 : 1;
            outcome.out_of_order += record.words[0] > last ? 0 : 1;
            last = record.words[0];
        }
        outcome.lost = reader.lost();
        outcome.out_of_order += last == records ? 0 : 1;
    };
    std::thread first([&] { read_all(outcomes[0]); });
    std::thread second([&] { read_all(outcomes[1]); });
    while (ready < 2) {
        std::this_thread::yield();
    }
    Long record;
    for (std::uint64_t i = 1; i <= records; ++i) {
        record.words.fill(i);
        writer.push(record);
    }
    first.join();
    second.join();
    for (const Outcome& outcome : outcomes) {
        EXPECT_EQ(outcome.torn, 0U);
        EXPECT_EQ(outcome.out_of_order, 0U);
        EXPECT_EQ(outcome.delivered + outcome.lost, records);
    }
}

TEST_F(TickRing, PushAndReadDoNotAllocate) {
    TickRingWriter<TickRecord> writer(path_, small_);
    TickRingReader<TickRecord> reader(path_);
    TickRecord record;
    TickRecord got;
    {
        const RealtimeSection section;
        for (std::uint64_t i = 0; i < 100; ++i) {
            record.tick = i;
            writer.push(record);
            reader.read(got);
        }
    }
    EXPECT_EQ(got.tick, 99U);
}

TEST_F(TickRing, ANewWriterShowsToReadersOfTheOldRing) {
    auto first = std::make_unique<TickRingWriter<Numbered>>(path_, small_);
    TickRingReader<Numbered> reader(path_);
    first->push(numbered(1));
    EXPECT_FALSE(reader.closed());
    EXPECT_FALSE(reader.replaced());
    first.reset();
    EXPECT_TRUE(reader.closed());
    EXPECT_FALSE(reader.replaced());

    TickRingWriter<Numbered> second(path_, small_);
    second.push(numbered(100));
    EXPECT_TRUE(reader.replaced());
    Numbered record;
    ASSERT_TRUE(reader.read(record)) << "what the old writer pushed is still there";
    EXPECT_EQ(record.words[0], 1U);

    TickRingReader<Numbered> anew(path_);
    EXPECT_NE(anew.epoch(), reader.epoch());
    EXPECT_EQ(anew.epoch(), second.epoch());
    ASSERT_TRUE(anew.read(record));
    EXPECT_EQ(record.words[0], 100U);
}

TEST_F(TickRing, TheFileHasTheModeAskedForWhateverTheUmaskAndLeavesNoTemporary) {
    const mode_t before = umask(077);
    const TickRingWriter<Numbered> writer(path_, small_);
    umask(before);
    struct stat facts {};
    ASSERT_EQ(stat(path_.c_str(), &facts), 0);
    EXPECT_EQ(facts.st_mode & 0777U, 0640U);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator{}), 1);
}

template <class Make>
void expect_error(Make make, const std::string& part) {
    EXPECT_THAT(make, Throws<std::runtime_error>(Property(&std::runtime_error::what, HasSubstr(part))));
}

TEST_F(TickRing, ReadersSayWhatIsWrongWithTheFile) {
    const auto open = [&] { TickRingReader<Numbered> reader(path_); };
    expect_error(open, "No such file or directory; start the program that writes it");

    std::ofstream(path_) << "short";
    expect_error(open, path_.string() + ": is no tick ring");

    std::filesystem::remove(path_);
    std::ofstream(path_) << std::string(100'000, 'x');
    expect_error(open, "is no tick ring");

    { const TickRingWriter<TickRecord> other_record(path_, small_); }
    expect_error(open, "holds records of version " + std::to_string(TickRecord::layout_version) + " with " +
                           std::to_string(sizeof(TickRecord)) +
                           " bytes, this program reads version 7 with 480 bytes; run both from one release");

    { const TickRingWriter<Numbered> writer(path_, small_); }
    std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 1);
    expect_error(open, "is shorter than its 8 records; it is damaged");

    { const TickRingWriter<Numbered> writer(path_, small_); }
    {
        std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(offsetof(TickRingHeader, format_version));
        const std::uint32_t version = 99;
        file.write(reinterpret_cast<const char*>(&version), sizeof version);
    }
    expect_error(open, "has format 99, this program reads format 1");
}

TEST_F(TickRing, WritersSayWhatIsWrongWithPathAndCapacity) {
    expect_error([&] { TickRingWriter<Numbered> writer(folder_ / "nowhere" / "ticks", small_); },
                 "No such file or directory; make its folder");
    TickRingOptions options = small_;
    options.capacity_records = 1;
    expect_error([&] { TickRingWriter<Numbered> writer(path_, options); }, "capacity_records is 1");
    options.capacity_records = std::uint64_t{1} << 40;
    expect_error([&] { TickRingWriter<Numbered> writer(options); }, "capacity_records is 1099511627776");
}

}  // namespace
}  // namespace steadyboom::runtime
