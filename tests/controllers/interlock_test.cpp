#include "controllers/interlock.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "runtime/realtime_section.hpp"

namespace steadyboom::controllers {
namespace {

using namespace plant;
using enum InterlockState;

constexpr InterlockConfig config{.period_s = 0.005, .engage_ramp_s = 0.5, .stop_ramp_s = 0.1};
constexpr int ready_ticks = 200;   // 1 s
constexpr int engage_ticks = 100;  // 0.5 s
constexpr int stop_ticks = 20;     // 0.1 s

constexpr std::array all_states = {standby, ready, hold, engaging, active, stopping, fault_hold, limited};
constexpr std::array all_intents = {OperatorIntent::none,      OperatorIntent::arm,   OperatorIntent::engage,
                                    OperatorIntent::disengage, OperatorIntent::reset, OperatorIntent::stop};
constexpr std::array required = {strain_lower_microstrain, strain_upper_microstrain, boom_angle_rad,  line_tension_N,
                                 line_angle_rad,           Sensor::piston_m,         Sensor::spool_m, load_pressure_Pa};

ValveState answer_to(ValveMode mode) {
    switch (mode) {
        case ValveMode::disabled:
            return ValveState::disabled;
        case ValveMode::hold:
            return ValveState::hold;
        case ValveMode::active:
            return ValveState::active;
    }
    return ValveState::fault_hold;
}

/// An interlock among healthy devices; its members are what the next tick brings.
class Machine {
  public:
    Machine() {
        measured.age_ticks.fill(0);
        measured.valid.fill(true);
        measured.emergency_stop_healthy = true;
        measured.safety_inputs_age_ticks = 0;
    }

    const Permission& tick(OperatorIntent intent = OperatorIntent::none) {
        const runtime::RealtimeSection no_allocation;
        if (valve_follows) {
            measured.valve_state = answer_to(permit.mode);
        }
        permit = interlock.evaluate(measured, estimate, health, intent);
        return permit;
    }

    void run(int ticks) {
        for (int i = 0; i < ticks; ++i) {
            (void)tick();
        }
    }

    [[nodiscard]] InterlockState state() const { return interlock.state(); }

