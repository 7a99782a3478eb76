#pragma once

#include <string>
#include <type_traits>

#include <gtest/gtest.h>

#include "plant/crane_dynamics.hpp"
#include "second_derivation.hpp"

namespace steadyboom::plant {

/// Case `letter` of the thesis on one boom, as the type parameter of a test.
template <class BoomModel, char letter>
struct BoomCase {
    using Boom = BoomModel;
    using Crane = CraneDynamicsOf<Boom>;
    using Layout = typename Crane::Layout;
    using State = typename Crane::State;
    using Coordinates = typename Crane::Coordinates;
    using MassMatrix = typename Crane::MassMatrix;
    using Oracle = SecondDerivation<std::conditional_t<std::is_same_v<Boom, LinkBoom>, LinkOracle, BeamOracle>>;
    static constexpr char name = letter;
    static constexpr bool is_beam = std::is_same_v<Boom, BeamBoom>;
};
using BoomCases = testing::Types<BoomCase<LinkBoom, 'A'>, BoomCase<LinkBoom, 'B'>, BoomCase<LinkBoom, 'C'>,
                                 BoomCase<BeamBoom, 'A'>, BoomCase<BeamBoom, 'B'>, BoomCase<BeamBoom, 'C'>>;

struct BoomCaseName {
    template <class Case>
    static std::string GetName(int) {
        return (Case::is_beam ? "Beam" : "Links") + std::string("Case") + Case::name;
    }
};

}  // namespace steadyboom::plant
