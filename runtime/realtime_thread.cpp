#include "runtime/realtime_thread.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <system_error>
#include <utility>

namespace steadyboom::runtime {

namespace {

constexpr std::size_t helper_stack_bytes = 256 * 1024;

std::string words(int error) {
    return std::generic_category().message(error);
}

// Each further arena of the heap reserves 64 MiB, and locked memory counts what is reserved.
void share_one_arena() {
    mallopt(M_ARENA_MAX, 1);
}

std::uint64_t locked_memory_bytes() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("VmLck:")) {
            return std::stoull(line.substr(6)) * 1024;
        }
    }
    return 0;
}

std::int64_t throttle_runtime_us() {
    std::int64_t runtime_us = 0;
    std::ifstream("/proc/sys/kernel/sched_rt_runtime_us") >> runtime_us;
    return runtime_us;
}

std::string limit_in_words(int resource) {
    rlimit limit{};
    getrlimit(static_cast<__rlimit_resource_t>(resource), &limit);
    return limit.rlim_cur == RLIM_INFINITY ? "unlimited" : std::to_string(limit.rlim_cur);
}

// Recursion would be optimised into a loop over one frame; alloca takes the bytes in one go, and the volatile stores
// touch each page.
[[gnu::noinline]] void prefault_stack(std::size_t bytes) {
    auto* stack = static_cast<volatile unsigned char*>(__builtin_alloca(bytes));
    for (std::size_t i = 0; i < bytes; i += 4096) {
        stack[i] = 0;
    }
}

void prefault_heap(std::size_t bytes) {
    const std::unique_ptr<unsigned char[]> heap(new unsigned char[bytes]);
    auto* touched = static_cast<volatile unsigned char*>(heap.get());
    for (std::size_t i = 0; i < bytes; i += 4096) {
        touched[i] = 0;
    }
}

void pin(int cpu, RealtimeGrant& grant) {
    int error = EINVAL;
    if (cpu >= 0 && cpu < CPU_SETSIZE) {
        cpu_set_t wanted;
        CPU_ZERO(&wanted);
        CPU_SET(static_cast<std::size_t>(cpu), &wanted);
        error = sched_setaffinity(0, sizeof wanted, &wanted) == 0 ? 0 : errno;
        cpu_set_t effective;
        if (sched_getaffinity(0, sizeof effective, &effective) == 0 && CPU_EQUAL(&effective, &wanted)) {
            grant.cpu = cpu;
            return;
        }
    }
    grant.refusals.push_back({"CPU " + std::to_string(cpu), words(error),
                              "name one of the " + std::to_string(sysconf(_SC_NPROCESSORS_ONLN)) +
                                  " CPUs of this machine that the process may use (CPUAffinity=, AllowedCPUs=)",
                              true});
}

void lock_memory(const RealtimeOptions& options, RealtimeGrant& grant) {
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
        const int error = errno;
        grant.refusals.push_back({"locking memory",
                                  words(error) + " (RLIMIT_MEMLOCK is " + limit_in_words(RLIMIT_MEMLOCK) + " bytes)",
                                  "set LimitMEMLOCK=infinity in the unit, or give the program CAP_IPC_LOCK", true});
        return;
    }
    prefault_stack(options.prefault_stack_bytes);
    prefault_heap(options.prefault_heap_bytes);
    grant.locked_memory_bytes = locked_memory_bytes();
    if (grant.locked_memory_bytes == 0) {
        grant.refusals.push_back({"locking memory", "the kernel reports VmLck 0 although it agreed",
                                  "run on a kernel or container that keeps mlockall", true});
    }
}

void schedule(const RealtimeOptions& options, RealtimeGrant& grant) {
    const bool wants_fifo = options.policy == SchedulingPolicy::fifo;
    sched_param wanted{};
    wanted.sched_priority = wants_fifo ? options.priority : 0;
    const int error =
        sched_setscheduler(0, wants_fifo ? SCHED_FIFO | SCHED_RESET_ON_FORK : SCHED_OTHER, &wanted) == 0 ? 0 : errno;

    const int policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
    sched_param effective{};
    sched_getparam(0, &effective);
    grant.policy = policy == SCHED_FIFO ? SchedulingPolicy::fifo : SchedulingPolicy::other;
    grant.priority = effective.sched_priority;
    if (policy == (wants_fifo ? SCHED_FIFO : SCHED_OTHER) && effective.sched_priority == wanted.sched_priority) {
        return;
    }
    grant.refusals.push_back(
        {wants_fifo ? "SCHED_FIFO priority " + std::to_string(options.priority) : "SCHED_OTHER",
         error != 0 ? words(error) + " (RLIMIT_RTPRIO is " + limit_in_words(RLIMIT_RTPRIO) + ")"
                    : "the kernel put policy " + std::to_string(policy) + " in effect",
         error == EINVAL ? "give a priority from 1 to 99"
                         : "set LimitRTPRIO=99 in the unit without CPUWeight= or CPUQuota=, or give the program "
                           "CAP_SYS_NICE",
         true});
}