    Interlock interlock{config};
    CraneMeasurement measured;
    CraneEstimate estimate;
    Health health;
    bool valve_follows = true;
    Permission permit;
};

/// Brought there by the operator alone; fault_hold by a stop from hold, all well for over a second; limited by a
/// limiting fault, which lasts.
Machine machine_in(InterlockState wanted) {
    Machine machine;
    const auto expect = [&](InterlockState state) { EXPECT_EQ(machine.state(), state) << name_of(wanted); };
    if (wanted == standby) {
        machine.run(10);
        expect(standby);
        return machine;
    }
    machine.run(ready_ticks + 10);
    if (wanted == ready) {
        expect(ready);
        return machine;
    }
    (void)machine.tick(OperatorIntent::arm);
    machine.run(10);
    if (wanted == hold) {
        expect(hold);
        return machine;
    }
    if (wanted == fault_hold) {
        (void)machine.tick(OperatorIntent::stop);
        machine.run(ready_ticks + 10);
        expect(fault_hold);
        return machine;
    }
    (void)machine.tick(OperatorIntent::engage);
    machine.run(10);
    if (wanted == engaging) {
        expect(engaging);
        return machine;
    }
    machine.run(engage_ticks);
    if (wanted == active) {
        expect(active);
        return machine;
    }
    if (wanted == limited) {
        machine.health.bus_reasons = reason_error_passive;
        machine.run(stop_ticks);
        expect(limited);
        return machine;
    }
    (void)machine.tick(OperatorIntent::disengage);
    machine.run(3);
    expect(stopping);
    return machine;
}

bool armed(InterlockState state) {
    return state == hold || moves(state);
}

/// Mode, authority and cut-off belong to the state, and to nothing else.
void expect_permission_of_state(const Machine& machine, const std::string& where) {
    const Permission& permit = machine.permit;
    switch (machine.state()) {
        case standby:
        case ready:
        case fault_hold:
            EXPECT_EQ(permit.mode, ValveMode::disabled) << where;
            EXPECT_FALSE(permit.cutoff_energised) << where;
            EXPECT_EQ(permit.authority, 0.0) << where;
            EXPECT_NE(permit.reasons, reason_none) << where;
            break;
        case hold:
            EXPECT_EQ(permit.mode, ValveMode::hold) << where;
            EXPECT_TRUE(permit.cutoff_energised) << where;
            EXPECT_EQ(permit.authority, 0.0) << where;
            EXPECT_NE(permit.reasons, reason_none) << where;
            break;
        case engaging:
        case active:
        case limited:
        case stopping:
            EXPECT_EQ(permit.mode, ValveMode::active) << where;
            EXPECT_TRUE(permit.cutoff_energised) << where;
            EXPECT_GT(permit.authority, 0.0) << where;
            EXPECT_LE(permit.authority, 1.0) << where;
            break;
    }
    EXPECT_EQ(permit.motion(), moves(machine.state())) << where;
}

// ---- the operator -------------------------------------------------------------------------------------------------

struct Answer {
    bool accepted;
    InterlockState next;
};

/// What each state makes of each intent, all being well. A refused intent leaves the state as it is.
Answer answer(InterlockState state, OperatorIntent intent) {
    switch (intent) {
        case OperatorIntent::none:
            return {false, state};
        case OperatorIntent::arm:
            return state == ready ? Answer{true, hold} : Answer{false, state};
        case OperatorIntent::engage:
            return state == hold ? Answer{true, engaging} : Answer{false, state};
        case OperatorIntent::disengage:
            return moves(state) && state != stopping ? Answer{true, stopping} : Answer{false, state};
        case OperatorIntent::reset:
            return state == fault_hold ? Answer{true, standby} : Answer{false, state};
        case OperatorIntent::stop:
            return {true, moves(state) ? stopping : fault_hold};
    }
    return {false, state};
}

TEST(InterlockTable, EveryStateAnswersEveryIntentAsWritten) {
    for (const InterlockState state : all_states) {
        for (const OperatorIntent intent : all_intents) {
            Machine machine = machine_in(state);
            const bool accepted_before = machine.interlock.accepted();
            (void)machine.tick(intent);
            const std::string where =
                std::string(name_of(state)) + " and intent " + std::to_string(static_cast<int>(intent));
            const Answer expected = answer(state, intent);
            EXPECT_EQ(machine.state(), expected.next) << where;
            EXPECT_EQ(machine.interlock.accepted(),
                      intent == OperatorIntent::none ? accepted_before : expected.accepted)
                << where;
            expect_permission_of_state(machine, where);
        }
    }
}

TEST(Interlock, FateOfAnIntentStaysToldUntilTheNextOne) {
    Machine machine = machine_in(ready);
    (void)machine.tick(OperatorIntent::engage);
    machine.run(3);
    EXPECT_FALSE(machine.interlock.accepted());
    (void)machine.tick(OperatorIntent::arm);
    machine.run(3);
    EXPECT_TRUE(machine.interlock.accepted());
}

TEST(Interlock, IsReadyOnlyAfterOneSecondWithoutFault) {
    Machine machine;
    machine.run(150);
    machine.measured.valid[line_angle_rad] = false;
    (void)machine.tick();
    machine.measured.valid[line_angle_rad] = true;
    machine.run(ready_ticks - 1);
    EXPECT_EQ(machine.state(), standby);
    (void)machine.tick();
    EXPECT_EQ(machine.state(), ready);
    EXPECT_EQ(machine.permit.reasons, reason_not_armed);
}

TEST(Interlock, AuthorityRampsUpEvenlyInTheEngageTime) {
    Machine machine = machine_in(hold);
    (void)machine.tick(OperatorIntent::engage);
    for (int tick = 1; tick < engage_ticks; ++tick) {
        EXPECT_EQ(machine.state(), engaging) << tick;
        EXPECT_NEAR(machine.permit.authority, 0.01 * tick, 1e-12);
        EXPECT_EQ(machine.permit.reasons, reason_none);
        (void)machine.tick();
    }
    machine.run(1);  // rounding may take one more
    EXPECT_EQ(machine.state(), active);
    EXPECT_EQ(machine.permit.authority, 1.0);
}

TEST(Interlock, DisengageRampsDownWithinTheStopTimeAndHolds) {
    Machine machine = machine_in(active);
    double last = 1.0;
    (void)machine.tick(OperatorIntent::disengage);
    int ticks = 1;
    for (; machine.state() == stopping && ticks <= stop_ticks + 1; ++ticks) {
        EXPECT_NEAR(last - machine.permit.authority, 0.05, 1e-12);
        last = machine.permit.authority;
        (void)machine.tick();
    }
    EXPECT_EQ(machine.state(), hold);
    EXPECT_LE(ticks, stop_ticks + 1);
    EXPECT_GE(ticks, stop_ticks);
    EXPECT_EQ(machine.permit.reasons, reason_not_armed) << "nothing is latched";
    (void)machine.tick(OperatorIntent::engage);
    EXPECT_EQ(machine.state(), engaging);
    EXPECT_NEAR(machine.permit.authority, 0.01, 1e-12) << "and the ramp starts from nothing";
}

TEST(Interlock, OperatorsStopRampsDownAndLatches) {
    Machine machine = machine_in(active);
    (void)machine.tick(OperatorIntent::stop);
    EXPECT_NEAR(machine.permit.authority, 0.95, 1e-12);
    machine.run(stop_ticks);
    EXPECT_EQ(machine.state(), fault_hold);
    EXPECT_NE(machine.permit.reasons & reason_operator_stop, 0U);
}

TEST(Interlock, StopWinsOverADisengageUnderWay) {
    Machine machine = machine_in(stopping);
    (void)machine.tick(OperatorIntent::stop);
    machine.run(stop_ticks);
    EXPECT_EQ(machine.state(), fault_hold);
}

// ---- faults -------------------------------------------------------------------------------------------------------

struct Fault {
    const char* name;
    InterlockReason reason;
    bool immediate;
    int ticks;  ///< that it must last until it is one
    std::function<void(Machine&)> begin;
};

const std::vector<Fault>& faults() {
    static const std::vector<Fault> list = [] {
        std::vector<Fault> all = {
            {"estimate not finite", reason_estimate_not_finite, true, 1,
             [](Machine& machine) { machine.estimate.finite = false; }},
            {"emergency stop", reason_emergency_stop, true, 1,
             [](Machine& machine) { machine.measured.emergency_stop_healthy = false; }},
            {"safety inputs silent", reason_emergency_stop, true, 1,
             [](Machine& machine) { machine.measured.safety_inputs_age_ticks = 4; }},
            {"guard violated", reason_guard, true, 1, [](Machine& machine) { machine.health.guard_violated = true; }},
            {"overrun", reason_overrun, false, 1, [](Machine& machine) { machine.health.overran = true; }},
            {"cannot send", reason_bus_fault, false, 2, [](Machine& machine) { machine.health.send_failed = true; }},
            {"valve in a fault", reason_valve_not_following, false, 6,
             [](Machine& machine) {
                 machine.valve_follows = false;
                 machine.measured.valve_state = ValveState::fault_hold;
             }},
        };
        for (const InterlockReason reason : {reason_interface_down, reason_interface_gone, reason_flood}) {
            all.push_back(
                {"bus", reason, false, 1, [reason](Machine& machine) { machine.health.bus_reasons = reason; }});
        }
        for (const InterlockReason reason : {reason_bus_off, reason_spoof}) {
            all.push_back(
                {"bus", reason, true, 1, [reason](Machine& machine) { machine.health.bus_reasons = reason; }});
        }
        for (const Sensor channel : required) {
            all.push_back({"channel silent", reason_channel_missing, false, 1, [channel](Machine& machine) {
                               machine.measured.age_ticks[static_cast<std::size_t>(channel)] = 4;
                           }});
            all.push_back({"channel bad", reason_channel_missing, false, 1, [channel](Machine& machine) {
                               machine.measured.valid[static_cast<std::size_t>(channel)] = false;
                           }});
            all.push_back({"channel never heard", reason_channel_missing, false, 1, [channel](Machine& machine) {
                               machine.measured.age_ticks[static_cast<std::size_t>(channel)] = CraneMeasurement::never;
                           }});
        }
        return all;
    }();
    return list;
}

TEST(InterlockTable, EveryFaultFromEveryStateLeadsWhereItMust) {
    for (const Fault& fault : faults()) {
        for (const InterlockState state : all_states) {
            const std::string where = std::string(fault.name) + " in " + name_of(state);
            Machine machine = machine_in(state);
            const double authority = machine.permit.authority;
            fault.begin(machine);
            for (int tick = 1; tick < fault.ticks; ++tick) {
                (void)machine.tick();
                EXPECT_EQ(machine.permit.reasons & fault.reason, 0U) << where << ": too early";
            }
            (void)machine.tick();
            EXPECT_NE(machine.permit.reasons & fault.reason, 0U) << where;
            expect_permission_of_state(machine, where);

            if (!armed(state)) {
                EXPECT_EQ(machine.state(), state == ready ? standby : state) << where << ": not latched, not ready";
            } else if (fault.immediate || state == hold) {
                EXPECT_EQ(machine.state(), fault_hold) << where << ": in the same tick";
            } else {
                EXPECT_EQ(machine.state(), stopping) << where;
                if (state != engaging) {
                    EXPECT_LT(machine.permit.authority, authority) << where;
                }
                machine.run(stop_ticks);
                EXPECT_EQ(machine.state(), fault_hold) << where << ": within 0.1 s";
                expect_permission_of_state(machine, where);
            }
        }
    }
}

TEST(Interlock, ErrorPassiveTakesAuthorityTo15PercentWhileItLastsAndLatchesNothing) {
    Machine machine = machine_in(active);
    machine.health.bus_reasons = reason_error_passive;
    double last = 1.0;
    for (int tick = 1; tick <= 17; ++tick) {
        const Permission& permit = machine.tick();
        EXPECT_EQ(machine.state(), limited);
        EXPECT_NEAR(last - permit.authority, 0.05, 1e-12) << tick;
        EXPECT_EQ(permit.reasons, reason_error_passive);
        last = permit.authority;
    }
    for (int tick = 0; tick < 1000; ++tick) {
        ASSERT_NEAR(machine.tick().authority, 0.15, 1e-12);
    }
    machine.health.bus_reasons = reason_none;
    for (int tick = 1; tick < 85; ++tick) {
        EXPECT_NEAR(machine.tick().authority, 0.15 + 0.01 * tick, 1e-12) << "back as slowly as when engaging";
        EXPECT_EQ(machine.state(), engaging);
        EXPECT_EQ(machine.permit.reasons, reason_none);
    }
    machine.run(2);
    EXPECT_EQ(machine.state(), active);
}

TEST(Interlock, ALimitWhileEngagingNeverRaisesAuthority) {
    Machine machine = machine_in(hold);
    (void)machine.tick(OperatorIntent::engage);
    machine.run(4);
    const double before = machine.permit.authority;
    machine.health.bus_reasons = reason_error_passive;
    machine.run(100);
    EXPECT_EQ(machine.state(), limited);
    EXPECT_EQ(machine.permit.authority, before);
}

TEST(Interlock, ALimitStandsInTheWayOfReadyArmAndEngage) {
    Machine machine = machine_in(ready);
    machine.health.bus_reasons = reason_error_passive;
    (void)machine.tick(OperatorIntent::arm);
    EXPECT_FALSE(machine.interlock.accepted());
    EXPECT_EQ(machine.state(), standby);

    Machine held = machine_in(hold);
    held.health.bus_reasons = reason_error_passive;
    (void)held.tick(OperatorIntent::engage);
    EXPECT_FALSE(held.interlock.accepted());
    EXPECT_EQ(held.state(), hold) << "not latched";
}

TEST(Interlock, WarningsAreShownAndChangeNothing) {
    for (const InterlockReason reason : {reason_error_warning, reason_frames_lost, reason_bus_setup}) {
        for (const InterlockState state : {standby, ready, hold, engaging, active, fault_hold}) {
            Machine machine = machine_in(state);
            Machine unwarned = machine_in(state);
            machine.health.bus_reasons = reason;
            const Permission& permit = machine.tick();
            const Permission& expected = unwarned.tick();
            EXPECT_EQ(permit.reasons, expected.reasons | reason) << name_of(state);
            EXPECT_EQ(permit.authority, expected.authority);
            EXPECT_EQ(machine.state(), unwarned.state());
        }
        Machine machine;
        machine.health.bus_reasons = reason;
        machine.run(ready_ticks);
        EXPECT_EQ(machine.state(), ready) << reason;
        (void)machine.tick(OperatorIntent::arm);
        EXPECT_TRUE(machine.interlock.accepted());
    }
}

TEST(Interlock, BusOffLockoutHoldsInEveryStateAndIsNeverReset) {
    for (const InterlockState state : all_states) {
        Machine machine = machine_in(state);
        machine.health.bus_reasons = reason_bus_off_lockout;
        EXPECT_FALSE(machine.tick().motion());
        machine.health.bus_reasons = reason_none;
        machine.run(10 * ready_ticks);
        for (const OperatorIntent intent : {OperatorIntent::reset, OperatorIntent::arm, OperatorIntent::engage}) {
            (void)machine.tick(intent);
            EXPECT_FALSE(machine.interlock.accepted()) << name_of(state);
            EXPECT_EQ(machine.state(), fault_hold) << name_of(state);
            EXPECT_NE(machine.permit.reasons & reason_bus_off_lockout, 0U);
        }
    }
}

TEST(Interlock, LineLengthIsNotRequired) {
    Machine machine = machine_in(active);
    machine.measured.age_ticks[line_length_m] = CraneMeasurement::never;
    machine.measured.valid[line_length_m] = false;
    machine.run(100);
    EXPECT_EQ(machine.state(), active);
}

TEST(Interlock, DropoutOfAnyRequiredChannelIsRiddenOutForThreeTicksThenStops) {
    for (const Sensor channel : required) {
        Machine machine = machine_in(active);
        std::uint32_t& age = machine.measured.age_ticks[static_cast<std::size_t>(channel)];
        for (age = 1; age <= 3; ++age) {
            (void)machine.tick();
            ASSERT_EQ(machine.state(), active) << "channel " << channel << " for " << age << " ticks";
        }
        double last = machine.permit.authority;
        (void)machine.tick();
        ASSERT_EQ(machine.state(), stopping) << "channel " << channel;
        for (int ticks = 1; machine.state() == stopping; ++ticks, ++age) {
            ASSERT_LE(ticks, stop_ticks + 1) << "channel " << channel;
            EXPECT_NEAR(last - machine.permit.authority, 0.05, 1e-12);
            last = machine.permit.authority;
            (void)machine.tick();
        }
        EXPECT_EQ(machine.state(), fault_hold);
        EXPECT_EQ(machine.permit.authority, 0.0);
    }
}

TEST(Interlock, ShortDropoutsOfTheSafetyInputsAreRiddenOut) {
    Machine machine = machine_in(active);
    machine.measured.safety_inputs_age_ticks = 3;
    machine.run(10);
    EXPECT_EQ(machine.state(), active);
}

TEST(Interlock, OneFailedSendAndAFewTicksOfValveDelayAreTolerated) {
    Machine machine = machine_in(active);
    for (int i = 0; i < 50; ++i) {
        machine.health.send_failed = i % 2 == 0;
        (void)machine.tick();
    }
    machine.health.send_failed = false;
    machine.valve_follows = false;
    for (int i = 0; i < 60; ++i) {
        machine.measured.valve_state = i % 6 == 5 ? ValveState::active : ValveState::hold;
        (void)machine.tick();
    }
    EXPECT_EQ(machine.state(), active);
}

TEST(Interlock, EachCommandedModeWantsItsOwnValveState) {
    for (const InterlockState state : {hold, active}) {
        for (const ValveState wrong :
             {ValveState::not_ready, ValveState::init, ValveState::disabled, ValveState::hold, ValveState::active,
              ValveState::fault_hold, ValveState::fault_reaction, ValveState::fault_disabled}) {
            Machine machine = machine_in(state);
            if (wrong == answer_to(machine.permit.mode)) {
                continue;
            }
            machine.valve_follows = false;
            machine.measured.valve_state = wrong;
            machine.run(6 + stop_ticks);
            EXPECT_EQ(machine.state(), fault_hold) << name_of(state) << " and valve " << static_cast<int>(wrong);
        }
    }
}

TEST(Interlock, FaultDuringADisengageEndsInFaultHold) {
    Machine machine = machine_in(stopping);
    machine.health.overran = true;
    (void)machine.tick();
    machine.health.overran = false;
    machine.run(stop_ticks);
    EXPECT_EQ(machine.state(), fault_hold);
}

TEST(Interlock, ImmediateFaultDuringARampEndsIt) {
    Machine machine = machine_in(active);
    machine.health.overran = true;
    (void)machine.tick();
    ASSERT_EQ(machine.state(), stopping);
    machine.estimate.finite = false;
    EXPECT_FALSE(machine.tick().motion());
    EXPECT_EQ(machine.state(), fault_hold);
}

TEST(Interlock, RecoveryAloneNeverReEngages) {
    for (const Fault& fault : faults()) {
        Machine machine = machine_in(active);
        const Machine healthy;
        fault.begin(machine);
        machine.run(fault.ticks);
        machine.measured = healthy.measured;
        machine.estimate = healthy.estimate;
        machine.health = healthy.health;
        machine.valve_follows = true;
        machine.run(stop_ticks);
        for (int i = 0; i < 1000; ++i) {
            (void)machine.tick();
            ASSERT_EQ(machine.state(), fault_hold) << fault.name;
        }
        EXPECT_NE(machine.permit.reasons & fault.reason, 0U) << fault.name << ": the reason stays";
        for (const OperatorIntent intent : {OperatorIntent::arm, OperatorIntent::engage, OperatorIntent::disengage}) {
            (void)machine.tick(intent);
            EXPECT_FALSE(machine.interlock.accepted());
            EXPECT_EQ(machine.state(), fault_hold) << fault.name;
        }
        (void)machine.tick(OperatorIntent::reset);
        EXPECT_EQ(machine.state(), standby) << fault.name;
        EXPECT_EQ(machine.permit.reasons & fault.reason, 0U) << fault.name;
        for (int i = 0; i < 1000; ++i) {
            ASSERT_FALSE(machine.tick().motion()) << fault.name << ": needs arm and engage again";
        }
        EXPECT_EQ(machine.state(), ready);
    }
}

TEST(Interlock, DisengagingAfterAFaultAndItsResetHoldsAsBefore) {
    Machine machine = machine_in(active);
    (void)machine.tick(OperatorIntent::stop);
    machine.run(stop_ticks + ready_ticks);
    (void)machine.tick(OperatorIntent::reset);
    machine.run(ready_ticks);
    (void)machine.tick(OperatorIntent::arm);
    machine.run(10);
    (void)machine.tick(OperatorIntent::engage);
    machine.run(engage_ticks + 1);
    ASSERT_EQ(machine.state(), active);
    (void)machine.tick(OperatorIntent::disengage);
    machine.run(stop_ticks);
    EXPECT_EQ(machine.state(), hold);
}

TEST(Interlock, ResetIsRefusedUntilTheCauseIsGoneForASecond) {
    Machine machine = machine_in(active);
    machine.measured.emergency_stop_healthy = false;
    machine.run(300);
    (void)machine.tick(OperatorIntent::reset);
    EXPECT_FALSE(machine.interlock.accepted());
    machine.measured.emergency_stop_healthy = true;
    for (int tick = 1; tick < ready_ticks; ++tick) {
        (void)machine.tick(OperatorIntent::reset);
        ASSERT_FALSE(machine.interlock.accepted()) << tick;
        ASSERT_EQ(machine.state(), fault_hold) << tick;
    }
    (void)machine.tick(OperatorIntent::reset);
    EXPECT_TRUE(machine.interlock.accepted());
    EXPECT_EQ(machine.state(), standby);
}

TEST(Interlock, ArmAndEngageAreRefusedWhileAFaultIsPresent) {
    for (const Fault& fault : faults()) {
        Machine machine = machine_in(ready);
        fault.begin(machine);
        for (int tick = 1; tick < fault.ticks; ++tick) {
            (void)machine.tick();
        }
        (void)machine.tick(OperatorIntent::arm);
        EXPECT_FALSE(machine.interlock.accepted()) << fault.name;
        EXPECT_EQ(machine.state(), standby) << fault.name;

        Machine held = machine_in(hold);
        fault.begin(held);
        for (int tick = 1; tick < fault.ticks; ++tick) {
            (void)held.tick();
        }
        (void)held.tick(OperatorIntent::engage);
        EXPECT_FALSE(held.interlock.accepted()) << fault.name;
        EXPECT_EQ(held.state(), fault_hold) << fault.name;
    }
}

// ---- whatever comes -----------------------------------------------------------------------------------------------

TEST(Interlock, NoSequenceOfInputsMovesTheValveWithoutArmAndEngageAndGoodChannels) {
    EXPECT_TRUE(rc::check("motion only after arm and engage", [] {
        Machine machine;
        bool arm_seen = false;
        bool engage_seen = false;
        double last_authority = 0.0;
        const int stretches = *rc::gen::inRange(1, 80);
        const int fault_weight = *rc::gen::element(0, 1, 5);
        for (int i = 0; i < stretches; ++i) {
            const Machine healthy;
            machine.measured = healthy.measured;
            machine.estimate = healthy.estimate;
            machine.health = healthy.health;
            machine.valve_follows = true;
            const bool faulty = *rc::gen::inRange(0, 20) < fault_weight;
            const Fault* fault = nullptr;
            const bool passive = *rc::gen::inRange(0, 20) == 0;
            if (passive) {
                machine.health.bus_reasons = reason_error_passive;
            }
            if (faulty) {
                fault = &faults()[*rc::gen::inRange<std::size_t>(0, faults().size())];
                fault->begin(machine);
            }
            // Mostly the intent that leads on, so that runs get anywhere.
            OperatorIntent intent = *rc::gen::elementOf(all_intents);
            if (*rc::gen::inRange(0, 3) > 0) {
                intent = machine.state() == ready        ? OperatorIntent::arm
                         : machine.state() == hold       ? OperatorIntent::engage
                         : machine.state() == fault_hold ? OperatorIntent::reset
                                                         : OperatorIntent::none;
            }
            const int ticks = *rc::gen::element(1, 2, 5, 30, 250);
            for (int tick = 0; tick < ticks; ++tick) {
                const InterlockState before = machine.state();
                const OperatorIntent now = tick == 0 ? intent : OperatorIntent::none;
                const Permission& permit = machine.tick(now);
                const InterlockState after = machine.state();
                const bool fault_lasts = fault != nullptr && tick + 1 >= fault->ticks;
                if (machine.health.bus_reasons == reason_error_passive) {
                    RC_ASSERT(permit.authority <= std::max(last_authority - 0.05, limited_authority) + 1e-12);
                    RC_ASSERT(permit.authority <= last_authority && after != engaging && after != active);
                }
                if (before == ready && after == hold) {
                    RC_ASSERT(now == OperatorIntent::arm && !fault_lasts);
                    arm_seen = true;
                }
                if (before == hold && after == engaging) {
                    RC_ASSERT(now == OperatorIntent::engage && arm_seen);
                    engage_seen = true;
                }
                if (after == standby || after == fault_hold) {
                    arm_seen = engage_seen = false;
                }
                if (after == hold) {
                    engage_seen = false;
                }
                RC_ASSERT(permit.motion() == moves(after));
                RC_ASSERT(!permit.motion() || (arm_seen && engage_seen));
                RC_ASSERT(permit.cutoff_energised == armed(after));
                RC_ASSERT(permit.authority >= 0.0 && permit.authority <= 1.0);
                RC_ASSERT(permit.authority - last_authority <= config.period_s / config.engage_ramp_s + 1e-12);
                RC_ASSERT(permit.motion() || permit.authority == 0.0);
                RC_ASSERT(permit.motion() || permit.reasons != reason_none);
                if (fault_lasts) {
                    RC_ASSERT(after != engaging && after != active && after != limited && after != ready &&
                              after != hold);
                    RC_ASSERT(!fault->immediate || !permit.motion());
                    RC_ASSERT(tick + 1 < fault->ticks + stop_ticks + 1 || !permit.motion());
                }
                last_authority = permit.authority;
            }
        }
        RC_CLASSIFY(engage_seen, "ended in motion");
    }));
}

// ---- words and configuration --------------------------------------------------------------------------------------

TEST(Interlock, EveryReasonHasItsOwnWordsAndTheyAreJoinedInOrder) {
    EXPECT_EQ(reasons_in_words(reason_none), "");
    std::vector<std::string> words;
    for (int bit = 0; bit <= 18; ++bit) {
        words.push_back(reasons_in_words(1U << bit));
        EXPECT_FALSE(words.back().empty()) << bit;
        EXPECT_EQ(std::ranges::count(words, words.back()), 1) << words.back();
    }
    EXPECT_EQ(reasons_in_words(reason_emergency_stop | reason_channel_missing), words[0] + ", " + words[2]);
    EXPECT_THAT(words[2], testing::HasSubstr("emergency stop"));
    EXPECT_THAT(words[6], testing::HasSubstr("operator"));
}

TEST(Interlock, StatesHaveTheirNames) {
    const std::array names = {"STANDBY", "READY", "HOLD", "ENGAGING", "ACTIVE", "STOPPING", "FAULT_HOLD", "LIMITED"};
    for (std::size_t i = 0; i < all_states.size(); ++i) {
        EXPECT_STREQ(name_of(all_states[i]), names[i]);
    }
    EXPECT_STREQ(name_of(static_cast<InterlockState>(200)), "?");
}

TEST(Interlock, TimeThatIsNotPositiveIsRefusedByName) {
    const auto complaint = [](const InterlockConfig& bad) -> std::string {
        try {
            const Interlock interlock(bad);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(complaint(config), "");
    for (const double bad_s : {0.0, -0.1, std::nan(""), std::numeric_limits<double>::infinity()}) {
        InterlockConfig bad = config;
        bad.period_s = bad_s;
        EXPECT_THAT(complaint(bad), testing::HasSubstr("period_s")) << bad_s;
        bad = config;
        bad.engage_ramp_s = bad_s;
        EXPECT_THAT(complaint(bad), testing::HasSubstr("engage_ramp_s")) << bad_s;
        bad = config;
        bad.stop_ramp_s = bad_s;
        EXPECT_THAT(complaint(bad), testing::HasSubstr("stop_ramp_s")) << bad_s;
    }
}

}  // namespace
}  // namespace steadyboom::controllers
