// What the thesis reports of its three cases, and what this model adds to it, to the digits in plant/README.md.

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "crane_run.hpp"
#include "plant/energy.hpp"
#include "plant/linear_modes.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

using test_support::thesis_case;
using test_support::ThesisCase;

/// Equal once rounded to the printed number's last digit, whose unit is `digit`.
#define EXPECT_PRINTS(value, printed, digit) EXPECT_NEAR(value, printed, 0.5 * (digit) * (1.0 + 1e-9))

enum class Law { none, boom_angle, joint_deflection, swing_rate };

struct Figures {
    double first_energy_J = 0.0;
    double late_energy_J = 0.0;  ///< mean of the last second
    double peak_power_W = 0.0;
    double peak_opening_m = 0.0;
    double peak_R1_m = 0.0;  ///< from equilibrium
    double peak_R1_at_s = 0.0;
    double late_phi6_rms_rad = 0.0;
    double late_phi9_rms_rad = 0.0;
    bool pendent_slack = false;
    bool line_slack = false;
    double highest_pressure_Pa = 0.0;
};

Figures run(const ThesisCase& thesis, Law law) {
    const CraneDynamics crane(thesis.crane);
    const Equilibrium rest = find_equilibrium(crane);
    const CraneState& desired = rest.state;
    const ResidualEnergy residual(crane, rest.state);
    const auto opening_m = [&](double, const CraneState& x) {
        switch (law) {
            case Law::none:
                return 0.0;
            case Law::boom_angle:
                return thesis.angle_gain_m_rad * (desired[phi6_rad] - x[phi6_rad]) -
                       thesis.rate_gain_m_s_rad * x[velocity_offset + phi6_rad];
            case Law::joint_deflection:
                return thesis.joint_gain * (desired[q1_m] - x[q1_m]);
            case Law::swing_rate:
                return -thesis.swing_gain_m_s_rad * x[velocity_offset + phi9_rad];
        }
        return 0.0;
    };
    Figures figures;
    long late = 0;
    run_crane(crane, after_load_drop(crane, thesis.load_drop_m), 10.0, 1e-3, 1e-9, opening_m,
              [&](double t_s, const CraneState& x, double X_v) {
                  const CraneOutputs outputs = crane.outputs(x);
                  const double energy_J = residual.energy_J(x);
                  const double R1 = std::abs(x[R1_m] - desired[R1_m]);
                  if (t_s == 0.0) {
                      figures.first_energy_J = energy_J;
                  }
                  if (R1 > figures.peak_R1_m) {
                      figures.peak_R1_m = R1;
                      figures.peak_R1_at_s = t_s;
                  }
                  figures.peak_power_W =
                      std::max(figures.peak_power_W, std::abs(crane.actuator().hydraulic_power_W(
                                                         X_v, outputs.pendent_tension_N, rest.pendent_tension_N)));
                  figures.peak_opening_m = std::max(figures.peak_opening_m, std::abs(X_v));
                  figures.pendent_slack |= outputs.pendent_tension_N <= 0.0;
                  figures.line_slack |= outputs.load_line_tension_N <= 0.0;
                  figures.highest_pressure_Pa = std::max(figures.highest_pressure_Pa, outputs.load_pressure_Pa);
                  if (t_s > 9.0 - 1e-9) {
                      ++late;
                      figures.late_energy_J += energy_J;
                      figures.late_phi6_rms_rad += std::pow(x[phi6_rad] - desired[phi6_rad], 2);
                      figures.late_phi9_rms_rad += std::pow(x[phi9_rad], 2);
                  }
              });
    figures.late_energy_J /= static_cast<double>(late);
    figures.late_phi6_rms_rad = std::sqrt(figures.late_phi6_rms_rad / static_cast<double>(late));
    figures.late_phi9_rms_rad = std::sqrt(figures.late_phi9_rms_rad / static_cast<double>(late));
    return figures;
}

struct Mode {
    double frequency_Hz, digit_Hz;
    Coordinate dominant;
};

struct Printed {
    char name;
    double boom_deg;
    double load_pressure_MPa;
    std::vector<Mode> modes;
    double bounce_damping;
    bool pendent_slack;
    double peak_at_s, peak_digit_s;
    double injected_kJ;
    double law_two_residual_J, residual_digit_J;
};

const Printed& printed(char name) {
    static const std::vector<Printed> all = {
        {'A',
         59.84,
         6.8,
         {{0.14, 0.01, phi9_rad},
          {1.4, 0.1, phi6_rad},
          {3.7, 0.1, R9_m},
          {10.4, 0.1, phi2_rad},
          {18.3, 0.1, q1_m},
          {18.5, 0.1, R1_m},
          {69.8, 0.1, q2_m}},
         0.43,
         false,
         0.26,
         0.01,
         10.1,
         248.0,
         1.0},
        {'B',
         69.83,
         4.9,
         {{0.14, 0.01, phi9_rad},
          {1.3, 0.1, phi6_rad},
          {3.2, 0.1, R9_m},
          {8.9, 0.1, phi2_rad},
          {15.7, 0.1, R1_m},
          {18.2, 0.1, q1_m},
          {69.4, 0.1, q2_m}},
         0.43,
         true,
         0.3,
         0.1,
         40.7,
         4630.0,
         10.0},
        {'C',
         68.85,
         14.2,
         {{0.13, 0.01, phi9_rad},
          {0.34, 0.01, phi6_rad},
          {2.7, 0.1, R9_m},
          {3.1, 0.1, phi2_rad},
          {4.7, 0.1, q1_m},
          {12.4, 0.1, R1_m},
          {17.6, 0.1, q2_m}},
         0.41,
         false,
         1.1,
         0.1,
         40.7,
         3980.0,
         10.0},
    };
    for (const Printed& one : all) {
        if (one.name == name) {
            return one;
        }
    }
    throw std::invalid_argument("no such case");
}

