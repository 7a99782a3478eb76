#pragma once

#include <pthread.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "runtime/file_descriptor.hpp"

namespace steadyboom::runtime {

enum class SchedulingPolicy { other, fifo };

/// What the control thread asks of the kernel.
struct RealtimeOptions {
    SchedulingPolicy policy = SchedulingPolicy::fifo;
    int priority = 80;        ///< of fifo, 1 to 99
    std::optional<int> cpu;   ///< pin to this CPU
    bool lock_memory = true;  ///< no page of the process is ever swapped or faulted in
    std::size_t prefault_stack_bytes = 256 * 1024;
    std::size_t prefault_heap_bytes = 1024 * 1024;
    bool hold_dma_latency = true;  ///< keep the CPUs out of deep sleep while the process runs
};

/// What was asked for and not granted.
struct RealtimeRefusal {
    std::string what;    ///< for example "SCHED_FIFO priority 80"
    std::string reason;  ///< the kernel's errno in words, or what was found instead
    std::string remedy;  ///< what the one who runs the machine can do
    bool essential;      ///< the loop's timing cannot be relied on without it
    [[nodiscard]] std::string message() const { return what + " refused: " + reason + "; " + remedy; }
};

/// What become_realtime() got, as read back from the kernel. Keep it as long as the thread is to be real-time: it holds
/// /dev/cpu_dma_latency open.
class RealtimeGrant {
  public:
    SchedulingPolicy policy = SchedulingPolicy::other;  ///< in effect
    int priority = 0;                                   ///< in effect
    std::optional<int> cpu;                             ///< the only CPU the thread may run on
    std::uint64_t locked_memory_bytes = 0;              ///< VmLck of the process
    std::int64_t throttle_runtime_us = 0;  ///< sched_rt_runtime_us: of each second; -1 unlimited, 0 unknown
    bool dma_latency_held = false;
    std::vector<RealtimeRefusal> refusals;  ///< everything asked for and not granted; the caller logs each

    /// Nothing essential was refused: policy, priority, CPU and memory are as asked.
    [[nodiscard]] bool complete() const noexcept;
    /// One line for the log.
    [[nodiscard]] std::string summary() const;

  private:
    friend RealtimeGrant become_realtime(const RealtimeOptions& options);
    FileDescriptor dma_latency_file_;
};

/// Makes the calling thread the real-time one: pins it, keeps freed memory in the process, locks and prefaults memory,
/// then asks for the policy last. Nothing refused is fatal; everything refused is in the grant. Call it when set-up is
/// done and every helper thread runs.
[[nodiscard]] RealtimeGrant become_realtime(const RealtimeOptions& options);

/// A thread that is never real-time: ordinary scheduling whatever its maker has, a small stack (locked memory counts it
/// whole), and all signals blocked, so that they reach the main thread. Joined, after a stop request, at destruction.
class HelperThread {
  public:
    /// Throws std::system_error when no thread can be made or it cannot be made ordinary. `name` shows in ps, 15
    /// characters at most. `work` must not throw.
    HelperThread(const std::string& name, std::function<void(std::stop_token)> work);
    ~HelperThread();
    HelperThread(const HelperThread&) = delete;
    HelperThread& operator=(const HelperThread&) = delete;

    void request_stop() noexcept { stop_.request_stop(); }

  private:
    static void* enter(void* self) noexcept;

    std::string name_;
    std::function<void(std::stop_token)> work_;
    std::stop_source stop_;
    std::atomic<int> start_error_{-1};  ///< -1: not started yet
    pthread_t thread_{};
};

}  // namespace steadyboom::runtime
