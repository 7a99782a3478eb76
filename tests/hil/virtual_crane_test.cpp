#include "hil/virtual_crane.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "hil/state_names.hpp"
#include "plant/sensors.hpp"
#include "runtime/realtime_section.hpp"
#include "support/crane_on_the_bus.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::hil {
namespace {

using namespace plant;
using test_support::CraneOnTheBus;

constexpr int ticks_per_s = 200;
constexpr double brake_rate_m_s = 1.22;  ///< case A's: a fall through 76 mm

CraneParameters with_spool(char name = 'A') {
    CraneParameters crane = test_support::thesis_crane(name);
    crane.actuator.spool_bandwidth_Hz = 100.0;
    crane.actuator.spool_damping_ratio = 0.8;
    crane.actuator.spool_delay_s = 0.001;
    return crane;
}

TEST(VirtualCrane, StandsStillAtEquilibrium) {
    for (const char name : {'A', 'B', 'C'}) {
        CraneOnTheBus bench(with_spool(name));
        const CraneState start = bench.state();
        EXPECT_EQ(start, bench.crane.equilibrium().state);
        for (int tick = 0; tick < 10 * ticks_per_s; ++tick) {
            (void)bench.tick();
        }
        EXPECT_LT((bench.state() - start).cwiseAbs().maxCoeff(), 1e-9) << name;
        EXPECT_EQ(bench.crane.truth(0.0).spool_m, 0.0);
    }
}

TEST(VirtualCrane, StandsStillOnABeamBoomToo) {
    for (const char name : {'A', 'B', 'C'}) {
        CraneOnTheBus bench(with_spool(name), 1, 10, BoomKind::beam);
        const CraneState start = bench.state();
        EXPECT_EQ(start, bench.crane.equilibrium().state);
        EXPECT_GT(start[q1_m], 5.0 * CraneOnTheBus(with_spool(name)).state()[q1_m]) << "the beam sags more";
        for (int tick = 0; tick < 10 * ticks_per_s; ++tick) {
            (void)bench.tick();
        }
        EXPECT_LT((bench.state() - start).cwiseAbs().maxCoeff(), 1e-9) << name;
    }
}

TEST(VirtualCrane, BrakeSetsTheLineRateAndNothingElse) {
    CraneOnTheBus bench(with_spool());
    CraneState expected = bench.state();
    bench.crane.brake(brake_rate_m_s);
    expected[velocity_offset + R9_m] = brake_rate_m_s;
    EXPECT_EQ(bench.state(), expected);
}

TEST(VirtualCrane, OnlyAdvanceMovesTheState) {
    CraneOnTheBus bench(with_spool());
    bench.start();
    bench.crane.brake(brake_rate_m_s);
    const CraneState before = bench.state();
    for (int i = 0; i < 20; ++i) {
        (void)bench.sample(5e-3, CraneOnTheBus::engaged);
    }
    EXPECT_EQ(bench.state(), before);
    bench.advance();
    EXPECT_NE(bench.state(), before);
}

/// Everything a run of 2 s says, samples and states.
std::vector<double> run(std::uint64_t seed) {
    CraneOnTheBus bench(with_spool(), seed);
    bench.start();
    bench.crane.brake(brake_rate_m_s);
    std::vector<double> said;
    for (int tick = 0; tick < 2 * ticks_per_s; ++tick) {
        const CraneMeasurement measured = bench.tick(1e-3 * std::sin(0.1 * tick), CraneOnTheBus::engaged);
        said.insert(said.end(), measured.value.begin(), measured.value.end());
        const CraneState state = bench.state();
        said.insert(said.end(), state.begin(), state.end());
    }
    return said;
}

TEST(VirtualCrane, SameSeedGivesTheSameBits) {
    EXPECT_EQ(run(7), run(7));
}

TEST(VirtualCrane, AnotherSeedGivesOtherNoiseAndTheSameMotion) {
    const std::vector<double> one = run(7);
    const std::vector<double> other = run(8);
    ASSERT_EQ(one.size(), other.size());
    constexpr std::size_t per_tick = sensor_count + state_count;
    int different_samples = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
        if (i % per_tick < sensor_count) {
            different_samples += one[i] != other[i] ? 1 : 0;
        } else {
            ASSERT_EQ(one[i], other[i]);
        }
    }
    EXPECT_GT(different_samples, 1000);
}

