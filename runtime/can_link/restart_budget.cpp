#include "runtime/can_link/restart_budget.hpp"

namespace steadyboom::runtime {

void RestartBudget::see(bool bus_off, std::int64_t now_ns) noexcept {
    if (!bus_off) {
        off_since_ns_.reset();
        given_up_ = false;
    } else if (!off_since_ns_) {
        off_since_ns_ = now_ns;
    }
}

bool RestartBudget::grant(std::int64_t now_ns) noexcept {
    if (!off_since_ns_ || given_up_ || now_ns - *off_since_ns_ < least_off_ns) {
        return false;
    }
    std::int64_t& oldest_ns = granted_ns_[restarts_ % most_restarts];
    if (restarts_ >= most_restarts && now_ns - oldest_ns < window_ns) {
        given_up_ = true;
        return false;
    }
    oldest_ns = now_ns;
    ++restarts_;
    off_since_ns_ = now_ns;  // the next one, if it is needed, no sooner than after the first
    return true;
}

}  // namespace steadyboom::runtime
