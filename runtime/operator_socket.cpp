#include "runtime/operator_socket.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "runtime/file_descriptor.hpp"
#include "runtime/local_socket.hpp"
#include "runtime/realtime_thread.hpp"

namespace steadyboom::runtime {

namespace {

constexpr int answer_poll_ms = 2;

std::string words(int error) {
    return std::generic_category().message(error);
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw std::runtime_error("operator socket " + path.string() + ": " + what);
}

FileDescriptor handed_over_by_systemd() {
    const int count = sd_listen_fds(0);
    for (int descriptor = SD_LISTEN_FDS_START; descriptor < SD_LISTEN_FDS_START + count; ++descriptor) {
        if (sd_is_socket_unix(descriptor, SOCK_SEQPACKET, 1, nullptr, 0) > 0) {
            return FileDescriptor(descriptor);
        }
    }
    return {};
}

PeerCredentials credentials_of(int descriptor) {
    PeerCredentials peer;
    ucred kernel_says{};
    socklen_t size = sizeof kernel_says;
    if (getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &kernel_says, &size) != 0) {
        // Nobody: neither root nor any owner.
        peer.uid = ~std::uint32_t{0};
        return peer;
    }
    peer.pid = kernel_says.pid;
    peer.uid = kernel_says.uid;
    std::vector<gid_t> groups(256);
    size = static_cast<socklen_t>(groups.size() * sizeof(gid_t));
    if (getsockopt(descriptor, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &size) != 0) {
        size = 0;
    }
    peer.groups.push_back(kernel_says.gid);
    peer.groups.insert(peer.groups.end(), groups.begin(),
                       groups.begin() + static_cast<std::ptrdiff_t>(size / sizeof(gid_t)));
    return peer;
}

std::uint64_t random_token() {
    std::uint64_t token = 0;
    while (token == 0) {
        if (getrandom(&token, sizeof token, 0) != sizeof token) {
            token = 0;
        }
    }
    return token;
}

bool well_formed(const OperatorMessage& message) {
    return message.magic == operator_magic && message.version == operator_protocol_version &&
           !name_of(static_cast<OperatorCommand>(message.command)).empty();
}

struct Counters {
    std::atomic<std::uint64_t> accepted_connections{0};
    std::atomic<std::uint64_t> replaced_connections{0};
    std::atomic<std::uint64_t> messages{0};
    std::atomic<std::uint64_t> malformed{0};
    std::atomic<std::uint64_t> rate_limited{0};
    std::atomic<std::uint64_t> unauthorised{0};
};

}  // namespace

bool owner_or_group_may_command(const PeerCredentials& peer, std::uint32_t own_uid, std::uint32_t socket_gid) noexcept {
    return peer.uid == 0 || peer.uid == own_uid ||
           std::find(peer.groups.begin(), peer.groups.end(), socket_gid) != peer.groups.end();
}

class OperatorSocket::Server {
  public:
    Server(OperatorSocketOptions options, OperatorMailbox& mailbox, const Clock& clock)
        : options_(std::move(options)), mailbox_(mailbox), clock_(clock), wake_(eventfd(0, EFD_CLOEXEC)) {
        listener_ = handed_over_by_systemd();
        if (!listener_.is_open()) {
            listener_ = listen_at(options_.path, options_.file_mode);
            owns_file_ = true;
        }
        learn_file();
        if (!options_.may_command) {
            options_.may_command = [gid = socket_gid_](const PeerCredentials& peer) {
                return owner_or_group_may_command(peer, geteuid(), gid);
            };
        }
        if (!options_.describe) {
            options_.describe = [](const OperatorStatus& status) {
                return "state " + std::to_string(status.state) + ", reasons " + std::to_string(status.reasons);
            };
        }
        if (!options_.log) {
            options_.log = [](const std::string&) {};
        }
        thread_.emplace("operator", [this](const std::stop_token& stop) { serve(stop); });
    }

    ~Server() {
        thread_->request_stop();
        const std::uint64_t one = 1;
        [[maybe_unused]] const ssize_t written = write(wake_.get(), &one, sizeof one);
        thread_.reset();
        struct stat facts {};
        if (owns_file_ && stat(options_.path.c_str(), &facts) == 0 && facts.st_ino == socket_inode_) {
            unlink(options_.path.c_str());
        }
    }

    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    [[nodiscard]] OperatorSocketCounters counters() const noexcept {
        return {counters_.accepted_connections.load(),
                counters_.replaced_connections.load(),
                counters_.messages.load(),
                counters_.malformed.load(),
                counters_.rate_limited.load(),
                counters_.unauthorised.load()};
    }

  private:
    struct Pending {
        std::uint64_t serial;
        OperatorCommand command;
        std::int64_t deadline_ns;
    };