// Mean and deviation of 8000 samples at rest, through the frames: within four of their own deviations.
TEST(VirtualCrane, SensorsReadTheTruthWithTheStatedNoiseAndTheBussResolution) {
    CraneOnTheBus bench(with_spool());
    bench.start();
    const SensorVector truth = ideal_sensors(CraneDynamics(with_spool()), bench.state(), 0.0);
    const SensorVector stated = test_support::noise_on_the_bus(sensor_noise(7.6e-3), bench.network.table());
    constexpr int samples = 8000;
    SensorVector sum = SensorVector::Zero();
    SensorVector squares = SensorVector::Zero();
    SensorVector neighbours = SensorVector::Zero();
    SensorVector last = SensorVector::Zero();
    for (int i = 0; i < samples; ++i) {
        const CraneMeasurement measured = bench.sample();
        const SensorVector deviation = measured.value - truth;
        for (int channel = 0; channel < sensor_count; ++channel) {
            ASSERT_TRUE(measured.fresh(static_cast<Sensor>(channel)));
        }
        sum += deviation;
        squares += deviation.cwiseAbs2();
        neighbours += deviation.cwiseProduct(last);
        last = deviation;
    }
    for (int channel = 0; channel < sensor_count; ++channel) {
        const auto name = sensor_names[static_cast<std::size_t>(channel)];
        const double sigma = std::sqrt(squares[channel] / samples);
        EXPECT_NEAR(sigma / stated[channel], 1.0, 4.0 / std::sqrt(2.0 * samples)) << name;
        EXPECT_NEAR(sum[channel] / samples, 0.0, 4.0 * stated[channel] / std::sqrt(samples)) << name;
        EXPECT_NEAR(neighbours[channel] / squares[channel], 0.0, 4.0 / std::sqrt(samples)) << name << ": white";
    }
}

// With the cut-off closed X_p' = -share L_p': the oil gives way a little and nothing else moves the piston.
TEST(VirtualCrane, ShutCutoffLocksThePistonButForTheOil) {
    CraneOnTheBus bench(with_spool());
    bench.start();
    constexpr Permission shut{.mode = ValveMode::active, .cutoff_energised = false, .authority = 1.0};
    const CraneDynamics dynamics(with_spool());
    const auto pendent_m = [&] { return dynamics.outputs(bench.state()).pendent_length_m; };
    const double rest_m = pendent_m();
    const double share = dynamics.actuator().oil_compliance_share();
    bench.crane.brake(brake_rate_m_s);
    double largest_m = 0.0;
    double spool_m = 0.0;
    for (int tick = 0; tick < 5 * ticks_per_s; ++tick) {
        (void)bench.tick(5e-3, shut);
        ASSERT_GT(bench.crane.truth(0.0).pendent_tension_N, 0.0);
        ASSERT_NEAR(bench.state()[piston_index], -share * (pendent_m() - rest_m), 1e-8);
        largest_m = std::max(largest_m, std::abs(bench.state()[piston_index]));
        spool_m = bench.crane.truth(0.0).spool_m;
    }
    EXPECT_GT(largest_m, 1e-5) << "the oil was worked";
    EXPECT_NEAR(spool_m, 5e-3, 1e-6) << "and the spool stood open";
}

TEST(VirtualCrane, OpenCutoffLetsTheOpenedValveMoveThePiston) {
    for (const double opening_m : {1e-3, -1e-3}) {
        CraneOnTheBus bench(with_spool());
        bench.start();
        for (int tick = 0; tick < ticks_per_s / 2; ++tick) {
            (void)bench.tick(opening_m, CraneOnTheBus::engaged);
        }
        EXPECT_GT(bench.state()[piston_index] * std::copysign(1.0, opening_m), 0.01);
        EXPECT_TRUE(bench.sample().cutoff_open);
    }
}

