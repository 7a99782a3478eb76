#include "controllers/observer.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <stdexcept>
#include <string_view>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "hil/lockstep_run.hpp"
#include "hil/state_names.hpp"
#include "plant/equilibrium.hpp"
#include "plant/runge_kutta.hpp"
#include "plant/sensors.hpp"
#include "runtime/realtime_section.hpp"
#include "support/crane_on_the_bus.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::controllers {
namespace {

using namespace plant;

constexpr double period_s = 0.005;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array corrected = {strain_lower_microstrain, strain_upper_microstrain, boom_angle_rad,  line_tension_N,
                                  line_angle_rad,           Sensor::piston_m,         load_pressure_Pa};
constexpr int R9_rate = velocity_offset + R9_m;

CraneMeasurement measurement(const SensorVector& value) {
    CraneMeasurement measured;
    measured.value = value;
    measured.age_ticks.fill(0);
    measured.valid.fill(true);
    return measured;
}

CraneMeasurement only(Sensor channel, const SensorVector& value) {
    CraneMeasurement measured = measurement(value);
    measured.valid.fill(false);
    measured.valid[static_cast<std::size_t>(channel)] = true;
    return measured;
}

/// The observer on its own model: what it computes is right here or nowhere.
class ObserverOnItsOwnModel : public testing::Test {
  protected:
    explicit ObserverOnItsOwnModel(char name = 'A')
        : crane(test_support::thesis_crane(name)), equilibrium(find_equilibrium(crane).state) {
        config.sensor_sigma = sensor_noise(crane.parameters().actuator.spool_travel_m);
    }

    [[nodiscard]] Observer observer() const { return {crane, equilibrium, config}; }
    [[nodiscard]] SensorVector sensors(const CraneState& state) const { return ideal_sensors(crane, state, 0.0); }

    /// The model's own integration, written out once more.
    [[nodiscard]] CraneState onward(CraneState state, double opening_m) const {
        const auto rate = [&](double, const CraneState& x) { return crane.derivative(x, opening_m); };
        for (int i = 0; i < config.substeps; ++i) {
            state = runge_kutta_step(rate, 0.0, state, period_s / config.substeps);
        }
        return state;
    }

    /// Ropes taut, track whole.
    [[nodiscard]] CraneState disturbed() const {
        CraneState state = equilibrium;
        CraneState offset;
        offset << 5e-4, 1e-4, 5e-3, 5e-3, -4e-3, 1e-3, 0.01, 0.01, 2e-3, 0.1, 0.05, -0.05, 2e-3, 0.02, 2e-3;
        return state + offset;
    }

