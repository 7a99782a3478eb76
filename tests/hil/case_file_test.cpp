#include "hil/case_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace steadyboom::hil {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Moves to a fresh empty folder for one test.
class CaseLookup : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string folder = (std::filesystem::temp_directory_path() / "steadyboom-test-XXXXXX").string();
        ASSERT_NE(mkdtemp(folder.data()), nullptr);
        folder_ = folder;
        std::filesystem::current_path(folder_);
    }
    void TearDown() override {
        std::filesystem::current_path(before_);
        std::filesystem::remove_all(folder_);
    }
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

    static std::string error(std::string_view name) {
        try {
            (void)load_case(name);
        } catch (const runtime::ConfigError& rejected) {
            return rejected.what();
        }
        return "";
    }

  private:
    std::filesystem::path before_ = std::filesystem::current_path();
    std::filesystem::path folder_;
};

TEST_F(CaseLookup, FindsShippedCasesFromAnyFolder) {
    for (const auto& [name, drop_m] : {std::pair{"case-a", 0.076}, {"case-b", 0.305}, {"case-c", 0.305}}) {
        const Case loaded = load_case(name);
        EXPECT_EQ(loaded.name, name);
        EXPECT_EQ(loaded.manoeuvre.load_drop_m, drop_m);
        EXPECT_EQ(loaded.manoeuvre.duration_s, 10.0);
        EXPECT_DOUBLE_EQ(loaded.manoeuvre.brake_rate_m_s(), std::sqrt(2 * 9.81 * drop_m));
    }
}

TEST_F(CaseLookup, TakesAPathAndComesBackBitForBit) {
    Case written = load_case("case-c");
    written.name = "mine";
    written.manoeuvre.load_drop_m = 0.1 + 0.2;
    std::ofstream("mine.toml") << to_toml(written);
    for (const std::string& path : {std::string("mine.toml"), (folder() / "mine.toml").string()}) {
        const Case read = load_case(path);
        EXPECT_EQ(read.name, "mine");
        EXPECT_EQ(read.manoeuvre.load_drop_m, 0.1 + 0.2);
        EXPECT_EQ(runtime::crane_hash(read.crane), runtime::crane_hash(written.crane));
        EXPECT_EQ(to_toml(read), to_toml(written));
    }
}

TEST_F(CaseLookup, BoomIsTheLinksUnlessTheFileSaysBeam) {
    Case written = load_case("case-a");
    EXPECT_EQ(written.boom, BoomKind::links);
    EXPECT_EQ(load_case("case-b").boom, BoomKind::links) << "and says nothing of it";
    written.boom = BoomKind::beam;
    std::ofstream("beam.toml") << to_toml(written);
    const Case read = load_case("beam.toml");
    EXPECT_EQ(read.boom, BoomKind::beam);
    EXPECT_EQ(runtime::crane_hash(read.crane), runtime::crane_hash(load_case("case-a").crane))
        << "the parameters that the controller models are the same";
    std::ofstream("tube.toml") << "boom = \"tube\"\n" << runtime::to_toml(written) << "[manoeuvre]\n";
    EXPECT_EQ(error("tube.toml"), "tube.toml:1: boom = \"tube\": must be \"links\" or \"beam\"");
}

TEST_F(CaseLookup, PrefersTheShippedCaseToAFileOfItsName) {
    std::ofstream("case-a") << "garbage";
    EXPECT_EQ(load_case("case-a").name, "case-a");
    EXPECT_THAT(error("./case-a"), HasSubstr("./case-a:1: not valid TOML"));
}

TEST_F(CaseLookup, ListsTheKnownCasesForAnUnknownOne) {
    for (const char* name : {"case-d", "", "case-a.toml", "./nowhere.toml", "../cases/case-a"}) {
        EXPECT_EQ(error(name), "case \"" + std::string(name) +
                                   "\": must be the path of a TOML file or a known case: case-a, case-b, case-c");
    }
    EXPECT_THAT(error(std::string(10000, 'x')), HasSubstr("known case"));
}

TEST_F(CaseLookup, DemandsAManoeuvre) {
    const runtime::CraneFile crane_only = load_case("case-a");
    std::ofstream("crane.toml") << runtime::to_toml(crane_only);
    EXPECT_EQ(runtime::load_crane_file("crane.toml").name, "case-a");
    EXPECT_EQ(error("crane.toml"), "crane.toml:1: [manoeuvre]: section is missing");
}

}  // namespace
}  // namespace steadyboom::hil
