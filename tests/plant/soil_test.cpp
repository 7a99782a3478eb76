#include "plant/soil.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

constexpr double half_m = 4.11;

class SoilOfCaseA : public testing::Test {
  protected:
    SoilReaction at(double height_m, double tilt_rad, double height_rate_m_s = 0.0,
                    double tilt_rate_rad_s = 0.0) const {
        return soil.reaction(height_m, tilt_rad, std::sin(tilt_rad), height_rate_m_s, tilt_rate_rad_s);
    }

    Soil soil{test_support::thesis_crane('A').soil};
};

// 3.1.3-2 and -4 with G = 82.7 MPa; the mantissas are the thesis's own.
TEST_F(SoilOfCaseA, StiffnessesAreTheThesisFormulasValues) {
    const Soil::Coefficients full = soil.coefficients(1.0);
    EXPECT_NEAR(full.vertical_stiffness_N_m, 1.19e9, 0.005e9);
    EXPECT_NEAR(full.rocking_stiffness_N_m_rad, 1.24e10, 0.005e10);
    const double R_ev_m = std::sqrt(4.0 / std::numbers::pi * 4.11 * 1.22);
    EXPECT_NEAR(full.vertical_damping_N_s_m, 3.4 * R_ev_m * R_ev_m * std::sqrt(1780.0 * 82.7e6) / 0.7, 1.0);
}

TEST_F(SoilOfCaseA, TheWholeTrackBearsUntilItsHighEndReachesTheGround) {
    EXPECT_EQ(at(-0.01, 0.99 * std::asin(0.01 / half_m)).contact_fraction, 1.0);
    EXPECT_LT(at(-0.01, 1.01 * std::asin(0.01 / half_m)).contact_fraction, 1.0);
    EXPECT_DOUBLE_EQ(at(0.0, 0.01).contact_fraction, 0.5);
    EXPECT_DOUBLE_EQ(at(0.0, -0.01).contact_fraction, 0.5);
}

TEST_F(SoilOfCaseA, TiltingForwardUpMovesTheContactBackwards) {
    EXPECT_DOUBLE_EQ(at(0.0, 0.01).contact_offset_m, -half_m / 2.0);
    EXPECT_DOUBLE_EQ(at(0.0, -0.01).contact_offset_m, half_m / 2.0);
    EXPECT_EQ(at(-0.01, 0.001).contact_offset_m, 0.0);
}

TEST_F(SoilOfCaseA, MirroredStatesGiveMirroredForces) {
    for (const double height_m : {-0.02, -0.005, 0.0, 0.01}) {
        const SoilReaction one = at(height_m, 0.004, -0.1, 0.02);
        const SoilReaction other = at(height_m, -0.004, -0.1, -0.02);
        EXPECT_DOUBLE_EQ(one.vertical_N, other.vertical_N);
        EXPECT_DOUBLE_EQ(one.rocking_N_m, -other.rocking_N_m);
    }
}

TEST_F(SoilOfCaseA, ForcesOpposeSinkingAndRockingAndTheirRates) {
    const SoilReaction rest = at(-0.01, 0.001);
    EXPECT_GT(rest.vertical_N, 0.0);
    EXPECT_LT(rest.rocking_N_m, 0.0);
    EXPECT_GT(at(-0.01, 0.001, -0.01).vertical_N, rest.vertical_N);
    EXPECT_LT(at(-0.01, 0.001, 0.0, 0.01).rocking_N_m, rest.rocking_N_m);
}

TEST_F(SoilOfCaseA, NeverPullsTheTrackDown) {
    EXPECT_EQ(at(-0.001, 0.0, 10.0).vertical_N, 0.0);
    EXPECT_EQ(at(-0.001, 0.001, 10.0).vertical_N, 0.0);
}

TEST_F(SoilOfCaseA, ALiftedTrackFeelsNothing) {
    for (const SoilReaction& lifted : {at(0.1, 0.01, -1.0, 1.0), at(0.1, -0.01, -1.0, 1.0), at(0.001, 0.0, -1.0, 1.0),
                                       at(0.001, 0.5e-12, -1.0, 1.0)}) {
        EXPECT_EQ(lifted.contact_fraction, 0.0);
        EXPECT_EQ(lifted.vertical_N, 0.0);
        EXPECT_EQ(lifted.rocking_N_m, 0.0);
    }
}

TEST_F(SoilOfCaseA, ALevelTrackBearsFullyOrNotAtAll) {
    EXPECT_EQ(at(-1e-9, 0.9e-12).contact_fraction, 1.0);
    EXPECT_EQ(at(-1e-9, -0.9e-12).contact_fraction, 1.0);
    EXPECT_EQ(at(0.0, 0.0).contact_fraction, 0.0);
    EXPECT_EQ(at(1e-9, 0.9e-12).contact_fraction, 0.0);
}

// The vertical force is C0 where the track begins to lift an end and where its last point leaves.
TEST_F(SoilOfCaseA, ForcesAreContinuousAtFullContactAndAtLiftOff) {
    for (const double tilt_rad : {0.005, -0.005}) {
        const double edge_m = half_m * std::sin(0.005);
        const double jump_m = 1e-12;
        const SoilReaction below = at(-edge_m - jump_m, tilt_rad);
        const SoilReaction above = at(-edge_m + jump_m, tilt_rad);
        EXPECT_NEAR(below.vertical_N, above.vertical_N, 1e-6 * below.vertical_N);
        EXPECT_NEAR(below.rocking_N_m, above.rocking_N_m, 1e-6 * std::abs(below.rocking_N_m));
        EXPECT_NEAR(at(edge_m - 1e-9, tilt_rad).rocking_N_m, 0.0, 1.0);
    }
}

}  // namespace
}  // namespace steadyboom::plant