    CraneDynamics crane;
    CraneState equilibrium;
    ObserverConfig config;
};

TEST_F(ObserverOnItsOwnModel, WithNothingMeasuredItIsTheModelsIntegration) {
    Observer blind = observer();
    CraneState state = equilibrium;
    for (int tick = 0; tick < 400; ++tick) {
        const double opening_m = 2e-3 * std::sin(0.05 * tick);
        blind.correct(CraneMeasurement{});
        EXPECT_EQ(blind.estimate().used_channels, 0);
        EXPECT_EQ(blind.estimate().nis, 0.0);
        blind.predict(opening_m);
        state = onward(state, opening_m);
        ASSERT_LT((blind.estimate().state - state).cwiseAbs().maxCoeff(), 1e-11) << tick;
    }
    EXPECT_GT((state - equilibrium).cwiseAbs().maxCoeff(), 1e-3) << "the valve has moved the crane";
}

TEST_F(ObserverOnItsOwnModel, PredictionHoldsThePistonToItsTravel) {
    Observer blind = observer();
    for (int tick = 0; tick < 200; ++tick) {
        blind.predict(5e-3);
        ASSERT_LE(blind.estimate().state[piston_index], 0.10);
    }
    EXPECT_EQ(blind.estimate().state[piston_index], 0.10);
}

TEST_F(ObserverOnItsOwnModel, LookingAheadOnePeriodIsPredictingAndChangesNothing) {
    Observer looking = observer();
    looking.correct(measurement(sensors(disturbed())));
    const CraneState before = looking.estimate().state;
    const CraneState ahead = looking.ahead(1e-3, period_s);
    EXPECT_EQ(looking.estimate().state, before);
    EXPECT_EQ(looking.ahead(1e-3, 0.0), before);
    looking.predict(1e-3);
    EXPECT_LT((looking.estimate().state - ahead).cwiseAbs().maxCoeff(), 1e-13);
}

TEST_F(ObserverOnItsOwnModel, AgreeingSensorsCorrectNothing) {
    Observer agreeing = observer();
    agreeing.correct(measurement(sensors(equilibrium)));
    EXPECT_EQ(agreeing.estimate().state, equilibrium);
    EXPECT_EQ(agreeing.estimate().nis, 0.0);
    EXPECT_EQ(agreeing.estimate().used_channels, 7);
}

TEST_F(ObserverOnItsOwnModel, ConvergesToTheTruthFromADisturbedState) {
    Observer converging = observer();
    CraneState truth = disturbed();
    const CraneState initial_error = (converging.estimate().state - truth).cwiseAbs();
    for (int tick = 0; tick < 1000; ++tick) {
        converging.correct(measurement(sensors(truth)));
        converging.predict(0.0);
        truth = onward(truth, 0.0);
    }
    const CraneState error = (converging.estimate().state - truth).cwiseAbs();
    for (int i = 0; i < state_count; ++i) {
        EXPECT_LT(error[i], 1e-3 * initial_error[i]) << hil::state_names[static_cast<std::size_t>(i)];
    }
}

// Probed alone, channel i shows column i of P H' and S_ii; from these and H, differentiated here, follows the gain
// K = P H' (H P H' + R)^-1 of all channels at once, and their NIS e' S^-1 e.
TEST_F(ObserverOnItsOwnModel, ChannelsOneAfterTheOtherAreAllAtOnce) {
    using Rows = Eigen::Matrix<double, corrected.size(), state_count>;
    using Square = Eigen::Matrix<double, corrected.size(), corrected.size()>;
    using Channels = Eigen::Matrix<double, corrected.size(), 1>;
    const SensorVector rest = sensors(equilibrium);
    Rows H;
    for (int state = 0; state < state_count; ++state) {
        constexpr double difference = 1e-7;
        CraneState above = equilibrium;
        CraneState below = equilibrium;
        above[state] += difference;
        below[state] -= difference;
        const SensorVector slope = (sensors(above) - sensors(below)) / (2.0 * difference);
        for (std::size_t i = 0; i < corrected.size(); ++i) {
            H(static_cast<int>(i), state) = slope[corrected[i]];
        }
    }
    Rows HP;
    Square R = Square::Zero();
    Channels innovation;
    CraneMeasurement together = measurement(rest);
    for (std::size_t channel = 0; channel < corrected.size(); ++channel) {
        const int i = static_cast<int>(channel);
        const double sigma = config.sensor_sigma[corrected[channel]];
        innovation[i] = (i % 2 == 0 ? 2.0 : -3.0) * sigma;
        together.value[corrected[channel]] += innovation[i];
        Observer probed = observer();
        probed.correct(only(corrected[channel], together.value));
        const CraneState K_i = (probed.estimate().state - equilibrium) / innovation[i];
        R(i, i) = sigma * sigma;
        HP.row(i) = K_i.transpose() * (R(i, i) / (1.0 - H.row(i).dot(K_i)));
    }
    const Square S = HP * H.transpose() + R;
    const CraneState expected = HP.transpose() * S.ldlt().solve(innovation);
    Observer all = observer();
    all.correct(together);
    const CraneState error = all.estimate().state - equilibrium - expected;
    EXPECT_LT(error.cwiseQuotient(all.prior_sigma()).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_GT(expected.cwiseQuotient(all.prior_sigma()).cwiseAbs().maxCoeff(), 0.1);
    EXPECT_NEAR(all.estimate().nis, innovation.dot(S.ldlt().solve(innovation)), 1e-4 * all.estimate().nis);
}

TEST_F(ObserverOnItsOwnModel, OneChannelIsFollowedPartOfTheWayAndNeverBeyond) {
    for (const Sensor channel : corrected) {
        Observer following = observer();
        SensorVector seen = sensors(equilibrium);
        const double innovation = 2.0 * config.sensor_sigma[channel];
        seen[channel] += innovation;
        following.correct(only(channel, seen));
        EXPECT_EQ(following.estimate().used_channels, 1);
        const double share =
            (sensors(following.estimate().state)[channel] - sensors(equilibrium)[channel]) / innovation;
        EXPECT_GT(share, 0.001) << hil::sensor_names[static_cast<std::size_t>(channel)];
        EXPECT_LT(share, 1.0) << hil::sensor_names[static_cast<std::size_t>(channel)];
        // nis = innovation^2 / S with S = R / (1 - share).
        EXPECT_NEAR(following.estimate().nis, 4.0 * (1.0 - share), 0.01);
    }
}

TEST_F(ObserverOnItsOwnModel, LineLengthAndSpoolCorrectNothing) {
    for (const Sensor channel : {line_length_m, Sensor::spool_m}) {
        Observer ignoring = observer();
        ignoring.correct(only(channel, SensorVector::Constant(3.0)));
        EXPECT_EQ(ignoring.estimate().state, equilibrium);
        EXPECT_EQ(ignoring.estimate().used_channels, 0);
    }
}

TEST_F(ObserverOnItsOwnModel, SamplesThatAreOldOrBadAreLeftOut) {
    CraneMeasurement measured = measurement(SensorVector::Constant(3.0));
    for (std::size_t i = 0; i < sensor_count; ++i) {
        (i % 2 == 0 ? measured.age_ticks[i] = 1 : measured.valid[i] = false);
    }
    Observer ignoring = observer();
    ignoring.correct(measured);
    EXPECT_EQ(ignoring.estimate().state, equilibrium);
}

// The load is caught, swings up and leaves its line slack: a pin that reads zero then says nothing about R9.
TEST_F(ObserverOnItsOwnModel, ZeroTensionOnASlackModelCorrectsNothing) {
    Observer slack = observer();
    CraneState truth = equilibrium;
    truth[R9_rate] = 1.2;
    const auto tension_N = [&](const CraneState& x) { return crane.outputs(x).load_line_tension_N; };
    int slack_ticks = 0;
    for (int tick = 0; tick < 400; ++tick) {
        slack.correct(measurement(sensors(truth)));
        slack.predict(0.0);
        truth = onward(truth, 0.0);
        const CraneState estimate = slack.estimate().state;
        if (tension_N(estimate) > 0.0) {
            continue;
        }
        ++slack_ticks;
        Observer probed = slack;
        SensorVector zero = sensors(estimate);
        zero[line_tension_N] = 0.0;
        probed.correct(only(line_tension_N, zero));
        EXPECT_EQ(probed.estimate().used_channels, 1);
        EXPECT_EQ(probed.estimate().state, estimate);
        zero[line_tension_N] = 5e3;
        probed.correct(only(line_tension_N, zero));
        EXPECT_GT(probed.estimate().state[R9_m], estimate[R9_m]) << "a tension that is there lengthens the line";
    }
    EXPECT_GT(slack_ticks, 10);
}

TEST_F(ObserverOnItsOwnModel, ZeroTensionOnATautModelShortensTheLine) {
    Observer taut = observer();
    SensorVector zero = sensors(equilibrium);
    zero[line_tension_N] = 0.0;
    taut.correct(only(line_tension_N, zero));
    EXPECT_LT(taut.estimate().state[R9_m], equilibrium[R9_m] - 1e-3);
}

// Noise and process noise, both as the filter assumes them but a hundredth in size, so that the crane stays in its
// linear range: then nis / 0.01^2 is chi-squared with seven degrees of freedom, and its mean over T ticks is 7 with a
// deviation of sqrt(14 / T).
TEST_F(ObserverOnItsOwnModel, InnovationsAreAsLargeAsTheFilterBelieves) {
    constexpr double size = 0.01;
    CraneState process_sigma = CraneState::Constant(1e-5);
    velocities_of(process_sigma) << 1e-2, 2e-3, 2.0, 1e-2, 1e-2, 2e-3, 2e-3;
    process_sigma[piston_index] = 2e-3;
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        std::mt19937_64 random(seed);
        std::normal_distribution<double> normal;
        Observer filter = observer();
        CraneState truth = equilibrium;
        double sum = 0.0;
        constexpr int settling_ticks = 400;
        constexpr int counted_ticks = 2000;
        for (int tick = 0; tick < settling_ticks + counted_ticks; ++tick) {
            SensorVector seen = sensors(truth);
            for (int i = 0; i < sensor_count; ++i) {
                seen[i] += size * config.sensor_sigma[i] * normal(random);
            }
            filter.correct(measurement(seen));
            sum += tick < settling_ticks ? 0.0 : filter.estimate().nis / (size * size);
            filter.predict(0.0);
            truth = onward(truth, 0.0);
            for (int i = 0; i < state_count; ++i) {
                truth[i] += size * process_sigma[i] * std::sqrt(period_s) * normal(random);
            }
        }
        EXPECT_NEAR(sum / counted_ticks, 7.0, 4.0 * std::sqrt(14.0 / counted_ticks)) << "seed " << seed;
    }
}

TEST_F(ObserverOnItsOwnModel, CorrectAndPredictAllocateNothing) {
    Observer quiet = observer();
    const CraneMeasurement all = measurement(sensors(disturbed()));
    const CraneMeasurement one = only(line_tension_N, sensors(disturbed()));
    {
        const runtime::RealtimeSection no_allocation;
        quiet.correct(all);
        quiet.predict(1e-3);
        quiet.correct(one);
        quiet.correct(CraneMeasurement{});
        (void)quiet.ahead(1e-3, 0.004);
    }
    EXPECT_TRUE(quiet.estimate().finite);
}

TEST_F(ObserverOnItsOwnModel, SampleThatIsNoNumberIsToldAtOnceAndStaysTold) {
    for (const Sensor channel : corrected) {
        for (const double bad : {nan, std::numeric_limits<double>::infinity()}) {
            Observer poisoned = observer();
            SensorVector seen = sensors(equilibrium);
            EXPECT_TRUE(poisoned.estimate().finite);
            seen[channel] = bad;
            poisoned.correct(measurement(seen));
            EXPECT_FALSE(poisoned.estimate().finite) << channel;
            poisoned.predict(0.0);
            poisoned.correct(measurement(sensors(equilibrium)));
            EXPECT_FALSE(poisoned.estimate().finite) << channel;
        }
    }
}

TEST_F(ObserverOnItsOwnModel, OpeningThatIsNoNumberIsTold) {
    Observer poisoned = observer();
    poisoned.predict(nan);
    EXPECT_FALSE(poisoned.estimate().finite);
}

TEST_F(ObserverOnItsOwnModel, BadConfigurationIsRefused) {
    const ObserverConfig good = config;
    for (const double bad_s : {0.0, -0.005, nan, std::numeric_limits<double>::infinity()}) {
        config = good;
        config.period_s = bad_s;
        EXPECT_THROW((void)observer(), std::invalid_argument) << bad_s;
    }
    for (const int bad : {0, -4}) {
        config = good;
        config.substeps = bad;
        EXPECT_THROW((void)observer(), std::invalid_argument) << bad;
    }
    for (const Sensor channel : corrected) {
        for (const double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
            config = good;
            config.sensor_sigma[channel] = bad;
            EXPECT_THROW((void)observer(), std::invalid_argument) << channel << " sigma " << bad;
        }
    }
    config = good;
    config.sensor_sigma[line_length_m] = 0.0;
    EXPECT_NO_THROW((void)observer()) << "a channel that is not corrected with needs no sigma";
    equilibrium[q1_m] = nan;
    EXPECT_THROW((void)observer(), std::runtime_error);
}

TEST(ObserverOfEveryCase, HasASteadyCovariance) {
    for (const char name : {'A', 'B', 'C'}) {
        const CraneDynamics crane(test_support::thesis_crane(name));
        const Observer observer(crane, find_equilibrium(crane).state,
                                {.period_s = period_s, .sensor_sigma = sensor_noise(7.6e-3)});
        EXPECT_TRUE(observer.prior_sigma().allFinite()) << name;
        EXPECT_GT(observer.prior_sigma().minCoeff(), 0.0) << name;
        EXPECT_LT(observer.prior_sigma()[R1_m], 1e-3) << name << ": it knows the ground without measuring it";
    }
}

// ---- on the virtual crane, which differs from the model -----------------------------------------------------------

/// Largest share of error to motion, both RMS over the run, that the estimate of a state may have.
double largest_share(int index) {
    switch (index) {
        case R1_m:
        case phi2_rad:
            return 0.04;
        case R9_m:
        case q1_m:
        case q2_m:
        case phi6_rad:
        case phi9_rad:
            return 0.05;
        case R9_rate:
            return 0.25;
        case velocity_offset + q2_m:
            return 0.15;
        case piston_index:
            return 0.10;
        default:
            return 0.08;
    }
}

TEST(ObserverOnTheVirtualCrane, FollowsEveryStateOfCaseAThroughNoiseSpoolLagAndSlackRopes) {
    for (const LawKind law : {LawKind::none, LawKind::joint_deflection}) {
        for (const std::uint64_t seed : {1U, 2U, 3U}) {
            const hil::RunResult run = hil::run_in_lockstep(
                {.crane_case = hil::load_case("case-a"), .law = law, .duration_s = 10.0, .seed = seed});
            ASSERT_TRUE(run.stayed_engaged) << run.trouble;
            const CraneState rest = run.ticks.front().truth.state;
            CraneState error = CraneState::Zero();
            CraneState motion = CraneState::Zero();
            for (const hil::RunTick& tick : run.ticks) {
                if (tick.truth.t_s >= 0.0) {
                    error += (CraneState(tick.record.estimate.data()) - tick.truth.state).cwiseAbs2();
                    motion += (tick.truth.state - rest).cwiseAbs2();
                }
            }
            const CraneState share = error.cwiseQuotient(motion).cwiseSqrt();
            for (int i = 0; i < state_count; ++i) {
                EXPECT_LT(share[i], largest_share(i))
                    << hil::state_names[static_cast<std::size_t>(i)] << ", law " << name_of(law) << ", seed " << seed;
            }
        }
    }
}

/// Error to motion of the uncontrolled case A in its first 10 s, without the channels of `missing`.
CraneState share_without(std::span<const Sensor> missing, int& used_channels) {
    const hil::Case crane_case = hil::load_case("case-a");
    test_support::CraneOnTheBus bench(crane_case.crane);
    const CraneDynamics model(crane_case.crane);
    Observer observer(model, find_equilibrium(model).state,
                      {.period_s = period_s,
                       .sensor_sigma = test_support::noise_on_the_bus(
                           sensor_noise(crane_case.crane.actuator.spool_travel_m), bench.network.table())});
    bench.start();
    const CraneState rest = bench.state();
    bench.crane.brake(crane_case.manoeuvre.brake_rate_m_s());
    CraneState error = CraneState::Zero();
    CraneState motion = CraneState::Zero();
    for (int tick = 0; tick < 2000; ++tick) {
        const CraneState truth = bench.state();
        CraneMeasurement measured = bench.tick();
        for (const Sensor channel : missing) {
            measured.valid[static_cast<std::size_t>(channel)] = false;
        }
        observer.correct(measured);
        used_channels = observer.estimate().used_channels;
        observer.predict(0.0);
        EXPECT_TRUE(observer.estimate().finite);
        error += (observer.estimate().state - truth).cwiseAbs2();
        motion += (truth - rest).cwiseAbs2();
    }
    return error.cwiseQuotient(motion).cwiseSqrt();
}

struct MissingChannel {
    Sensor channel;
    double largest_share;  ///< of any state; with all channels it is 0.16, that of R9'
};

// About 1.3 times what is measured. Ground and boom stay known whichever channel is missing.
TEST(ObserverOnTheVirtualCrane, StaysBoundedWithoutAnyOneChannel) {
    for (const MissingChannel& missing :
         {MissingChannel{strain_lower_microstrain, 0.2}, MissingChannel{strain_upper_microstrain, 0.2},
          MissingChannel{boom_angle_rad, 0.2}, MissingChannel{line_tension_N, 0.8}, MissingChannel{line_angle_rad, 0.2},
          MissingChannel{Sensor::piston_m, 0.5}, MissingChannel{load_pressure_Pa, 0.2}}) {
        int used_channels = 0;
        const CraneState share = share_without(std::array{missing.channel}, used_channels);
        const std::string_view name = hil::sensor_names[static_cast<std::size_t>(missing.channel)];
        EXPECT_EQ(used_channels, 6) << name;
        EXPECT_LT(share.maxCoeff(), missing.largest_share) << name;
        for (const int index : {R1_m, phi2_rad, q1_m, q2_m, phi6_rad}) {
            EXPECT_LT(share[index], 0.06) << hil::state_names[static_cast<std::size_t>(index)] << " without " << name;
        }
    }
}

TEST(ObserverOnTheVirtualCrane, StaysFiniteWithNoChannelAtAll) {
    int used_channels = 7;
    const CraneState share = share_without(corrected, used_channels);
    EXPECT_EQ(used_channels, 0);
    EXPECT_NEAR(share[R9_m], 1.0, 0.1) << "it has not seen the brake and believes in rest";
}

}  // namespace
}  // namespace steadyboom::controllers
