#include "runtime/crane_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <random>
#include <regex>
#include <sstream>

#include "tests/runtime/toml_text.hpp"

namespace steadyboom::runtime {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::filesystem::path cases = STEADYBOOM_TEST_CASE_FOLDER;

/// what() of the error that loading `text` gives, from the file name on; empty when it loads.
std::string error_of(const std::string& text) {
    const TemporaryFile file("case-x.toml", text);
    try {
        (void)load_crane_file(file.path());
    } catch (const ConfigError& error) {
        const std::string message = error.what();
        const std::string folder = file.path().parent_path().string() + "/";
        EXPECT_THAT(message, StartsWith(folder));
        EXPECT_EQ(message.find('\n'), std::string::npos);
        return message.substr(folder.size());
    }
    return "";
}

bool identical(const CraneFile& a, const CraneFile& b) {
    return a.name == b.name && a.description == b.description &&
           std::memcmp(&a.crane.structure, &b.crane.structure, sizeof a.crane.structure) == 0 &&
           std::memcmp(&a.crane.soil, &b.crane.soil, sizeof a.crane.soil) == 0 &&
           std::memcmp(&a.crane.ropes, &b.crane.ropes, sizeof a.crane.ropes) == 0 &&
           a.crane.actuator.valve_model == b.crane.actuator.valve_model &&
           std::memcmp(&a.crane.actuator.piston_area_m2, &b.crane.actuator.piston_area_m2,
                       sizeof(plant::ActuatorParameters) - offsetof(plant::ActuatorParameters, piston_area_m2)) == 0 &&
           std::memcmp(&a.gains, &b.gains, sizeof a.gains) == 0;
}

/// Table 1 as the crane model fixes it, written down a second time.
struct TableColumn {
    const char* name;
    double R_B, G, phi6_deg, m_B, K_B, K_WRP, K3;
};

class ShippedCase : public ::testing::TestWithParam<TableColumn> {};

TEST_P(ShippedCase, HoldsTheValuesOfTableOne) {
    const TableColumn& column = GetParam();
    const CraneFile file = load_crane_file(cases / (std::string(column.name) + ".toml"));
    EXPECT_EQ(file.name, column.name);
    EXPECT_FALSE(file.description.empty());

    const plant::StructureParameters& s = file.crane.structure;
    const double rad = std::numbers::pi / 180.0;
    EXPECT_EQ(s.boom_length_m, column.R_B);
    EXPECT_EQ(s.boom_link_mass_kg, column.m_B);
    EXPECT_EQ(s.boom_joint_stiffness_N_m, column.K_B);
    EXPECT_EQ(s.boom_damping_ratio, 0.007);
    EXPECT_EQ(s.boom_outer_chord_m, 1.22);
    EXPECT_DOUBLE_EQ(s.boom_angle_rad, column.phi6_deg * rad);
    EXPECT_EQ(s.load_mass_kg, 13600.0);
    EXPECT_EQ(s.track_mass_kg, 61300.0);
    EXPECT_EQ(s.car_body_mass_kg, 87600.0);
    EXPECT_EQ(s.track_inertia_kg_m2, 3.95e5);
    EXPECT_EQ(s.car_body_inertia_kg_m2, 3.39e5);
    EXPECT_EQ(s.track_centre_height_m, 0.762);
    EXPECT_EQ(s.car_body_height_m, 1.78);
    EXPECT_EQ(s.car_body_setback_m, 4.32);
    EXPECT_EQ(s.boom_butt_offset_m, 1.27);
    EXPECT_DOUBLE_EQ(s.car_body_angle_rad, 2.86 * rad);
    EXPECT_EQ(s.pendent_anchor_radius_m, 10.67);
    EXPECT_DOUBLE_EQ(s.pendent_anchor_angle_rad, 40.1 * rad);

    EXPECT_EQ(file.crane.soil.shear_modulus_Pa, column.G);
    EXPECT_EQ(file.crane.soil.poisson_ratio, 0.30);
    EXPECT_EQ(file.crane.soil.density_kg_m3, 1780.0);
    EXPECT_EQ(file.crane.soil.track_half_length_m, 4.11);
    EXPECT_EQ(file.crane.soil.track_width_m, 1.22);

    EXPECT_EQ(file.crane.ropes.load_line_length_m, 12.2);
    EXPECT_EQ(file.crane.ropes.load_line_stiffness_N_m, 3.83e6);
    EXPECT_EQ(file.crane.ropes.pendent_stiffness_N_m, column.K_WRP);

    const plant::ActuatorParameters& a = file.crane.actuator;
    EXPECT_EQ(a.valve_model, plant::ValveModel::linear);
    EXPECT_EQ(a.piston_area_m2, 0.0645);
    EXPECT_EQ(a.flow_gain_m2_s, 4.12);
    EXPECT_EQ(a.oil_volume_m3, 1.31e-2);
    EXPECT_EQ(a.bulk_modulus_Pa, 700e6);
    EXPECT_EQ(a.leakage_m3_s_Pa, 0.0);
    EXPECT_EQ(a.spool_travel_m, 7.6e-3);
    EXPECT_EQ(a.piston_travel_m, 0.10);
    EXPECT_EQ(a.supply_pressure_Pa, 28e6);
    EXPECT_EQ(a.load_pressure_report_Pa, 21e6);
    EXPECT_EQ(a.discharge_coefficient, 0.61);
    EXPECT_EQ(a.oil_density_kg_m3, 850.0);
    EXPECT_EQ(a.spool_diameter_m, 1.24e-2);
    EXPECT_EQ(a.spool_bandwidth_Hz, 100.0);
    EXPECT_EQ(a.spool_damping_ratio, 0.8);
    EXPECT_EQ(a.spool_delay_s, 0.001);

    EXPECT_EQ(file.gains.boom_angle_gain_m_rad, 0.05);
    EXPECT_EQ(file.gains.boom_rate_gain_m_s_rad, 0.2);
    EXPECT_EQ(file.gains.joint_gain_m_m, column.K3);
    EXPECT_EQ(file.gains.swing_rate_gain_m_s_rad, 0.20);
}

TEST_P(ShippedCase, ComesBackBitForBitFromItsOwnWriting) {
    const CraneFile file = load_crane_file(cases / (std::string(GetParam().name) + ".toml"));
    const TemporaryFile copy("copy.toml", to_toml(file));
    EXPECT_TRUE(identical(load_crane_file(copy.path()), file));
}

INSTANTIATE_TEST_SUITE_P(Cases, ShippedCase,
                         ::testing::Values(TableColumn{"case-a", 45.7, 82.7e6, 60, 4730, 1.31e9, 1.59e7, 0.15},
                                           TableColumn{"case-b", 45.7, 62.0e6, 70, 4730, 1.31e9, 1.031e7, 0.15},
                                           TableColumn{"case-c", 91.4, 41.4e6, 70, 9460, 6.53e8, 4.933e6, 0.02}),
                         [](const auto& column) { return std::string("Case") + column.param.name[5]; });

class CaseText : public ::testing::Test {
  protected:
    const std::string text = text_of(cases / "case-a.toml");
    const std::vector<Line> keys = key_lines(text);