// The load pressure holds the flow back one way and drives it the other, which no linear valve does.
TEST(VirtualCrane, ValveIsTheNonlinearOneWhateverTheFileSays) {
    const auto travelled_m = [](double opening_m) {
        CraneOnTheBus bench(with_spool());
        bench.start();
        for (int tick = 0; tick < 20; ++tick) {
            (void)bench.tick(opening_m, CraneOnTheBus::engaged);
        }
        return bench.state()[piston_index];
    };
    EXPECT_EQ(with_spool().actuator.valve_model, ValveModel::linear);
    EXPECT_NEAR(travelled_m(-1e-3) / travelled_m(1e-3), -std::sqrt((28.0 + 6.8) / (28.0 - 6.8)), 0.05);
}

TEST(VirtualCrane, PistonAndSpoolKeepToTheirTravel) {
    for (const double sign : {1.0, -1.0}) {
        CraneParameters parameters = with_spool();
        parameters.actuator.spool_damping_ratio = 0.2;  // overshoots
        CraneOnTheBus bench(parameters);
        bench.start();
        double largest_spool_m = 0.0;
        for (int tick = 0; tick < 4 * ticks_per_s && std::abs(bench.state()[piston_index]) < 0.10; ++tick) {
            (void)bench.tick(sign * 7.6e-3, CraneOnTheBus::engaged);
            largest_spool_m = std::max(largest_spool_m, std::abs(bench.crane.truth(0.0).spool_m));
        }
        (void)bench.tick(sign * 7.6e-3, CraneOnTheBus::engaged);
        EXPECT_EQ(bench.state()[piston_index], sign * 0.10);
        EXPECT_EQ(largest_spool_m, 7.6e-3);
    }
}

/// Unit step response of a spool of 100 Hz.
double response(double zeta, double t_s) {
    const double omega = 2.0 * std::numbers::pi * 100.0;
    const double damped = omega * std::sqrt(1.0 - zeta * zeta);
    const double decay = std::exp(-zeta * omega * t_s);
    return t_s <= 0.0 ? 0.0 : 1.0 - decay * (std::cos(damped * t_s) + zeta * omega / damped * std::sin(damped * t_s));
}

TEST(VirtualCrane, SpoolFollowsASetPointAfterItsDeadTimeAsASecondOrderSystem) {
    CraneOnTheBus bench(with_spool(), 1, 50);  // 0.1 ms steps
    bench.start();
    // The bus carries the set-point in 1/16384 of the travel.
    const double set_point_m = std::round(2e-3 / 7.6e-3 * 16384.0) / 16384.0 * 7.6e-3;
    for (int tick = 1; tick <= 8; ++tick) {
        (void)bench.tick(2e-3, CraneOnTheBus::engaged);
        EXPECT_NEAR(bench.crane.truth(0.0).spool_m, set_point_m * response(0.8, 0.005 * tick - 0.001),
                    1e-5 * set_point_m)
            << tick;
    }
}

// Lightly damped, the spool reaches its stop 4 ms after the order, at speed; from 6 ms on it returns as from rest.
TEST(VirtualCrane, SpoolsStopTakesItsSpeedAway) {
    CraneParameters parameters = with_spool();
    parameters.actuator.spool_damping_ratio = 0.2;
    CraneOnTheBus bench(parameters, 1, 50);
    bench.start();
    (void)bench.tick(7.6e-3, CraneOnTheBus::engaged);
    EXPECT_EQ(bench.crane.truth(0.0).spool_m, 7.6e-3);
    (void)bench.tick(0.0, CraneOnTheBus::engaged);
    EXPECT_NEAR(bench.crane.truth(0.0).spool_m, 7.6e-3 * (1.0 - response(0.2, 0.004)), 1e-5);
}

