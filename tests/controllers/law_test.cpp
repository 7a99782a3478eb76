#include "controllers/law.hpp"

#include <gtest/gtest.h>

namespace steadyboom::controllers {
namespace {

using namespace plant;

constexpr ThesisGains table_1{.boom_angle_gain_m_rad = 0.05,
                              .boom_rate_gain_m_s_rad = 0.2,
                              .joint_gain_m_m = 0.15,
                              .swing_rate_gain_m_s_rad = 0.20};

/// At phi6D = 1.04, q1D = 0.03, and nothing that any law reads at zero by chance.
CraneState set_point() {
    CraneState state;
    state << -0.01, 0.002, 12.3, 0.03, 0.02, 1.04, 0.1, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 0.01;
    return state;
}

CraneState at_rest() {
    CraneState state = set_point();
    velocities_of(state).setZero();
    return state;
}

double opening_m(LawKind kind, const CraneState& state) {
    return Law(kind, table_1, set_point()).command(state).opening_m;
}

// 6-29: 0.05 (1.04 - 1.05) - 0.2 * 0.004 = -0.0013.
TEST(BoomAngleLaw, LowersABoomThatIsHighAndRising) {
    CraneState state = at_rest();
    state[phi6_rad] = 1.05;
    EXPECT_NEAR(opening_m(LawKind::boom_angle, state), -0.0005, 1e-15);
    state[velocity_offset + phi6_rad] = 0.004;
    EXPECT_NEAR(opening_m(LawKind::boom_angle, state), -0.0013, 1e-15);
}

TEST(BoomAngleLaw, LiftsABoomThatIsLowAndFalling) {
    CraneState state = at_rest();
    state[phi6_rad] = 1.02;
    state[velocity_offset + phi6_rad] = -0.01;
    EXPECT_NEAR(opening_m(LawKind::boom_angle, state), 0.001 + 0.002, 1e-15);
}

// 6-30: 0.15 (0.03 - 0.05) = -0.003. A joint that sags downwards wants less tension.
TEST(JointDeflectionLaw, PaysOutWhenTheJointSagsAndHaulsInWhenItRises) {
    CraneState state = at_rest();
    state[q1_m] = 0.05;
    EXPECT_NEAR(opening_m(LawKind::joint_deflection, state), -0.003, 1e-15);
    state[q1_m] = -0.01;
    EXPECT_NEAR(opening_m(LawKind::joint_deflection, state), 0.006, 1e-15);
}

// 6-31: -0.20 * 0.015 = -0.003.
TEST(SwingRateLaw, OpensAgainstTheSwingRate) {
    CraneState state = at_rest();
    state[velocity_offset + phi9_rad] = 0.015;
    EXPECT_NEAR(opening_m(LawKind::swing_rate, state), -0.003, 1e-15);
    state[velocity_offset + phi9_rad] = -0.03;
    EXPECT_NEAR(opening_m(LawKind::swing_rate, state), 0.006, 1e-15);
}

TEST(NoLaw, NeverOpensTheValve) {
    EXPECT_EQ(opening_m(LawKind::none, CraneState::Constant(3.0)), 0.0);
}

// The set-point above has velocities of 9; a law that took them as desired ones would open wide.
TEST(Laws, AskForNothingAtTheSetPointWhateverItsVelocities) {
    for (const LawKind kind : all_laws) {
        EXPECT_EQ(opening_m(kind, at_rest()), 0.0) << name_of(kind);
    }
}

TEST(Laws, ReadOnlyTheStatesOfTheirEquation) {
    const auto reads = [](LawKind kind, int index) {
        switch (kind) {
            case LawKind::none:
                return false;
            case LawKind::boom_angle:
                return index == phi6_rad || index == velocity_offset + phi6_rad;
            case LawKind::joint_deflection:
                return index == q1_m;
            case LawKind::swing_rate:
                return index == velocity_offset + phi9_rad;
        }
        return false;
    };
    for (const LawKind kind : all_laws) {
        for (int i = 0; i < state_count; ++i) {
            CraneState state = at_rest();
            state[i] += 0.01;
            EXPECT_EQ(opening_m(kind, state) != 0.0, reads(kind, i)) << name_of(kind) << " and state " << i;
        }
    }
}

TEST(Laws, EachGainSwitchesItsOwnTermOff) {
    CraneState state = at_rest();
    state[phi6_rad] += 0.01;
    state[velocity_offset + phi6_rad] = 0.01;
    ThesisGains gains = table_1;
    gains.boom_angle_gain_m_rad = 0.0;
    EXPECT_NEAR(Law(LawKind::boom_angle, gains, set_point()).command(state).opening_m, -0.002, 1e-15);
    gains = table_1;
    gains.boom_rate_gain_m_s_rad = 0.0;
    EXPECT_NEAR(Law(LawKind::boom_angle, gains, set_point()).command(state).opening_m, -0.0005, 1e-15);
}

TEST(Laws, NamesAreTheCommandLinesWordsAndRoundTrip) {
    EXPECT_EQ(name_of(LawKind::none), "none");
    EXPECT_EQ(name_of(LawKind::boom_angle), "boom-angle");
    EXPECT_EQ(name_of(LawKind::joint_deflection), "joint-deflection");
    EXPECT_EQ(name_of(LawKind::swing_rate), "swing-rate");
    for (const LawKind kind : all_laws) {
        EXPECT_EQ(law_named(name_of(kind)), kind);
    }
    for (const char* unknown : {"", "None", "boom_angle", "joint", "swing-rate ", "?"}) {
        EXPECT_FALSE(law_named(unknown).has_value()) << unknown;
    }
}

}  // namespace
}  // namespace steadyboom::controllers
