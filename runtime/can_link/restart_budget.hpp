#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace steadyboom::runtime {

/// When a link that is bus-off may be restarted: at the earliest 100 ms after it went off, at most three times in any
/// minute. Who needs a fourth has a fault that restarts do not cure: given up until the link is seen well again.
class RestartBudget {
  public:
    static constexpr std::int64_t least_off_ns = 100'000'000;
    static constexpr std::int64_t window_ns = 60'000'000'000;
    static constexpr std::size_t most_restarts = 3;

    /// What was just seen of the link.
    void see(bool bus_off, std::int64_t now_ns) noexcept;

    /// Somebody asks for a restart. True: do it now; it is counted.
    [[nodiscard]] bool grant(std::int64_t now_ns) noexcept;

    [[nodiscard]] bool given_up() const noexcept { return given_up_; }
    [[nodiscard]] std::uint32_t restarts() const noexcept { return restarts_; }

  private:
    std::optional<std::int64_t> off_since_ns_;
    std::array<std::int64_t, most_restarts> granted_ns_{};  ///< the newest ones, in turns
    std::uint32_t restarts_ = 0;
    bool given_up_ = false;
};

}  // namespace steadyboom::runtime
