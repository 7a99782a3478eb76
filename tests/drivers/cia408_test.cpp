#include "drivers/cia408.hpp"

#include <array>
#include <deque>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace steadyboom::drivers {
namespace {

using plant::ValveMode;
using plant::ValveState;
using enum plant::ValveState;

constexpr std::array states = {not_ready, init, disabled, hold, active, fault_hold, fault_reaction, fault_disabled};

/// Words that bring a valve from power-on into each state, and the fault that must act meanwhile.
Cia408Valve valve_in(ValveState state) {
    Cia408Valve valve;
    switch (state) {
        case not_ready:
            break;
        case init:
            valve.step({});
            break;
        case disabled:
            valve.step({.control_word_raw = 0b001});
            break;
        case hold:
            valve.step({.control_word_raw = 0b011});
            break;
        case active:
            valve.step({.control_word_raw = 0b111});
            break;
        case fault_hold:
            valve.step({.control_word_raw = 0b011});
            valve.step({.control_word_raw = 0b011, .fault = ValveFault::holds});
            break;
        case fault_reaction:
            valve.step({.control_word_raw = 0b111});
            valve.step({.control_word_raw = 0b111, .fault = ValveFault::holds, .reaction_done = false});
            break;
        case fault_disabled:
            valve.step({.control_word_raw = 0b001});
            valve.step({.control_word_raw = 0b001, .fault = ValveFault::holds});
            break;
    }
    EXPECT_EQ(valve.state(), state);
    return valve;
}

/// One letter for each state, as the tables below spell them.
ValveState named(char letter) {
    switch (letter) {
        case 'n':
            return not_ready;
        case 'i':
            return init;
        case 'd':
            return disabled;
        case 'h':
            return hold;
        case 'a':
            return active;
        case 'H':
            return fault_hold;
        case 'R':
            return fault_reaction;
        default:
            return fault_disabled;
    }
}

struct Row {
    ValveState from;
    const char* to;  ///< by the bits M H D of the word, 000 to 111
};

void expect_table(const std::vector<Row>& rows, Cia408Valve::Inputs inputs) {
    ASSERT_EQ(rows.size(), states.size());
    for (const auto& row : rows) {
        for (std::uint16_t word = 0; word < 16; ++word) {
            auto valve = valve_in(row.from);
            inputs.control_word_raw = word;
            const auto to = valve.step(inputs);
            // With the reset bit the word has an edge only if the other bits stay: the tests of resets look at those.
            const bool resets = word == 0b1001 || word == 0b1011;
            if (!(is_fault(row.from) && resets)) {
                EXPECT_EQ(static_cast<int>(to), static_cast<int>(named(row.to[word & 7U])))
                    << "from " << static_cast<int>(row.from) << " by word " << word;
            }
            EXPECT_EQ(valve.step(inputs), to) << "the same inputs again change nothing";
        }
    }
}

TEST(Cia408Valve, EveryStateAndControlWordWithoutFault) {
    expect_table(
        {
            {not_ready, "idihidia"},
            {init, "idihidia"},
            {disabled, "iddhddda"},
            {hold, "idhhhhha"},
            {active, "idhhaaaa"},
            {fault_hold, "DDHHHHHH"},
            {fault_reaction, "DDHHHHHH"},
            {fault_disabled, "DDDDDDDD"},
        },
        {});
}

TEST(Cia408Valve, EveryStateAndControlWordBeforeTheSelfTestIsDone) {
    expect_table(
        {
            {not_ready, "nnnnnnnn"},
            {init, "idihidia"},
            {disabled, "iddhddda"},
            {hold, "idhhhhha"},
            {active, "idhhaaaa"},
            {fault_hold, "DDHHHHHH"},
            {fault_reaction, "DDHHHHHH"},
            {fault_disabled, "DDDDDDDD"},
        },
        {.initialised = false});
}

TEST(Cia408Valve, EveryStateAndControlWordWithAFaultThatHolds) {
    expect_table(
        {
            {not_ready, "DDDDDDDD"},
            {init, "DDDDDDDD"},
            {disabled, "DDDDDDDD"},
            {hold, "DDHHHHHH"},
            {active, "DDHHHHHH"},
            {fault_hold, "DDHHHHHH"},
            {fault_reaction, "DDHHHHHH"},
            {fault_disabled, "DDDDDDDD"},
        },
        {.fault = ValveFault::holds});
}

TEST(Cia408Valve, EveryStateAndControlWordWithAFaultThatDisables) {
    std::vector<Row> rows;
    for (const auto state : states) {
        rows.push_back({state, "DDDDDDDD"});
    }
    expect_table(rows, {.fault = ValveFault::disables});
}

TEST(Cia408Valve, FaultReactionLastsUntilTheSpoolHasComeToRest) {
    for (const auto fault : {ValveFault::holds, ValveFault::disables}) {
        expect_table(
            {
                {not_ready, "RRRRRRRR"},
                {init, "RRRRRRRR"},
                {disabled, "RRRRRRRR"},
                {hold, "RRRRRRRR"},
                {active, "RRRRRRRR"},
                {fault_hold, fault == ValveFault::holds ? "DDHHHHHH" : "RRRRRRRR"},
                {fault_reaction, "RRRRRRRR"},
                {fault_disabled, "DDDDDDDD"},
            },
            {.fault = fault, .reaction_done = false});
    }
}

TEST(Cia408Valve, WorseFaultDuringTheReactionLowersItsOutcome) {
    auto valve = valve_in(fault_reaction);
    valve.step({.control_word_raw = 0b111, .fault = ValveFault::disables, .reaction_done = false});
    EXPECT_EQ(valve.step({.control_word_raw = 0b111}), fault_disabled);
}

TEST(Cia408Valve, OfAllPairsOfWordsOnlyAPureEdgeOfTheResetBitResetsAndNeverToMotion) {
    for (const auto state : {fault_hold, fault_disabled}) {
        for (const auto fault : {ValveFault::none, ValveFault::holds, ValveFault::disables}) {
            for (std::uint16_t first = 0; first < 16; ++first) {
                for (std::uint16_t second = 0; second < 16; ++second) {
                    auto valve = valve_in(state);
                    const auto between = valve.step({.control_word_raw = first, .fault = fault});
                    const auto to = valve.step({.control_word_raw = second, .fault = fault});
                    const bool edge = second == (first | 8U) && first < 8 && fault == ValveFault::none;
                    // The first word may have been an edge itself, against the word that brought the valve here.
                    if (!is_fault(between)) {
                        EXPECT_EQ(fault, ValveFault::none);
                        EXPECT_EQ(first, state == fault_hold ? 0b1011 : 0b1001);
                        continue;
                    }
                    if (edge && between == fault_disabled && first == 0b001) {
                        EXPECT_EQ(to, disabled);
                    } else if (edge && between == fault_hold && first == 0b011) {
                        EXPECT_EQ(to, hold);
                    } else {
                        EXPECT_TRUE(is_fault(to)) << first << " then " << second;
                    }
                }
            }
        }
    }
}

TEST(Cia408Valve, HeldResetBitResetsOnceOnly) {
    auto valve = valve_in(fault_disabled);
    EXPECT_EQ(valve.step({.control_word_raw = 0b1001, .fault = ValveFault::holds}), fault_disabled)
        << "the fault still lasts";
    EXPECT_EQ(valve.step({.control_word_raw = 0b1001}), fault_disabled) << "that edge is used up";
    EXPECT_EQ(valve.step({.control_word_raw = 0b0001}), fault_disabled);
    EXPECT_EQ(valve.step({.control_word_raw = 0b1001}), disabled);
}

TEST(Cia408Valve, UpperBitsOfTheControlWordMeanNothing) {
    auto valve = valve_in(init);
    EXPECT_EQ(valve.step({.control_word_raw = 0xFFF3}), hold);
}

TEST(Cia408Valve, RandomInputsNeverRaiseAValveWhileItsFaultLasts) {
    const auto level = [](ValveState state) {
        return state == active ? 4 : state == hold ? 3 : state == disabled ? 2 : state == init ? 1 : 0;
    };
    std::mt19937 random(1);
    Cia408Valve valve;
    auto before = valve.state();
    for (int step = 0; step < 200'000; ++step) {
        const auto fault = random() % 4 == 0 ? static_cast<ValveFault>(1 + random() % 2) : ValveFault::none;
        const auto after = valve.step({.control_word_raw = static_cast<std::uint16_t>(random() % 16),
                                       .fault = fault,
                                       .reaction_done = random() % 2 == 0});
        if (fault != ValveFault::none) {
            ASSERT_TRUE(is_fault(after));
        }
        if (is_fault(before)) {
            ASSERT_LE(level(after), level(hold)) << "a reset is never motion";
        }
        before = after;
    }
}

TEST(Cia408StatusWord, EveryStateAndFlagSurvivesTheBus) {
    for (const auto state : states) {
        for (unsigned flags = 0; flags < 16; ++flags) {
            const ValveStatus sent{.state = state,
                                   .pressure_control_effective = (flags & 1U) != 0,
                                   .ramp_running = (flags & 2U) != 0,
                                   .limit_touched = (flags & 4U) != 0,
                                   .control_deviation = (flags & 8U) != 0};
            const auto word = status_word(sent);
            EXPECT_EQ(word, static_cast<unsigned>(state) | flags << 8U);
            EXPECT_EQ(valve_status(word), sent);
        }
    }
}

TEST(Cia408StatusWord, PatternsThatAreNoStateReadAsNotReady) {
    const std::set<unsigned> known = {0b0000, 0b1000, 0b1001, 0b1011, 0b1111, 0b0011, 0b0111, 0b0001};
    for (unsigned word = 0; word <= 0xFFFF; ++word) {
        const auto state = valve_status(static_cast<std::uint16_t>(word)).state;
        const auto nibble = word & 0x0FU;
        ASSERT_EQ(static_cast<unsigned>(state), known.contains(nibble) ? nibble : 0U);
    }
}

TEST(Cia408Controller, FirstWordForEveryWishAndReport) {
    const auto first_word = [](ValveMode wanted, ValveState reported) {
        Cia408Controller controller;
        return controller.control_word(wanted, reported);
    };
    for (const auto state : states) {
        EXPECT_EQ(first_word(ValveMode::disabled, state), 0b0001);
        const bool up = state == disabled || state == hold || state == active;
        EXPECT_EQ(first_word(ValveMode::hold, state), up ? 0b0011 : 0b0001);
        EXPECT_EQ(first_word(ValveMode::active, state), up ? 0b0011 : 0b0001);
    }
}

/// A controller and a valve whose reports come a few ticks late.
class Cia408LoopTest : public ::testing::Test {
  protected:
    ValveState tick(ValveMode wanted, ValveFault fault = ValveFault::none, int lag_ticks = 1) {
        word_ = controller_.control_word(wanted, reports_[static_cast<std::size_t>(lag_ticks - 1)]);
        const auto state = valve_.step({.control_word_raw = word_, .fault = fault});
        reports_.push_front(state);
        reports_.pop_back();
        return state;
    }
    void reach_active() {
        for (int i = 0; i < 20; ++i) {
            tick(ValveMode::active);
        }
        ASSERT_EQ(valve_.state(), active);
    }

