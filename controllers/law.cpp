#include "controllers/law.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace steadyboom::controllers {

namespace {

constexpr std::array<std::pair<LawKind, std::string_view>, 4> names{{{LawKind::none, "none"},
                                                                     {LawKind::boom_angle, "boom-angle"},
                                                                     {LawKind::joint_deflection, "joint-deflection"},
                                                                     {LawKind::swing_rate, "swing-rate"}}};

}  // namespace

std::string_view name_of(LawKind kind) noexcept {
    const auto* found = std::ranges::find(names, kind, &std::pair<LawKind, std::string_view>::first);
    return found == names.end() ? "?" : found->second;
}

std::optional<LawKind> law_named(std::string_view name) noexcept {
    const auto* found = std::ranges::find(names, name, &std::pair<LawKind, std::string_view>::second);
    return found == names.end() ? std::nullopt : std::optional(found->first);
}

Law::Law(LawKind kind, const ThesisGains& gains, const plant::CraneState& set_point)
    : kind_(kind), gains_(gains), set_point_(set_point) {}

plant::ValveCommand Law::command(const plant::CraneState& state) const noexcept {
    using namespace plant;
    const auto rate = [&](Coordinate coordinate) { return state[velocity_offset + coordinate]; };
    switch (kind_) {
        case LawKind::none:
            return {0.0};
        case LawKind::boom_angle:
            return {gains_.boom_angle_gain_m_rad * (set_point_[phi6_rad] - state[phi6_rad]) -
                    gains_.boom_rate_gain_m_s_rad * rate(phi6_rad)};
        case LawKind::joint_deflection:
            return {gains_.joint_gain_m_m * (set_point_[q1_m] - state[q1_m])};
        case LawKind::swing_rate:
            return {-gains_.swing_rate_gain_m_s_rad * rate(phi9_rad)};
    }
    return {0.0};
}

}  // namespace steadyboom::controllers
