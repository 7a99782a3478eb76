#include "runtime/operator_client.hpp"

#include <sys/socket.h>
#include <sys/time.h>

#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>

#include "runtime/local_socket.hpp"

namespace steadyboom::runtime {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw std::runtime_error("operator socket " + path.string() + ": " + what);
}

}  // namespace

OperatorClient::OperatorClient(const std::filesystem::path& path, std::chrono::milliseconds patience) : path_(path) {
    const auto give_up = std::chrono::steady_clock::now() + patience;
    socket_ = connect_to(path);
    while (!socket_.is_open()) {
        const int error = errno;
        if ((error != ENOENT && error != ECONNREFUSED) || std::chrono::steady_clock::now() >= give_up) {
            fail(path, "cannot connect: " + std::generic_category().message(error) +
                           (error == EACCES ? "; join the group that owns it" : "; start the controller first"));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        socket_ = connect_to(path);
    }
}

OperatorReply OperatorClient::request(OperatorCommand command, std::uint64_t token, std::chrono::milliseconds timeout) {
    OperatorMessage message;
    message.command = static_cast<std::uint16_t>(command);
    message.token = token;
    if (send(socket_.get(), &message, sizeof message, MSG_NOSIGNAL) != sizeof message) {
        fail(path_, "the controller closed the connection");
    }
    const timeval patience{static_cast<time_t>(timeout.count() / 1000),
                           static_cast<suseconds_t>(timeout.count() % 1000 * 1000)};
    setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    OperatorReply reply;
    const ssize_t bytes = recv(socket_.get(), &reply, sizeof reply, MSG_TRUNC);
    if (bytes < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
        fail(path_, "no reply within " + std::to_string(timeout.count()) + " ms");
    }
    if (bytes <= 0) {
        fail(path_, "the controller closed the connection");
    }
    if (bytes != sizeof reply || reply.magic != operator_magic || reply.version != operator_protocol_version) {
        fail(path_, "the reply is of another protocol; run both programs from one release");
    }
    return reply;
}

OperatorReply OperatorClient::arm_and_engage() {
    const OperatorReply armed = request(OperatorCommand::arm);
    return armed.outcome() == OperatorResult::done ? request(OperatorCommand::engage, armed.token) : armed;
}

}  // namespace steadyboom::runtime
