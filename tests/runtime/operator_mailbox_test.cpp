#include "runtime/operator_mailbox.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "runtime/realtime_section.hpp"

namespace steadyboom::runtime {
namespace {

OperatorRequest request(std::uint64_t serial) {
    OperatorRequest made;
    made.serial = serial;
    made.command = OperatorCommand::stop;
    return made;
}

TEST(OperatorMailbox, RequestsComeOutInOrderAndAnswersGoBack) {
    OperatorMailbox mailbox;
    EXPECT_FALSE(mailbox.try_pop());
    EXPECT_TRUE(mailbox.try_push(request(1)));
    EXPECT_TRUE(mailbox.try_push(request(2)));
    const auto first = mailbox.try_pop();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->serial, 1U);
    EXPECT_EQ(first->command, OperatorCommand::stop);
    EXPECT_TRUE(mailbox.answer(*first, OperatorResult::refused, 0x12));
    const auto answer = mailbox.try_pop_answer();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->serial, 1U);
    EXPECT_EQ(answer->result, OperatorResult::refused);
    EXPECT_EQ(answer->reasons, 0x12U);
    EXPECT_EQ(mailbox.try_pop()->serial, 2U);
}

TEST(OperatorMailbox, AFullMailboxRefusesAndLosesNothingItTook) {
    OperatorMailbox mailbox;
    std::uint64_t taken = 0;
    while (mailbox.try_push(request(taken))) {
        ++taken;
    }
    EXPECT_EQ(taken, OperatorMailbox::capacity);
    for (std::uint64_t serial = 0; serial < taken; ++serial) {
        EXPECT_EQ(mailbox.try_pop()->serial, serial);
    }
    EXPECT_FALSE(mailbox.try_pop());
}

TEST(OperatorMailbox, TheTicksSideNeitherAllocatesNorWaitsForAnyone) {
    OperatorMailbox mailbox;
    ASSERT_TRUE(mailbox.try_push(request(1)));
    const RealtimeSection section;
    for (std::uint64_t tick = 0; tick < 100; ++tick) {
        if (const auto got = mailbox.try_pop()) {
            mailbox.answer(*got, OperatorResult::done);
        }
        OperatorStatus status;
        status.tick = tick;
        mailbox.publish(status);
    }
}

TEST(OperatorMailbox, AStatusReadWhileTheTickPublishesIsNeverTorn) {
    OperatorMailbox mailbox;
    std::atomic<bool> stop{false};
    std::thread tick([&] {
        for (std::uint32_t i = 1; !stop; ++i) {
            mailbox.publish({i, static_cast<std::int64_t>(i), i, i});
        }
    });
    std::uint64_t newest = 0;
    for (int i = 0; i < 100'000 || newest == 0; ++i) {
        const OperatorStatus status = mailbox.status();
        ASSERT_EQ(status.tick, status.state);
        ASSERT_EQ(status.tick, status.reasons);
        ASSERT_EQ(static_cast<std::int64_t>(status.tick), status.time_ns);
        ASSERT_GE(status.tick, newest);
        newest = status.tick;
    }
    stop = true;
    tick.join();
}

}  // namespace
}  // namespace steadyboom::runtime