    struct Connection {
        FileDescriptor socket;
        PeerCredentials peer;
        bool may_command;
        std::int64_t last_heard_ns;
        std::optional<Pending> pending;
    };

    struct Allowance {
        std::int32_t pid;
        double messages;
        std::int64_t as_of_ns;
    };

    void learn_file() {
        sockaddr_un address{};
        socklen_t size = sizeof address;
        struct stat facts {};
        if (getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0 ||
            stat(address.sun_path, &facts) != 0) {
            fail(options_.path, "the socket handed over has no file: " + words(errno));
        }
        socket_gid_ = facts.st_gid;
        socket_inode_ = facts.st_ino;
    }

    void serve(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            std::vector<pollfd> polled{{wake_.get(), POLLIN, 0}, {listener_.get(), POLLIN, 0}};
            bool pending = false;
            for (const Connection& connection : connections_) {
                const bool waits = connection.pending.has_value();
                polled.push_back({connection.socket.get(), static_cast<short>(waits ? 0 : POLLIN), 0});
                pending = pending || waits;
            }
            if (poll(polled.data(), polled.size(), pending ? answer_poll_ms : -1) < 0 && errno != EINTR) {
                options_.log("poll failed: " + words(errno));
                return;
            }
            deliver_answers();
            for (std::size_t i = 2; i < polled.size(); ++i) {
                Connection& connection = connections_[i - 2];
                if (!connection.socket.is_open() || polled[i].revents == 0) {
                    continue;
                }
                if (connection.pending) {
                    connection.socket = FileDescriptor();  // hung up before its answer
                } else {
                    receive(connection);
                }
            }
            std::erase_if(connections_, [](const Connection& connection) { return !connection.socket.is_open(); });
            if ((polled[1].revents & POLLIN) != 0) {
                accept_one();
            }
        }
    }

    void accept_one() {
        FileDescriptor socket(accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
        if (!socket.is_open()) {
            return;
        }
        if (connections_.size() >= static_cast<std::size_t>(std::max(1, options_.connections))) {
            const auto idlest = std::min_element(connections_.begin(), connections_.end(),
                                                 [](const Connection& a, const Connection& b) {
                                                     return std::pair(a.pending.has_value(), a.last_heard_ns) <
                                                            std::pair(b.pending.has_value(), b.last_heard_ns);
                                                 });
            options_.log("too many connections, closing that of " + who(idlest->peer));
            connections_.erase(idlest);
            ++counters_.replaced_connections;
        }
        PeerCredentials peer = credentials_of(socket.get());
        const bool may_command = options_.may_command(peer);
        connections_.push_back({std::move(socket), std::move(peer), may_command, clock_.now_ns(), std::nullopt});
        ++counters_.accepted_connections;
    }

    void receive(Connection& connection) {
        OperatorMessage message;
        const ssize_t bytes = recv(connection.socket.get(), &message, sizeof message, MSG_TRUNC | MSG_DONTWAIT);
        if (bytes == 0 || (bytes < 0 && errno != EAGAIN)) {
            connection.socket = FileDescriptor();
            return;
        }
        if (bytes < 0) {
            return;
        }
        ++counters_.messages;
        connection.last_heard_ns = clock_.now_ns();
        if (!within_rate(connection.peer.pid)) {
            ++counters_.rate_limited;
            options_.log("too many messages, closing the connection of " + who(connection.peer));
            reply(connection, OperatorResult::rate_limited);
            connection.socket = FileDescriptor();
            return;
        }
        if (bytes != sizeof message || !well_formed(message)) {
            ++counters_.malformed;
            options_.log("not an operator message, closing the connection of " + who(connection.peer));
            connection.socket = FileDescriptor();
            return;
        }
        handle(connection, static_cast<OperatorCommand>(message.command), message.token);
    }

    void handle(Connection& connection, OperatorCommand command, std::uint64_t token) {
        if (command == OperatorCommand::status) {
            reply(connection, OperatorResult::done);
            return;
        }
        if (!connection.may_command) {
            ++counters_.unauthorised;
            log_outcome(connection, command, OperatorResult::unauthorised);
            reply(connection, OperatorResult::unauthorised);
            return;
        }
        const bool token_holds = token_ != 0 && token == token_ && clock_.now_ns() < token_deadline_ns_;
        if (command == OperatorCommand::engage && !token_holds) {
            log_outcome(connection, command, OperatorResult::bad_token);
            reply(connection, OperatorResult::bad_token);
            return;
        }
        token_ = 0;
        OperatorRequest request;
        request.serial = ++serial_;
        request.command = command;
        request.peer_pid = connection.peer.pid;
        request.peer_uid = connection.peer.uid;
        if (!mailbox_.try_push(request)) {
            log_outcome(connection, command, OperatorResult::busy);
            reply(connection, OperatorResult::busy);
            return;
        }
        connection.pending = {serial_, command, clock_.now_ns() + options_.answer_timeout_ns};
    }

    void deliver_answers() {
        while (const std::optional<OperatorAnswer> answer = mailbox_.try_pop_answer()) {
            for (Connection& connection : connections_) {
                if (connection.pending && connection.pending->serial == answer->serial) {
                    finish(connection, answer->result, answer->reasons);
                }
            }
        }
        for (Connection& connection : connections_) {
            if (connection.pending && clock_.now_ns() >= connection.pending->deadline_ns) {
                finish(connection, OperatorResult::no_answer, std::nullopt);
            }
        }
    }

    void finish(Connection& connection, OperatorResult result, std::optional<std::uint32_t> reasons) {
        const OperatorCommand command = connection.pending->command;
        connection.pending.reset();
        std::uint64_t token = 0;
        if (command == OperatorCommand::arm && result == OperatorResult::done) {
            token = token_ = random_token();
            token_deadline_ns_ = clock_.now_ns() + options_.token_lifetime_ns;
        }
        log_outcome(connection, command, result);
        reply(connection, result, result == OperatorResult::refused ? reasons : std::nullopt, token);
    }

    void reply(Connection& connection, OperatorResult result, std::optional<std::uint32_t> reasons = std::nullopt,
               std::uint64_t token = 0) {
        OperatorStatus status = mailbox_.status();
        status.reasons = reasons.value_or(status.reasons);
        OperatorReply message;
        message.result = static_cast<std::uint16_t>(result);
        message.state = status.state;
        message.reasons = status.reasons;
        message.tick = status.tick;
        message.tick_age_ns = status.time_ns == 0 ? -1 : std::max<std::int64_t>(0, clock_.now_ns() - status.time_ns);
        message.token = token;
        const std::string text = options_.describe(status);
        text.copy(message.text.data(), message.text.size() - 1);
        // A peer that does not read its replies loses its connection.
        if (send(connection.socket.get(), &message, sizeof message, MSG_NOSIGNAL | MSG_DONTWAIT) != sizeof message) {
            connection.socket = FileDescriptor();
        }
    }

    // One allowance for each process, whatever number of connections it has or had.
    bool within_rate(std::int32_t pid) {
        const std::int64_t now_ns = clock_.now_ns();
        for (Allowance& allowance : allowances_) {
            const double elapsed_s = static_cast<double>(now_ns - allowance.as_of_ns) * 1e-9;
            allowance.messages =
                std::min(options_.messages_per_s, allowance.messages + elapsed_s * options_.messages_per_s);
            allowance.as_of_ns = now_ns;
        }
        std::erase_if(allowances_, [&](const Allowance& allowance) {
            return allowance.pid != pid && allowance.messages >= options_.messages_per_s;
        });
        auto own = std::find_if(allowances_.begin(), allowances_.end(),
                                [&](const Allowance& allowance) { return allowance.pid == pid; });
        if (own == allowances_.end()) {
            own = allowances_.insert(own, {pid, options_.messages_per_s, now_ns});
        }
        if (own->messages < 1.0) {
            return false;
        }
        own->messages -= 1.0;
        return true;
    }

    void log_outcome(const Connection& connection, OperatorCommand command, OperatorResult result) {
        options_.log(std::string(name_of(command)) + " from " + who(connection.peer) + ": " +
                     std::string(name_of(result)));
    }

    static std::string who(const PeerCredentials& peer) {
        return "process " + std::to_string(peer.pid) + " of user " + std::to_string(peer.uid);
    }

    OperatorSocketOptions options_;
    OperatorMailbox& mailbox_;
    const Clock& clock_;
    FileDescriptor wake_;
    FileDescriptor listener_;
    bool owns_file_ = false;
    std::uint32_t socket_gid_ = 0;
    std::uint64_t socket_inode_ = 0;

    std::vector<Connection> connections_;
    std::vector<Allowance> allowances_;
    std::uint64_t serial_ = 0;
    std::uint64_t token_ = 0;  ///< 0: none
    std::int64_t token_deadline_ns_ = 0;
    Counters counters_;
    std::optional<HelperThread> thread_;
};

OperatorSocket::OperatorSocket(OperatorSocketOptions options, OperatorMailbox& mailbox, const Clock& clock)
    : server_(std::make_unique<Server>(std::move(options), mailbox, clock)) {}

OperatorSocket::~OperatorSocket() = default;

OperatorSocketCounters OperatorSocket::counters() const noexcept {
    return server_->counters();
}

}  // namespace steadyboom::runtime
