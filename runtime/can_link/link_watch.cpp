#include "runtime/can_link/link_watch.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <optional>
#include <thread>
#include <utility>

#include "controllers/interlock.hpp"
#include "runtime/local_socket.hpp"

namespace steadyboom::runtime {

std::uint32_t reasons_of(const LinkReport& report) noexcept {
    std::uint32_t reasons = controllers::reason_none;
    switch (report.condition) {
        case LinkCondition::bus_off:
            reasons |= controllers::reason_bus_off;
            break;
        case LinkCondition::passive:
            reasons |= controllers::reason_error_passive;
            break;
        case LinkCondition::warning:
            reasons |= controllers::reason_error_warning;
            break;
        case LinkCondition::unknown:
        case LinkCondition::absent:  // the tick's own socket tells of these two
        case LinkCondition::stopped:
        case LinkCondition::active:
            break;
    }
    reasons |= report.given_up ? controllers::reason_bus_off_lockout : 0U;
    reasons |= report.problems != link_problem_none ? controllers::reason_bus_setup : 0U;
    return reasons;
}

LinkWatch::LinkWatch(LinkWatchOptions options)
    : options_(std::move(options)), thread_("link", [this](const std::stop_token& stop) { watch(stop); }) {}

void LinkWatch::watch(const std::stop_token& stop) {
    using std::chrono::milliseconds;
    using std::chrono::steady_clock;
    constexpr milliseconds round(100);
    FileDescriptor daemon;
    std::optional<std::uint32_t> told;
    const auto tell = [&](std::uint32_t reasons, const std::string& why) {
        if (told != reasons) {
            options_.set_reasons(reasons);
            options_.log(why);
            told = reasons;
        }
    };
    auto last_heard = steady_clock::now();
    while (!stop.stop_requested()) {
        if (!daemon.is_open()) {
            daemon = connect_to(options_.socket_path);
        }
        pollfd ready{.fd = daemon.get(), .events = POLLIN, .revents = 0};
        if (!daemon.is_open()) {
            std::this_thread::sleep_for(round);
        } else if (poll(&ready, 1, static_cast<int>(round.count())) == 1) {
            LinkReport report;
            const ssize_t bytes = recv(daemon.get(), &report, sizeof report, MSG_DONTWAIT | MSG_TRUNC);
            if (bytes != sizeof report || report.magic != link_magic) {
                daemon = FileDescriptor();
                std::this_thread::sleep_for(round);
            } else {
                last_heard = steady_clock::now();
                const std::uint32_t reasons = reasons_of(report);
                tell(reasons, reasons == 0 ? "the link is well" : controllers::reasons_in_words(reasons));
                if (report.condition == LinkCondition::bus_off && options_.may_restart()) {
                    const LinkRequest request;
                    (void)send(daemon.get(), &request, sizeof request, MSG_NOSIGNAL | MSG_DONTWAIT);
                }
            }
        }
        if (steady_clock::now() - last_heard > options_.silence) {
            tell(controllers::reason_bus_setup, "nobody watches the link: no report from " +
                                                    options_.socket_path.string() + "; start steadyboom-can@");
        }
    }
}

}  // namespace steadyboom::runtime
