#include "hil/reproduction/sensitivity.hpp"

#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace steadyboom::hil::reproduction {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Half a second: enough to see what is varied, not for a verdict.
const ThesisRuns& short_runs() {
    static const ThesisRuns made = run_thesis({.duration_s = 0.5, .period_s = 0.005}, [](std::string_view) {});
    return made;
}
const Sensitivity& of_short_runs() {
    static const Sensitivity made = run_sensitivity(short_runs(), [](int, int) {});
    return made;
}

const Variation& variation(const Sensitivity& sensitivity, std::string_view name) {
    for (const Variation& one : sensitivity.variations) {
        if (name_of(one) == name) {
            return one;
        }
    }
    throw std::out_of_range(std::string(name));
}

TEST(Sensitivity, VariesEveryParameterThatHasARangeAndCountsTheVariations) {
    int calls = 0;
    const Sensitivity sensitivity = run_sensitivity(short_runs(), [&](int done, int all) {
        EXPECT_EQ(done, ++calls);
        EXPECT_EQ(all, 19);
    });
    EXPECT_EQ(calls, 19);
    std::set<std::string> names;
    std::set<std::string> symbols;
    std::set<std::string> parameters;
    for (const Variation& one : sensitivity.variations) {
        EXPECT_TRUE(names.insert(name_of(one)).second) << name_of(one);
        EXPECT_TRUE(symbols.insert(one.symbol).second) << one.symbol;
        parameters.insert(one.parameter);
    }
    EXPECT_EQ(names.size(), 19U);
    for (const char* symbol : {"nu = 0.2", "beta_e x 0.25", "K_WRP of B x 0.5", "valve nonlinear"}) {
        EXPECT_TRUE(symbols.contains(symbol)) << symbol;
    }
    for (const SensitivityRange& range : sensitivity.ranges) {
        EXPECT_EQ(parameters.erase(range.parameter), 1U) << range.parameter;
        EXPECT_THAT(range.reason, Not(IsEmpty()));
    }
    EXPECT_THAT(parameters, IsEmpty());
}

TEST(Sensitivity, VariedRowsAreThoseOfTheVariedRuns) {
    const ThesisRuns varied =
        rerun(short_runs(), "", [](plant::CraneParameters& crane) { crane.soil.poisson_ratio = 0.40; });
    const std::vector<Row> expected = judge(varied);
    const std::vector<Row>& rows = variation(of_short_runs(), "soil.poisson_ratio = 0.4").rows;
    ASSERT_EQ(rows.size(), expected.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].verdict, expected[i].verdict) << rows[i].id;
        EXPECT_EQ(rows[i].here, expected[i].here) << rows[i].id;
    }
}

TEST(Sensitivity, PendentOfCaseBLeavesRowsOfTheOtherCasesAsTheyAre) {
    const std::vector<Row> nominal = judge(short_runs());
    const std::vector<Row>& rows = variation(of_short_runs(), "ropes.pendent_stiffness_N_m = 5.155e+06 in case-b").rows;
    int touched = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].id.starts_with("5-A") || rows[i].id.starts_with("7-A") || rows[i].id.starts_with("7-C")) {
            EXPECT_EQ(rows[i].here, nominal[i].here) << rows[i].id;
        }
        touched += rows[i].here == nominal[i].here ? 0 : 1;
    }
    EXPECT_GT(touched, 20);
}

TEST(Sensitivity, CraneThatCannotStandIsAVariationWithItsFailure) {
    for (const Variation& one : of_short_runs().variations) {
        const bool printed_c = name_of(one) == "ropes.pendent_stiffness_N_m = 6.57e+04 in case-c";
        EXPECT_EQ(one.rows.empty(), printed_c) << name_of(one);
        EXPECT_EQ(!one.failure.empty(), printed_c) << name_of(one);
        if (printed_c) {
            EXPECT_THAT(one.failure, HasSubstr("cannot stand"));
        }
    }
}

/// Over the thesis's 10 s, and one variation of 19. Rows that hang on less than a few per cent are not held.
TEST(Sensitivity, SofterPendentInCaseBMakesALaterShockOutdoTheFirstAndTurnsNothingInCaseA) {
    const ThesisRuns runs = run_thesis({}, [](std::string_view) {});
    const std::vector<Row> rows = judge(runs);
    Sensitivity sensitivity;
    sensitivity.variations.push_back(
        {.parameter = "ropes.pendent_stiffness_N_m",
         .value = "half",
         .symbol = "K_WRP of B x 0.5",
         .case_name = "case-b",
         .rows = judge(
             rerun(runs, "case-b", [](plant::CraneParameters& crane) { crane.ropes.pendent_stiffness_N_m *= 0.5; })),
         .failure = {}});
    std::map<std::string, TurnedRow> turned;
    for (const TurnedRow& row : turned_rows(rows, sensitivity)) {
        turned.insert({row.row->id, row});
        ASSERT_EQ(row.turns.size(), 1U);
        EXPECT_EQ(row.turns[0].variation, &sensitivity.variations[0]);
        EXPECT_NE(row.turns[0].to, row.row->verdict);
        EXPECT_FALSE(row.row->id.starts_with("5-A") || row.row->id.starts_with("7-A")) << row.row->id;
    }
    ASSERT_TRUE(turned.contains("5-B-05"));
    EXPECT_EQ(turned.at("5-B-05").row->verdict, Verdict::does_not_hold);
    EXPECT_EQ(turned.at("5-B-05").turns[0].to, Verdict::holds_in_kind);
    EXPECT_LT(turned.size(), rows.size() / 4);
}

}  // namespace
}  // namespace steadyboom::hil::reproduction
