#include <array>
#include <functional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/sdo_client.hpp"
#include "drivers/sdo_server.hpp"

namespace steadyboom::drivers {
namespace {

using Bytes = std::array<std::uint8_t, 8>;
using Outcome = SdoClient::Outcome;

constexpr std::uint8_t node = 0x14;
constexpr std::int64_t timeout_ns = 100'000'000;

CanFrame request(const Bytes& bytes) {
    return {.id = 0x614, .length = 8, .data = bytes};
}

CanFrame response(const Bytes& bytes) {
    return {.id = 0x594, .length = 8, .data = bytes};
}

class SdoClientTest : public ::testing::Test {
  protected:
    Bytes sent() {
        const auto frame = client_.poll(now_ns_);
        if (!frame) {
            ADD_FAILURE() << "nothing to send";
            return {};
        }
        EXPECT_EQ(frame->id, 0x614U);
        EXPECT_EQ(frame->length, 8);
        EXPECT_EQ(frame->stamp_ns, now_ns_);
        return frame->data;
    }
    bool silent() { return !client_.poll(now_ns_).has_value(); }

    std::int64_t now_ns_ = -3;  // the clock may start below zero
    SdoClient client_{timeout_ns};
};

class SdoServerTest : public ::testing::Test {
  protected:
    Bytes answered(const Bytes& bytes) {
        const auto frame = server_.answer(request(bytes), 7);
        if (!frame) {
            ADD_FAILURE() << "no answer";
            return {};
        }
        EXPECT_EQ(frame->id, 0x594U);
        EXPECT_EQ(frame->length, 8);
        EXPECT_EQ(frame->stamp_ns, 7);
        return frame->data;
    }