FileDescriptor hold_dma_latency(RealtimeGrant& grant) {
    FileDescriptor file(open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC));
    const std::int32_t latency_us = 0;
    if (!file.is_open() || write(file.get(), &latency_us, sizeof latency_us) != sizeof latency_us) {
        grant.refusals.push_back({"/dev/cpu_dma_latency", words(errno),
                                  "let the user write it (DeviceAllow=, udev), or accept wake-ups a few times later",
                                  false});
        return {};
    }
    grant.dma_latency_held = true;
    return file;
}

}  // namespace

bool RealtimeGrant::complete() const noexcept {
    return std::none_of(refusals.begin(), refusals.end(),
                        [](const RealtimeRefusal& refusal) { return refusal.essential; });
}

std::string RealtimeGrant::summary() const {
    std::ostringstream line;
    line << (policy == SchedulingPolicy::fifo ? "SCHED_FIFO priority " + std::to_string(priority) : "SCHED_OTHER")
         << ", CPU " << (cpu ? std::to_string(*cpu) : "any") << ", " << locked_memory_bytes / 1024
         << " KiB of memory locked, " << (dma_latency_held ? "deep sleep held off" : "deep sleep allowed");
    if (throttle_runtime_us > 0) {
        line << ", kernel throttles real-time to " << throttle_runtime_us << " us of each second";
    }
    return line.str();
}

RealtimeGrant become_realtime(const RealtimeOptions& options) {
    RealtimeGrant grant;
    grant.throttle_runtime_us = throttle_runtime_us();
    if (options.cpu) {
        pin(*options.cpu, grant);
    }
    // Freed memory stays in the heap.
    mallopt(M_TRIM_THRESHOLD, INT_MAX);
    mallopt(M_TOP_PAD, 64 * 1024);
    mallopt(M_MMAP_MAX, 0);
    share_one_arena();
    if (options.lock_memory) {
        lock_memory(options, grant);
    }
    if (options.hold_dma_latency) {
        grant.dma_latency_file_ = hold_dma_latency(grant);
    }
    schedule(options, grant);
    return grant;
}

HelperThread::HelperThread(const std::string& name, std::function<void(std::stop_token)> work)
    : name_(name.substr(0, 15)), work_(std::move(work)) {
    share_one_arena();
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, helper_stack_bytes);

    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int error = pthread_create(&thread_, &attributes, &HelperThread::enter, this);
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    pthread_attr_destroy(&attributes);
    if (error == 0) {
        start_error_.wait(-1);
        error = start_error_;
        if (error != 0) {
            pthread_join(thread_, nullptr);
        }
    }
    if (error != 0) {
        throw std::system_error(error, std::generic_category(), "cannot start the ordinary thread " + name_);
    }
}

HelperThread::~HelperThread() {
    stop_.request_stop();
    pthread_join(thread_, nullptr);
}

// The thread makes itself ordinary: attributes that ask for it would fail where a unit's system call filter forbids
// asking, even for a thread that is ordinary already because its maker's policy is reset on fork.
void* HelperThread::enter(void* self) noexcept {
    auto* thread = static_cast<HelperThread*>(self);
    pthread_setname_np(pthread_self(), thread->name_.c_str());
    const sched_param ordinary{};
    const bool is_ordinary = sched_getscheduler(0) == SCHED_OTHER || sched_setscheduler(0, SCHED_OTHER, &ordinary) == 0;
    const int error = is_ordinary ? 0 : errno;
    thread->start_error_ = error;
    thread->start_error_.notify_one();
    if (error == 0) {
        thread->work_(thread->stop_.get_token());
    }
    return nullptr;
}

}  // namespace steadyboom::runtime
