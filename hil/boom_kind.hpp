#pragma once

#include <array>
#include <string_view>
#include <type_traits>
#include <utility>

#include "plant/crane_dynamics.hpp"

namespace steadyboom::hil {

/// Which boom the true crane has. The controller's model always has the links.
enum class BoomKind {
    links,  ///< plant::LinkBoom, the thesis's
    beam    ///< plant::BeamBoom, the higher-order boom the thesis was checked against
};

inline constexpr std::array<std::pair<std::string_view, BoomKind>, 2> boom_kinds{
    {{"links", BoomKind::links}, {"beam", BoomKind::beam}}};

[[nodiscard]] constexpr std::string_view name_of(BoomKind kind) noexcept {
    return kind == BoomKind::links ? "links" : "beam";
}

/// Calls `work` with std::type_identity of the boom's class and returns what it returns.
template <class Work>
decltype(auto) with_boom(BoomKind kind, const Work& work) {
    return kind == BoomKind::links ? work(std::type_identity<plant::LinkBoom>{})
                                   : work(std::type_identity<plant::BeamBoom>{});
}

}  // namespace steadyboom::hil
