#include "hil/dbc_file.hpp"

#include <fstream>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/message_fields.hpp"
#include "tests/hil/sample_networks.hpp"

namespace steadyboom::hil {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string dbc(const drivers::NetworkConfig& config) {
    return dbc_of(drivers::DeviceTable(config));
}

TEST(DbcFile, TheOneInTheRepositoryIsTheTables) {
    std::ifstream file(STEADYBOOM_DBC);
    std::ostringstream content;
    content << file.rdbuf();
    // Not EXPECT_EQ: its listing of two such texts would hide the remedy.
    EXPECT_TRUE(content.str() == dbc({}))
        << "the table has changed: build/release/bin/steadyboom dbc --out docs/steadyboom.dbc";
}

TEST(DbcFile, MessagesHaveSenderLengthAndCycleTime) {
    const auto text = dbc(unprotected_network());
    EXPECT_THAT(text, HasSubstr("BO_ 404 boom_inclinometer_tpdo1: 4 boom_inclinometer\n"
                                " SG_ boom_angle : 0|32@1- (0.001,0) [-90|120] \"deg\" controller\n"));
    EXPECT_THAT(text, HasSubstr("BA_ \"GenMsgCycleTime\" BO_ 404 5;\n"));
    EXPECT_THAT(text, HasSubstr("BA_ \"GenMsgCycleTime\" BO_ 1812 100;\n"));
    EXPECT_THAT(text, Not(HasSubstr("BA_ \"GenMsgCycleTime\" BO_ 0 ")));
    EXPECT_THAT(text, HasSubstr("VAL_ 1812 nmt_state 0 \"boot_up\" 4 \"stopped\" 5 \"operational\" 127 "));
    EXPECT_THAT(text, HasSubstr("BO_ 148 boom_inclinometer_emergency: 8 boom_inclinometer\n"));
    EXPECT_THAT(text, HasSubstr(" 33072 \"life guard or heartbeat missed\""));  // 8130h
}

TEST(DbcFile, ProtectedFramesEndWithCounterAndChecksum) {
    EXPECT_EQ(dbc(unprotected_network()).find("CHECKSUM"), std::string::npos);
    EXPECT_THAT(dbc({}), HasSubstr("BO_ 404 boom_inclinometer_tpdo1: 6 boom_inclinometer\n"
                                   " SG_ boom_angle : 0|32@1- (0.001,0) [-90|120] \"deg\" controller\n"
                                   " SG_ COUNTER : 32|4@1+ (1,0) [0|14] \"\" controller\n"
                                   " SG_ QUALITY : 36|4@1+ (1,0) [0|15] \"\" controller\n"
                                   " SG_ CHECKSUM : 40|8@1+ (1,0) [0|255] \"\" controller\n"));
}

TEST(DbcFile, AForeignDevicesValuesStandAsItsNetworkFileSays) {
    const auto text = dbc(foreign_network());
    EXPECT_THAT(text, HasSubstr("BO_ 906 boom_inclinometer_tpdo3: 5 boom_inclinometer\n"
                                " SG_ boom_angle : 31|16@0- (-0.01,90) [-90|120] \"deg\" controller\n"));
    EXPECT_THAT(text, HasSubstr("BA_ \"GenMsgCycleTime\" BO_ 906 4;\n"));
    EXPECT_THAT(text, Not(HasSubstr("load_pressure")));
}

TEST(DbcFile, NamesFitTheFormatAndFieldsOverlapNowhere) {
    for (const auto& config : {drivers::NetworkConfig{}, unprotected_network(), foreign_network(), j1939_network()}) {
        const drivers::DeviceTable table(config);
        std::set<std::string> messages;
        for (const auto& row : table.messages()) {
            if (!row.present) {
                continue;
            }
            EXPECT_LE(row.name.size(), 32U) << row.name;
            EXPECT_TRUE(messages.insert(row.name).second) << row.name;
            std::set<std::string> names;
            std::set<unsigned> bits;
            for (const auto& field : fields_of(table, row.message)) {
                EXPECT_LE(field.name.size(), 32U) << field.name;
                EXPECT_TRUE(names.insert(field.name).second) << row.name << ' ' << field.name;
                // Counted in the order of its own byte order: from the top of its first byte down, or up.
                const unsigned first = field.big_endian ? field.start_bit - 7U : field.start_bit;
                for (unsigned i = 0; i < field.size_bits; ++i) {
                    EXPECT_LT(first + i, 8U * row.length_bytes) << row.name << ' ' << field.name;
                    EXPECT_TRUE(bits.insert(first + i).second) << row.name << ' ' << field.name;
                }
            }
            EXPECT_FALSE(names.empty()) << row.name;
        }
    }
}

}  // namespace
}  // namespace steadyboom::hil
