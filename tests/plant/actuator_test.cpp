#include "plant/actuator.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "crane_run.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

constexpr double area_m2 = 0.0645;
constexpr double travel_m = 7.6e-3;

Actuator actuator(ValveModel model, double leakage_m3_s_Pa = 0.0) {
    CraneParameters parameters = test_support::thesis_crane('A');
    parameters.actuator.valve_model = model;
    parameters.actuator.leakage_m3_s_Pa = leakage_m3_s_Pa;
    return {parameters.actuator, parameters.ropes};
}

TEST(LinearValve, FlowIsTheGainTimesTheOpeningAtAnyPressure) {
    const Actuator valve = actuator(ValveModel::linear);
    for (const double pressure_Pa : {0.0, 7e6, 27e6}) {
        EXPECT_DOUBLE_EQ(valve.load_flow_m3_s(1e-3, pressure_Pa), 4.12e-3);
        EXPECT_DOUBLE_EQ(valve.load_flow_m3_s(-2e-3, pressure_Pa), -8.24e-3);
    }
}

TEST(NonlinearValve, GivesTheRatedFlowAtFullOpeningAndRatedPressure) {
    EXPECT_NEAR(actuator(ValveModel::nonlinear).load_flow_m3_s(travel_m, 21e6), 0.0164, 0.00005);
}

TEST(NonlinearValve, PressureHoldsFlowBackOneWayAndDrivesItTheOther) {
    const Actuator valve = actuator(ValveModel::nonlinear);
    const double gain = 0.61 * std::numbers::pi * 1.24e-2;
    EXPECT_NEAR(valve.load_flow_m3_s(2e-3, 7e6), gain * 2e-3 * std::sqrt(21e6 / 850.0), 1e-12);
    EXPECT_NEAR(valve.load_flow_m3_s(-2e-3, 7e6), -gain * 2e-3 * std::sqrt(35e6 / 850.0), 1e-12);
    EXPECT_EQ(valve.load_flow_m3_s(0.0, 7e6), 0.0);
}

TEST(NonlinearValve, CannotLiftAgainstMoreThanTheSupplyButCanStillLower) {
    const Actuator valve = actuator(ValveModel::nonlinear);
    EXPECT_EQ(valve.load_flow_m3_s(5e-3, 28e6), 0.0);
    EXPECT_EQ(valve.load_flow_m3_s(5e-3, 40e6), 0.0);
    EXPECT_LT(valve.load_flow_m3_s(-5e-3, 40e6), 0.0);
}

// The slope of 6-22 at small openings is the linear valve's gain: 4.2 at the thesis's P_L0 of 1.6 MPa.
TEST(NonlinearValve, SlopeAtSmallOpeningsIsTheLinearGain) {
    const Actuator nonlinear = actuator(ValveModel::nonlinear);
    EXPECT_NEAR(nonlinear.load_flow_m3_s(1e-6, 1.6e6) / 1e-6, 4.2, 0.05);
    EXPECT_NEAR(actuator(ValveModel::linear).load_flow_m3_s(1e-6, 1.6e6) / 1e-6, 4.2, 0.1);
}

TEST(Piston, MovesWithTheFlowOverItsAreaWhileThePendentIsSlack) {
    EXPECT_DOUBLE_EQ(actuator(ValveModel::linear).piston_rate_m_s(3e-3, 0.0, 0.7, 0.0), 4.12 * 3e-3 / area_m2);
    EXPECT_DOUBLE_EQ(actuator(ValveModel::linear).piston_rate_m_s(-3e-3, 0.0, 0.7, 0.0), -4.12 * 3e-3 / area_m2);
}

// Behind a shut valve the oil column, 4 beta_e A_p^2 / V_t, is a spring in series with the pendent.
TEST(Piston, ShutValveMakesTheOilASpringInSeriesWithThePendent) {
    const double rope_N_m = 1.59e7;
    const double oil_N_m = 4.0 * 700e6 * area_m2 * area_m2 / 1.31e-2;
    const double series_N_m = 1.0 / (1.0 / rope_N_m + 1.0 / oil_N_m);
    constexpr double pendent_rate_m_s = 0.3;
    const double rate_m_s = actuator(ValveModel::linear).piston_rate_m_s(0.0, 4e5, pendent_rate_m_s, 0.0);
    EXPECT_LT(rate_m_s, 0.0) << "the stretching pendent pulls the piston in";
    EXPECT_NEAR(rope_N_m * (pendent_rate_m_s + rate_m_s), series_N_m * pendent_rate_m_s, 1e-9 * series_N_m);
    EXPECT_NEAR(actuator(ValveModel::linear).oil_compliance_share(), 1.0 - series_N_m / rope_N_m, 1e-12);
}

