#pragma once

#include <optional>
#include <string_view>

#include "controllers/law_gains.hpp"
#include "plant/crane_state.hpp"
#include "plant/valve_command.hpp"

namespace steadyboom::controllers {

/// The thesis's three compensation techniques (chapter 6), and none.
enum class LawKind {
    none,              ///< X_v = 0
    boom_angle,        ///< X_v = K1 (phi6D - phi6) + K2 (phi6D' - phi6')   (6-29)
    joint_deflection,  ///< X_v = K3 (q1D - q1)                             (6-30)
    swing_rate,        ///< X_v = K4 (phi9D' - phi9')                       (6-31)
};

inline constexpr LawKind all_laws[] = {LawKind::none, LawKind::boom_angle, LawKind::joint_deflection,
                                       LawKind::swing_rate};

/// "none", "boom-angle", "joint-deflection", "swing-rate": the command line's and the configuration's words.
[[nodiscard]] std::string_view name_of(LawKind kind) noexcept;
[[nodiscard]] std::optional<LawKind> law_named(std::string_view name) noexcept;

/// Proportional feedback of a few states, pure: the same estimate gives the same command. It knows no limits; the
/// limiter does. Desired positions are the set-point's, desired velocities are zero.
class Law {
  public:
    /// `set_point` is the equilibrium to hold, in the units of plant/crane_state.hpp; only positions are used.
    Law(LawKind kind, const ThesisGains& gains, const plant::CraneState& set_point);

    [[nodiscard]] plant::ValveCommand command(const plant::CraneState& state) const noexcept;

    [[nodiscard]] const plant::CraneState& set_point() const noexcept { return set_point_; }

  private:
    LawKind kind_;
    ThesisGains gains_;
    plant::CraneState set_point_;
};

}  // namespace steadyboom::controllers
