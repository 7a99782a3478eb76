#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hil/reproduction/claim.hpp"
#include "hil/reproduction/reproduction_report.hpp"

namespace steadyboom::hil::reproduction {
namespace {

/// What the model says today: a change of the model that turns a verdict must change this file with it. One row a line,
/// its id and its verdict.
std::map<std::string, std::string> pinned() {
    std::ifstream file(STEADYBOOM_VERDICTS);
    EXPECT_TRUE(file) << STEADYBOOM_VERDICTS;
    std::map<std::string, std::string> verdicts;
    for (std::string id, verdict; file >> id && std::getline(file >> std::ws, verdict);) {
        EXPECT_TRUE(verdicts.insert({id, verdict}).second) << id;
    }
    return verdicts;
}

/// The table of docs/reproduction.md: chapter, rows, then how many of each verdict.
std::map<std::string, std::vector<int>> documented_counts() {
    std::ifstream file(STEADYBOOM_REPRODUCTION_PAGE);
    EXPECT_TRUE(file) << STEADYBOOM_REPRODUCTION_PAGE;
    std::map<std::string, std::vector<int>> counts;
    const std::regex row(R"(\| (5|7|8|all) \| (\d+) \| (\d+) \| (\d+) \| (\d+) \|.*)");
    for (std::string line; std::getline(file, line);) {
        if (std::smatch found; std::regex_match(line, found, row)) {
            for (std::size_t i = 2; i <= 5; ++i) {
                counts[found[1]].push_back(std::stoi(found[i]));
            }
        }
    }
    return counts;
}

const auto silent = [](std::string_view) {};

/// Half a second instead of ten: enough for the form of what is written, not for a verdict.
const ThesisRuns& runs() {
    static const ThesisRuns made = run_thesis({.duration_s = 0.5, .period_s = 0.005}, silent);
    return made;
}
const std::vector<Row>& rows() {
    static const std::vector<Row> made = judge(runs());
    return made;
}

/// One misprint that is made up; all else as the command makes it, of the short runs.
const Appendix& appendix() {
    static const Appendix made = [] {
        Appendix of_short_runs{.booms = booms_alone(runs().a.options().crane_case.crane.structure),
                               .conditioning = {conditioning_of(runs().a)},
                               .misprints = {{.id = "m",
                                              .where = "3.1.3-2 <a>",
                                              .printed = "1",
                                              .used = "2",
                                              .calculation = "sum",
                                              .consequence = "none",
                                              .numbers = {{"stiffness_N_m", 3.0}}}},
                               .sensitivity = run_sensitivity(runs(), [](int, int) {})};
        return of_short_runs;
    }();
    return made;
}

TEST(Reproduction, VerdictsAreTheModelsOfTodayAndTheirCountsThoseOfThePage) {
    const ThesisRuns full = run_thesis({}, silent);
    const std::vector<Row> judged = judge(full);
    std::map<std::string, std::string> verdicts = pinned();
    std::map<std::string, std::vector<int>> counts;
    for (const Row& row : judged) {
        EXPECT_EQ(verdicts[row.id], name_of(row.verdict)) << row.id << ": " << row.here << "; " << row.reason;
        verdicts.erase(row.id);
        for (const Measure& measure : row.measures) {
            EXPECT_TRUE(std::isfinite(measure.value)) << row.id << ": " << measure.name;
        }
        for (const std::string& chapter : {row.section.substr(0, 1), std::string("all")}) {
            std::vector<int>& count = counts[chapter];
            count.resize(4);
            ++count[0];
            ++count[1 + static_cast<std::size_t>(row.verdict)];
        }
    }
    EXPECT_TRUE(verdicts.empty()) << verdicts.begin()->first << " is no row";
    EXPECT_EQ(documented_counts(), counts);
    // Without a law the piston only yields with the oil, and the soil takes what the boom's own damping does not.
    const double start_J = full.a.signal(Signal::crane_energy_J).front();
    const double end_J = full.a.signal(Signal::crane_energy_J).back();
    EXPECT_LT(std::abs(full.a.piston_work_J()), 0.01 * start_J);
    EXPECT_LT(full.a.soil_work_J(), 0.0);
    EXPECT_GT(full.a.soil_work_J(), -(start_J - end_J) * 1.1);
    EXPECT_LT(full.a2.piston_work_J(), 0.0);
}

TEST(Reproduction, EveryRowSaysAllThatAReaderNeeds) {
    std::set<std::string> ids;
    for (const Row& row : rows()) {
        EXPECT_TRUE(ids.insert(row.id).second) << row.id;
        for (const std::string* field : {&row.section, &row.figures, &row.claim, &row.thesis, &row.here, &row.reason}) {
            EXPECT_FALSE(field->empty()) << row.id;
        }
        EXPECT_FALSE(row.measures.empty()) << row.id;
        if (row.verdict == Verdict::does_not_hold) {
            EXPECT_FALSE(row.would_hold_if.empty()) << row.id;
        }
        if (row.verdict == Verdict::holds) {
            EXPECT_TRUE(row.would_hold_if.empty()) << row.id;
        }
        for (const Measure& measure : row.measures) {
            EXPECT_LE(measure.in_kind.low, measure.holds.low) << row.id << ": " << measure.name;
            EXPECT_GE(measure.in_kind.high, measure.holds.high) << row.id << ": " << measure.name;
            EXPECT_LE(measure.verdict(), row.verdict) << row.id << ": " << measure.name;
        }
    }
}

TEST(Reproduction, VerdictsFollowTheStatedRules) {
    EXPECT_EQ(number("", "kW", 13.0, 14.2).verdict(), Verdict::holds);
    EXPECT_EQ(number("", "kW", 13.0, 14.4).verdict(), Verdict::holds_in_kind);
    EXPECT_EQ(number("", "kW", 13.0, 26.1).verdict(), Verdict::does_not_hold);
    EXPECT_EQ(number("", "kW", 13.0, -13.0).verdict(), Verdict::does_not_hold);
    EXPECT_EQ(frequency("", 7.0, 6.4).verdict(), Verdict::holds);
    EXPECT_EQ(frequency("", 7.0, 8.6).verdict(), Verdict::holds_in_kind);
    EXPECT_EQ(frequency("", 7.0, 3.7).verdict(), Verdict::does_not_hold);
    EXPECT_EQ(change("", -43.0, -39.0).verdict(), Verdict::holds);
    EXPECT_EQ(change("", -43.0, -3.0).verdict(), Verdict::holds_in_kind);
    EXPECT_EQ(change("", -43.0, 3.0).verdict(), Verdict::does_not_hold);
    EXPECT_EQ(change("", -5.0, -6.9).verdict(), Verdict::holds);
    EXPECT_EQ(at_most("", "", 0.6, 0.5, 0.8).verdict(), Verdict::holds_in_kind);
    EXPECT_EQ(at_least("", "", 0.6, 0.5, 0.3).verdict(), Verdict::holds);
    EXPECT_EQ(smaller("", 1.01).verdict(), Verdict::does_not_hold);
    EXPECT_EQ(larger("", 1.01).verdict(), Verdict::holds);
    EXPECT_EQ(larger("", std::numeric_limits<double>::quiet_NaN()).verdict(), Verdict::does_not_hold);
    EXPECT_EQ(larger("", std::numeric_limits<double>::infinity()).verdict(), Verdict::does_not_hold);
    EXPECT_EQ(same("", 1.09).verdict(), Verdict::holds);
    EXPECT_EQ(same("", 1.2).verdict(), Verdict::holds_in_kind);
}

TEST(Reproduction, JsonHoldsEveryRowMeasureAndRange) {
    const auto document = nlohmann::json::parse(json_of(rows(), appendix(), runs()));
    EXPECT_EQ(document.at("counts").at("rows"), rows().size());
    EXPECT_EQ(document.at("counts").at("does not hold"), count(rows(), Verdict::does_not_hold));
    ASSERT_EQ(document.at("rows").size(), rows().size());
    for (std::size_t i = 0; i < rows().size(); ++i) {
        const auto& row = document["rows"][i];
        EXPECT_EQ(row.at("id"), rows()[i].id);
        EXPECT_EQ(row.at("verdict"), name_of(rows()[i].verdict));
        ASSERT_EQ(row.at("measures").size(), rows()[i].measures.size());
        for (std::size_t k = 0; k < rows()[i].measures.size(); ++k) {
            const auto& measure = row["measures"][k];
            if (std::isfinite(rows()[i].measures[k].value)) {
                EXPECT_EQ(measure.at("value").get<double>(), rows()[i].measures[k].value);
            } else {
                EXPECT_TRUE(measure.at("value").is_null());
            }
            EXPECT_EQ(measure.at("holds").size(), 2u);
            EXPECT_EQ(measure.at("holds_in_kind").size(), 2u);
        }
    }
}

TEST(Reproduction, JsonAndPageHoldRunsConditioningMisprintsAndSensitivity) {
    const auto document = nlohmann::json::parse(json_of(rows(), appendix(), runs()));
    EXPECT_EQ(document.at("misprints").at(0).at("numbers").at("stiffness_N_m"), 3.0);
    EXPECT_EQ(document.at("booms").at(2).at("first_frequency_Hz"), appendix().booms[2].first_Hz);
    EXPECT_EQ(document.at("conditioning").at(0).at("worst_condition"), appendix().conditioning[0].worst_condition);
    ASSERT_EQ(document.at("runs").size(), runs().all().size());
    const auto& a = document["runs"][0];
    EXPECT_EQ(a.at("figures").size(), figure_rows.size());
    EXPECT_EQ(a.at("modes").size(), runs().a.modes().size());
    const std::vector<SpectralPeak> peaks = visible_peaks(runs().a, Signal::q1_m);
    ASSERT_EQ(a.at("spectral_peaks").at("q1_m").size(), peaks.size());
    EXPECT_EQ(a["spectral_peaks"]["q1_m"].at(0).at("frequency_Hz"), peaks.at(0).frequency_Hz);

    const std::vector<Variation>& variations = appendix().sensitivity.variations;
    const auto& judged = document.at("sensitivity").at("variations");
    ASSERT_EQ(judged.size(), variations.size());
    EXPECT_EQ(judged[0].at("rows").size(), rows().size());
    EXPECT_EQ(judged[0]["rows"].at(rows()[0].id).at("verdict"), name_of(variations[0].rows[0].verdict));

    const std::string page = page_of(rows(), appendix(), runs());
    EXPECT_NE(page.find("3.1.3-2 &lt;a&gt;"), std::string::npos);
    for (const Variation& variation : variations) {
        EXPECT_NE(page.find(variation.symbol), std::string::npos) << variation.symbol;
        EXPECT_NE(page.find(name_of(variation)), std::string::npos) << name_of(variation);
    }
}

TEST(Reproduction, TableListsEveryRow) {
    const std::string table = table_of(rows());
    for (const Row& row : rows()) {
        EXPECT_NE(table.find(row.id + " "), std::string::npos) << row.id;
    }
}

TEST(Reproduction, QuickPageLeavesOutWhatWasNotDone) {
    const std::string page = page_of(rows(), {}, runs());
    EXPECT_EQ(page.find("<h2>Sensitivity"), std::string::npos);
    EXPECT_EQ(page.find("<h2>Misprints"), std::string::npos);
    EXPECT_NE(page.find("</html>"), std::string::npos);
}

TEST(Reproduction, ClaimsStandBeforeFiguresAndFiguresBeforeTheAppendix) {
    const std::string page = page_of(rows(), appendix(), runs());
    EXPECT_LT(page.find("<td>8-19</td>"), page.find("<b>Fig. 24, "));
    EXPECT_LT(page.find("<b>Fig. 58, 100"), page.find("<h2>Sensitivity"));
}

TEST(Reproduction, TextsAboutModesQuoteTheModesOfTheRun) {
    const std::string words = mode_would_have_to_be(runs().a, 7.0);
    // 10.4 Hz is nearer to 7 Hz than 3.7 Hz is, as a ratio; (7 / 10.4)^2 = 0.45.
    EXPECT_NE(words.find("is at 10.4 Hz and would need 0.45 times"), std::string::npos) << words;
    EXPECT_NE(words.find(modes_in_words(runs().a)), std::string::npos) << words;
    EXPECT_EQ(modes_in_words(runs().a), "0.14, 1.4, 3.7, 10, 18, 18 Hz");
}

TEST(Reproduction, RerunMakesTheNamedCaseAnewAndSharesTheOthers) {
    const ThesisRuns soft =
        rerun(runs(), "case-b", [](plant::CraneParameters& crane) { crane.ropes.pendent_stiffness_N_m *= 0.5; });
    const std::vector<const ThesisRun*> before = runs().all();
    const std::vector<const ThesisRun*> after = soft.all();
    for (std::size_t i = 0; i < before.size(); ++i) {
        const bool shared = &before[i]->signal(Signal::R1_m) == &after[i]->signal(Signal::R1_m);
        EXPECT_EQ(shared, before[i]->options().crane_case.name != "case-b") << before[i]->name();
        EXPECT_EQ(before[i]->name(), after[i]->name());
        const double factor = shared ? 1.0 : 0.5;
        EXPECT_EQ(after[i]->options().crane_case.crane.ropes.pendent_stiffness_N_m,
                  factor * before[i]->options().crane_case.crane.ropes.pendent_stiffness_N_m);
    }
}

TEST(Reproduction, BoomEnergyIsThatOfTheRunsOwnBoom) {
    const plant::StructureParameters& structure = runs().a.options().crane_case.crane.structure;
    const double R_B = structure.boom_length_m;
    const double E_I = structure.bending_stiffness_N_m2();
    const auto bending_J = [&](const ThesisRun& run, std::size_t sample) {
        const double q1 = run.signal(Signal::q1_m)[sample];
        const double q2 = run.signal(Signal::q2_m)[sample];
        if (run.options().crane_case.boom == BoomKind::links) {  // 3.1.1-19
            return 243.0 * E_I / std::pow(R_B, 3) * (q1 * q1 + q2 * q2 - q1 * q2);
        }
        const double a1 = (q1 + q2) / std::sqrt(3.0);  // the third mode rests at both thirds
        const double a2 = (q1 - q2) / std::sqrt(3.0);
        return 0.25 * E_I * std::pow(std::numbers::pi, 4) / std::pow(R_B, 3) * (a1 * a1 + 16.0 * a2 * a2);
    };
    for (const ThesisRun* run : {&runs().a, &runs().a_beam}) {
        const std::vector<double>& boom_J = run->signal(Signal::boom_energy_J);
        EXPECT_EQ(boom_J.front(), 0.0) << run->name();
        double all_J = 0.0, bent_J = 0.0;
        for (std::size_t i = 0; i < boom_J.size(); ++i) {
            EXPECT_GE(boom_J[i], bending_J(*run, i) * (1.0 - 1e-9)) << run->name() << " at sample " << i;
            all_J += boom_J[i];
            bent_J += bending_J(*run, i);
        }
        EXPECT_LT(all_J, 3.0 * bent_J) << run->name() << ": it bends more than it moves";
    }
}

TEST(Reproduction, CondensationMakesTheThreeLinksSevenAndAHalfTimesAsStiffAsThePinnedBeam) {
    const plant::StructureParameters& structure = runs().a.options().crane_case.crane.structure;
    const std::vector<BoomAlone> rows = booms_alone(structure);
    ASSERT_EQ(rows.size(), 3U);
    const double l = structure.link_length_m();
    const double unit_N_m = structure.boom_joint_stiffness_N_m / (3.0 * l * l);  // E I / L_B^3
    // 3.1.1-19: 9 E I / L_B^3 (2, -1; -1, 2). The textbook's simply supported beam: F = 6 E I w / (5 L_B^3).
    EXPECT_NEAR(rows[0].stiffness_N_m, 9.0 * unit_N_m, 1e-9 * unit_N_m);
    EXPECT_NEAR(rows[1].stiffness_N_m, 1.2 * unit_N_m, 1e-9 * unit_N_m);
    EXPECT_NEAR(rows[0].first_Hz / rows[1].first_Hz, std::sqrt(7.5), 1e-9);
    EXPECT_GT(rows[0].first_Hz / rows[2].first_Hz, 3.0);
}

TEST(Conditioning, MassMatrixIsFarFromSingularInEveryCaseAndBothSolversAgree) {
    for (const ThesisRun* run : {&runs().a, &runs().b, &runs().c, &runs().a_beam}) {
        const bool links = run->options().crane_case.boom == BoomKind::links;
        const Conditioning row = conditioning_of(*run);
        EXPECT_EQ(row.run, run->name());
        EXPECT_EQ(row.rows, links ? 7 : 8) << row.run;
        EXPECT_GT(row.condition_at_rest, links ? 1e5 : 1e4) << row.run;
        EXPECT_LT(row.worst_condition, 1e6) << row.run;
        EXPECT_LT(row.worst_scaled_condition, 300.0) << row.run;
        EXPECT_GT(row.worst_condition, row.condition_at_rest) << row.run;
        EXPECT_GT(row.worst_scaled_condition, row.scaled_condition_at_rest) << row.run;
        EXPECT_GE(row.rows_without_dominant_diagonal, 5) << row.run;  // what the thesis calls ill-conditioned
        EXPECT_GT(row.solver_difference, 0.0) << row.run;
        EXPECT_LT(row.solver_difference, 1e-12) << row.run;
    }
}

TEST(Reproduction, PageIsSelfContainedAndNamesEveryRowAndFigure) {
    const std::string page = page_of(rows(), appendix(), runs());
    for (const Row& row : rows()) {
        EXPECT_NE(page.find("<td>" + row.id + "</td>"), std::string::npos) << row.id;
    }
    for (const std::string_view foreign : {"src=", "<link", "<script", "url(http"}) {
        EXPECT_EQ(page.find(foreign), std::string::npos) << foreign;
    }
    EXPECT_NE(page.find("Fig. 24, 63, 71, 81, 101"), std::string::npos);
    EXPECT_LT(page.size(), 6'000'000u);
}

TEST(Reproduction, RunsTooShortForASpectrumAreRefused) {
    EXPECT_THROW((void)run_thesis({.duration_s = 0.005, .period_s = 0.001}, silent), std::invalid_argument);
}

}  // namespace
}  // namespace steadyboom::hil::reproduction
