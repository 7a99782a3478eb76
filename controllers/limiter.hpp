#pragma once

#include "plant/valve_command.hpp"

namespace steadyboom::controllers {

struct LimiterConfig {
    double max_opening_m = 0.0;  ///< largest |opening|
    double max_slew_m_s = 0.0;   ///< largest change of the opening per second
    double period_s = 0.0;       ///< of the control tick
};

/// Performance limits on a law's command, one after the other in this order: finite, permission, authority, absolute,
/// slew. A command inside all of them passes unchanged; whatever changed it is reported as plant::LimitReason bits.
///
/// Without permission the command is neutral at once; the way there is the interlock's business (it lowers authority
/// first), so that slew never delays a stop.
class Limiter {
  public:
    /// Throws std::invalid_argument, naming the limit and its value, unless all three are positive and finite.
    explicit Limiter(const LimiterConfig& config);

    [[nodiscard]] plant::LimitedCommand apply(const plant::ValveCommand& wanted,
                                              const plant::Permission& permit) noexcept;

  private:
    double max_opening_m_;
    double max_step_m_;
    double last_opening_m_ = 0.0;
};

/// The limits themselves, pure: each takes and returns an opening in m and adds its bit to `reasons` if it changed it.
[[nodiscard]] double limit_to_finite_m(double opening_m, std::uint32_t& reasons) noexcept;
[[nodiscard]] double limit_to_permission_m(double opening_m, const plant::Permission& permit,
                                           std::uint32_t& reasons) noexcept;
[[nodiscard]] double limit_to_authority_m(double opening_m, double authority, std::uint32_t& reasons) noexcept;
[[nodiscard]] double limit_to_absolute_m(double opening_m, double max_opening_m, std::uint32_t& reasons) noexcept;
[[nodiscard]] double limit_to_slew_m(double opening_m, double last_opening_m, double max_step_m,
                                     std::uint32_t& reasons) noexcept;

}  // namespace steadyboom::controllers