class ThesisCaseOf : public testing::TestWithParam<char> {};

TEST_P(ThesisCaseOf, StandsAtThePrintedAngleAndPressure) {
    const Equilibrium rest = find_equilibrium(CraneDynamics(thesis_case(GetParam()).crane));
    EXPECT_PRINTS(rest.state[phi6_rad] * 180.0 / std::numbers::pi, printed(GetParam()).boom_deg, 0.01);
    EXPECT_PRINTS(rest.pendent_tension_N / 0.0645 / 1e6, printed(GetParam()).load_pressure_MPa, 0.1);
}

TEST_P(ThesisCaseOf, HasThePrintedModes) {
    const CraneDynamics crane(thesis_case(GetParam()).crane);
    const std::vector<LinearMode> modes = linear_modes(crane, find_equilibrium(crane).state);
    const std::vector<Mode>& expected = printed(GetParam()).modes;
    ASSERT_EQ(modes.size(), expected.size());
    for (std::size_t i = 0; i < modes.size(); ++i) {
        EXPECT_PRINTS(modes[i].frequency_Hz, expected[i].frequency_Hz, expected[i].digit_Hz);
        EXPECT_EQ(modes[i].dominant, expected[i].dominant) << coordinate_name(modes[i].dominant);
        EXPECT_GT(modes[i].damping_ratio, -1e-6);
        if (modes[i].dominant == R1_m) {
            EXPECT_PRINTS(modes[i].damping_ratio, printed(GetParam()).bounce_damping, 0.01);
        }
    }
}

TEST_P(ThesisCaseOf, UncontrolledRunGoesSlackAndPeaksWhenPrinted) {
    const Printed& expected = printed(GetParam());
    const Figures free = run(thesis_case(GetParam()), Law::none);
    EXPECT_EQ(free.pendent_slack, expected.pendent_slack);
    EXPECT_TRUE(free.line_slack);
    EXPECT_PRINTS(free.peak_R1_at_s, expected.peak_at_s, expected.peak_digit_s);
    EXPECT_PRINTS(free.first_energy_J / 1e3, expected.injected_kJ, 0.1);
    EXPECT_EQ(free.peak_power_W, 0.0);
}

TEST_P(ThesisCaseOf, LawTwoLeavesThePrintedResidualEnergy) {
    const Printed& expected = printed(GetParam());
    EXPECT_PRINTS(run(thesis_case(GetParam()), Law::joint_deflection).late_energy_J, expected.law_two_residual_J,
                  expected.residual_digit_J);
}

INSTANTIATE_TEST_SUITE_P(Thesis, ThesisCaseOf, testing::Values('A', 'B', 'C'),
                         [](const auto& test) { return std::string("Case") + test.param; });

TEST(ThesisCaseA, LawTwoQuietsTheBoomForSeventeenKilowatts) {
    const ThesisCase thesis = thesis_case('A');
    const Figures free = run(thesis, Law::none);
    const Figures law = run(thesis, Law::joint_deflection);
    EXPECT_PRINTS(law.peak_power_W, 17e3, 1e3);
    EXPECT_LT(law.late_phi6_rms_rad, 0.35 * free.late_phi6_rms_rad);
    EXPECT_LT(law.late_energy_J, 0.06 * free.late_energy_J);
}

TEST(ThesisCaseA, LawOneNeedsFarMorePowerAndEnlargesTheGroundsMotion) {
    const ThesisCase thesis = thesis_case('A');
    const Figures law = run(thesis, Law::boom_angle);
    EXPECT_GT(law.peak_power_W, 5.0 * run(thesis, Law::joint_deflection).peak_power_W);
    EXPECT_GT(law.peak_R1_m, 2.0 * run(thesis, Law::none).peak_R1_m);
}

TEST(ThesisCaseA, LawThreeSaturatesTheValve) {
    const Figures law = run(thesis_case('A'), Law::swing_rate);
    EXPECT_EQ(law.peak_opening_m, 7.6e-3);
    EXPECT_GT(law.peak_power_W, 200e3);
}

TEST(ThesisCaseC, LawTwoHardlyHelpsAndItsPressureStaysBelowTheReportedLimit) {
    const ThesisCase thesis = thesis_case('C');
    const Figures free = run(thesis, Law::none);
    const Figures law = run(thesis, Law::joint_deflection);
    EXPECT_GT(law.late_energy_J, 0.9 * free.late_energy_J);
    EXPECT_PRINTS(std::max(free.highest_pressure_Pa, law.highest_pressure_Pa) / 1e6, 19.4, 0.1);
}

}  // namespace
}  // namespace steadyboom::plant