    std::vector<ObjectEntry> dictionary_ = {
        {.object = {0x1000, 0}, .size_bytes = 4, .value_raw = 0x0003'019A},
        {.object = {0x1017, 0}, .size_bytes = 2, .access = ObjectAccess::read_write, .value_raw = 100},
        {.object = {0x1018, 0}, .size_bytes = 1, .value_raw = 4},
        {.object = {0x1018, 2}, .size_bytes = 3, .value_raw = 0x0A0B0C},
        {.object = {0x1800, 2},
         .size_bytes = 1,
         .access = ObjectAccess::read_write,
         .value_raw = 1,
         .lowest_raw = 1,
         .highest_raw = 240},
        {.object = {0x1011, 1}, .size_bytes = 4, .access = ObjectAccess::write_only},
    };
    SdoServer server_{node, dictionary_};
};

TEST(SdoAbort, EveryCodeHasWordsOfItsOwn) {
    const std::vector<std::uint32_t> codes = {
        0,          0x05030000, 0x05040000, 0x05040001, 0x05040002, 0x05040003,  0x05040004, 0x05040005, 0x06010000,
        0x06010001, 0x06010002, 0x06020000, 0x06040041, 0x06040042, 0x06040043,  0x06040047, 0x06060000, 0x06070010,
        0x06070012, 0x06070013, 0x06090011, 0x06090030, 0x06090031, 0x06090032,  0x06090036, 0x060A0023, 0x08000000,
        0x08000020, 0x08000021, 0x08000022, 0x08000023, 0x08000024, 0x12345678U,
    };
    std::set<std::string_view> texts;
    for (const auto code : codes) {
        EXPECT_TRUE(texts.insert(text_of(static_cast<SdoAbort>(code))).second) << std::hex << code;
    }
    EXPECT_EQ(text_of(static_cast<SdoAbort>(0x12345678U)), "unknown abort code");
}

TEST_F(SdoClientTest, ReadsOneToFourBytes) {
    for (std::uint8_t size = 1; size <= 4; ++size) {
        ASSERT_TRUE(client_.upload(node, {0x1018, 2}));
        EXPECT_TRUE(client_.busy());
        EXPECT_EQ(sent(), (Bytes{0x40, 0x18, 0x10, 0x02}));
        EXPECT_TRUE(silent()) << "the request is sent once";
        const auto command = static_cast<std::uint8_t>(0x4F - 4 * (size - 1));
        EXPECT_TRUE(client_.receive(response({command, 0x18, 0x10, 0x02, 0x11, 0x22, 0x33, 0x84})));
        EXPECT_FALSE(client_.busy());
        EXPECT_EQ(client_.outcome(), Outcome::done);
        EXPECT_EQ(client_.size_bytes(), size);
        EXPECT_EQ(client_.value(), size == 4 ? 0x84332211U : 0x84332211U & ((1U << (8 * size)) - 1U));
        EXPECT_EQ(client_.abort_code(), SdoAbort::none);
        EXPECT_TRUE(silent());
    }
}

TEST_F(SdoClientTest, AnswerWithoutASizeIsFourBytes) {
    ASSERT_TRUE(client_.upload(node, {0x1000, 0}));
    (void)sent();
    EXPECT_TRUE(client_.receive(response({0x42, 0x00, 0x10, 0x00, 0x11, 0x22, 0x33, 0x44})));
    EXPECT_EQ(client_.value(), 0x44332211U);
    EXPECT_EQ(client_.size_bytes(), 4);
}

TEST_F(SdoClientTest, WritesOneToFourBytes) {
    const std::array<std::uint8_t, 4> commands = {0x2F, 0x2B, 0x27, 0x23};
    for (std::uint8_t size = 1; size <= 4; ++size) {
        ASSERT_TRUE(client_.download(node, {0x1017, 0}, 0x84332211U, size));
        Bytes expected = {commands[size - 1U], 0x17, 0x10, 0x00, 0x11, 0x22, 0x33, 0x84};
        std::fill(expected.begin() + 4 + size, expected.end(), std::uint8_t{0});
        EXPECT_EQ(sent(), expected);
        EXPECT_TRUE(client_.receive(response({0x60, 0x17, 0x10, 0x00})));
        EXPECT_EQ(client_.outcome(), Outcome::done);
    }
}

TEST_F(SdoClientTest, AbortOfTheNodeEndsTheTransferWithItsCode) {
    for (const bool writes : {false, true}) {
        ASSERT_TRUE(writes ? client_.download(node, {0x1017, 0}, 1, 2) : client_.upload(node, {0x1017, 0}));
        (void)sent();
        EXPECT_TRUE(client_.receive(response({0x80, 0x17, 0x10, 0x00, 0x02, 0x00, 0x01, 0x06})));
        EXPECT_EQ(client_.outcome(), Outcome::aborted);
        EXPECT_EQ(client_.abort_code(), SdoAbort::read_only);
        EXPECT_FALSE(client_.busy());
        EXPECT_TRUE(silent());
    }
}

TEST_F(SdoClientTest, SilenceEndsInATimeoutAndAnAbortCountedFromTheSend) {
    ASSERT_TRUE(client_.upload(node, {0x1000, 0}));
    now_ns_ += 10 * timeout_ns;
    EXPECT_EQ(sent()[0], 0x40) << "the time to answer starts with the send";
    now_ns_ += timeout_ns;
    EXPECT_TRUE(silent());
    EXPECT_TRUE(client_.busy());
    now_ns_ += 1;
    EXPECT_EQ(sent(), (Bytes{0x80, 0x00, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05}));
    EXPECT_FALSE(client_.busy());
    EXPECT_EQ(client_.outcome(), Outcome::timed_out);
    EXPECT_EQ(client_.abort_code(), SdoAbort::timeout);
    EXPECT_FALSE(client_.receive(response({0x43, 0x00, 0x10, 0x00, 1, 2, 3, 4}))) << "too late";
    EXPECT_EQ(client_.outcome(), Outcome::timed_out);
    EXPECT_EQ(client_.unexpected_answers(), 1U);
}

TEST_F(SdoClientTest, SegmentedAnswerIsAborted) {
    ASSERT_TRUE(client_.upload(node, {0x1008, 0}));
    (void)sent();
    EXPECT_TRUE(client_.receive(response({0x41, 0x08, 0x10, 0x00, 0x10, 0, 0, 0})));
    EXPECT_TRUE(client_.busy()) << "until its abort has left";
    EXPECT_EQ(sent(), (Bytes{0x80, 0x08, 0x10, 0x00, 0x01, 0x00, 0x04, 0x05}));
    EXPECT_FALSE(client_.busy());
    EXPECT_EQ(client_.outcome(), Outcome::aborted);
    EXPECT_EQ(client_.abort_code(), SdoAbort::command_unknown);
}

TEST_F(SdoClientTest, OfAllCommandBytesOnlyTheRightOnesEndAReadOrAWriteWell) {
    for (const bool writes : {false, true}) {
        for (unsigned command = 0; command < 256; ++command) {
            ASSERT_TRUE(writes ? client_.download(node, {0x1017, 0}, 1, 2) : client_.upload(node, {0x1017, 0}));
            (void)sent();
            EXPECT_TRUE(client_.receive(response({static_cast<std::uint8_t>(command), 0x17, 0x10, 0x00})));
            const bool right = writes ? (command & 0xE0U) == 0x60 : (command & 0xE2U) == 0x42;
            EXPECT_EQ(client_.outcome(), right ? Outcome::done : Outcome::aborted) << std::hex << command;
            EXPECT_EQ(client_.poll(now_ns_).has_value(), !right && command != 0x80) << std::hex << command;
            ASSERT_FALSE(client_.busy());
        }
    }
}

TEST_F(SdoClientTest, FramesOfOthersAndOfOtherKindsAreLeftAlone) {
    ASSERT_TRUE(client_.upload(node, {0x1000, 0}));
    const auto good = response({0x43, 0x00, 0x10, 0x00, 1, 2, 3, 4});
    EXPECT_FALSE(client_.receive(good)) << "before the request left";
    (void)sent();
    for (const auto& spoil : std::vector<std::function<void(CanFrame&)>>{
             [](CanFrame& f) { f.id = 0x595; }, [](CanFrame& f) { f.id = 0x580; }, [](CanFrame& f) { f.id = 0x600; },
             [](CanFrame& f) { f.length = 7; }, [](CanFrame& f) { f.extended = true; },
             [](CanFrame& f) { f.remote = true; }, [](CanFrame& f) { f.error = true; },
             [](CanFrame& f) { f.data[1] = 0x01; }, [](CanFrame& f) { f.data[2] = 0x11; },
             [](CanFrame& f) { f.data[3] = 0x01; }}) {
        auto bad = good;
        spoil(bad);
        EXPECT_FALSE(client_.receive(bad));
        EXPECT_TRUE(client_.busy());
    }
    EXPECT_TRUE(client_.receive(good));
    EXPECT_EQ(client_.value(), 0x04030201U);
}

TEST_F(SdoClientTest, OneTransferAtATime) {
    ASSERT_TRUE(client_.upload(node, {0x1000, 0}));
    EXPECT_FALSE(client_.upload(0x20, {0x1018, 1}));
    EXPECT_FALSE(client_.download(0x20, {0x1017, 0}, 1, 2));
    EXPECT_EQ(sent(), (Bytes{0x40, 0x00, 0x10, 0x00}));
    EXPECT_FALSE(client_.upload(node, {0x1018, 1}));
}

TEST_F(SdoClientTest, ImpossibleNodesAndSizesAreRefused) {
    EXPECT_FALSE(client_.upload(0, {0x1000, 0}));
    EXPECT_FALSE(client_.upload(128, {0x1000, 0}));
    EXPECT_FALSE(client_.download(node, {0x1017, 0}, 1, 0));
    EXPECT_FALSE(client_.download(node, {0x1017, 0}, 1, 5));
    EXPECT_FALSE(client_.busy());
    EXPECT_TRUE(client_.upload(127, {0x1000, 0}));
}

TEST_F(SdoServerTest, ReadsItsEntriesInTheirSizes) {
    EXPECT_EQ(answered({0x40, 0x00, 0x10, 0x00}), (Bytes{0x43, 0x00, 0x10, 0x00, 0x9A, 0x01, 0x03, 0x00}));
    EXPECT_EQ(answered({0x40, 0x18, 0x10, 0x02}), (Bytes{0x47, 0x18, 0x10, 0x02, 0x0C, 0x0B, 0x0A, 0x00}));
    EXPECT_EQ(answered({0x40, 0x17, 0x10, 0x00}), (Bytes{0x4B, 0x17, 0x10, 0x00, 100}));
    EXPECT_EQ(answered({0x40, 0x18, 0x10, 0x00}), (Bytes{0x4F, 0x18, 0x10, 0x00, 4}));
    EXPECT_EQ(server_.status().reads, 4U);
}

TEST_F(SdoServerTest, WriteChangesTheDictionary) {
    EXPECT_EQ(answered({0x2B, 0x17, 0x10, 0x00, 0x2C, 0x01, 0xEE, 0xEE}), (Bytes{0x60, 0x17, 0x10, 0x00}));
    EXPECT_EQ(dictionary_[1].value_raw, 300U);
    EXPECT_EQ(answered({0x22, 0x17, 0x10, 0x00, 0x90, 0x01, 0xEE, 0xEE}), (Bytes{0x60, 0x17, 0x10, 0x00}));
    EXPECT_EQ(dictionary_[1].value_raw, 400U) << "a size that is not given is the entry's";
    EXPECT_EQ(answered({0x23, 0x11, 0x10, 0x01, 'l', 'o', 'a', 'd'})[0], 0x60);
    EXPECT_EQ(dictionary_[5].value_raw, 0x64616F6CU);
    EXPECT_EQ(server_.status().writes, 3U);
}

TEST_F(SdoServerTest, RefusesWithTheRightAbortCodeAndChangesNothing) {
    const auto before = dictionary_;
    const std::vector<std::pair<Bytes, SdoAbort>> cases = {
        {{0x40, 0x01, 0x10, 0x00}, SdoAbort::no_such_object},
        {{0x2F, 0x01, 0x10, 0x00, 1}, SdoAbort::no_such_object},
        {{0x40, 0x18, 0x10, 0x05}, SdoAbort::no_such_subindex},
        {{0x2F, 0x17, 0x10, 0x01, 1}, SdoAbort::no_such_subindex},
        {{0x40, 0x11, 0x10, 0x01}, SdoAbort::write_only},
        {{0x23, 0x00, 0x10, 0x00, 1}, SdoAbort::read_only},
        {{0x2F, 0x17, 0x10, 0x00, 1}, SdoAbort::size_too_short},
        {{0x27, 0x17, 0x10, 0x00, 1}, SdoAbort::size_too_long},
        {{0x23, 0x17, 0x10, 0x00, 1}, SdoAbort::size_too_long},
        {{0x2F, 0x00, 0x18, 0x02, 241}, SdoAbort::value_too_high},
        {{0x2F, 0x00, 0x18, 0x02, 0}, SdoAbort::value_too_low},
        {{0x21, 0x17, 0x10, 0x00, 10}, SdoAbort::command_unknown},
        {{0x00, 0x17, 0x10, 0x00}, SdoAbort::command_unknown},
        {{0x60, 0x17, 0x10, 0x00}, SdoAbort::command_unknown},
        {{0xA0, 0x17, 0x10, 0x00}, SdoAbort::command_unknown},
        {{0xC0, 0x17, 0x10, 0x00}, SdoAbort::command_unknown},
        {{0xE0, 0x17, 0x10, 0x00}, SdoAbort::command_unknown},
    };
    for (const auto& [bytes, abort] : cases) {
        const auto code = static_cast<std::uint32_t>(abort);
        const Bytes expected = {0x80,
                                bytes[1],
                                bytes[2],
                                bytes[3],
                                static_cast<std::uint8_t>(code),
                                static_cast<std::uint8_t>(code >> 8U),
                                static_cast<std::uint8_t>(code >> 16U),
                                static_cast<std::uint8_t>(code >> 24U)};
        EXPECT_EQ(answered(bytes), expected) << text_of(abort);
    }
    EXPECT_EQ(server_.status().aborts, cases.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_EQ(dictionary_[i].value_raw, before[i].value_raw);
    }
}

TEST_F(SdoServerTest, LimitsThemselvesMayBeWritten) {
    for (const std::uint8_t limit : {std::uint8_t{1}, std::uint8_t{240}}) {
        EXPECT_EQ(answered({0x2F, 0x00, 0x18, 0x02, limit})[0], 0x60);
        EXPECT_EQ(dictionary_[4].value_raw, limit);
    }
}

TEST_F(SdoServerTest, AnswersNothingButRequestsToItsNode) {
    const auto good = request({0x40, 0x00, 0x10, 0x00});
    for (const auto& spoil : std::vector<std::function<void(CanFrame&)>>{
             [](CanFrame& f) { f.id = 0x615; }, [](CanFrame& f) { f.id = 0x594; }, [](CanFrame& f) { f.length = 4; },
             [](CanFrame& f) { f.extended = true; }, [](CanFrame& f) { f.remote = true; },
             [](CanFrame& f) { f.error = true; }, [](CanFrame& f) { f.data[0] = 0x80; }}) {
        auto bad = good;
        spoil(bad);
        EXPECT_FALSE(server_.answer(bad, 0).has_value());
    }
    EXPECT_TRUE(server_.answer(good, 0).has_value());
}

TEST_F(SdoServerTest, BadDictionariesAreRefusedWithTheEntrysName) {
    const auto complaint = [](std::vector<ObjectEntry> dictionary) -> std::string {
        try {
            const SdoServer server(node, dictionary);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "accepted";
    };
    using ::testing::HasSubstr;
    EXPECT_THAT(complaint({{.object = {0x1017, 0}, .size_bytes = 0}}), HasSubstr("1017h:00"));
    EXPECT_THAT(complaint({{.object = {0x1017, 0}, .size_bytes = 5}}), HasSubstr("size_bytes = 5"));
    EXPECT_THAT(complaint({{.object = {0x1017, 0}, .size_bytes = 1, .value_raw = 256}}), HasSubstr("does not fit"));
    EXPECT_THAT(complaint({{.object = {0x1017, 0}, .lowest_raw = 2, .highest_raw = 1}}), HasSubstr("lowest_raw"));
    EXPECT_THAT(complaint({{.object = {0x1017, 0}}, {.object = {0x1017, 1}}, {.object = {0x1017, 0}}}),
                HasSubstr("twice"));
}

TEST_F(SdoServerTest, ClientAndServerUnderstandEachOtherForEveryEntry) {
    SdoClient client;
    for (const auto& entry : dictionary_) {
        if (entry.access == ObjectAccess::write_only) {
            continue;
        }
        const auto expected = entry.value_raw;
        ASSERT_TRUE(client.upload(node, entry.object));
        ASSERT_TRUE(client.receive(server_.answer(client.poll(0).value(), 0).value()));
        EXPECT_EQ(client.outcome(), Outcome::done);
        EXPECT_EQ(client.value(), expected);
        EXPECT_EQ(client.size_bytes(), entry.size_bytes);
        const auto wanted = entry.value_raw + 1;
        ASSERT_TRUE(client.download(node, entry.object, wanted, entry.size_bytes));
        ASSERT_TRUE(client.receive(server_.answer(client.poll(0).value(), 0).value()));
        const bool writable = entry.access == ObjectAccess::read_write;
        EXPECT_EQ(client.outcome(), writable ? Outcome::done : Outcome::aborted);
        EXPECT_EQ(client.abort_code(), writable ? SdoAbort::none : SdoAbort::read_only);
        EXPECT_EQ(entry.value_raw, writable ? wanted : expected);
    }
}

}  // namespace
}  // namespace steadyboom::drivers