    [[nodiscard]] const Line& line(const std::string& key) const {
        for (const Line& candidate : keys) {
            if (candidate.key == key) {
                return candidate;
            }
        }
        throw std::logic_error("no key " + key);
    }
};

using CraneFileErrors = CaseText;

TEST_F(CraneFileErrors, KeepTheirPublishedForm) {
    const Line& boom = line("boom_length_m");
    EXPECT_EQ(error_of(with_value(text, boom, "-3")), "case-x.toml:" + std::to_string(boom.number) +
                                                          ": crane.boom_length_m = -3: must be a number in [3, 300] m");
}

TEST_F(CraneFileErrors, NameEachMissingKeyAndTheLineOfItsSection) {
    ASSERT_EQ(keys.size(), 51U);
    const std::vector<std::string> lines = lines_of(text);
    for (const Line& key : keys) {
        std::vector<std::string> without = lines;
        without[key.number - 1].clear();
        const auto header = std::find_if(lines.begin(), lines.end(), [&](const std::string& candidate) {
            return candidate == "[" + key.section + "]";
        });
        if (key.key == "boom") {
            EXPECT_NO_THROW((void)load_crane_file(TemporaryFile("case-x.toml", joined(without)).path()));
            continue;
        }
        const auto header_line = key.section.empty() ? 1 : header - lines.begin() + 1;
        EXPECT_THAT(error_of(joined(without)), StartsWith("case-x.toml:" + std::to_string(header_line) + ": " +
                                                          key.full_name() + ": is missing; must be "));
    }
}

TEST_F(CraneFileErrors, NameLineKeyAndValueOfEachBadNumber) {
    std::size_t numbers = 0;
    for (const Line& key : keys) {
        if (key.value.front() == '"') {
            continue;
        }
        ++numbers;
        const std::string start = "case-x.toml:" + std::to_string(key.number) + ": " + key.full_name() + " = ";
        const std::vector<std::pair<std::string, std::string>> bad_values{{"nan", "nan"},
                                                                          {"inf", "inf"},
                                                                          {"-inf", "-inf"},
                                                                          {"1e300", "1e+300"},
                                                                          {"-1e300", "-1e+300"},
                                                                          {"true", "true"},
                                                                          {"\"12\"", "\"12\""},
                                                                          {"[1, 2]", "an array"},
                                                                          {"{ a = 1 }", "a section"},
                                                                          {"1979-05-27", "a date or time"}};
        for (const auto& [value, shown] : bad_values) {
            EXPECT_THAT(error_of(with_value(text, key, value)),
                        AllOf(StartsWith(start + shown + ": must be a number in "), Not(HasSubstr("\n"))));
        }
    }
    EXPECT_EQ(numbers, 47U);
}

TEST_F(CraneFileErrors, NameLineKeyAndValueOfEachBadText) {
    for (const char* key : {"name", "description", "valve_model"}) {
        const Line& bad = line(key);
        const std::string start = "case-x.toml:" + std::to_string(bad.number) + ": " + bad.full_name() + " = ";
        EXPECT_THAT(error_of(with_value(text, bad, "3")), StartsWith(start + "3: must be "));
    }
    EXPECT_THAT(error_of(with_value(text, line("valve_model"), "\"Linear\"")),
                EndsWith("actuator.valve_model = \"Linear\": must be \"linear\" or \"nonlinear\""));
    EXPECT_THAT(error_of(with_value(text, line("name"), "\"\"")), HasSubstr("must be a text of 1 to 100 bytes"));
    EXPECT_THAT(error_of(with_value(text, line("valve_model"), "\"a\\nb\"")), HasSubstr("\"a\\u000Ab\""));
}

TEST_F(CraneFileErrors, RefuseABoomThatTheControllerDoesNotModel) {
    const Line& boom = line("boom");
    EXPECT_EQ(
        error_of(with_value(text, boom, "\"beam\"")),
        "case-x.toml:" + std::to_string(boom.number) +
            ": boom = \"beam\": must be \"links\", the boom that the controller models, or left out; another boom "
            "is for the virtual crane's file");
}

TEST_F(CraneFileErrors, SuggestTheClosestKeyForAnUnknownOne) {
    std::vector<std::string> lines = lines_of(text);
    const std::size_t boom = line("boom_length_m").number;
    lines[boom - 1] = "boom_lenght_m = 45.7";
    EXPECT_EQ(error_of(joined(lines)),
              "case-x.toml:" + std::to_string(boom) +
                  ": crane.boom_lenght_m = 45.7: unknown key; did you mean crane.boom_length_m?");
    EXPECT_EQ(error_of("nmae = 3\n" + text), "case-x.toml:1: nmae = 3: unknown key; did you mean name?");
    EXPECT_EQ(error_of(text + "shear_modulus_Pa = 1\n"),
              "case-x.toml:" + std::to_string(lines.size() + 1) +
                  ": manoeuvre.shear_modulus_Pa = 1: unknown key; did you mean soil.shear_modulus_Pa?");
}

TEST_F(CraneFileErrors, NameUnknownMissingAndMistypedSections) {
    const std::size_t end = lines_of(text).size();
    EXPECT_EQ(error_of(text + "[sail]\n"),
              "case-x.toml:" + std::to_string(end + 1) +
                  ": [sail]: unknown section; known are [crane], [soil], [ropes], [actuator], [gains], [manoeuvre]");
    EXPECT_THAT(error_of("soil = 3\n"), StartsWith("case-x.toml:1: soil = 3: must be a section [soil]"));
    EXPECT_THAT(error_of("[[soil]]\n"), HasSubstr(": must be a section [soil]"));
    EXPECT_EQ(error_of("name = \"x\"\ndescription = \"\"\n"), "case-x.toml:1: [crane]: section is missing");
    EXPECT_THAT(error_of(""), StartsWith("case-x.toml:1: name: is missing"));
}

TEST_F(CraneFileErrors, NameTheLineOfASyntaxError) {
    EXPECT_THAT(error_of("name = \"x\"\n[crane\n"), StartsWith("case-x.toml:2: not valid TOML: "));
    EXPECT_THAT(error_of(text + "load_drop_m = 1\n"), HasSubstr(": not valid TOML: "));
}

TEST_F(CraneFileErrors, CoverFilesThatCannotBeRead) {
    const TemporaryFile file("case-x.toml", "");
    const auto message = [](const std::filesystem::path& path) {
        try {
            (void)load_crane_file(path);
        } catch (const ConfigError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(message(file.path().string() + ".gone"), EndsWith("cannot be read: No such file or directory"));
    EXPECT_THAT(message(file.path().parent_path()), HasSubstr("is a directory"));
    EXPECT_THAT(message("/dev/zero"), HasSubstr("larger than 1 MiB"));
}

TEST_F(CraneFileErrors, CoverNestingThatWouldExhaustTheStack) {
    std::string dotted;
    for (int depth = 0; depth < 100'000; ++depth) {
        dotted += "a.";
    }
    EXPECT_EQ(error_of("\n" + dotted + "a = 1\n"),
              "case-x.toml:2: is longer than 8192 bytes, so this is no configuration");
    EXPECT_EQ(error_of("[" + dotted + "a]\n"), "case-x.toml:1: is longer than 8192 bytes, so this is no configuration");
    EXPECT_THAT(error_of("[" + dotted.substr(0, 8000) + "a]\n" + dotted.substr(0, 8000) + "a = 1\n"),
                HasSubstr("[a]: unknown section"));
    EXPECT_THAT(error_of("a = " + std::string(8000, '[')), HasSubstr("not valid TOML: "));
}

TEST_F(CraneFileErrors, CatchValuesThatContradictEachOther) {
    EXPECT_THAT(error_of(with_value(text, line("pendent_anchor_angle_deg"), "-25")),
                HasSubstr(": crane.pendent_anchor_angle_deg = -25.0: must keep the angle between boom and anchor"));
    EXPECT_THAT(error_of(with_value(text, line("pendent_anchor_radius_m"), "46")), HasSubstr("crane.boom_length_m"));
    EXPECT_THAT(error_of(with_value(text, line("track_width_m"), "8.3")), HasSubstr("soil.track_half_length_m"));
    EXPECT_THAT(error_of(with_value(text, line("load_pressure_report_Pa"), "28.1e6")),
                HasSubstr("must not exceed actuator.supply_pressure_Pa"));
}

TEST_F(CaseText, AcceptsAnIntegerWhereANumberIsAsked) {
    EXPECT_EQ(error_of(with_value(text, line("boom_length_m"), "46")), "");
}

TEST_F(CaseText, BoundsBelongToTheRangeExactlyAsDocumented) {
    EXPECT_EQ(error_of(with_value(text, line("boom_length_m"), "300")), "");
    EXPECT_NE(error_of(with_value(text, line("boom_length_m"), "300.00000000000006")), "");
    EXPECT_NE(error_of(with_value(text, line("boom_angle_deg"), "0")), "");
    EXPECT_NE(error_of(with_value(text, line("boom_angle_deg"), "90")), "");
    EXPECT_EQ(error_of(with_value(text, line("poisson_ratio"), "0")), "");
    EXPECT_NE(error_of(with_value(text, line("poisson_ratio"), "0.5")), "");
    EXPECT_NE(error_of(with_value(text, line("duration_s"), "0")), "");
    EXPECT_EQ(error_of(with_value(text, line("duration_s"), "3600")), "");
}

TEST_F(CaseText, DocumentsTheRangeThatIsEnforced) {
    static const std::regex documented(R"(([\[(])([-0-9.e ]+), ([-0-9.e ]+)([\])]))");
    static const std::regex enforced(R"(.*must be a number in ([\[(])([-0-9.e+]+), ([-0-9.e+]+)([\])]).*)");
    const std::vector<std::string> lines = lines_of(text);
    for (const Line& key : keys) {
        if (key.value.front() == '"') {
            continue;
        }
        std::string comment = lines[key.number - 1];
        std::smatch is;
        const std::string error = error_of(with_value(text, key, "nan"));
        ASSERT_TRUE(std::regex_match(error, is, enforced)) << error;
        std::smatch says;
        if (key.section == "gains") {
            comment = "[0, 100]";
        }
        ASSERT_TRUE(std::regex_search(comment, says, documented)) << comment;
        const auto number = [](std::string digits) {
            std::erase(digits, ' ');
            return std::stod(digits);
        };
        EXPECT_EQ(says[1], is[1]) << key.key;
        EXPECT_EQ(number(says[2]), number(is[2])) << key.key;
        EXPECT_EQ(number(says[3]), number(is[3])) << key.key;
        EXPECT_EQ(says[4], is[4]) << key.key;
    }
}

TEST_F(CaseText, MayLeaveTheManoeuvreOutForTheController) {
    std::vector<std::string> lines = lines_of(text);
    lines.erase(std::find(lines.begin(), lines.end(), "[manoeuvre]"), lines.end());
    EXPECT_EQ(error_of(joined(lines)), "");
    EXPECT_THAT(error_of(joined(lines) + "[manoeuvre]\nload_drop_m = 0.1\n"),
                HasSubstr("manoeuvre.duration_s: is missing"));
}

TEST_F(CaseText, GarbageNeverGetsPastAsAnythingButAConfigError) {
    std::mt19937 random(20240607);
    const auto below_bound = [&random](std::size_t bound) {
        return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
    };
    std::size_t rejected = 0;
    constexpr std::size_t trials = 600;
    for (std::size_t trial = 0; trial < trials; ++trial) {
        std::string garbage = text;
        for (std::size_t change = 1 + below_bound(8); change > 0 && !garbage.empty(); --change) {
            const std::size_t at = below_bound(garbage.size());
            switch (below_bound(5)) {
                case 0:
                    garbage[at] = static_cast<char>(below_bound(256));
                    break;
                case 1:
                    garbage.erase(at, below_bound(40));
                    break;
                case 2:
                    garbage.insert(at, garbage.substr(below_bound(garbage.size()), below_bound(40)));
                    break;
                case 3:
                    garbage.insert(at, 1 + below_bound(300), "[{\"'.=\n9e-\\"[below_bound(11)]);
                    break;
                default:
                    garbage.resize(at + 1);
            }
        }
        // Anything that is not a ConfigError leaves error_of and fails the test.
        rejected += error_of(garbage).empty() ? 0 : 1;
    }
    EXPECT_GT(rejected, trials / 2);
    EXPECT_LT(rejected, trials);
}

TEST(CraneFileWriting, RoundTripsAwkwardNumbersAndTexts) {
    CraneFile file = load_crane_file(cases / "case-a.toml");
    file.name = "quote \" backslash \\ newline \n bell \a end";
    file.crane.structure.boom_length_m = 100.0 / 3.0;
    file.crane.structure.track_mass_kg = std::nextafter(4e6, 5e6);
    file.crane.ropes.pendent_stiffness_N_m = 1e10;
    file.crane.actuator.leakage_m3_s_Pa = 5e-324;
    const TemporaryFile copy("copy.toml", to_toml(file));
    EXPECT_TRUE(identical(load_crane_file(copy.path()), file));
}

TEST(CraneFileWriting, RoundTripsAnyAngleAndMismatch) {
    std::mt19937 random(7);
    const CraneFile original = load_crane_file(cases / "case-a.toml");
    for (int trial = 0; trial < 500; ++trial) {
        CraneFile file = original;
        std::ostringstream factor;
        factor.precision(17);
        factor << std::uniform_real_distribution<double>(0.8, 1.2)(random);
        apply_mismatch(file, "boom_angle_deg=" + factor.str());
        apply_mismatch(file, "pendent_anchor_angle_deg=" + factor.str());
        apply_mismatch(file, "car_body_angle_deg=" + factor.str());
        apply_mismatch(file, "soil.shear_modulus_Pa=" + factor.str());
        const TemporaryFile copy("copy.toml", to_toml(file));
        ASSERT_TRUE(identical(load_crane_file(copy.path()), file)) << factor.str();
    }
}

class Mismatch : public ::testing::Test {
  protected:
    CraneFile file = load_crane_file(cases / "case-a.toml");
    const CraneFile original = file;

    std::string error(std::string_view change) {
        try {
            apply_mismatch(file, change);
        } catch (const ConfigError& rejected) {
            EXPECT_TRUE(identical(file, original)) << "a rejected change must leave the file alone";
            return rejected.what();
        }
        return "";
    }
};

TEST_F(Mismatch, ScalesTheNamedKeyAndNoOther) {
    apply_mismatch(file, "soil.shear_modulus_Pa=1.2");
    EXPECT_EQ(file.crane.soil.shear_modulus_Pa, 82.7e6 * 1.2);
    file.crane.soil.shear_modulus_Pa = original.crane.soil.shear_modulus_Pa;
    EXPECT_TRUE(identical(file, original));
}

TEST_F(Mismatch, TakesABareKey) {
    apply_mismatch(file, "load_mass_kg=1.25");
    EXPECT_EQ(file.crane.structure.load_mass_kg, 17000.0);
}

TEST_F(Mismatch, ReachesEveryNumberOfTheControllersCopy) {
    for (const Line& key : key_lines(to_toml(file))) {
        if (key.value.front() == '"') {
            EXPECT_THAT(error(key.full_name() + "=1.01"), HasSubstr("is no number")) << key.key;
            continue;
        }
        CraneFile changed = original;
        apply_mismatch(changed, key.full_name() + "=1.01");
        EXPECT_EQ(identical(changed, original), key.key == "leakage_m3_s_Pa") << key.key;
    }
}

TEST_F(Mismatch, ScalesAnglesAsTheyStandInTheFile) {
    apply_mismatch(file, "boom_angle_deg=1.1");
    EXPECT_NEAR(file.crane.structure.boom_angle_rad, 66.0 * std::numbers::pi / 180.0, 1e-15);
}

TEST_F(Mismatch, RejectsWhatNoFileCouldHold) {
    EXPECT_EQ(error("boom_angle_deg=1.5"),
              "boom_angle_deg=1.5: gives crane.boom_angle_deg = 90: must be a number in (0, 90) deg");
    EXPECT_THAT(error("supply_pressure_Pa=0.7"),
                HasSubstr("actuator.load_pressure_report_Pa = 2.1e+07: must not exceed"));
    EXPECT_THAT(error("track_width_m=7"), HasSubstr("must not exceed twice"));
}

TEST_F(Mismatch, RejectsBadFactorsAndKeys) {
    for (const char* factor : {"", "0", "-1", "nan", "inf", "1e999", "1.2x", " 1.2", "0x2", "1,2"}) {
        EXPECT_THAT(error("load_mass_kg=" + std::string(factor)), HasSubstr("finite number above 0")) << factor;
    }
    EXPECT_EQ(error("soil.shear_modulus=1.2"),
              "soil.shear_modulus=1.2: unknown key; did you mean soil.shear_modulus_Pa?");
    EXPECT_THAT(error("boom_angle_rad=1.2"), HasSubstr("did you mean crane.boom_angle_deg?"));
    EXPECT_THAT(error("load_mass_kg"), HasSubstr("must be KEY=FACTOR"));
    EXPECT_THAT(error("=2"), HasSubstr("unknown key"));
    EXPECT_THAT(error(""), HasSubstr("must be KEY=FACTOR"));
}

TEST(CraneHash, TellsEveryParameterApart) {
    const CraneFile original = load_crane_file(cases / "case-a.toml");
    std::vector<std::uint64_t> seen{crane_hash(original.crane)};
    for (const Line& key : key_lines(to_toml(original))) {
        if (key.value.front() == '"' || key.section == "gains") {
            continue;
        }
        CraneFile changed = original;
        if (key.key == "leakage_m3_s_Pa") {
            changed.crane.actuator.leakage_m3_s_Pa = 1e-12;
        } else {
            apply_mismatch(changed, key.full_name() + "=1.0000000000001");
        }
        seen.push_back(crane_hash(changed.crane));
    }
    CraneFile nonlinear = original;
    nonlinear.crane.actuator.valve_model = plant::ValveModel::nonlinear;
    seen.push_back(crane_hash(nonlinear.crane));
    EXPECT_EQ(seen.size(), 43U);
    std::sort(seen.begin(), seen.end());
    EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
}

TEST(CraneHash, DependsOnTheCraneAlone) {
    CraneFile file = load_crane_file(cases / "case-a.toml");
    const std::uint64_t hash = crane_hash(file.crane);
    apply_mismatch(file, "joint_gain_m_m=2");
    file.name = "another";
    EXPECT_EQ(crane_hash(file.crane), hash);
    EXPECT_EQ(crane_hash(load_crane_file(cases / "case-a.toml").crane), hash);
}

}  // namespace
}  // namespace steadyboom::runtime
