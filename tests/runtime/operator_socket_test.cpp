#include "runtime/operator_socket.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "runtime/file_descriptor.hpp"
#include "runtime/operator_client.hpp"

namespace steadyboom::runtime {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Property;
using testing::Throws;

// The tick's side as a thread that answers at once, as the test says.
class AnsweringTick {
  public:
    explicit AnsweringTick(OperatorMailbox& mailbox)
        : thread_([this, &mailbox] {
              while (!stop_) {
                  if (const auto request = mailbox.try_pop()) {
                      const std::lock_guard lock(mutex_);
                      commands_.push_back(request->command);
                      peer_pid_ = request->peer_pid;
                      mailbox.answer(*request, result, reasons);
                  }
                  std::this_thread::yield();
              }
          }) {}
    ~AnsweringTick() {
        stop_ = true;
        thread_.join();
    }
    std::vector<OperatorCommand> commands() {
        const std::lock_guard lock(mutex_);
        return commands_;
    }
    std::int32_t peer_pid() {
        const std::lock_guard lock(mutex_);
        return peer_pid_;
    }
    std::atomic<OperatorResult> result{OperatorResult::done};
    std::atomic<std::uint32_t> reasons{0};

  private:
    std::mutex mutex_;
    std::vector<OperatorCommand> commands_;
    std::int32_t peer_pid_ = 0;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

class OperatorSocketTest : public testing::Test {
  protected:
    OperatorSocketTest() {
        options_.path = path_;
        options_.describe = [](const OperatorStatus& status) { return "because of " + std::to_string(status.reasons); };
    }
    ~OperatorSocketTest() override { std::filesystem::remove_all(folder_); }

    void listen() { socket_.emplace(options_, mailbox_, clock_); }
    OperatorClient connect() { return OperatorClient(path_); }

