#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <boost/lockfree/spsc_queue.hpp>

#include "drivers/network_config.hpp"
#include "runtime/seqlock.hpp"

namespace steadyboom::runtime {

enum class OperatorCommand : std::uint16_t {
    status = 1,  ///< answered from the last snapshot; never reaches the tick
    arm = 2,     ///< answered with the one-time token that engage needs
    engage = 3,
    disengage = 4,
    reset = 5,
    stop = 6,
};

enum class OperatorResult : std::uint16_t {
    done = 0,
    refused = 1,       ///< the tick said no; `reasons` say why
    bad_token = 2,     ///< engage without the token of the latest arm, or too late
    unauthorised = 3,  ///< this peer may only ask for the status
    busy = 4,          ///< the tick has not yet taken earlier requests
    no_answer = 5,     ///< the tick did not answer in time; the command may still take effect
    rate_limited = 6,  ///< too many messages; the connection is closed
};

/// A command on its way to the tick, with who sent it.
struct OperatorRequest {
    std::uint64_t serial = 0;
    OperatorCommand command = OperatorCommand::status;
    std::int32_t peer_pid = 0;
    std::uint32_t peer_uid = 0;
};

/// What the tick did with a request.
struct OperatorAnswer {
    std::uint64_t serial = 0;
    OperatorResult result = OperatorResult::refused;
    std::uint32_t reasons = 0;
};

/// What the tick tells the world each time it runs. `state` and `reasons` mean what the interlock says they mean.
struct OperatorStatus {
    std::uint64_t tick = 0;
    std::int64_t time_ns = 0;  ///< steady time of that tick; 0 before the first
    std::uint32_t state = 0;
    std::uint32_t reasons = 0;
    std::array<std::uint8_t, drivers::device_count> device_state{};     ///< drivers::DeviceState
    std::array<std::uint16_t, drivers::device_count> emergency_code{};  ///< in force, 0: none
};

/// Requests to the control tick and its answers, with no lock between the tick and the rest of the process.
/// One thread uses the tick's side and one thread the socket's side.
class OperatorMailbox {
  public:
    static constexpr std::size_t capacity = 16;

    // The tick's side: noexcept, wait-free, no allocation.

    /// The oldest request not yet taken. Take at most one a tick: a flood of requests must not lengthen a tick.
    [[nodiscard]] std::optional<OperatorRequest> try_pop() noexcept {
        OperatorRequest request;
        return requests_.pop(request) ? std::optional(request) : std::nullopt;
    }

    /// Says what became of a request taken by try_pop(). False when the socket's side has stopped listening.
    bool answer(const OperatorRequest& request, OperatorResult result, std::uint32_t reasons = 0) noexcept {
        return answers_.push(OperatorAnswer{request.serial, result, reasons});
    }

    void publish(const OperatorStatus& status) noexcept { status_.store(status); }

    // The socket's side.

    [[nodiscard]] bool try_push(const OperatorRequest& request) noexcept { return requests_.push(request); }

    [[nodiscard]] std::optional<OperatorAnswer> try_pop_answer() noexcept {
        OperatorAnswer answer;
        return answers_.pop(answer) ? std::optional(answer) : std::nullopt;
    }

    /// From any thread.
    [[nodiscard]] OperatorStatus status() const noexcept { return status_.load(); }

  private:
    boost::lockfree::spsc_queue<OperatorRequest, boost::lockfree::capacity<capacity>> requests_;
    boost::lockfree::spsc_queue<OperatorAnswer, boost::lockfree::capacity<2 * capacity>> answers_;
    Seqlock<OperatorStatus> status_;
};

}  // namespace steadyboom::runtime
