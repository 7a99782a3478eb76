#include "runtime/can_link/link_server.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <tuple>
#include <utility>

#include "runtime/local_socket.hpp"

namespace steadyboom::runtime {

namespace {

bool differ(LinkReport a, LinkReport b) {
    const auto facts = [](const LinkReport& report) {
        return std::tuple(report.condition, report.problems, report.given_up, report.virtual_bus, report.bit_rate_bit_s,
                          report.restart_ms, report.queue_frames, report.restarts);
    };
    return facts(a) != facts(b);
}

}  // namespace

LinkServer::LinkServer(LinkServerOptions options)
    : options_(std::move(options)), listener_(listen_at(options_.socket_path, options_.socket_mode)) {}

LinkServer::~LinkServer() {
    unlink(options_.socket_path.c_str());
}

bool LinkServer::request_waits() {
    bool waits = false;
    while (controller_.is_open()) {
        LinkRequest request{.magic = 0};
        const ssize_t bytes = recv(controller_.get(), &request, sizeof request, MSG_DONTWAIT | MSG_TRUNC);
        if (bytes < 0) {
            break;
        }
        if (bytes != sizeof request || request.magic != link_magic) {
            controller_ = FileDescriptor();  // gone, or of another protocol
            break;
        }
        waits = true;
    }
    return waits;
}

void LinkServer::step(std::int64_t now_ns) {
    if (FileDescriptor newcomer(accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
        newcomer.is_open()) {
        controller_ = std::move(newcomer);
    }
    LinkReport seen = options_.read();
    budget_.see(seen.condition == LinkCondition::bus_off, now_ns);
    if (request_waits() && budget_.grant(now_ns)) {
        (void)options_.restart();
        seen = options_.read();
        budget_.see(seen.condition == LinkCondition::bus_off, now_ns);
    }
    seen.given_up = budget_.given_up();
    seen.restarts = budget_.restarts();
    if (!told_ || differ(seen, report_)) {
        options_.changed(seen);
        told_ = true;
    }
    report_ = seen;
    if (controller_.is_open() && send(controller_.get(), &report_, sizeof report_, MSG_NOSIGNAL | MSG_DONTWAIT) < 0 &&
        errno != EAGAIN) {
        controller_ = FileDescriptor();
    }
}

}  // namespace steadyboom::runtime