    FileDescriptor connect_raw() {
        FileDescriptor raw(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path, path_.c_str(), path_.native().size());
        EXPECT_EQ(::connect(raw.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
        return raw;
    }

    // Waits for the server to hang up without having said anything.
    static bool closed_without_reply(const FileDescriptor& raw) {
        char byte = 0;
        const ssize_t bytes = recv(raw.get(), &byte, 1, 0);
        return bytes == 0 || (bytes < 0 && errno == ECONNRESET);
    }

    std::filesystem::path folder_ = [] {
        std::string name = testing::TempDir() + "steadyboom-operator-XXXXXX";
        return std::filesystem::path(mkdtemp(name.data()));
    }();
    std::filesystem::path path_ = folder_ / "operator.sock";
    SimulatedClock clock_{1'000'000'000};
    OperatorMailbox mailbox_;
    OperatorSocketOptions options_;
    std::optional<OperatorSocket> socket_;
};

TEST_F(OperatorSocketTest, StatusIsAnsweredFromTheNewestSnapshotWithoutTheTick) {
    listen();
    auto client = connect();
    EXPECT_EQ(client.request(OperatorCommand::status).tick_age_ns, -1) << "no tick yet";

    mailbox_.publish({.tick = 42, .time_ns = clock_.now_ns() - 3'000'000, .state = 5, .reasons = 9});
    const OperatorReply reply = client.request(OperatorCommand::status);
    EXPECT_EQ(reply.outcome(), OperatorResult::done);
    EXPECT_EQ(reply.tick, 42U);
    EXPECT_EQ(reply.tick_age_ns, 3'000'000);
    EXPECT_EQ(reply.state, 5U);
    EXPECT_EQ(reply.reasons, 9U);
    EXPECT_EQ(reply.words(), "because of 9");
    EXPECT_FALSE(mailbox_.try_pop());
}

TEST_F(OperatorSocketTest, EngageNeedsTheTokenOfTheLatestArmAndUsesItUp) {
    listen();
    AnsweringTick tick(mailbox_);
    auto client = connect();
    EXPECT_EQ(client.request(OperatorCommand::engage, 0).outcome(), OperatorResult::bad_token);

    const std::uint64_t first = client.request(OperatorCommand::arm).token;
    const std::uint64_t second = client.request(OperatorCommand::arm).token;
    EXPECT_NE(first, 0U);
    EXPECT_NE(first, second);
    EXPECT_EQ(client.request(OperatorCommand::engage, first).outcome(), OperatorResult::bad_token);
    EXPECT_EQ(client.request(OperatorCommand::engage, second).outcome(), OperatorResult::done);
    EXPECT_EQ(client.request(OperatorCommand::engage, second).outcome(), OperatorResult::bad_token);
    EXPECT_THAT(tick.commands(), ElementsAre(OperatorCommand::arm, OperatorCommand::arm, OperatorCommand::engage));
    EXPECT_EQ(tick.peer_pid(), getpid());
}

TEST_F(OperatorSocketTest, AnotherConnectionMayEngageWithTheTokenButNotAfterItsLifetime) {
    listen();
    AnsweringTick tick(mailbox_);
    std::uint64_t token = connect().request(OperatorCommand::arm).token;
    clock_.advance(options_.token_lifetime_ns - 1);
    EXPECT_EQ(connect().request(OperatorCommand::engage, token).outcome(), OperatorResult::done);

    token = connect().request(OperatorCommand::arm).token;
    clock_.advance(options_.token_lifetime_ns);
    EXPECT_EQ(connect().request(OperatorCommand::engage, token).outcome(), OperatorResult::bad_token);
}

TEST_F(OperatorSocketTest, StopDisengageAndResetRevokeTheToken) {
    listen();
    AnsweringTick tick(mailbox_);
    auto client = connect();
    for (const OperatorCommand command : {OperatorCommand::stop, OperatorCommand::disengage, OperatorCommand::reset}) {
        const std::uint64_t token = client.request(OperatorCommand::arm).token;
        EXPECT_EQ(client.request(command).outcome(), OperatorResult::done);
        EXPECT_EQ(client.request(OperatorCommand::engage, token).outcome(), OperatorResult::bad_token);
    }
}

TEST_F(OperatorSocketTest, ARefusalCarriesTheTicksReasonsAndNoToken) {
    listen();
    AnsweringTick tick(mailbox_);
    tick.result = OperatorResult::refused;
    tick.reasons = 0x30;
    const OperatorReply reply = connect().request(OperatorCommand::arm);
    EXPECT_EQ(reply.outcome(), OperatorResult::refused);
    EXPECT_EQ(reply.reasons, 0x30U);
    EXPECT_EQ(reply.words(), "because of 48");
    EXPECT_EQ(reply.token, 0U);
    EXPECT_EQ(connect().arm_and_engage().outcome(), OperatorResult::refused);
    EXPECT_THAT(tick.commands(), ElementsAre(OperatorCommand::arm, OperatorCommand::arm));
}

TEST_F(OperatorSocketTest, ACommandTheTickDoesNotTakeIsReportedAsUnanswered) {
    options_.answer_timeout_ns = 500'000'000;
    listen();
    std::atomic<bool> replied{false};
    OperatorReply reply;
    std::thread operator_thread([&] {
        reply = connect().request(OperatorCommand::stop);
        replied = true;
    });
    // Only once the request is in the mailbox is its deadline set.
    std::optional<OperatorRequest> request;
    while (!(request = mailbox_.try_pop())) {
        std::this_thread::yield();
    }
    while (!replied) {
        clock_.advance(100'000'000);
        std::this_thread::yield();
    }
    operator_thread.join();
    EXPECT_EQ(reply.outcome(), OperatorResult::no_answer);

    // The late answer reaches nobody, least of all the next command.
    mailbox_.answer(*request, OperatorResult::refused);
    AnsweringTick tick(mailbox_);
    EXPECT_EQ(connect().request(OperatorCommand::reset).outcome(), OperatorResult::done);
}

TEST_F(OperatorSocketTest, AFullMailboxMakesCommandsBusyAtOnce) {
    for (std::size_t i = 0; i < OperatorMailbox::capacity; ++i) {
        ASSERT_TRUE(mailbox_.try_push({}));
    }
    listen();
    EXPECT_EQ(connect().request(OperatorCommand::stop).outcome(), OperatorResult::busy);
}

TEST_F(OperatorSocketTest, APeerWithoutRightsMayAskButNotCommand) {
    options_.may_command = [](const PeerCredentials&) { return false; };
    listen();
    AnsweringTick tick(mailbox_);
    auto client = connect();
    EXPECT_EQ(client.request(OperatorCommand::status).outcome(), OperatorResult::done);
    for (const OperatorCommand command : {OperatorCommand::arm, OperatorCommand::engage, OperatorCommand::disengage,
                                          OperatorCommand::reset, OperatorCommand::stop}) {
        EXPECT_EQ(client.request(command).outcome(), OperatorResult::unauthorised);
    }
    EXPECT_TRUE(tick.commands().empty());
    EXPECT_EQ(socket_->counters().unauthorised, 5U);
}

TEST_F(OperatorSocketTest, CredentialsAreThoseOfTheKernel) {
    std::atomic<std::int32_t> pid{0};
    std::atomic<std::uint32_t> uid{~0U};
    std::atomic<std::uint32_t> gid{~0U};
    options_.may_command = [&](const PeerCredentials& peer) {
        pid = peer.pid;
        uid = peer.uid;
        gid = peer.groups.at(0);
        return true;
    };
    listen();
    connect().request(OperatorCommand::status);
    EXPECT_EQ(pid, getpid());
    EXPECT_EQ(uid, geteuid());
    EXPECT_EQ(gid, getegid());
}

TEST(OwnerOrGroupMayCommand, RootOwnerAndMembersMayOthersMayNot) {
    EXPECT_TRUE(owner_or_group_may_command({1, 0, {0}}, 990, 991));
    EXPECT_TRUE(owner_or_group_may_command({1, 990, {100}}, 990, 991));
    EXPECT_TRUE(owner_or_group_may_command({1, 1000, {1000, 27, 991}}, 990, 991));
    EXPECT_FALSE(owner_or_group_may_command({1, 1000, {1000, 27, 990}}, 990, 991));
    EXPECT_FALSE(owner_or_group_may_command({1, ~0U, {}}, 990, 991));
}

TEST_F(OperatorSocketTest, GarbageOfAnyKindClosesTheConnectionAndReachesNobody) {
    options_.messages_per_s = 1000.0;
    listen();
    AnsweringTick tick(mailbox_);
    OperatorMessage stop;
    stop.command = static_cast<std::uint16_t>(OperatorCommand::stop);
    std::vector<std::vector<char>> packets;
    const auto add = [&](const OperatorMessage& message, std::size_t bytes) {
        std::vector<char> packet(bytes, '\x5A');
        std::memcpy(packet.data(), &message, std::min(bytes, sizeof message));
        packets.push_back(packet);
    };
    for (const std::size_t bytes : {1U, 15U, 17U, 4096U, 60'000U}) {
        add(stop, bytes);
    }
    OperatorMessage wrong = stop;
    wrong.magic ^= 1U;
    add(wrong, sizeof wrong);
    wrong = stop;
    wrong.version = operator_protocol_version + 1;
    add(wrong, sizeof wrong);
    for (const int command : {0, 7, 0xFFFF}) {
        wrong = stop;
        wrong.command = static_cast<std::uint16_t>(command);
        add(wrong, sizeof wrong);
    }
    for (const std::vector<char>& packet : packets) {
        const FileDescriptor raw = connect_raw();
        ASSERT_EQ(send(raw.get(), packet.data(), packet.size(), MSG_NOSIGNAL), static_cast<ssize_t>(packet.size()));
        EXPECT_TRUE(closed_without_reply(raw));
    }
    EXPECT_EQ(socket_->counters().malformed, packets.size());
    EXPECT_TRUE(tick.commands().empty());
    EXPECT_EQ(connect().request(OperatorCommand::stop).outcome(), OperatorResult::done);
}

TEST_F(OperatorSocketTest, AFloodIsCutOffAtItsBoundAndOthersStillGetThrough) {
    listen();
    const FileDescriptor raw = connect_raw();
    OperatorMessage status;
    status.command = static_cast<std::uint16_t>(OperatorCommand::status);
    // The clock stands still, so that exactly the burst is let through.
    int answered = 0;
    OperatorReply reply;
    for (int i = 0; i < 50; ++i) {
        ASSERT_EQ(send(raw.get(), &status, sizeof status, MSG_NOSIGNAL), static_cast<ssize_t>(sizeof status));
        ASSERT_EQ(recv(raw.get(), &reply, sizeof reply, 0), static_cast<ssize_t>(sizeof reply));
        answered += reply.outcome() == OperatorResult::done ? 1 : 0;
    }
    EXPECT_EQ(answered, 50);
    ASSERT_EQ(send(raw.get(), &status, sizeof status, MSG_NOSIGNAL), static_cast<ssize_t>(sizeof status));
    ASSERT_EQ(recv(raw.get(), &reply, sizeof reply, 0), static_cast<ssize_t>(sizeof reply));
    EXPECT_EQ(reply.outcome(), OperatorResult::rate_limited);
    EXPECT_TRUE(closed_without_reply(raw));
    EXPECT_EQ(socket_->counters().rate_limited, 1U);

    // A new connection of the same process is no way round the bound; time is.
    EXPECT_EQ(connect().request(OperatorCommand::status).outcome(), OperatorResult::rate_limited);
    clock_.advance(1'000'000'000);
    EXPECT_EQ(connect().request(OperatorCommand::status).outcome(), OperatorResult::done);
}

TEST_F(OperatorSocketTest, ConnectionsThatSayNothingCannotLockAnOperatorOut) {
    listen();
    AnsweringTick tick(mailbox_);
    std::vector<FileDescriptor> silent;
    for (int i = 0; i < 20; ++i) {
        silent.push_back(connect_raw());
    }
    auto client = connect();
    EXPECT_EQ(client.request(OperatorCommand::stop).outcome(), OperatorResult::done);
    EXPECT_EQ(socket_->counters().replaced_connections, 13U);
    EXPECT_TRUE(closed_without_reply(silent.front()));
}

TEST_F(OperatorSocketTest, APeerThatHangsUpBeforeItsAnswerHarmsNobody) {
    listen();
    {
        const FileDescriptor raw = connect_raw();
        OperatorMessage arm;
        arm.command = static_cast<std::uint16_t>(OperatorCommand::arm);
        ASSERT_EQ(send(raw.get(), &arm, sizeof arm, MSG_NOSIGNAL), static_cast<ssize_t>(sizeof arm));
        std::optional<OperatorRequest> request;
        while (!(request = mailbox_.try_pop())) {
            std::this_thread::yield();
        }
        EXPECT_EQ(shutdown(raw.get(), SHUT_RDWR), 0);
        mailbox_.answer(*request, OperatorResult::done);
    }
    AnsweringTick tick(mailbox_);
    EXPECT_EQ(connect().arm_and_engage().outcome(), OperatorResult::done);
}

TEST_F(OperatorSocketTest, TheFileHasItsModeIsReplacedWhenStaleAndGoneAtTheEnd) {
    {
        const FileDescriptor stale = [&] {
            FileDescriptor bound(socket(AF_UNIX, SOCK_SEQPACKET, 0));
            sockaddr_un address{};
            address.sun_family = AF_UNIX;
            std::memcpy(address.sun_path, path_.c_str(), path_.native().size());
            EXPECT_EQ(bind(bound.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
            return bound;
        }();
    }
    ASSERT_TRUE(std::filesystem::exists(path_));
    const mode_t before = umask(0077);
    listen();
    umask(before);
    struct stat facts {};
    ASSERT_EQ(stat(path_.c_str(), &facts), 0);
    EXPECT_EQ(facts.st_mode & 0777U, 0660U);
    socket_.reset();
    EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(OperatorSocketTest, BadPathsAreRefusedWithTheRemedy) {
    const auto expect_error = [](auto make, const std::string& part) {
        EXPECT_THAT(make, Throws<std::runtime_error>(Property(&std::runtime_error::what, HasSubstr(part))));
    };
    listen();
    OperatorMailbox second;
    expect_error([&] { OperatorSocket other(options_, second, clock_); }, "another program listens there");
    EXPECT_EQ(connect().request(OperatorCommand::status).outcome(), OperatorResult::done);
    socket_.reset();

    std::ofstream(path_) << "a file of someone's";
    expect_error([&] { OperatorSocket other(options_, second, clock_); }, "there is a file of another kind");
    EXPECT_TRUE(std::filesystem::is_regular_file(path_));

    options_.path = folder_ / "nowhere" / "operator.sock";
    expect_error([&] { OperatorSocket other(options_, second, clock_); }, "make its folder");
    options_.path = std::string(200, 'x');
    expect_error([&] { OperatorSocket other(options_, second, clock_); }, "1 to 107 characters");
    expect_error([&] { OperatorClient client(folder_ / "nobody"); }, "start the controller first");
}

TEST_F(OperatorSocketTest, ASocketHandedOverBySystemdIsUsedAndItsFileLeftAlone) {
    int status = 0;
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        FileDescriptor bound(socket(AF_UNIX, SOCK_SEQPACKET, 0));
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path, path_.c_str(), path_.native().size());
        bool good = bind(bound.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
                    ::listen(bound.get(), 8) == 0 && dup2(bound.get(), 3) == 3;
        setenv("LISTEN_FDS", "1", 1);
        setenv("LISTEN_PID", std::to_string(getpid()).c_str(), 1);
        options_.path.clear();
        listen();
        good = good && connect().request(OperatorCommand::status).outcome() == OperatorResult::done;
        socket_.reset();
        good = good && std::filesystem::exists(path_);
        _exit(good ? 0 : 1);
    }
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace steadyboom::runtime
