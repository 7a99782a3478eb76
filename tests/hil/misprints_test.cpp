#include "hil/reproduction/misprints.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace steadyboom::hil {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Numbers are held as they are printed: to half a unit of the last digit.
class Misprints : public testing::Test {
  protected:
    static const std::vector<MisprintRow>& rows() {
        static const std::vector<MisprintRow> all = misprint_rows();
        return all;
    }
    static const MisprintRow& row(const char* id) { return misprint_row(rows(), id); }
    static double number(const char* id, const char* key) { return row(id).number(key); }
};

TEST_F(Misprints, EachSaysWhereWhatWhyAndWithWhatNumbers) {
    std::set<std::string> ids;
    for (const MisprintRow& row : rows()) {
        SCOPED_TRACE(row.id);
        EXPECT_TRUE(ids.insert(row.id).second);
        EXPECT_THAT(row.where, Not(IsEmpty()));
        EXPECT_THAT(row.printed, Not(IsEmpty()));
        EXPECT_THAT(row.used, Not(IsEmpty()));
        EXPECT_NE(row.printed, row.used);
        EXPECT_THAT(row.calculation, Not(IsEmpty()));
        EXPECT_THAT(row.consequence, Not(IsEmpty()));
        EXPECT_THAT(row.numbers, Not(IsEmpty()));
        for (const MisprintNumber& number : row.numbers) {
            EXPECT_TRUE(std::isfinite(number.value)) << number.key;
        }
    }
    EXPECT_EQ(ids.size(), 22U);
}

TEST_F(Misprints, UnknownRowsAndNumbersAreErrors) {
    EXPECT_THROW((void)misprint_row(rows(), "no-such"), std::out_of_range);
    EXPECT_THROW((void)rows().front().number("no-such"), std::out_of_range);
}

TEST_F(Misprints, GroundStiffnessOfTheFormulaIsAHundredTimesThePrintedInCaseA) {
    EXPECT_NEAR(number("ground-stiffness", "case_a_N_m"), 1.19e9, 0.005e9);
    EXPECT_NEAR(number("ground-stiffness", "case_b_N_m") / number("ground-stiffness", "case_a_N_m"), 62.0 / 82.7,
                1e-12);
    EXPECT_NEAR(number("ground-stiffness", "case_c_N_m") / number("ground-stiffness", "case_a_N_m"), 41.4 / 82.7,
                1e-12);
    EXPECT_NEAR(number("ground-stiffness", "printed_settlement_m"), 0.146, 0.0005);
}

TEST_F(Misprints, PrintedGroundStiffnessBouncesNearOneHertz) {
    // Undamped; the damped crane's 18.5 Hz (plant/linear_modes.hpp) is lower.
    EXPECT_NEAR(number("ground-stiffness", "used_ground_mode_Hz"), 20.0, 0.05);
    EXPECT_NEAR(number("ground-stiffness", "printed_ground_mode_Hz"), 1.20, 0.005);
}

TEST_F(Misprints, RockingStiffnessOfTheFormula) {
    EXPECT_NEAR(number("rocking-stiffness", "case_a_N_m_rad"), 1.24e10, 0.005e10);
    EXPECT_GT(number("rocking-stiffness", "printed_rocking_mode_Hz"), 500.0);
}

TEST_F(Misprints, RopeLawGivesThePendentsOfCasesBAndC) {
    EXPECT_NEAR(number("pendent-stiffness-b", "rope_law_N_m"), 1.031e7, 0.0005e7);
    EXPECT_NEAR(number("pendent-stiffness-c", "rope_law_N_m"), 4.933e6, 0.0005e6);
}

TEST_F(Misprints, PrintedPendentOfCaseBSagsTo63Point8Degrees) {
    EXPECT_NEAR(number("pendent-stiffness-b", "printed_boom_angle_deg"), 63.8, 0.05);
    EXPECT_NEAR(number("pendent-stiffness-b", "used_boom_angle_deg"), 69.83, 0.005);
    EXPECT_THAT(row("pendent-stiffness-b").consequence, HasSubstr("63.8 deg"));
}

TEST_F(Misprints, PrintedPendentOfCaseCHasNoEquilibrium) {
    EXPECT_THROW((void)number("pendent-stiffness-c", "printed_boom_angle_deg"), std::out_of_range);
    EXPECT_THAT(row("pendent-stiffness-c").consequence, HasSubstr("the crane cannot stand"));
    EXPECT_NEAR(number("pendent-stiffness-c", "used_boom_angle_deg"), 68.85, 0.005);
}

TEST_F(Misprints, OilVolumeIsWhatThePistonSweeps) {
    EXPECT_NEAR(number("oil-volume", "swept_m3"), 1.29e-2, 0.005e-2);
    EXPECT_NEAR(number("oil-volume", "swept_four_inches_m3"), 1.31e-2, 0.005e-2);
    EXPECT_GT(number("oil-volume", "printed_compliance_share"), 30.0 * number("oil-volume", "used_compliance_share"));
    EXPECT_GT(number("oil-volume", "printed_residual_J"), number("oil-volume", "used_residual_J"));
}

