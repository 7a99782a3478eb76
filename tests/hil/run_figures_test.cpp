#include "hil/run_figures.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "hil/true_crane.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::hil {
namespace {

using namespace plant;

constexpr double duration_s = 10.0;
constexpr int samples_per_s = 2000;

/// Trajectories made by hand about the equilibrium of case A.
class Figures : public testing::Test {
  protected:
    Figures() : crane(true_crane.dynamics()), equilibrium(true_crane.equilibrium()) {}

    [[nodiscard]] TruthSample at_rest(double t_s) const {
        return {.t_s = t_s,
                .state = equilibrium.state,
                .pendent_tension_N = equilibrium.pendent_tension_N,
                .load_line_tension_N = equilibrium.load_line_tension_N};
    }

    /// Samples from -1 s to 11 s; `shape` changes each.
    [[nodiscard]] RunFigures of(const std::function<void(TruthSample&)>& shape) const {
        FigureAccumulator figures(equilibrium.state, duration_s);
        for (int i = -samples_per_s; i <= 11 * samples_per_s; ++i) {
            TruthSample sample = at_rest(static_cast<double>(i) / samples_per_s);
            shape(sample);
            figures.add(sample);
        }
        return figures.figures();
    }

    TrueCrane<LinkBoom> true_crane{test_support::thesis_crane('A')};
    const CraneDynamics& crane;
    const Equilibrium& equilibrium;
};

struct Tracked {
    Coordinate coordinate;
    double RunFigures::*peak;
    double RunFigures::*late_rms;
};
constexpr std::array tracked{
    Tracked{R1_m, &RunFigures::peak_R1_m, &RunFigures::late_rms_R1_m},
    Tracked{phi2_rad, &RunFigures::peak_phi2_rad, &RunFigures::late_rms_phi2_rad},
    Tracked{phi6_rad, &RunFigures::peak_phi6_rad, &RunFigures::late_rms_phi6_rad},
    Tracked{phi9_rad, &RunFigures::peak_phi9_rad, &RunFigures::late_rms_phi9_rad},
    Tracked{q1_m, &RunFigures::peak_q1_m, &RunFigures::late_rms_q1_m},
};

TEST_F(Figures, CraneAtRestHasNone) {
    const RunFigures figures = of([](TruthSample&) {});
    for (const FigureRow& row : figure_rows) {
        EXPECT_EQ(figures.*row.value, 0.0) << row.key;
    }
}

TEST_F(Figures, ConstantDeviationIsItsOwnPeakAndRmsAndNobodyElses) {
    for (const Tracked& one : tracked) {
        const RunFigures figures = of([&](TruthSample& sample) { sample.state[one.coordinate] -= 0.003; });
        for (const Tracked& other : tracked) {
            const double expected = other.coordinate == one.coordinate ? 0.003 : 0.0;
            EXPECT_NEAR(figures.*other.peak, expected, 1e-14);
            EXPECT_NEAR(figures.*other.late_rms, expected, 1e-14);
        }
    }
}

// A sine of two whole periods in the second half: RMS is amplitude over root two, the peak is the amplitude.
TEST_F(Figures, SineHasItsAmplitudeAsPeakAndOverRootTwoAsRms) {
    const RunFigures figures = of(
        [](TruthSample& sample) { sample.state[q1_m] += 0.02 * std::sin(2.0 * std::numbers::pi * 0.4 * sample.t_s); });
    EXPECT_NEAR(figures.peak_q1_m, 0.02, 1e-12);
    EXPECT_NEAR(figures.late_rms_q1_m, 0.02 / std::numbers::sqrt2, 1e-8);
}

TEST_F(Figures, WhatHappensInTheFirstHalfIsNoLateMotion) {
    const RunFigures early = of([](TruthSample& sample) { sample.state[phi6_rad] += sample.t_s <= 5.0 ? 0.01 : 0.0; });
    EXPECT_NEAR(early.peak_phi6_rad, 0.01, 1e-14);
    EXPECT_EQ(early.late_rms_phi6_rad, 0.0);
    const RunFigures late = of([](TruthSample& sample) { sample.state[phi6_rad] += sample.t_s > 7.5 ? 0.01 : 0.0; });
    EXPECT_NEAR(late.late_rms_phi6_rad, 0.01 * std::sqrt(0.5), 1e-10) << "half of the second half";
}

TEST_F(Figures, SamplesBeforeTheBrakeAndAfterTheEndAreIgnored) {
    const RunFigures figures = of([](TruthSample& sample) {
        if (sample.t_s < 0.0 || sample.t_s > duration_s) {
            sample.state.setConstant(5.0);
            sample.spool_m = 1.0;
            sample.pendent_tension_N = 0.0;
            sample.load_line_tension_N = 0.0;
            sample.load_pressure_Pa = 1e9;
            sample.hydraulic_power_W = 1e9;
        }
    });
    for (const FigureRow& row : figure_rows) {
        EXPECT_EQ(figures.*row.value, 0.0) << row.key;
    }
}

TEST_F(Figures, FirstAndLastInstantCount) {
    const RunFigures first = of([](TruthSample& sample) { sample.spool_m = sample.t_s == 0.0 ? 4e-3 : 0.0; });
    EXPECT_EQ(first.peak_opening_m, 4e-3);
    const RunFigures last = of([](TruthSample& sample) { sample.spool_m = sample.t_s == 10.0 ? -4e-3 : 0.0; });
    EXPECT_EQ(last.peak_opening_m, 4e-3);
}

TEST_F(Figures, TimeOfTheLargestGroundMotionIsItsFirstInstant) {
    const RunFigures figures = of([](TruthSample& sample) {
        sample.state[R1_m] += sample.t_s < 0.26 ? 1e-3 : sample.t_s < 3.0 ? -2e-3 : 2e-3 - 1e-9;
    });
    EXPECT_NEAR(figures.peak_R1_m, 2e-3, 1e-14);
    EXPECT_DOUBLE_EQ(figures.peak_R1_time_s, 0.26);
}

TEST_F(Figures, PeaksAreOfMagnitudes) {
    const RunFigures figures = of([](TruthSample& sample) {
        sample.spool_m = sample.t_s < 2.0 ? -5e-3 : 3e-3;
        sample.hydraulic_power_W = sample.t_s < 3.0 ? -17e3 : 12e3;
        sample.load_pressure_Pa = sample.t_s < 4.0 ? 9e6 : 7e6;
    });
    EXPECT_EQ(figures.peak_opening_m, 5e-3);
    EXPECT_EQ(figures.peak_power_W, 17e3);
    EXPECT_EQ(figures.peak_load_pressure_Pa, 9e6);
}

TEST_F(Figures, SlackSharesAreOfTheWholeTime) {
    const RunFigures figures = of([](TruthSample& sample) {
        sample.load_line_tension_N = sample.t_s > 2.0 && sample.t_s <= 4.5 ? 0.0 : 1e5;
        sample.pendent_tension_N = sample.t_s > 9.0 ? 0.0 : 4e5;
    });
    EXPECT_NEAR(figures.load_line_slack_share, 0.25, 1e-12);
    EXPECT_NEAR(figures.pendent_slack_share, 0.10, 1e-12);
}

// E = 1/2 M11 v^2 with v growing evenly through the last second: its mean is 1/6 M11 V^2. Before that, much more.
TEST_F(Figures, ResidualEnergyIsTheMeanOfTheLastSecond) {
    const double mass_kg = crane.mass_matrix(coordinates_of(equilibrium.state))(R1_m, R1_m);
    constexpr double top_m_s = 0.02;
    const RunFigures figures = of([&](TruthSample& sample) {
        sample.state[velocity_offset + R1_m] = sample.t_s <= 9.0 ? 3.0 : top_m_s * (sample.t_s - 9.0);
        sample = true_crane.sample(sample.state, 0.0, sample.t_s);
    });
    const double expected_J = mass_kg * top_m_s * top_m_s / 6.0;
    EXPECT_NEAR(figures.residual_energy_J, expected_J, 1e-3 * expected_J);
}

TEST_F(Figures, SamplesCountByTheTimeTheyStandFor) {
    FigureAccumulator figures(equilibrium.state, duration_s);
    for (const auto& [t_s, deviation_m] : {std::pair{0.0, 0.0}, {5.0, 0.0}, {6.0, 0.1}, {10.0, 0.2}}) {
        TruthSample sample = at_rest(t_s);
        sample.state[q1_m] += deviation_m;
        sample.pendent_tension_N = t_s == 6.0 ? 0.0 : 1.0;
        figures.add(sample);
    }
    EXPECT_NEAR(figures.figures().late_rms_q1_m, std::sqrt((1.0 * 0.01 + 4.0 * 0.04) / 5.0), 1e-12);
    EXPECT_NEAR(figures.figures().pendent_slack_share, 0.1, 1e-15);
}

TEST_F(Figures, RunWithoutSamplesHasNone) {
    const RunFigures figures = FigureAccumulator(equilibrium.state, duration_s).figures();
    for (const FigureRow& row : figure_rows) {
        EXPECT_EQ(figures.*row.value, 0.0) << row.key;
    }
}

TEST_F(Figures, DurationThatIsNotPositiveIsRefused) {
    for (const double bad_s : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THROW(FigureAccumulator(equilibrium.state, bad_s), std::invalid_argument) << bad_s;
    }
}

TEST(FigureRows, NameEveryFigureOnce) {
    EXPECT_EQ(figure_rows.size() * sizeof(double), sizeof(RunFigures));
    std::set<std::string_view> keys;
    for (const FigureRow& row : figure_rows) {
        keys.insert(row.key);
        RunFigures marked;
        marked.*row.value = 1.0;
        for (const FigureRow& other : figure_rows) {
            EXPECT_EQ(marked.*other.value, other.key == row.key ? 1.0 : 0.0) << row.key << " and " << other.key;
        }
    }
    EXPECT_EQ(keys.size(), figure_rows.size());
}

TEST_F(Figures, TruthSampleTellsWhatTheModelTells) {
    CraneState state = equilibrium.state;
    state[phi6_rad] -= 1e-3;
    state[R9_m] += 2e-3;
    const TruthSample sample = true_crane.sample(state, 2e-3, 1.5);
    const CraneOutputs outputs = crane.outputs(state);
    EXPECT_EQ(sample.t_s, 1.5);
    EXPECT_EQ(sample.state, state);
    EXPECT_EQ(sample.spool_m, 2e-3);
    EXPECT_EQ(sample.pendent_tension_N, outputs.pendent_tension_N);
    EXPECT_EQ(sample.load_line_tension_N, outputs.load_line_tension_N);
    EXPECT_EQ(sample.chord_m, outputs.chord_m);
    EXPECT_EQ(sample.contact_fraction, outputs.contact_fraction);
    EXPECT_EQ(sample.load_pressure_Pa, outputs.load_pressure_Pa);
    const double pressure_rise_Pa = (outputs.pendent_tension_N - equilibrium.pendent_tension_N) / 0.0645;
    EXPECT_GT(pressure_rise_Pa, 0.0);
    EXPECT_NEAR(sample.hydraulic_power_W, pressure_rise_Pa * 4.12 * 2e-3, 1e-9 * sample.hydraulic_power_W);
}

}  // namespace
}  // namespace steadyboom::hil
