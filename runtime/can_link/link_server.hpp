#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "runtime/can_link/link_message.hpp"
#include "runtime/can_link/restart_budget.hpp"
#include "runtime/file_descriptor.hpp"

namespace steadyboom::runtime {

struct LinkServerOptions {
    std::filesystem::path socket_path;
    std::uint32_t socket_mode = 0660;
    std::function<LinkReport()> read;                ///< looks at the link
    std::function<bool()> restart;                   ///< restarts it; false when the kernel refuses
    std::function<void(const LinkReport&)> changed;  ///< anything but the error counts differs from before
};

/// The daemon's side: reports a link to the controller that is connected, and restarts it when that asks and the budget
/// allows. One controller at a time; a new one replaces the old.
class LinkServer {
  public:
    /// Throws std::runtime_error when it cannot listen.
    explicit LinkServer(LinkServerOptions options);
    ~LinkServer();
    LinkServer(const LinkServer&) = delete;
    LinkServer& operator=(const LinkServer&) = delete;

    /// One look, one report. Whoever connected or asked since the last one is served.
    void step(std::int64_t now_ns);

    /// The newest report.
    [[nodiscard]] const LinkReport& report() const noexcept { return report_; }

  private:
    [[nodiscard]] bool request_waits();

    LinkServerOptions options_;
    FileDescriptor listener_;
    FileDescriptor controller_;
    RestartBudget budget_;
    LinkReport report_;
    bool told_ = false;
};

}  // namespace steadyboom::runtime