TEST_F(Misprints, ContactNeedsTheSignAndTheLength) {
    EXPECT_EQ(number("contact-length", "used_contact_fraction"), 1.0);
    EXPECT_EQ(number("contact-length", "printed_contact_fraction"), 0.0);
    EXPECT_LT(number("contact-length", "raised_edge_m"), 0.0);
    EXPECT_NEAR(number("contact-fraction", "printed_contact_fraction"), 0.622, 0.0005);
}

TEST_F(Misprints, SinkUsedIsTheMeanOfTheBearingLength) {
    // Half a milliradian: the sine and the angle differ by 4e-8.
    EXPECT_NEAR(number("sink", "used_y_m") / number("sink", "mean_sink_m"), 1.0, 1e-7);
    EXPECT_GT(number("sink", "printed_y_m"), 0.0);
    EXPECT_GT(number("sink", "used_force_N"), 1e5);
    EXPECT_EQ(number("sink", "printed_force_N"), 0.0);
}

TEST_F(Misprints, FlowAtANegativeOpeningIsWhatTheSupplyEdgePasses) {
    const double edges = number("flow-reversal", "two_edges_m3_s");
    EXPECT_NEAR(number("flow-reversal", "used_m3_s") / edges, 1.0, 1e-12);
    EXPECT_LT(number("flow-reversal", "printed_m3_s") / edges, 0.7);
}

TEST_F(Misprints, PendentsPullAndPrintedWorkLetsTheBoomFall) {
    EXPECT_GT(number("pendent-work", "pendent_moment_N_m"), 1e6);
    EXPECT_LT(std::abs(number("pendent-work", "used_phi6_balance_N_m")), 1.0);
    EXPECT_NEAR(number("pendent-work", "printed_phi6_balance_N_m") / number("pendent-work", "pendent_moment_N_m"), -2.0,
                1e-6);
    EXPECT_LT(number("pendent-work", "printed_phi6_acceleration_rad_s2"), 0.0);
}

TEST_F(Misprints, FlowPressureCoefficientIsTheSlopeOnlyWithTheRoot) {
    const double slope = number("flow-pressure", "slope_m3_s_Pa");
    EXPECT_NEAR(number("flow-pressure", "used_m3_s_Pa") / slope, 1.0, 1e-6);
    EXPECT_GT(number("flow-pressure", "printed_m3_s_Pa") / slope, 100.0);
}

TEST_F(Misprints, SpecificWeightTreblesTheDamping) {
    EXPECT_NEAR(number("soil-density", "damping_ratio_printed_over_used"), std::sqrt(9.81), 1e-12);
    EXPECT_NEAR(number("soil-density", "used_ground_damping"), 0.43, 0.005);
    EXPECT_GT(number("soil-density", "printed_ground_damping"), 0.9);
}

TEST_F(Misprints, SpoolDiameterFollowsFromFlowAndFlowGain) {
    EXPECT_NEAR(number("spool-diameter", "used_flow_m3_s"), 0.0164, 0.00005);
    EXPECT_NEAR(number("spool-diameter", "solved_diameter_m"), 1.24e-2, 0.005e-2);
    EXPECT_NEAR(number("spool-diameter", "used_flow_gain_m2_s"), 4.2, 0.05);
    EXPECT_NEAR(number("spool-diameter", "printed_flow_m3_s"), 0.0164 * 3.64 / 1.24, 0.0005);
}

/// The whole printed left-hand side equals the model's, but for the term in question.
TEST_F(Misprints, PrintedEquationsOfMotionBalanceOnceCorrected) {
    for (const char* id : {"fig13-boom-butt", "fig13-tip"}) {
        SCOPED_TRACE(id);
        EXPECT_LT(number(id, "used_imbalance_N"), 1e-6);
        EXPECT_GT(std::abs(number(id, "printed_imbalance_N")), 1.0);
    }
    for (const char* id : {"fig19-car-body-arm", "fig20-rocking-damping", "fig20-pendent-arm", "fig20-load-weight"}) {
        SCOPED_TRACE(id);
        EXPECT_LT(number(id, "used_imbalance_N_m"), 1e-5);
        EXPECT_GT(std::abs(number(id, "printed_imbalance_N_m")), 1e3);
    }
}

TEST_F(Misprints, BendingForceOnJointTwoIsTheEnergysSlope) {
    EXPECT_NEAR(number("fig18-bending", "used_N") / number("fig18-bending", "energy_slope_N"), 1.0, 1e-9);
    EXPECT_NEAR(number("fig18-bending", "printed_N_m") / number("fig18-bending", "energy_slope_N"), 45.7 / 3.0, 1e-6);
}

TEST_F(Misprints, PressuresAtRestAreFarAboveThePrintedOne) {
    EXPECT_NEAR(number("rest-pressure", "case_a_Pa"), 6.8e6, 0.05e6);
    EXPECT_NEAR(number("rest-pressure", "case_b_Pa"), 4.9e6, 0.05e6);
    EXPECT_NEAR(number("rest-pressure", "case_c_Pa"), 14.2e6, 0.05e6);
}

TEST_F(Misprints, PowerDivisorIsThatOfPsiAndGallons) {
    EXPECT_NEAR(number("power-divisor", "divisor_for_psi_and_gallons"), 2298.0, 1.5);
}

}  // namespace
}  // namespace steadyboom::hil
