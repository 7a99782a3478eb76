// Both ends of the talk about a link over a real local socket, with a link that the test plays.
#include <sys/socket.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "controllers/interlock.hpp"
#include "runtime/can_link/link_server.hpp"
#include "runtime/can_link/link_watch.hpp"
#include "runtime/local_socket.hpp"

namespace steadyboom::runtime {
namespace {

namespace fs = std::filesystem;
using namespace controllers;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t s = 1000 * ms;

TEST(RestartBudget, AllowsNoRestartOfALinkThatIsNotOff) {
    RestartBudget budget;
    EXPECT_FALSE(budget.grant(10 * s));
    budget.see(false, 10 * s);
    EXPECT_FALSE(budget.grant(20 * s));
    EXPECT_FALSE(budget.given_up());
}

TEST(RestartBudget, AllowsOneNoSoonerThan100MillisecondsAfterBusOff) {
    RestartBudget budget;
    budget.see(true, 5 * s);
    EXPECT_FALSE(budget.grant(5 * s + 99 * ms));
    EXPECT_TRUE(budget.grant(5 * s + 100 * ms));
    budget.see(true, 5 * s + 101 * ms);
    EXPECT_FALSE(budget.grant(5 * s + 199 * ms)) << "nor after the last one";
    EXPECT_TRUE(budget.grant(5 * s + 200 * ms));
}

TEST(RestartBudget, GivesUpAtTheFourthInAMinuteUntilTheLinkIsSeenWell) {
    RestartBudget budget;
    for (int i = 0; i < 3; ++i) {
        budget.see(false, i * s);
        budget.see(true, i * s);
        EXPECT_TRUE(budget.grant(i * s + 100 * ms)) << i;
    }
    budget.see(true, 30 * s);
    EXPECT_FALSE(budget.given_up()) << "as long as nobody asks";
    EXPECT_FALSE(budget.grant(59 * s));
    EXPECT_TRUE(budget.given_up());
    EXPECT_FALSE(budget.grant(600 * s)) << "and waiting does not help";
    budget.see(false, 601 * s);
    EXPECT_FALSE(budget.given_up());
    budget.see(true, 602 * s);
    EXPECT_TRUE(budget.grant(603 * s));
    EXPECT_EQ(budget.restarts(), 4U);
}

TEST(RestartBudget, MinuteSlides) {
    RestartBudget budget;
    for (int i = 0; i < 20; ++i) {
        budget.see(true, 21 * i * s);
        EXPECT_TRUE(budget.grant(21 * i * s + 100 * ms)) << "one each 21 s is three a minute, at number " << i;
        budget.see(false, 21 * i * s + 200 * ms);
    }
}

TEST(LinkReportMeaning, EachConditionIsItsReason) {
    EXPECT_EQ(reasons_of({.condition = LinkCondition::active}), reason_none);
    EXPECT_EQ(reasons_of({.condition = LinkCondition::unknown, .virtual_bus = true}), reason_none);
    EXPECT_EQ(reasons_of({.condition = LinkCondition::stopped}), reason_none);
    EXPECT_EQ(reasons_of({.condition = LinkCondition::absent}), reason_none);
    EXPECT_EQ(reasons_of({.condition = LinkCondition::warning}), reason_error_warning);
    EXPECT_EQ(reasons_of({.condition = LinkCondition::passive}), reason_error_passive);
    EXPECT_EQ(reasons_of({.condition = LinkCondition::bus_off}), reason_bus_off);
    EXPECT_EQ(reasons_of({.condition = LinkCondition::bus_off, .given_up = true}),
              reason_bus_off | reason_bus_off_lockout);
    EXPECT_EQ(reasons_of({.condition = LinkCondition::active, .problems = link_problem_queue}), reason_bus_setup);
}

class LinkTalk : public testing::Test {
  protected:
    LinkTalk() {
        std::string name = (fs::temp_directory_path() / "steadyboom-test.XXXXXX").string();
        folder_ = mkdtemp(name.data());
    }
    ~LinkTalk() override { fs::remove_all(folder_); }

    [[nodiscard]] fs::path path() const { return folder_ / "link.sock"; }

    /// A server of the link that `link` is; a restart that works makes it active.
    LinkServerOptions options() {
        return {.socket_path = path(),
                .read = [this] { return link; },
                .restart =
                    [this] {
                        ++restarts;
                        if (restart_helps) {
                            link.condition = LinkCondition::active;
                        }
                        return true;
                    },
                .changed = [this](const LinkReport& report) { changes.push_back(report); }};
    }

    LinkWatchOptions watch_options() {
        return {.socket_path = path(),
                .set_reasons =
                    [this](std::uint32_t reasons) {
                        const std::lock_guard lock(mutex_);
                        told_.push_back(reasons);
                    },
                .may_restart = [this] { return safe.load(); },
                .log = [](const std::string&) {},
                .silence = std::chrono::milliseconds(300)};
    }