    Cia408Controller controller_;
    Cia408Valve valve_;
    std::uint16_t word_ = 0;
    std::deque<ValveState> reports_ = std::deque<ValveState>(5, not_ready);
};

TEST_F(Cia408LoopTest, RaisesOneStateATickAndLowersAtOnce) {
    EXPECT_EQ(tick(ValveMode::disabled), disabled);
    EXPECT_EQ(tick(ValveMode::active), hold);
    EXPECT_EQ(tick(ValveMode::active), active);
    EXPECT_EQ(tick(ValveMode::disabled), disabled);
    EXPECT_EQ(tick(ValveMode::hold), hold);
    EXPECT_EQ(tick(ValveMode::hold), hold);
    EXPECT_EQ(word_ & control_reset, 0) << "no reset unless asked for";
}

TEST_F(Cia408LoopTest, ValveThatFellByItselfIsNotRaisedUntilDisabledWasWanted) {
    reach_active();
    valve_.restart();
    valve_.step({.control_word_raw = 0b001});
    reports_.front() = disabled;
    for (int i = 0; i < 100; ++i) {
        ASSERT_EQ(tick(ValveMode::active), disabled);
        ASSERT_EQ(word_, 0b0001);
        ASSERT_TRUE(controller_.fallen());
    }
    EXPECT_EQ(tick(ValveMode::hold), disabled) << "less is not nothing";
    EXPECT_EQ(tick(ValveMode::disabled), disabled);
    EXPECT_FALSE(controller_.fallen());
    reach_active();
}

TEST_F(Cia408LoopTest, FaultedValveIsKeptDisabledEvenWhenTheFaultResetsItself) {
    reach_active();
    tick(ValveMode::active, ValveFault::holds);
    tick(ValveMode::active);
    EXPECT_EQ(valve_.state(), fault_disabled);
    reports_.front() = hold;  // someone at the valve has reset it
    tick(ValveMode::active);
    EXPECT_EQ(word_, 0b0001);
}

TEST_F(Cia408LoopTest, FaultDuringTheRiseKeepsItDownToo) {
    tick(ValveMode::disabled);
    tick(ValveMode::active);
    tick(ValveMode::active, ValveFault::holds);
    ASSERT_TRUE(is_fault(valve_.state()));
    tick(ValveMode::active);
    valve_ = valve_in(hold);  // someone at the valve has reset it
    reports_.front() = hold;
    for (int i = 0; i < 10; ++i) {
        tick(ValveMode::active);
        EXPECT_EQ(word_, 0b0001);
    }
}

TEST_F(Cia408LoopTest, QuickLoweringAndRaisingIsNoFall) {
    for (int lag_ticks = 1; lag_ticks <= 5; ++lag_ticks) {
        for (const auto low : {ValveMode::hold, ValveMode::disabled}) {
            for (const auto high : {ValveMode::hold, ValveMode::active}) {
                for (int low_ticks = 1; low_ticks <= 8; ++low_ticks) {
                    for (int i = 0; i < 20; ++i) {
                        tick(ValveMode::active, ValveFault::none, lag_ticks);
                    }
                    ASSERT_EQ(valve_.state(), active);
                    for (int i = 0; i < low_ticks; ++i) {
                        tick(low, ValveFault::none, lag_ticks);
                    }
                    for (int i = 0; i < 20; ++i) {
                        tick(high, ValveFault::none, lag_ticks);
                        ASSERT_FALSE(controller_.fallen()) << lag_ticks << " " << low_ticks;
                    }
                    ASSERT_EQ(valve_.state(), high == ValveMode::hold ? hold : active) << lag_ticks << " " << low_ticks;
                }
            }
        }
    }
}

TEST_F(Cia408LoopTest, ResetIsOneEdgeAndLeadsToDisabled) {
    reach_active();
    tick(ValveMode::active, ValveFault::holds);
    for (int i = 0; i < 5; ++i) {
        tick(ValveMode::disabled);
    }
    ASSERT_EQ(valve_.state(), fault_disabled);
    controller_.request_reset();
    std::string reset_bits;
    for (int i = 0; i < 8; ++i) {
        tick(ValveMode::disabled);
        reset_bits += (word_ & control_reset) != 0 ? '1' : '0';
        EXPECT_EQ(word_ & 0b111, 0b001);
    }
    EXPECT_EQ(reset_bits, "00110000");
    EXPECT_EQ(valve_.state(), disabled);
    EXPECT_FALSE(controller_.resetting());
    reach_active();
}

TEST_F(Cia408LoopTest, ResetSurvivesTheLossOfAnyOneFrame) {
    for (int lost = 0; lost < 6; ++lost) {
        auto valve = valve_in(fault_disabled);
        Cia408Controller controller;
        controller.request_reset();
        for (int i = 0; i < 6; ++i) {
            const auto word = controller.control_word(ValveMode::disabled, fault_disabled);
            if (i != lost) {
                valve.step({.control_word_raw = word});
            }
        }
        EXPECT_EQ(valve.state(), disabled) << lost;
    }
}

TEST_F(Cia408LoopTest, ResetWaitsForTheFaultReactionAndIsForgottenWhenMoreIsWanted) {
    controller_.request_reset();
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(controller_.control_word(ValveMode::disabled, fault_reaction), 0b0001);
    }
    EXPECT_TRUE(controller_.resetting());
    EXPECT_EQ(controller_.control_word(ValveMode::hold, fault_disabled), 0b0001);
    EXPECT_FALSE(controller_.resetting());
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(controller_.control_word(ValveMode::disabled, fault_disabled), 0b0001);
    }
}

TEST_F(Cia408LoopTest, WhateverHappensTheWordNeverAsksForMoreThanIsWantedAndNeverForAResetUnasked) {
    std::mt19937 random(4);
    constexpr std::array modes = {ValveMode::disabled, ValveMode::hold, ValveMode::active};
    auto wanted = ValveMode::disabled;
    bool fell = false;
    for (int i = 0; i < 300'000; ++i) {
        if (random() % 16 == 0) {
            wanted = modes[random() % 3];
        }
        if (wanted == ValveMode::disabled) {
            fell = false;
        }
        if (random() % 64 == 0) {
            valve_.restart();
        }
        const auto fault = random() % 64 == 0 ? ValveFault::holds : ValveFault::none;
        tick(wanted, fault);
        const int asked = word_ & 0b111;
        ASSERT_EQ(word_ & control_reset, 0);
        ASSERT_LE(asked, wanted == ValveMode::active ? 0b111 : wanted == ValveMode::hold ? 0b011 : 0b001);
        fell = fell || (controller_.fallen() && wanted != ValveMode::disabled);
        if (fell) {
            ASSERT_EQ(asked, 0b001);
        }
    }
}

}  // namespace
}  // namespace steadyboom::drivers
