#include "hil/run_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "hil/figure_table.hpp"
#include "hil/whole_file.hpp"
#include "tests/hil/sample_runs.hpp"

namespace steadyboom::hil {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts(1);
    for (const char character : text) {
        if (character == separator) {
            parts.emplace_back();
        } else {
            parts.back() += character;
        }
    }
    return parts;
}

std::string content_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::set<std::string> names_in(const std::filesystem::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        names.insert(entry.path().filename());
    }
    return names;
}

class RunFolder : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "steadyboom-test-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

    static std::string error(const std::filesystem::path& path) {
        try {
            write_whole_file(path, "content");
        } catch (const std::runtime_error& failure) {
            return failure.what();
        }
        return "";
    }

  private:
    std::filesystem::path folder_;
};

constexpr const char* header =
    "t_s,strain_lower_microstrain_meas,strain_upper_microstrain_meas,boom_angle_rad_meas,line_tension_N_meas,"
    "line_angle_rad_meas,line_length_m_meas,piston_m_meas,spool_m_meas,load_pressure_Pa_meas,"
    "R1_m_est,phi2_rad_est,R9_m_est,q1_m_est,q2_m_est,phi6_rad_est,phi9_rad_est,"
    "R1dot_m_s_est,phi2dot_rad_s_est,R9dot_m_s_est,q1dot_m_s_est,q2dot_m_s_est,phi6dot_rad_s_est,phi9dot_rad_s_est,"
    "piston_m_est,"
    "R1_m_true,phi2_rad_true,R9_m_true,q1_m_true,q2_m_true,phi6_rad_true,phi9_rad_true,"
    "R1dot_m_s_true,phi2dot_rad_s_true,R9dot_m_s_true,q1dot_m_s_true,q2dot_m_s_true,phi6dot_rad_s_true,"
    "phi9dot_rad_s_true,piston_m_true,"
    "valve_m_true,pendent_tension_N_true,load_line_tension_N_true,chord_m_true,contact_fraction_true,"
    "hydraulic_power_W_true,"
    "wanted_opening_m,limited_opening_m,applied_opening_m,authority,interlock_state,limit_reasons,permission_reasons,"
    "observer_nis,sampled_t_s";

/// The cells of one line of ticks.csv by the names of their columns.
std::map<std::string, std::string> cells_of(const std::string& csv, std::size_t line) {
    const std::vector<std::string> lines = split(csv, '\n');
    const std::vector<std::string> names = split(lines[0], ',');
    const std::vector<std::string> values = split(lines[line], ',');
    EXPECT_EQ(values.size(), names.size());
    std::map<std::string, std::string> cells;
    for (std::size_t i = 0; i < names.size(); ++i) {
        cells[names[i]] = values[i];
    }
    return cells;
}

TEST(TicksCsv, HasTheDocumentedColumnsInEveryLine) {
    const RunResult run = sample_run(controllers::LawKind::none, 2e-3);
    const std::vector<std::string> lines = split(ticks_csv(run), '\n');
    ASSERT_EQ(lines.size(), run.ticks.size() + 2);
    EXPECT_EQ(lines.front(), header);
    EXPECT_EQ(lines.back(), "");
    const std::size_t columns = split(header, ',').size();
    for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
        ASSERT_EQ(split(lines[i], ',').size(), columns) << "line " << i;
    }
}

TEST(TicksCsv, NumbersReadBackBitForBit) {
    const RunResult run = sample_run(controllers::LawKind::none, 2e-3);
    const std::string csv = ticks_csv(run);
    for (const std::size_t k : {0U, 1003U, 1200U}) {
        auto cells = cells_of(csv, k + 1);
        const auto& [record, truth] = run.ticks[k];
        EXPECT_EQ(std::stod(cells["t_s"]), truth.t_s);
        EXPECT_EQ(std::stod(cells["R1_m_true"]), truth.state[plant::R1_m]);
        EXPECT_EQ(std::stod(cells["phi6_rad_true"]), truth.state[plant::phi6_rad]);
        EXPECT_EQ(std::stod(cells["phi6_rad_est"]), record.estimate[plant::phi6_rad]);
        EXPECT_EQ(std::stod(cells["piston_m_est"]), record.estimate[plant::piston_index]);
        EXPECT_EQ(std::stod(cells["valve_m_true"]), truth.spool_m);
        EXPECT_EQ(std::stod(cells["pendent_tension_N_true"]), truth.pendent_tension_N);
        EXPECT_EQ(std::stod(cells["hydraulic_power_W_true"]), truth.hydraulic_power_W);
        EXPECT_EQ(cells["wanted_opening_m"], "0.002");
        EXPECT_EQ(cells["limited_opening_m"], "0.0015");
        EXPECT_EQ(cells["applied_opening_m"], "0.00125");
        EXPECT_EQ(cells["authority"], "0.75");
        EXPECT_EQ(cells["interlock_state"], "ENGAGING");
        EXPECT_EQ(cells["limit_reasons"], "20");
        EXPECT_EQ(cells["permission_reasons"], "256");
        EXPECT_EQ(cells["observer_nis"], "8.5");
    }
}

