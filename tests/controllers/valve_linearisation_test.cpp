#include "controllers/valve_linearisation.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "plant/actuator.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::controllers {
namespace {

using namespace plant;

class ValveLinearisationOfCaseA : public testing::Test {
  protected:
    ValveLinearisationOfCaseA() : crane(test_support::thesis_crane('A')), linearisation(crane.actuator) {}

    [[nodiscard]] Actuator valve(ValveModel model) const {
        ActuatorParameters parameters = crane.actuator;
        parameters.valve_model = model;
        return {parameters, crane.ropes};
    }

    CraneParameters crane;
    ValveLinearisation linearisation;
};

// Two derivations meet: the plant's orifice (6-22) under the converted command and the linear valve (6-11) under the
// law's own. 26.6 MPa is the supply less its 5 %.
TEST_F(ValveLinearisationOfCaseA, OrificeUnderTheConvertedCommandGivesTheLinearValvesFlow) {
    const Actuator orifice = valve(ValveModel::nonlinear);
    const Actuator linear = valve(ValveModel::linear);
    for (double pressure_Pa = 0.0; pressure_Pa <= 26.6e6; pressure_Pa += 0.7e6) {
        for (const double opening_m : {-7.6e-3, -3e-3, -1e-4, -1e-9, 1e-9, 1e-4, 3e-3, 7.6e-3}) {
            const ValveCommand spool = linearisation.spool_command({opening_m}, pressure_Pa);
            const double wanted_m3_s = linear.load_flow_m3_s(opening_m, pressure_Pa);
            EXPECT_NEAR(orifice.load_flow_m3_s(spool.opening_m, pressure_Pa), wanted_m3_s,
                        1e-12 * std::abs(wanted_m3_s))
                << opening_m << " m at " << pressure_Pa << " Pa";
        }
    }
}

TEST_F(ValveLinearisationOfCaseA, LiftingAgainstPressureOpensFurtherThanLowering) {
    const double lift_m = linearisation.spool_command({1e-3}, 6.8e6).opening_m;
    const double lower_m = linearisation.spool_command({-1e-3}, 6.8e6).opening_m;
    EXPECT_GT(lift_m, -lower_m);
    EXPECT_NEAR(lift_m / -lower_m, std::sqrt((28.0 + 6.8) / (28.0 - 6.8)), 1e-12);
}

TEST_F(ValveLinearisationOfCaseA, ThereAndBackIsTheSameOpeningEvenAtStall) {
    for (const double pressure_Pa : {0.0, 1.6e6, 6.8e6, 21e6, 27.9e6, 28e6, 60e6}) {
        for (const double opening_m : {-5e-3, -1e-7, 0.0, 1e-7, 5e-3}) {
            const double spool_m = linearisation.spool_command({opening_m}, pressure_Pa).opening_m;
            EXPECT_NEAR(linearisation.linear_opening_m(spool_m, pressure_Pa), opening_m,
                        1e-15 * std::abs(opening_m) * 4)
                << opening_m << " m at " << pressure_Pa << " Pa";
        }
    }
    EXPECT_EQ(linearisation.spool_command({0.0}, 6.8e6).opening_m, 0.0);
}

// The drop is taken as at least 5 % of the supply's: beyond 26.6 MPa the command stays what it is there.
TEST_F(ValveLinearisationOfCaseA, StalledValveAsksForNoEndlessOpening) {
    const double at_floor_m = linearisation.spool_command({1e-3}, 26.6e6).opening_m;
    EXPECT_LT(linearisation.spool_command({1e-3}, 26.5e6).opening_m, at_floor_m);
    for (const double pressure_Pa : {26.7e6, 28e6, 28.1e6, 1e9}) {
        EXPECT_NEAR(linearisation.spool_command({1e-3}, pressure_Pa).opening_m, at_floor_m, 1e-12 * at_floor_m);
    }
    EXPECT_LT(at_floor_m, 5e-3);
}

}  // namespace
}  // namespace steadyboom::controllers
