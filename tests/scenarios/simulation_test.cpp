// `simulate`, the thesis's own way, against what the model page says a right implementation shows.
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hil/simulation.hpp"
#include "plant/adaptive_runge_kutta.hpp"

namespace {

using namespace steadyboom;
using controllers::LawKind;
using hil::TruthSample;

struct Simulated {
    hil::RunFigures figures;
    std::vector<TruthSample> samples;
};

Simulated simulated(const std::string& name, LawKind law, std::optional<double> step_s = {},
                    double output_period_s = 0.005) {
    Simulated result;
    result.figures = hil::simulate(
        {.crane_case = hil::load_case(name), .law = law, .step_s = step_s, .output_period_s = output_period_s},
        [&](const TruthSample& sample) { result.samples.push_back(sample); });
    return result;
}

TEST(Simulation, UncontrolledRopesGoSlackAsTheModelPageSays) {
    const hil::RunFigures a = simulated("case-a", LawKind::none).figures;
    const hil::RunFigures b = simulated("case-b", LawKind::none).figures;
    const hil::RunFigures c = simulated("case-c", LawKind::none).figures;
    EXPECT_EQ(a.pendent_slack_share, 0.0);
    EXPECT_GT(b.pendent_slack_share, 0.0);
    EXPECT_EQ(c.pendent_slack_share, 0.0);
    EXPECT_GT(a.load_line_slack_share, 0.0);
    EXPECT_GT(b.load_line_slack_share, 0.0);
    EXPECT_GT(c.load_line_slack_share, 0.0);
    EXPECT_NEAR(a.peak_R1_time_s, 0.26, 0.005);
    EXPECT_NEAR(b.peak_R1_time_s, 0.3, 0.05);
    EXPECT_NEAR(c.peak_R1_time_s, 1.1, 0.05);
}

TEST(Simulation, LawTwoLeavesTheResidualEnergyOfTheModelPage) {
    EXPECT_NEAR(simulated("case-a", LawKind::joint_deflection).figures.residual_energy_J, 248.0, 1.0);
    EXPECT_NEAR(simulated("case-b", LawKind::joint_deflection).figures.residual_energy_J, 4630.0, 10.0);
    EXPECT_NEAR(simulated("case-c", LawKind::joint_deflection).figures.residual_energy_J, 3980.0, 10.0);
}

TEST(Simulation, LawTwoInCaseANeedsAboutSeventeenKilowattAndLeavesAQuarterOfTheLateMotion) {
    const hil::RunFigures none = simulated("case-a", LawKind::none).figures;
    const hil::RunFigures law_2 = simulated("case-a", LawKind::joint_deflection).figures;
    EXPECT_NEAR(law_2.peak_power_W, 17e3, 0.5e3);
    EXPECT_LT(law_2.late_rms_q1_m / none.late_rms_q1_m, 0.5);
    EXPECT_LT(law_2.late_rms_R1_m / none.late_rms_R1_m, 0.3);
}

TEST(Simulation, LawOneNeedsFarMorePowerAndEnlargesTheGroundMotion) {
    const hil::RunFigures none = simulated("case-a", LawKind::none).figures;
    const hil::RunFigures law_1 = simulated("case-a", LawKind::boom_angle).figures;
    EXPECT_GT(law_1.peak_power_W, 5.0 * simulated("case-a", LawKind::joint_deflection).figures.peak_power_W);
    EXPECT_GT(law_1.peak_R1_m, 1.5 * none.peak_R1_m);
}

TEST(Simulation, LawThreeSaturatesTheValve) {
    EXPECT_EQ(simulated("case-a", LawKind::swing_rate).figures.peak_opening_m, 7.6e-3);
}

TEST(Simulation, LawTwoHardlyHelpsInCaseC) {
    const double none_J = simulated("case-c", LawKind::none).figures.residual_energy_J;
    EXPECT_NEAR(simulated("case-c", LawKind::joint_deflection).figures.residual_energy_J, none_J, 0.02 * none_J);
}

TEST(Simulation, FixedStepsAndAdaptiveStepsAgreeAtEveryOutput) {
    // Neither step divides the output period: both go through dense output.
    const Simulated adaptive = simulated("case-a", LawKind::joint_deflection, {}, 0.0333);
    const Simulated fixed = simulated("case-a", LawKind::joint_deflection, 0.0004, 0.0333);
    ASSERT_EQ(adaptive.samples.size(), fixed.samples.size());
    for (std::size_t i = 0; i < fixed.samples.size(); ++i) {
        EXPECT_EQ(adaptive.samples[i].t_s, fixed.samples[i].t_s);
        const plant::CraneState difference = adaptive.samples[i].state - fixed.samples[i].state;
        EXPECT_LT(difference.head<plant::coordinate_count>().cwiseAbs().maxCoeff(), 1e-6) << fixed.samples[i].t_s;
        EXPECT_LT(difference.segment<plant::coordinate_count>(plant::velocity_offset).cwiseAbs().maxCoeff(), 2e-4)
            << fixed.samples[i].t_s;
    }
}

TEST(Simulation, TighterToleranceComesNearerAndOneOutOfRangeIsRefused) {
    const auto end = [](double tolerance) {
        plant::CraneState last;
        hil::simulate({.crane_case = hil::load_case("case-a"), .duration_s = 2.0, .tolerance = tolerance},
                      [&](const TruthSample& sample) { last = sample.state; });
        return last;
    };
    const plant::CraneState best = end(1e-12);
    const double loose = (end(1e-4) - best).norm();
    const double middling = (end(1e-7) - best).norm();
    EXPECT_LT(middling, 0.1 * loose);
    EXPECT_LT((end(1e-9) - best).norm(), 0.1 * middling);
    EXPECT_THROW((void)end(0.0), std::invalid_argument);
    EXPECT_THROW((void)end(0.1), std::invalid_argument);
}

TEST(Simulation, OutputsComeAtTheirTimesAndTheLastAtTheEnd) {
    std::vector<double> times_s;
    hil::simulate({.crane_case = hil::load_case("case-a"), .duration_s = 0.1, .output_period_s = 0.03},
                  [&](const TruthSample& sample) { times_s.push_back(sample.t_s); });
    ASSERT_EQ(times_s.size(), 5U);
    EXPECT_EQ(times_s[0], 0.0);
    EXPECT_DOUBLE_EQ(times_s[1], 0.03);
    EXPECT_DOUBLE_EQ(times_s[3], 0.09);
    EXPECT_EQ(times_s[4], 0.1);
}

TEST(Simulation, StartsAtEquilibriumWithTheBrakesImpulse) {
    const Simulated start = simulated("case-b", LawKind::joint_deflection);
    const TruthSample& first = start.samples.front();
    EXPECT_DOUBLE_EQ(first.state[plant::velocity_offset + plant::R9_m], std::sqrt(2.0 * 9.81 * 0.305));
    EXPECT_EQ(first.spool_m, 0.0);
    EXPECT_EQ(first.state[plant::piston_index], 0.0);
    EXPECT_EQ(first.hydraulic_power_W, 0.0);
}

TEST(Simulation, AStepBeyondTheStabilityLimitIsAnErrorNotANumber) {
    EXPECT_THROW(simulated("case-a", LawKind::none, 0.02), plant::IntegrationError);
    EXPECT_THROW(hil::simulate({.crane_case = hil::load_case("case-a"), .duration_s = -1.0}, [](const auto&) {}),
                 std::invalid_argument);
}

}  // namespace