TEST(VirtualCrane, ValveCentresItselfAndShutsTheCutoffWhenTheControllerFallsSilent) {
    CraneOnTheBus bench(with_spool());
    bench.start();
    for (int tick = 0; tick < 20; ++tick) {
        (void)bench.tick(1e-3, CraneOnTheBus::engaged);
    }
    bench.advance();
    bench.advance();
    bench.advance();
    bench.advance();  // 25 ms after the last order
    EXPECT_EQ(bench.crane.valve().state(), ValveState::active);
    EXPECT_GT(bench.crane.truth(0.0).spool_m, 0.9e-3);
    bench.advance();
    EXPECT_EQ(bench.crane.valve().state(), ValveState::fault_reaction) << "until its spool is at the centre";
    EXPECT_FALSE(bench.crane.valve().cutoff_open());
    for (int i = 0; i < 10; ++i) {
        bench.advance();
    }
    EXPECT_LT(std::abs(bench.crane.truth(0.0).spool_m), 0.01 * 7.6e-3) << "within 75 ms";
    (void)bench.tick();
    const CraneMeasurement measured = bench.tick();
    EXPECT_EQ(measured.valve_state, ValveState::fault_hold);
    EXPECT_FALSE(measured.cutoff_open);
}

// Case B makes both ropes slack.
TEST(VirtualCrane, SlackRopesReadZeroAndNeverLess) {
    CraneOnTheBus bench(with_spool('B'));
    bench.start();
    bench.crane.brake(std::sqrt(2.0 * gravity_m_s2 * 0.305));
    int slack_line_zeros = 0;
    int slack_line = 0;
    int slack_pendent_zeros = 0;
    int slack_pendent = 0;
    for (int tick = 0; tick < 10 * ticks_per_s; ++tick) {
        const TruthSample truth = bench.crane.truth(0.0);
        (void)bench.sample();
        const CraneMeasurement measured = bench.tick();  // answers to the SYNC of sample()
        ASSERT_TRUE(measured.fresh(line_tension_N));
        ASSERT_TRUE(measured.fresh(load_pressure_Pa));
        ASSERT_GE(measured.value[line_tension_N], 0.0);
        ASSERT_GE(measured.value[load_pressure_Pa], 0.0);
        if (truth.load_line_tension_N == 0.0) {
            ++slack_line;
            slack_line_zeros += measured.value[line_tension_N] == 0.0 ? 1 : 0;
        }
        if (truth.pendent_tension_N == 0.0) {
            ++slack_pendent;
            slack_pendent_zeros += measured.value[load_pressure_Pa] == 0.0 ? 1 : 0;
        }
    }
    ASSERT_GT(slack_line, 50);
    ASSERT_GT(slack_pendent, 10);
    EXPECT_NEAR(static_cast<double>(slack_line_zeros) / slack_line, 0.5, 2.5 / std::sqrt(slack_line));
    EXPECT_GT(slack_pendent_zeros, slack_pendent / 4);
    EXPECT_EQ(bench.network.status().faulty_values, 0U) << "no device called its own sample underflow";
}

TEST(VirtualCrane, AllocatesNothingOnceItStands) {
    for (const BoomKind boom : {BoomKind::links, BoomKind::beam}) {
        CraneOnTheBus bench(with_spool(), 1, 10, boom);
        bench.start();
        const runtime::RealtimeSection no_allocation;
        bench.crane.brake(brake_rate_m_s);
        for (int tick = 0; tick < ticks_per_s; ++tick) {
            (void)bench.tick(1e-3, CraneOnTheBus::engaged);
        }
    }
}

TEST(VirtualCrane, CraneThatCannotStandIsRefused) {
    CraneParameters soft = with_spool();
    soft.ropes.pendent_stiffness_N_m = 1e4;
    EXPECT_THROW(CraneOnTheBus{soft}, EquilibriumError);
}

}  // namespace
}  // namespace steadyboom::hil