TEST(TicksCsv, LeavesCellsEmptyWhereNoGoodSampleCame) {
    const std::string csv = ticks_csv(sample_run(controllers::LawKind::none, 2e-3));
    auto before_any = cells_of(csv, 2);
    for (const char* name : {"strain_lower_microstrain_meas", "boom_angle_rad_meas", "load_pressure_Pa_meas"}) {
        EXPECT_EQ(before_any[name], "") << name;
    }
    EXPECT_EQ(before_any["sampled_t_s"], "");
    auto later = cells_of(csv, 3);
    EXPECT_EQ(later["strain_lower_microstrain_meas"], "0.1");
    EXPECT_EQ(later["load_pressure_Pa_meas"], "0.9");
    EXPECT_EQ(later["boom_angle_rad_meas"], "") << "one tick old";
    EXPECT_EQ(later["line_angle_rad_meas"], "") << "not valid";
    EXPECT_DOUBLE_EQ(std::stod(later["sampled_t_s"]), -4.995) << "one tick before t_s";
}

TEST(CanLog, NamesTheInProcessBusLikeAnInterface) {
    const RunResult run = sample_run(controllers::LawKind::none, 2e-3);
    EXPECT_EQ(can_log(run.frames, "loopback"),
              "(0000000001.500000) can0 080#\n"
              "(0000000001.500250) can0 1A0#AB01\n");
    EXPECT_THAT(can_log(run.frames, "vcan7"), StartsWith("(0000000001.500000) vcan7 080#\n"));
}

TEST_F(RunFolder, HoldsTheThreeFilesAndNothingElse) {
    const RunResult run = sample_run(controllers::LawKind::joint_deflection, 0.5e-3);
    const auto target = folder() / "new" / "run";
    write_run_folder(target, run);
    write_run_folder(target, run);
    EXPECT_EQ(names_in(target), (std::set<std::string>{"ticks.csv", "can.log", "figures.json"}));
    EXPECT_EQ(content_of(target / "ticks.csv"), ticks_csv(run));
    EXPECT_EQ(content_of(target / "can.log"), can_log(run.frames, run.bus));
    EXPECT_EQ(content_of(target / "figures.json"), figures_json(run, nullptr));
}

TEST_F(RunFolder, FailureNamesThePathAndKeepsTheOldContent) {
    std::ofstream(folder() / "file") << "old";
    EXPECT_THAT(error(folder() / "file" / "inside"),
                AllOf(HasSubstr((folder() / "file").string()), HasSubstr("Not a directory")));
    std::filesystem::create_directories(folder() / "taken" / "full");
    EXPECT_THAT(error(folder() / "taken"), HasSubstr((folder() / "taken").string() + ": cannot be written"));
    EXPECT_EQ(names_in(folder()), (std::set<std::string>{"file", "taken"})) << "a temporary file was left";
    EXPECT_THAT(error("/proc/steadyboom/run"), HasSubstr("/proc/steadyboom/run: cannot be written"));
}

TEST(FiguresJson, HoldsEveryFigureAndTheRatios) {
    const std::vector<RunResult> runs = sample_runs();
    const auto json = nlohmann::json::parse(figures_json(runs[2], &runs[0].figures));
    EXPECT_EQ(json["law"], "joint-deflection");
    EXPECT_EQ(json["case"], "case-a");
    EXPECT_EQ(json["bus"], "loopback");
    EXPECT_EQ(json["rate_Hz"], 200.0);
    EXPECT_EQ(json["duration_s"], 1.0);
    EXPECT_EQ(json["seed"], 7);
    EXPECT_EQ(json["stayed_engaged"], true);
    for (const FigureRow& row : figure_rows) {
        EXPECT_EQ(json[std::string(row.key)], runs[2].figures.*row.value) << row.key;
        EXPECT_TRUE(json["ratio_to_uncontrolled"].contains(std::string(row.key))) << row.key;
    }
    EXPECT_EQ(json["ratio_to_uncontrolled"]["peak_R1_m"], 0.25);
    EXPECT_TRUE(json["ratio_to_uncontrolled"]["pendent_slack_share"].is_null());
    EXPECT_FALSE(nlohmann::json::parse(figures_json(runs[2], nullptr)).contains("ratio_to_uncontrolled"));
}

TEST(Ratio, IsThereOnlyWhereItSaysSomething) {
    const auto row = [](std::string_view key) { return *std::ranges::find(figure_rows, key, &FigureRow::key); };
    const RunFigures uncontrolled{.peak_R1_m = 4e-3, .peak_opening_m = 1e-3};
    const RunFigures figures{.peak_R1_m = 1e-3, .pendent_slack_share = 0.5, .peak_opening_m = 2e-3};
    EXPECT_EQ(ratio_to(uncontrolled, figures, row("peak_R1_m")), 0.25);
    EXPECT_EQ(ratio_to(uncontrolled, figures, row("pendent_slack_share")), std::nullopt) << "the divisor is zero";
    EXPECT_EQ(ratio_to(uncontrolled, figures, row("peak_opening_m")), std::nullopt) << "the row is not compared";
}

}  // namespace
}  // namespace steadyboom::hil
