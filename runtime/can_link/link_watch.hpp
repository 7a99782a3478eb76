#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>

#include "runtime/can_link/link_message.hpp"
#include "runtime/realtime_thread.hpp"

namespace steadyboom::runtime {

struct LinkWatchOptions {
    std::filesystem::path socket_path;               ///< of the link daemon
    std::function<void(std::uint32_t)> set_reasons;  ///< controllers::InterlockReason bits, at each change
    std::function<bool()> may_restart;               ///< the machine is safe, so the link may come back
    std::function<void(const std::string&)> log;
    std::chrono::milliseconds silence{1000};  ///< after that long without a report nobody watches the link
};

/// What a report means to the interlock.
[[nodiscard]] std::uint32_t reasons_of(const LinkReport& report) noexcept;

/// The controller's side: on a thread that is not the tick's, hears the link daemon's reports, turns them into reasons
/// and asks for a restart after bus-off. A daemon that is not there is looked for again and again.
class LinkWatch {
  public:
    explicit LinkWatch(LinkWatchOptions options);

  private:
    void watch(const std::stop_token& stop);

    LinkWatchOptions options_;
    HelperThread thread_;  ///< last: it uses the others
};

}  // namespace steadyboom::runtime