TEST(Piston, TautPendentAndOpenValveShareTheFlow) {
    const double c_m2 = 1.31e-2 * 1.59e7 / (4.0 * area_m2 * 700e6);
    EXPECT_NEAR(actuator(ValveModel::linear).piston_rate_m_s(2e-3, 4e5, 0.05, 0.0),
                (4.12 * 2e-3 - c_m2 * 0.05) / (area_m2 + c_m2), 1e-14);
}

TEST(Piston, LeakageLetsThePendentOut) {
    const double c_m2 = 1.31e-2 * 1.59e7 / (4.0 * area_m2 * 700e6);
    EXPECT_NEAR(actuator(ValveModel::linear, 1e-11).piston_rate_m_s(0.0, 4e5, 0.0, 0.0),
                -1e-11 * 4e5 / area_m2 / (area_m2 + c_m2), 1e-15);
}

TEST(Piston, StopsAtEitherEndAndComesBackFromIt) {
    const Actuator piston = actuator(ValveModel::linear);
    EXPECT_EQ(piston.piston_rate_m_s(3e-3, 0.0, 0.0, 0.10), 0.0);
    EXPECT_EQ(piston.piston_rate_m_s(-3e-3, 0.0, 0.0, -0.10), 0.0);
    EXPECT_LT(piston.piston_rate_m_s(-3e-3, 0.0, 0.0, 0.10), 0.0);
    EXPECT_GT(piston.piston_rate_m_s(3e-3, 0.0, 0.0, -0.10), 0.0);
    EXPECT_GT(piston.piston_rate_m_s(3e-3, 0.0, 0.0, 0.0999), 0.0);
    EXPECT_EQ(piston.clamp_piston_m(0.11), 0.10);
    EXPECT_EQ(piston.clamp_piston_m(-0.11), -0.10);
    EXPECT_EQ(piston.clamp_opening_m(8e-3), travel_m);
    EXPECT_EQ(piston.clamp_opening_m(-8e-3), -travel_m);
}

// What lies behind the stop is steel: the pendent does not see an overshoot of the integrator.
TEST(Piston, BeyondItsStopPullsNoHarderThanAtIt) {
    const CraneDynamics crane(test_support::thesis_crane('A'));
    CraneState x = find_equilibrium(crane).state;
    x[piston_index] = 0.10;
    const CraneState at_stop = crane.derivative(x, 0.0);
    const double tension_N = crane.outputs(x).pendent_tension_N;
    x[piston_index] = 0.12;
    EXPECT_EQ(crane.derivative(x, 0.0), at_stop);
    EXPECT_EQ(crane.outputs(x).pendent_tension_N, tension_N);
}

TEST(Piston, LengtheningRaisesTheTensionAndLiftsTheBoom) {
    const CraneDynamics crane(test_support::thesis_crane('A'));
    const CraneState rest = find_equilibrium(crane).state;
    CraneState longer = rest;
    longer[piston_index] = 0.01;
    EXPECT_NEAR(crane.outputs(longer).pendent_tension_N - crane.outputs(rest).pendent_tension_N, 1.59e5, 1.0);
    EXPECT_GT(crane.derivative(longer, 0.0)[velocity_offset + phi6_rad], 0.0);
    EXPECT_GT(crane.derivative(rest, 1e-3)[piston_index], 0.0);
}

TEST(Piston, ConstantFlowIntoASlackPendentRunsToTheStopInTheTimeItTakes) {
    // The boom stands so high that the pendent stays slack for the whole stroke.
    const CraneDynamics crane(test_support::thesis_crane('A'));
    CraneState start = find_equilibrium(crane).state;
    start[phi6_rad] += 0.1;
    const double rate_m_s = 4.12 * 5e-3 / area_m2;
    double arrived_s = 0.0;
    run_crane(
        crane, start, 0.4, 1e-3, 1e-9, [](double, const CraneState&) { return 5e-3; },
        [&](double t_s, const CraneState& x, double) {
            ASSERT_EQ(crane.outputs(x).pendent_tension_N, 0.0);
            EXPECT_NEAR(x[piston_index], std::min(0.10, rate_m_s * t_s), 1e-9);
            if (arrived_s == 0.0 && x[piston_index] >= 0.10 - 1e-9) {
                arrived_s = t_s;
            }
        });
    EXPECT_NEAR(arrived_s, 0.10 / rate_m_s, 1e-3);
}

TEST(HydraulicPower, IsTheGainTimesOpeningTimesPressureAboveEquilibriumForBothValves) {
    for (const ValveModel model : {ValveModel::linear, ValveModel::nonlinear}) {
        const Actuator valve = actuator(model);
        EXPECT_NEAR(valve.hydraulic_power_W(1e-3, 5e5, 4e5), 1e5 / area_m2 * 4.12e-3, 1e-9);
        EXPECT_NEAR(valve.hydraulic_power_W(-1e-3, 3e5, 4e5), 1e5 / area_m2 * 4.12e-3, 1e-9);
        EXPECT_LT(valve.hydraulic_power_W(1e-3, 3e5, 4e5), 0.0);
    }
}

}  // namespace
}  // namespace steadyboom::plant
