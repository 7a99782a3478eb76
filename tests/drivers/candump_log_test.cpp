#include "drivers/candump_log.hpp"

#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace steadyboom::drivers {
namespace {

TEST(CandumpLine, StandardFrameReadsAsInTheManualOfCanUtils) {
    const CanFrame frame{
        .id = 0x044, .length = 5, .data = {0x2A, 0x36, 0x6C, 0x2B, 0xBA, 0xFF}, .stamp_ns = 1'436'509'052'249'713'999};
    EXPECT_EQ(candump_line(frame, "vcan0").view(), "(1436509052.249713) vcan0 044#2A366C2BBA");
}

TEST(CandumpLine, SmallStampsAndEmptyFramesKeepTheirWidth) {
    EXPECT_EQ(candump_line({.id = 0x7, .length = 0, .stamp_ns = 5'000'000}, "can0").view(),
              "(0000000000.005000) can0 007#");
    EXPECT_EQ(candump_line({.id = 0x7, .length = 0, .stamp_ns = -5}, "can0").view(), "(0000000000.000000) can0 007#");
}

TEST(CandumpLine, ExtendedRemoteAndErrorFramesAreTold) {
    EXPECT_EQ(candump_line({.id = 0x123, .length = 1, .data = {0x0F}, .extended = true}, "can0").view(),
              "(0000000000.000000) can0 00000123#0F");
    EXPECT_EQ(candump_line({.id = 0x123, .length = 0, .remote = true}, "can0").view(),
              "(0000000000.000000) can0 123#R");
    EXPECT_EQ(candump_line({.id = 0x123, .length = 4, .remote = true}, "can0").view(),
              "(0000000000.000000) can0 123#R4");
    EXPECT_EQ(candump_line({.id = 0x40, .length = 8, .error = true}, "can0").view(),
              "(0000000000.000000) can0 20000040#0000000000000000");
}

TEST(CandumpLine, LongestLineFits) {
    CanFrame frame{.id = 0x1FFF'FFFF, .length = 255, .extended = true, .stamp_ns = INT64_MAX};
    frame.data.fill(0xAB);
    EXPECT_EQ(candump_line(frame, "a-name-much-too-long-for-linux").view(),
              "(9223372036.854775) a-name-much-too 1FFFFFFF#ABABABABABABABAB");
}

CandumpEntry read(std::string_view line) {
    return read_candump_line(line);
}

TEST(CandumpRead, EveryKindOfLineThatCandumpWritesIsRead) {
    const auto standard = read("(1436509052.249713) vcan0 044#2A366C2BBA");
    ASSERT_EQ(standard.kind, CandumpKind::frame) << standard.problem;
    EXPECT_EQ(standard.interface, "vcan0");
    EXPECT_EQ(standard.frame.stamp_ns, 1'436'509'052'249'713'000);
    EXPECT_EQ(standard.frame.id, 0x044U);
    EXPECT_EQ(standard.frame.length, 5);
    EXPECT_EQ(standard.frame.data[0], 0x2A);
    EXPECT_EQ(standard.frame.data[4], 0xBA);
    EXPECT_FALSE(standard.frame.extended || standard.frame.remote || standard.frame.error);

    const auto extended = read("(0000000000.000001)  can0 0CFE1234#0f");
    EXPECT_TRUE(extended.frame.extended);
    EXPECT_EQ(extended.frame.id, 0x0CFE'1234U);
    EXPECT_EQ(extended.frame.data[0], 0x0F);
    EXPECT_EQ(extended.interface, "can0");

    const auto remote = read("(0000000000.000000) can0 123#R4");
    EXPECT_TRUE(remote.frame.remote);
    EXPECT_EQ(remote.frame.length, 4);
    EXPECT_EQ(read("(0000000000.000000) can0 123#R").frame.length, 0);

    const auto error = read("(0000000000.000000) can0 20000040#0000000000000000");
    EXPECT_TRUE(error.frame.error);
    EXPECT_FALSE(error.frame.extended);
    EXPECT_EQ(error.frame.id, 0x40U);
}

TEST(CandumpRead, CanFdFramesAreToldFromOurs) {
    const std::string line = "(0000000001.000000) can0 123##1" + std::string(128, 'A');
    const auto entry = read(line);
    EXPECT_EQ(entry.kind, CandumpKind::fd_frame) << entry.problem;
    EXPECT_EQ(entry.frame.id, 0x123U);
    EXPECT_EQ(entry.frame.length, 0);
    EXPECT_EQ(read("(0000000001.000000) can0 12345678##0").kind, CandumpKind::fd_frame);
    EXPECT_EQ(read(line + "AA").problem, "more bytes than a frame has");
    EXPECT_EQ(read("(0000000001.000000) can0 123##").problem, "no flags after '##'");
}

TEST(CandumpRead, MalformedLinesSayWhatIsWrongAndWhere) {
    struct Row {
        std::string_view line;
        std::string_view problem;
        std::size_t column;
    };
    const Row table[] = {
        {"", "no '(' before the stamp", 1},
        {"can0 123#", "no '(' before the stamp", 1},
        {"(.000000) can0 123#", "no seconds in the stamp", 2},
        {"(99999999999999999999.000000) can0 123#", "the stamp is beyond what 64 bits of nanoseconds hold", 2},
        {"(1) can0 123#", "no '.' in the stamp", 3},
        {"(1.00000) can0 123#", "the stamp has not six decimals", 9},
        {"(1.0000000) can0 123#", "no ')' after the stamp's sixth decimal", 10},
        {"(1.000000)can0 123#", "no space after the stamp", 11},
        {"(1.000000) ", "no interface", 12},
        {"(1.000000) can0", "no frame after the interface", 16},
        {"(1.000000) a-name-much-too-long 123#", "an interface's name has at most 15 characters", 12},
        {"(1.000000) can0 12#", "an identifier has 3 or 8 hexadecimal digits", 17},
        {"(1.000000) can0 123456789#", "no '#' after the identifier", 25},
        {"(1.000000) can0 12G#", "an identifier has 3 or 8 hexadecimal digits", 17},
        {"(1.000000) can0 123", "no '#' after the identifier", 20},
        {"(1.000000) can0 800#", "the identifier is beyond its 11 or 29 bits", 17},
        {"(1.000000) can0 40000000#", "the identifier is beyond its 11 or 29 bits", 17},
        {"(1.000000) can0 123#0", "half a byte", 22},
        {"(1.000000) can0 123#0G", "half a byte", 22},
        {"(1.000000) can0 123#G0", "not a hexadecimal digit", 21},
        {"(1.000000) can0 123#00 ", "not a hexadecimal digit", 23},
        {"(1.000000) can0 123#001122334455667788", "more bytes than a frame has", 37},
        {"(1.000000) can0 123#R9", "a frame has at most 8 bytes", 22},
        {"(1.000000) can0 123#R44", "something after the frame", 23},
    };
    for (const auto& row : table) {
        const auto entry = read(row.line);
        EXPECT_EQ(entry.kind, CandumpKind::malformed) << row.line;
        EXPECT_EQ(entry.problem, row.problem) << row.line;
        EXPECT_EQ(entry.column, row.column) << row.line;
    }
}

TEST(CandumpRead, ReadsBackWhateverIsWritten) {
    std::mt19937_64 random(4);
    for (int i = 0; i < 100'000; ++i) {
        const auto bits = random();
        CanFrame frame;
        frame.error = bits % 8 == 0;
        frame.extended = !frame.error && bits % 8 < 3;
        frame.remote = !frame.error && bits % 8 == 4;
        frame.id = static_cast<std::uint32_t>(random()) & (frame.extended || frame.error ? 0x1FFF'FFFFU : 0x7FFU);
        frame.length = static_cast<std::uint8_t>(random() % 9);
        if (!frame.remote) {
            std::generate_n(frame.data.begin(), frame.length, [&] { return static_cast<std::uint8_t>(random()); });
        }
        frame.stamp_ns = static_cast<std::int64_t>(random() % 9'000'000'000'000'000) * 1000;
        const auto line = candump_line(frame, "vcan0");
        const auto entry = read(line.view());
        ASSERT_EQ(entry.kind, CandumpKind::frame) << line.view() << ' ' << entry.problem;
        EXPECT_EQ(candump_line(entry.frame, entry.interface).view(), line.view());
        EXPECT_EQ(entry.frame.id, frame.id) << line.view();
        EXPECT_EQ(entry.frame.length, frame.length) << line.view();
        EXPECT_EQ(entry.frame.data, frame.data) << line.view();
        EXPECT_EQ(entry.frame.stamp_ns, frame.stamp_ns) << line.view();
        EXPECT_EQ(entry.frame.extended, frame.extended) << line.view();
        EXPECT_EQ(entry.frame.remote, frame.remote) << line.view();
        EXPECT_EQ(entry.frame.error, frame.error) << line.view();
    }
}

TEST(CandumpRead, ADamagedLineIsReadAsWhatItSaysOrRefused) {
    std::mt19937 random(5);
    const std::string_view alphabet = "0123456789ABCDEFabcdefR#()._ can\t\xFF";
    const std::string_view whole = "(0000000012.345678) can0 18FEF100#0011223344556677";
    int read_count = 0;
    for (int i = 0; i < 200'000; ++i) {
        std::string line(whole);
        for (unsigned n = random() % 4; n > 0; --n) {
            const auto at = random() % (line.size() + 1);
            switch (random() % 3) {
                case 0:
                    line.insert(at, 1, alphabet[random() % alphabet.size()]);
                    break;
                case 1:
                    line.erase(at, 1);
                    break;
                default:
                    line.resize(at);
            }
        }
        const auto entry = read(line);
        if (entry.kind == CandumpKind::malformed) {
            EXPECT_FALSE(entry.problem.empty()) << line;
            EXPECT_TRUE(entry.column >= 1 && entry.column <= line.size() + 1) << line;
        } else if (entry.kind == CandumpKind::frame) {
            ++read_count;
            EXPECT_LE(entry.frame.length, 8) << line;
            const auto again = read(candump_line(entry.frame, entry.interface).view());
            EXPECT_EQ(again.kind, CandumpKind::frame) << line;
            EXPECT_EQ(again.frame.data, entry.frame.data) << line;
        }
    }
    EXPECT_GT(read_count, 10'000);
}

}  // namespace
}  // namespace steadyboom::drivers