    std::uint32_t newest_reasons() {
        const std::lock_guard lock(mutex_);
        return told_.empty() ? ~0U : told_.back();
    }

    /// Steps the server, 100 ms of its time each, until `reached` or far too many.
    template <class Condition>
    bool step_until(LinkServer& server, const Condition& reached) {
        for (int i = 0; i < 3000; ++i) {
            server.step(now_ns += 100 * ms);
            if (reached()) {
                return true;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return false;
    }

    LinkReport link{.condition = LinkCondition::active, .bit_rate_bit_s = 500'000, .queue_frames = 4};
    std::vector<LinkReport> changes;
    int restarts = 0;
    bool restart_helps = true;
    std::atomic<bool> safe{true};
    std::int64_t now_ns = 0;

  private:
    fs::path folder_;
    std::mutex mutex_;
    std::vector<std::uint32_t> told_;
};

TEST_F(LinkTalk, ControllerLearnsOfEachConditionAndThatNobodyWatchesAnyMore) {
    const LinkWatch watch(watch_options());
    while (newest_reasons() != reason_bus_setup) {  // nobody there yet
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    {
        LinkServer server(options());
        EXPECT_TRUE(step_until(server, [&] { return newest_reasons() == reason_none; }));
        link.condition = LinkCondition::passive;
        EXPECT_TRUE(step_until(server, [&] { return newest_reasons() == reason_error_passive; }));
        link.condition = LinkCondition::active;
        EXPECT_TRUE(step_until(server, [&] { return newest_reasons() == reason_none; }));
    }
    while (newest_reasons() != reason_bus_setup) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    LinkServer again(options());
    EXPECT_TRUE(step_until(again, [&] { return newest_reasons() == reason_none; }));
}

TEST_F(LinkTalk, BusOffIsRestartedOnlyWhenTheMachineIsSafe) {
    safe = false;
    LinkServer server(options());
    const LinkWatch watch(watch_options());
    link.condition = LinkCondition::bus_off;
    EXPECT_TRUE(step_until(server, [&] { return newest_reasons() == reason_bus_off; }));
    for (int i = 0; i < 20; ++i) {
        server.step(now_ns += 100 * ms);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_EQ(restarts, 0);
    safe = true;
    EXPECT_TRUE(step_until(server, [&] { return newest_reasons() == reason_none; }));
    EXPECT_EQ(restarts, 1);
    EXPECT_EQ(server.report().restarts, 1U);
}

TEST_F(LinkTalk, BusOffThatRestartsDoNotCureLocksTheControllerOut) {
    restart_helps = false;
    LinkServer server(options());
    const LinkWatch watch(watch_options());
    link.condition = LinkCondition::bus_off;
    EXPECT_TRUE(step_until(server, [&] { return newest_reasons() == (reason_bus_off | reason_bus_off_lockout); }));
    EXPECT_EQ(restarts, 3);
}

TEST_F(LinkTalk, GarbageClosesTheConnectionAndANewControllerReplacesTheOld) {
    LinkServer server(options());
    const FileDescriptor first = connect_to(path());
    server.step(0);
    LinkReport report;
    ASSERT_EQ(recv(first.get(), &report, sizeof report, MSG_DONTWAIT), static_cast<ssize_t>(sizeof report));
    EXPECT_EQ(report.bit_rate_bit_s, 500'000U);
    link.condition = LinkCondition::bus_off;
    server.step(1 * s);
    ASSERT_EQ(send(first.get(), "garbage", 7, MSG_NOSIGNAL), 7);
    server.step(2 * s);
    EXPECT_EQ(restarts, 0);
    (void)recv(first.get(), &report, sizeof report, MSG_DONTWAIT);  // the report of 1 s
    EXPECT_EQ(recv(first.get(), &report, sizeof report, MSG_DONTWAIT), 0) << "closed";

    const FileDescriptor second = connect_to(path());
    server.step(3 * s);
    const FileDescriptor third = connect_to(path());
    server.step(4 * s);
    while (recv(second.get(), &report, sizeof report, MSG_DONTWAIT) > 0) {
    }
    EXPECT_EQ(recv(second.get(), &report, sizeof report, MSG_DONTWAIT), 0) << "replaced";
    EXPECT_GT(recv(third.get(), &report, sizeof report, MSG_DONTWAIT), 0);
}

TEST_F(LinkTalk, ChangesAreToldOnceAndErrorCountsAreNoChange) {
    LinkServer server(options());
    for (std::uint16_t i = 0; i < 10; ++i) {
        link.transmit_error_count = i;
        server.step(i * s);
    }
    link.bit_rate_bit_s = 250'000;
    server.step(11 * s);
    server.step(12 * s);
    ASSERT_EQ(changes.size(), 2U);
    EXPECT_EQ(changes[1].bit_rate_bit_s, 250'000U);
}

}  // namespace
}  // namespace steadyboom::runtime
