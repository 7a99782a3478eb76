#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "runtime/clock.hpp"
#include "runtime/operator_mailbox.hpp"
#include "runtime/operator_protocol.hpp"

namespace steadyboom::runtime {

/// Who is at the other end, as the kernel says (SO_PEERCRED, SO_PEERGROUPS).
struct PeerCredentials {
    std::int32_t pid = 0;
    std::uint32_t uid = 0;
    std::vector<std::uint32_t> groups;  ///< primary group first
};

/// Root, the controller's own user, and members of the group that owns the socket's file may command.
[[nodiscard]] bool owner_or_group_may_command(const PeerCredentials& peer, std::uint32_t own_uid,
                                              std::uint32_t socket_gid) noexcept;

struct OperatorSocketOptions {
    /// Where to listen. A socket handed over by systemd (LISTEN_FDS) takes precedence.
    std::filesystem::path path;
    std::uint32_t file_mode = 0660;

    int connections = 8;                              ///< open at once; one more replaces the longest idle one
    double messages_per_s = 50.0;                     ///< sustained and burst bound of one peer process
    std::int64_t answer_timeout_ns = 500'000'000;     ///< until a command the tick has not answered is no_answer
    std::int64_t token_lifetime_ns = 30'000'000'000;  ///< from arm to engage

    /// Puts a status into words for the reply. Runs on the socket's thread.
    std::function<std::string(const OperatorStatus&)> describe;
    /// Who may do more than ask for the status; owner_or_group_may_command when empty.
    std::function<bool(const PeerCredentials&)> may_command;
    /// One line for the log: accepted commands with their sender, refusals, closed connections. Runs on the socket's
    /// thread.
    std::function<void(const std::string&)> log;
};

struct OperatorSocketCounters {
    std::uint64_t accepted_connections = 0;
    std::uint64_t replaced_connections = 0;  ///< closed to make room
    std::uint64_t messages = 0;
    std::uint64_t malformed = 0;
    std::uint64_t rate_limited = 0;
    std::uint64_t unauthorised = 0;
};

/// Listens for operators on a thread of its own (ordinary scheduling, all signals blocked) and passes their commands to
/// the control tick through the mailbox. Nothing a peer does reaches the tick but whole, authorised commands, at most
/// OperatorMailbox::capacity waiting.
///
/// Arm yields a random one-time token; engage needs it within the token's lifetime, and any other command but status
/// revokes it. Make it before become_realtime(): the thread keeps the affinity of its maker.
class OperatorSocket {
  public:
    /// Binds and listens at once; throws std::runtime_error naming the path and the remedy (in use by a live process,
    /// no such folder, no permission). A stale socket file is replaced. `clock` must outlive this.
    OperatorSocket(OperatorSocketOptions options, OperatorMailbox& mailbox, const Clock& clock);
    ~OperatorSocket();
    OperatorSocket(const OperatorSocket&) = delete;
    OperatorSocket& operator=(const OperatorSocket&) = delete;

    /// From any thread.
    [[nodiscard]] OperatorSocketCounters counters() const noexcept;

  private:
    class Server;
    std::unique_ptr<Server> server_;
};

}  // namespace steadyboom::runtime
