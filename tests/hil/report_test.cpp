#include "hil/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>

#include "hil/figure_table.hpp"
#include "hil/plot.hpp"
#include "tests/hil/sample_runs.hpp"

namespace steadyboom::hil {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsNan;
using ::testing::Not;

/// The line of the table that begins with `label`, its words separated by single blanks.
std::string row_of(const std::string& table, const std::string& label) {
    std::istringstream lines(table);
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with(label)) {
            std::istringstream words(line);
            std::string result;
            for (std::string word; words >> word;) {
                result += (result.empty() ? "" : " ") + word;
            }
            return result;
        }
    }
    return "";
}

TEST(FigureTable, ShowsValuesWithTheirRatioToTheUncontrolledRun) {
    const std::string table = figure_table(sample_runs());
    EXPECT_EQ(row_of(table, "peak R1"), "peak R1 mm 2.00 (1.00) 3.00 (1.50) 0.500 (0.25) 26.4 (13.2)");
    EXPECT_EQ(row_of(table, "residual energy"), "residual energy J 2000 (1.00) 3000 (1.50) 500 (0.25) 26400 (13.2)");
    EXPECT_EQ(row_of(table, "peak hydraulic power"), "peak hydraulic power kW 0 17.0 17.0 17.0");
    EXPECT_EQ(row_of(table, "pendent slack"), "pendent slack % 0 0 0 0");
}

TEST(FigureTable, FitsATerminalAndAlignsItsColumns) {
    const std::string table = figure_table(sample_runs());
    std::istringstream lines(table);
    std::vector<std::size_t> ends;
    for (std::string line; std::getline(lines, line);) {
        EXPECT_LE(line.size(), 120U) << line;
        EXPECT_NE(line.back(), ' ') << line;
        if (line.starts_with("peak R1") || line.starts_with("residual energy") || line.starts_with(" ")) {
            ends.push_back(line.size());
        }
    }
    EXPECT_THAT(ends, ElementsAre(ends[0], ends[0], ends[0]));
}

TEST(FigureTable, HasNoRatiosWithoutAnUncontrolledRun) {
    std::vector<RunResult> runs = sample_runs();
    runs.erase(runs.begin());
    EXPECT_EQ(row_of(figure_table(runs), "peak R1"), "peak R1 mm 3.00 0.500 26.4");
}

TEST(FigureTable, SaysWhatElseAReaderMustKnow) {
    std::vector<RunResult> runs = sample_runs();
    EXPECT_THAT(figure_table(runs), Not(HasSubstr(": ")));
    runs[3].stayed_engaged = false;
    runs[3].trouble = "emergency stop";
    runs[1].figures.peak_load_pressure_Pa = 22e6;
    EXPECT_THAT(figure_table(runs),
                AllOf(HasSubstr("swing-rate: the controller was not in command throughout: emergency stop\n"),
                      HasSubstr("boom-angle: the load pressure reached 22.0 MPa, above 21.0 MPa\n")));
}

TEST(Thinning, KeepsThePeaksOfEverySpan) {
    Curve curve;
    for (int i = 0; i < 10'000; ++i) {
        curve.x.push_back(0.001 * i);
        curve.y.push_back(i == 4321 ? 100.0 : i == 7654 ? -50.0 : 0.0);
    }
    const Curve thin = thinned(curve, {0.0, 10.0}, 100);
    EXPECT_LE(thin.x.size(), 200U);
    EXPECT_TRUE(std::ranges::is_sorted(thin.x));
    EXPECT_EQ(std::ranges::max(thin.y), 100.0);
    EXPECT_EQ(std::ranges::min(thin.y), -50.0);
    EXPECT_EQ(thin.x[static_cast<std::size_t>(std::ranges::max_element(thin.y) - thin.y.begin())], curve.x[4321]);
}

TEST(Thinning, DropsWhatIsOutsideAndKeepsGaps) {
    const double gap = std::numeric_limits<double>::quiet_NaN();
    const Curve curve{.x = {-1.0, 0.0, 1.0, 2.0, 3.0}, .y = {9.0, 1.0, gap, 2.0, 9.0}};
    const Curve thin = thinned(curve, {0.0, 2.0}, 100);
    EXPECT_THAT(thin.x, ElementsAre(0.0, 1.0, 2.0));
    EXPECT_THAT(thin.y, ElementsAre(1.0, IsNan(), 2.0));
}

