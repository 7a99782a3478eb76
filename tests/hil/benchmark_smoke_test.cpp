#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "hil/benchmark/rounds.hpp"
#include "hil/benchmark/row.hpp"

namespace steadyboom::hil::benchmark {
namespace {

struct Ended {
    int code;
    std::string output;
};

/// The benchmark as a user runs it: one round, no regard to times. `redirection` says which stream is kept.
Ended run_benchmark(const std::string& arguments, const std::string& redirection, const std::string& environment = "") {
    const std::string command = environment + " '" STEADYBOOM_BENCHMARK "' " + arguments + " " + redirection;
    std::FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) {
        return {-1, "popen failed"};
    }
    std::string output;
    std::array<char, 4096> part;
    while (const std::size_t got = std::fread(part.data(), 1, part.size(), pipe)) {
        output.append(part.data(), got);
    }
    const int status = pclose(pipe);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
}

TEST(Benchmark, RunsEveryRowAndItsPeersAgreeWithUs) {
    const Ended ended = run_benchmark("--rounds 1 --json", "2>/dev/null");
    ASSERT_EQ(ended.code, 0) << ended.output;
    const nlohmann::json document = nlohmann::json::parse(ended.output);
    EXPECT_EQ(document.at("rounds"), 1);
    EXPECT_TRUE(document.at("version").is_string());
    EXPECT_TRUE(document.at("cpu").is_string());
    EXPECT_TRUE(document.at("cpu_dma_latency_held").is_boolean());
    std::set<std::string> names;
    for (const nlohmann::json& row : document.at("rows")) {
        names.insert(row.at("name").get<std::string>());
        const double must = row.at("must");
        const double aim = row.at("aim");
        const std::string verdict = row.at("verdict");
        if (verdict == "absent") {
            EXPECT_TRUE(row.at("measured").is_null());
            EXPECT_NE(row.at("remark"), "");
            continue;
        }
        const double measured = row.at("measured");
        EXPECT_GT(measured, 0.0) << row;
        EXPECT_FALSE(row.at("figures").empty()) << row;
        const bool at_most = row.at("bound") == "at most";
        const bool reaches_must = at_most ? measured <= must : measured >= must;
        const bool reaches_aim = at_most ? measured <= aim : measured >= aim;
        EXPECT_EQ(verdict, reaches_aim ? "aim met" : reaches_must ? "must met" : "MISSED") << row;
    }
    EXPECT_THAT(names, testing::IsSupersetOf({"right-hand-side", "rk4-step", "mass-matrix", "odeint", "gsl", "scipy",
                                              "lockstep", "network", "ring-push", "receive", "batched-io"}));
}

TEST(Benchmark, PrintsATableOfTheRowsAskedFor) {
    const Ended ended = run_benchmark("--rounds 1 --rows rk4-step", "2>/dev/null");
    EXPECT_EQ(ended.code, 0);
    EXPECT_THAT(ended.output, testing::HasSubstr("| what | against | must | aim | measured | verdict |"));
    EXPECT_THAT(ended.output, testing::HasSubstr("| RK4 step | 4 right-hand sides |"));
    EXPECT_THAT(ended.output, testing::Not(testing::HasSubstr("FullPivLU")));
}

TEST(Benchmark, UnknownRowIsOneLineAndExitCode2) {
    const Ended ended = run_benchmark("--rows warp-drive", "2>&1 >/dev/null");
    EXPECT_EQ(ended.code, 2);
    EXPECT_THAT(ended.output, testing::HasSubstr("\"warp-drive\""));
    EXPECT_EQ(std::count(ended.output.begin(), ended.output.end(), '\n'), 1) << ended.output;
}

TEST(Benchmark, MissingPeerIsAbsentAndNeverPassed) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("steadyboom-no-numpy-" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    std::ofstream(folder / "numpy.py") << "raise ImportError\n";
    const Ended ended =
        run_benchmark("--rounds 1 --json --check --rows scipy", "2>/dev/null", "PYTHONPATH='" + folder.string() + "'");
    std::filesystem::remove_all(folder);
    ASSERT_EQ(ended.code, 0) << ended.output;
    const nlohmann::json row = nlohmann::json::parse(ended.output).at("rows").at(0);
    EXPECT_EQ(row.at("verdict"), "absent");
    EXPECT_TRUE(row.at("measured").is_null());
    EXPECT_THAT(row.at("remark").get<std::string>(), testing::HasSubstr("python3-numpy"));
}

TEST(Rounds, RatioIsFormedWithinEachRoundBeforeTheMedian) {
    std::vector<std::string> order;
    std::array<std::vector<double>, 2> played{{{99, 1, 100, 10}, {99, 2, 50, 10}}};
    std::array<std::size_t, 2> next{};
    const auto play = [&](std::size_t i, const char* name) {
        order.emplace_back(name);
        return played[i][next[i]++];
    };
    const Candidate candidates[] = {{"a", [&] { return play(0, "a"); }}, {"b", [&] { return play(1, "b"); }}};
    const Rounds rounds(candidates, 3);
    // The first of each is warming up; the ratios are 1/2, 2 and 1.
    EXPECT_THAT(order, testing::ElementsAre("a", "b", "a", "b", "b", "a", "a", "b"));
    EXPECT_DOUBLE_EQ(rounds.median_ratio(0, 1), 1.0);
    EXPECT_DOUBLE_EQ(rounds.median_ns(0), 10.0);
}

TEST(Rounds, RatioOfARoundThatADisturbanceHitDoesNotCount) {
    std::array<std::vector<double>, 2> played{{{0, 4, 4, 400}, {0, 2, 200, 200}}};
    std::array<std::size_t, 2> next{};
    const Candidate candidates[] = {{"a", [&] { return played[0][next[0]++]; }},
                                    {"b", [&] { return played[1][next[1]++]; }}};
    const Rounds rounds(candidates, 3);
    EXPECT_DOUBLE_EQ(rounds.median_ratio(0, 1), 2.0);
    EXPECT_DOUBLE_EQ(rounds.median_ns(0) / rounds.median_ns(1), 0.02);
}

TEST(Quantile, IsTheSmallestValueThatTheShareDoesNotExceed) {
    const std::vector<double> values{5, 1, 4, 2, 3, 6, 7, 8, 9, 10};
    EXPECT_EQ(quantile(values, 0.5), 5);
    EXPECT_EQ(quantile(values, 0.99), 10);
    EXPECT_EQ(quantile(values, 0.0), 1);
    EXPECT_EQ(quantile({3.0}, 0.999), 3);
}

TEST(Verdict, ComparesWithMustAndAimOnTheSideTheBoundSays) {
    const Bound at_most{.at_most = true, .must = 3.0, .aim = 2.0};
    const Bound at_least{.at_most = false, .must = 80.0, .aim = 150.0};
    const auto measured = [](double value) { return Measurement{Outcome::measured, value, {}, {}}; };
    EXPECT_EQ(judge(at_most, measured(2.0)), Verdict::aim);
    EXPECT_EQ(judge(at_most, measured(2.1)), Verdict::must);
    EXPECT_EQ(judge(at_most, measured(3.1)), Verdict::missed);
    EXPECT_EQ(judge(at_least, measured(150.0)), Verdict::aim);
    EXPECT_EQ(judge(at_least, measured(80.0)), Verdict::must);
    EXPECT_EQ(judge(at_least, measured(79.0)), Verdict::missed);
    EXPECT_EQ(judge(at_most, measured(std::numeric_limits<double>::quiet_NaN())), Verdict::missed);
}

TEST(Verdict, OfAnAbsentOrDisagreeingPeerIsNeverAPass) {
    const Bound bound{.at_most = true, .must = 3.0, .aim = 2.0};
    EXPECT_EQ(judge(bound, Measurement::absence("no package")), Verdict::absent);
    EXPECT_EQ(judge(bound, Measurement::disagreement("1e-3 off")), Verdict::disagree);
}

}  // namespace
}  // namespace steadyboom::hil::benchmark
