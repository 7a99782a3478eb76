#include "runtime/realtime_thread.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <string>
#include <thread>

namespace steadyboom::runtime {
namespace {

using testing::HasSubstr;

// become_realtime() changes its whole process, so that each of these asks for it in a process of its own.
template <class Body>
void in_own_process(Body body) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        body();
        std::fflush(nullptr);
        _exit(testing::Test::HasFailure() ? 1 : 0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 0) << "the failures of the other process are printed above";
}

// Nothing above what any user may have.
void give_up_rights() {
    const rlimit none{0, 0};
    setrlimit(RLIMIT_RTPRIO, &none);
    setrlimit(RLIMIT_MEMLOCK, &none);
    if (geteuid() == 0) {
        ASSERT_EQ(setgid(65534), 0);
        ASSERT_EQ(setuid(65534), 0);
    }
}

const RealtimeRefusal* refusal_of(const RealtimeGrant& grant, const std::string& what) {
    for (const RealtimeRefusal& refusal : grant.refusals) {
        if (refusal.what.find(what) != std::string::npos) {
            return &refusal;
        }
    }
    return nullptr;
}

TEST(BecomeRealtime, WithoutRightsEveryRefusalIsReportedWithReasonAndRemedyAndNothingIsClaimed) {
    in_own_process([] {
        give_up_rights();
        const RealtimeGrant grant = become_realtime({});
        EXPECT_FALSE(grant.complete());
        EXPECT_EQ(grant.policy, SchedulingPolicy::other);
        EXPECT_EQ(grant.priority, 0);
        EXPECT_EQ(grant.locked_memory_bytes, 0U);

        const RealtimeRefusal* fifo = refusal_of(grant, "SCHED_FIFO priority 80");
        ASSERT_NE(fifo, nullptr);
        EXPECT_THAT(fifo->message(), HasSubstr("refused: Operation not permitted (RLIMIT_RTPRIO is 0); set "
                                               "LimitRTPRIO=99"));
        const RealtimeRefusal* memory = refusal_of(grant, "locking memory");
        ASSERT_NE(memory, nullptr);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
        // Their mlockall does nothing and says it did: only the look at VmLck notices.
        EXPECT_THAT(memory->message(), HasSubstr("the kernel reports VmLck 0 although it agreed"));
#else
        EXPECT_THAT(memory->message(), HasSubstr("(RLIMIT_MEMLOCK is 0 bytes); set LimitMEMLOCK=infinity"));
#endif
        EXPECT_EQ(refusal_of(grant, "/dev/cpu_dma_latency") == nullptr, grant.dma_latency_held);
        EXPECT_THAT(grant.summary(), HasSubstr("SCHED_OTHER"));
    });
}

TEST(BecomeRealtime, AnImpossibleCpuOrPriorityIsARefusalThatNamesIt) {
    in_own_process([] {
        RealtimeOptions options;
        options.cpu = 100'000;
        options.priority = 120;
        options.lock_memory = false;
        const RealtimeGrant grant = become_realtime(options);
        EXPECT_FALSE(grant.cpu);
        const RealtimeRefusal* cpu = refusal_of(grant, "CPU 100000");
        ASSERT_NE(cpu, nullptr);
        EXPECT_THAT(cpu->reason, HasSubstr("Invalid argument"));
        const RealtimeRefusal* fifo = refusal_of(grant, "SCHED_FIFO priority 120");
        ASSERT_NE(fifo, nullptr);
        EXPECT_THAT(fifo->remedy, HasSubstr("from 1 to 99"));
    });
}

TEST(BecomeRealtime, WhatTheGrantSaysIsWhatTheKernelSays) {
    in_own_process([] {
        cpu_set_t allowed;
        ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
        int cpu = 0;
        while (!CPU_ISSET(static_cast<std::size_t>(cpu), &allowed)) {
            ++cpu;
        }
        RealtimeOptions options;
        options.cpu = cpu;
        options.priority = 7;
        const RealtimeGrant grant = become_realtime(options);

        sched_param effective{};
        sched_getparam(0, &effective);
        const bool is_fifo = sched_getscheduler(0) == (SCHED_FIFO | SCHED_RESET_ON_FORK);
        EXPECT_EQ(grant.policy == SchedulingPolicy::fifo, is_fifo);
        EXPECT_EQ(grant.priority, effective.sched_priority);
        EXPECT_EQ(refusal_of(grant, "SCHED_FIFO") == nullptr, is_fifo);
        EXPECT_EQ(refusal_of(grant, "locking memory") == nullptr, grant.locked_memory_bytes > 0);
        ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
        EXPECT_EQ(grant.cpu, cpu);
        EXPECT_EQ(CPU_COUNT(&allowed), 1);
        EXPECT_LE(grant.locked_memory_bytes, 16U * 1024 * 1024);
    });
}

TEST(BecomeRealtime, WhatItsUnitGaveItAlreadyCountsWhereAskingForItIsForbidden) {
    in_own_process([] {
        sched_param before{};
        before.sched_priority = 12;
        const bool given = sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &before) == 0;
        give_up_rights();
        const RealtimeGrant grant = become_realtime({.priority = 12, .lock_memory = false, .hold_dma_latency = false});
        EXPECT_EQ(grant.complete(), given);
        EXPECT_EQ(grant.priority, given ? 12 : 0);
        EXPECT_FALSE(become_realtime({.priority = 13, .lock_memory = false}).complete());
    });
}

TEST(BecomeRealtime, AskingForNothingIsGrantedWhole) {
    in_own_process([] {
        const RealtimeGrant grant =
            become_realtime({.policy = SchedulingPolicy::other, .lock_memory = false, .hold_dma_latency = false});
        EXPECT_TRUE(grant.complete());
        EXPECT_FALSE(grant.dma_latency_held);
    });
}

TEST(BecomeRealtime, MemoryAndPolicyOfHelpersMadeLaterStayOrdinary) {
    in_own_process([] {
        const RealtimeGrant grant = become_realtime({.priority = 5});
        std::atomic<int> policy{-1};
        {
            const HelperThread helper("helper", [&](const std::stop_token&) { policy = sched_getscheduler(0); });
        }
        EXPECT_EQ(policy, SCHED_OTHER);
    });
}

TEST(HelperThread, RunsNamedWithAllSignalsBlockedUntilAskedToStop) {
    std::atomic<bool> blocked{false};
    std::atomic<bool> started{false};
    {
        const HelperThread helper("a-name-that-is-too-long", [&](const std::stop_token& stop) {
            sigset_t mask;
            pthread_sigmask(SIG_SETMASK, nullptr, &mask);
            blocked = sigismember(&mask, SIGTERM) == 1 && sigismember(&mask, SIGINT) == 1;
            started = true;
            while (!stop.stop_requested()) {
                std::this_thread::yield();
            }
        });
        while (!started) {
            std::this_thread::yield();
        }
        sigset_t mask;
        pthread_sigmask(SIG_SETMASK, nullptr, &mask);
        EXPECT_EQ(sigismember(&mask, SIGTERM), 0) << "the maker's own mask is as before";
    }
    EXPECT_TRUE(blocked);
}

}  // namespace
}  // namespace steadyboom::runtime