TEST(Plots, GapsBreakTheLine) {
    Plot plot{.x_label = "it's \"x\"; `date`", .y_label = "y", .x_range = {0.0, 4.0}};
    plot.curves.push_back({.x = {0.0, 1.0, 2.0, 3.0, 4.0},
                           .y = {0.0, 1.0, std::numeric_limits<double>::quiet_NaN(), 1.0, 0.0},
                           .colour = "#112233"});
    const std::vector<std::string> drawn = draw_plots(std::span(&plot, 1));
    ASSERT_EQ(drawn.size(), 1U);
    const std::string& svg = drawn.front();
    EXPECT_THAT(svg, AllOf(HasSubstr("<svg"), HasSubstr("</svg>"), HasSubstr("it's"), HasSubstr("`date`"),
                           Not(HasSubstr("rgb(  1,   2,   3)")), Not(HasSubstr("<?xml"))));
    const auto curve = svg.find("rgb( 17,  34,  51)");
    ASSERT_NE(curve, std::string::npos);
    const auto path = svg.find(" d='", curve);
    const std::string points = svg.substr(path, svg.find('\'', path + 4) - path);
    EXPECT_EQ(std::ranges::count(points, 'M'), 2) << points;
}

TEST(Plots, MissingGnuplotIsNamedWithItsPackage) {
    const std::string path = std::getenv("PATH");
    setenv("PATH", "/nonexistent", 1);
    std::string message;
    try {
        (void)draw_plots({});
    } catch (const std::runtime_error& missing) {
        message = missing.what();
    }
    setenv("PATH", path.c_str(), 1);
    EXPECT_EQ(message, "plots: gnuplot is not installed; install the Debian package gnuplot-nox");
}

class ReportFile : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "steadyboom-test-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string report(const std::vector<RunResult>& runs) {
        write_report(folder_ / "report.html", runs);
        std::ifstream file(folder_ / "report.html", std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }

  private:
    std::filesystem::path folder_;
};

TEST_F(ReportFile, ShowsEveryLawAndFigureAndLoadsNothing) {
    const std::vector<RunResult> runs = sample_runs();
    const std::string page = report(runs);
    EXPECT_THAT(page, AllOf(HasSubstr("uncontrolled"), HasSubstr("boom angle"), HasSubstr("joint deflection"),
                            HasSubstr("swing rate"), HasSubstr("<b>500 J</b>, 25.0 % of that")));
    for (const FigureRow& row : figure_rows) {
        EXPECT_THAT(page, HasSubstr("<td>" + std::string(row.label) + "</td>"));
    }
    for (const char* outside : {"http", "src=", "@import", "url(", "<script", "<link"}) {
        std::string rest = page;
        for (auto at = rest.find("url(#tip)"); at != std::string::npos; at = rest.find("url(#tip)")) {
            rest.erase(at, 9);
        }
        EXPECT_THAT(rest, Not(HasSubstr(outside)));
    }
    EXPECT_LT(page.size(), 2'000'000U);
    EXPECT_THAT(page, HasSubstr("</html>\n"));
}

TEST_F(ReportFile, HasOneDrawingForEachFigureElement) {
    const std::string page = report(sample_runs());
    const auto count = [&](const std::string& what) {
        int found = 0;
        for (auto at = page.find(what); at != std::string::npos; at = page.find(what, at + 1)) {
            ++found;
        }
        return found;
    };
    EXPECT_EQ(count("<figure>"), 16);
    EXPECT_EQ(count("<svg"), 16);
    EXPECT_EQ(count("</svg>"), 16);
    EXPECT_EQ(count("<g"), count("</g>"));
}

TEST_F(ReportFile, SameRunsGiveTheSameBytes) {
    EXPECT_EQ(report(sample_runs()), report(sample_runs()));
}

TEST_F(ReportFile, HighlightsTheLawThatLeavesLeastEnergyIfItStayedInCommand) {
    std::vector<RunResult> runs = sample_runs();
    EXPECT_THAT(report(runs), HasSubstr("The law <b>joint deflection</b>"));
    runs[2].stayed_engaged = false;
    EXPECT_THAT(report(runs), AllOf(HasSubstr("None of the laws left less."), HasSubstr("class=\"warn\"")));
}

TEST_F(ReportFile, ForeignTextCannotBecomeMarkup) {
    std::vector<RunResult> runs = sample_runs();
    for (RunResult& run : runs) {
        run.options.crane_case.description = "<script>\"&";
        run.options.mismatches = {"<b>=2"};
    }
    EXPECT_THAT(report(runs),
                AllOf(HasSubstr("&lt;script&gt;&quot;&amp;"), HasSubstr("&lt;b&gt;=2"), Not(HasSubstr("<script>"))));
}

TEST_F(ReportFile, ASingleRunIsAReportToo) {
    const std::string page = report({sample_run(controllers::LawKind::swing_rate, 1e-3)});
    EXPECT_THAT(page, AllOf(HasSubstr("swing rate"), Not(HasSubstr("boom angle</b>")), Not(HasSubstr("×"))));
}

TEST_F(ReportFile, RejectsRunsItCannotCompare) {
    EXPECT_THROW(report({}), std::invalid_argument);
    std::vector<RunResult> runs = sample_runs();
    runs[1].options.crane_case.name = "other";
    EXPECT_THROW(report(runs), std::invalid_argument);
    runs = sample_runs();
    runs[1].ticks.clear();
    EXPECT_THROW(report(runs), std::invalid_argument);
}

}  // namespace
}  // namespace steadyboom::hil
