// The telemetry process as it runs beside a controller: ring in, LCM out, recorded by LCM's own logger. Label vcan: it
// needs a loopback interface that carries multicast.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <lcm/lcm-cpp.hpp>

#include "child_process.hpp"
#include "runtime/telemetry/tick_message.hpp"
#include "runtime/tick_ring.hpp"
#include "steadyboom/status_t.hpp"

namespace steadyboom::runtime {
namespace {

using testing::HasSubstr;

constexpr auto patience = std::chrono::seconds(60);

// Waits for something that another process does.
bool eventually(const std::function<bool()>& happened) {
    const auto give_up = std::chrono::steady_clock::now() + patience;
    while (!happened()) {
        if (std::chrono::steady_clock::now() > give_up) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
}

std::string text_of(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

TickRecord record_of(std::uint64_t tick) {
    TickRecord record;
    record.tick = tick;
    record.time_ns = static_cast<std::int64_t>(tick) * 5'000'000;
    const auto number = static_cast<double>(tick);
    for (std::size_t i = 0; i < record.estimate.size(); ++i) {
        record.estimate[i] = number + 0.001 * static_cast<double>(i);
        record.setpoint[i] = -record.estimate[i];
    }
    for (std::size_t i = 0; i < record.measured.size(); ++i) {
        record.measured[i] = number * 1e-3 + static_cast<double>(i);
        record.measured_age_ticks[i] = static_cast<std::uint32_t>(tick % 4);
    }
    record.wanted_opening_m = number * 1e-6;
    record.applied_opening_m = number * 0.5e-6;
    record.wake_up_latency_ns = static_cast<std::int64_t>(tick) * 3;
    record.interlock_state = static_cast<std::uint8_t>(tick % 7);
    return record;
}

std::vector<std::uint8_t> bytes_of(const steadyboom::tick_t& message) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    return bytes;
}

struct Recording {
    std::vector<steadyboom::tick_t> ticks;
    std::vector<steadyboom::status_t> statuses;
    std::size_t undecodable = 0;
    std::size_t probes = 0;
};

Recording read_recording(const std::filesystem::path& path) {
    Recording recording;
    lcm::LogFile log(path.string(), "r");
    if (!log.good()) {
        return recording;
    }
    const auto decode = [&](const lcm::LogEvent& event, auto& into) {
        if (into.decode(event.data, 0, event.datalen) != event.datalen) {
            ++recording.undecodable;
        }
    };
    while (const lcm::LogEvent* event = log.readNextEvent()) {
        if (event->channel == "STEADYBOOM_TICK") {
            decode(*event, recording.ticks.emplace_back());
        } else if (event->channel == "STEADYBOOM_STATUS") {
            decode(*event, recording.statuses.emplace_back());
        } else if (event->channel == "PROBE") {
            ++recording.probes;
        }
    }
    return recording;
}

class Telemetry : public testing::Test {
  protected:
    ~Telemetry() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] std::vector<std::string> command() const {
        return {STEADYBOOM_TELEMETRY, "--ring", ring_.string(), "--url", url_};
    }

    // The logger listens when it has recorded a message of ours.
    void wait_for_logger() {
        lcm::LCM probe(url_);
        ASSERT_TRUE(probe.good());
        ASSERT_TRUE(eventually([&] {
            probe.publish("PROBE", "x", 1);
            return std::filesystem::exists(log_) && read_recording(log_).probes > 0;
        })) << "lcm-logger records nothing: is there a multicast route on lo?";
    }

    std::filesystem::path folder_ = [] {
        std::string name = testing::TempDir() + "steadyboom-telemetry-XXXXXX";
        return std::filesystem::path(mkdtemp(name.data()));
    }();
    std::filesystem::path ring_ = folder_ / "ticks";
    std::filesystem::path log_ = folder_ / "ticks.lcmlog";
    std::filesystem::path output_ = folder_ / "telemetry.txt";
    std::string url_ = "udpm://239.255.76.67:7712?ttl=0";
    TickRingOptions options_{.capacity_records = 1024, .period_ns = 5'000'000, .crane_hash = 0x1234, .file_mode = 0640};
};

TEST_F(Telemetry, EveryTickOfTwoControllersArrivesInTheLogWithItsValues) {
    ChildProcess logger({"lcm-logger", "--quiet", "--flush-interval=10", "--lcm-url=" + url_, log_.string()},
                        folder_ / "logger.txt");
    wait_for_logger();
    ChildProcess telemetry(command(), output_);

    constexpr std::uint64_t ticks_each = 300;
    const auto run_controller = [&](std::uint64_t first_tick) {
        auto writer = std::make_unique<TickRingWriter<TickRecord>>(ring_, options_);
        for (std::uint64_t tick = first_tick; tick < first_tick + ticks_each; ++tick) {
            writer->push(record_of(tick));
            // At a controller's pace: the logger's socket holds some 90 messages, and UDP drops what comes in a burst.
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return writer;
    };
    auto writer = run_controller(0);
    ASSERT_TRUE(eventually([&] { return read_recording(log_).ticks.size() >= ticks_each; })) << text_of(output_);
    writer.reset();
    writer = run_controller(1000);
    ASSERT_TRUE(eventually([&] { return read_recording(log_).ticks.size() >= 2 * ticks_each; })) << text_of(output_);

    telemetry.signal(SIGTERM);
    EXPECT_EQ(telemetry.wait(), 0);
    EXPECT_THAT(text_of(output_), HasSubstr("600 ticks published, 0 lost, 0 not sent"));
    ASSERT_TRUE(eventually([&] {
        const Recording now = read_recording(log_);
        return !now.statuses.empty() && now.statuses.back().published_ticks == 600;
    }));
    logger.signal(SIGINT);
    logger.wait();

    const Recording recording = read_recording(log_);
    EXPECT_EQ(recording.undecodable, 0U);
    ASSERT_EQ(recording.ticks.size(), 2 * ticks_each);
    for (std::size_t i = 0; i < recording.ticks.size(); ++i) {
        const TickRecord expected = record_of(i < ticks_each ? i : 1000 + i - ticks_each);
        ASSERT_EQ(recording.ticks[i].tick, static_cast<std::int64_t>(expected.tick));
        ASSERT_EQ(recording.ticks[i].estimate.phi6_rad, expected.estimate[plant::phi6_rad]);
        ASSERT_EQ(recording.ticks[i].applied_opening_m, expected.applied_opening_m);
        ASSERT_EQ(bytes_of(recording.ticks[i]), bytes_of(to_message(expected)));
    }
    const steadyboom::status_t& last = recording.statuses.back();
    EXPECT_EQ(last.lost_ticks, 0);
    EXPECT_EQ(last.publish_errors, 0);
    EXPECT_EQ(last.rings_opened, 2);
    EXPECT_EQ(last.crane_hash_bits, 0x1234);
    EXPECT_EQ(last.period_ns, 5'000'000);
    EXPECT_EQ(last.writer_present, 1);
}

TEST_F(Telemetry, WhatItCouldNotReadInTimeIsInItsStatusAsLost) {
    ChildProcess logger({"lcm-logger", "--quiet", "--flush-interval=10", "--lcm-url=" + url_, log_.string()},
                        folder_ / "logger.txt");
    wait_for_logger();
    options_.capacity_records = 16;
    TickRingWriter<TickRecord> writer(ring_, options_);
    ChildProcess telemetry(command(), output_);
    writer.push(record_of(0));
    ASSERT_TRUE(eventually([&] { return read_recording(log_).ticks.size() == 1; }));

    telemetry.signal(SIGSTOP);
    for (std::uint64_t tick = 1; tick <= 100; ++tick) {
        writer.push(record_of(tick));
    }
    telemetry.signal(SIGCONT);
    ASSERT_TRUE(eventually([&] {
        const Recording now = read_recording(log_);
        return !now.statuses.empty() && now.statuses.back().lost_ticks == 84;
    })) << text_of(output_);
    telemetry.signal(SIGTERM);
    EXPECT_EQ(telemetry.wait(), 0);
    EXPECT_EQ(read_recording(log_).ticks.back().tick, 100);
}

TEST_F(Telemetry, ARingOfAnotherReleaseEndsItWithOneLine) {
    std::ofstream(ring_) << std::string(10'000, 'x');
    ChildProcess telemetry(command(), output_);
    EXPECT_EQ(telemetry.wait(), 1);
    EXPECT_EQ(text_of(output_), "steadyboom-telemetry: tick ring " + ring_.string() + ": is no tick ring\n");
}

TEST_F(Telemetry, BadOptionsEndItWithExitCodeTwo) {
    EXPECT_EQ(ChildProcess({STEADYBOOM_TELEMETRY, "--nonsense"}, output_).wait(), 2);
    EXPECT_EQ(ChildProcess({STEADYBOOM_TELEMETRY, "--config", (folder_ / "absent.toml").string()}, output_).wait(), 2);
    EXPECT_EQ(ChildProcess({STEADYBOOM_TELEMETRY, "--help"}, output_).wait(), 0);
    EXPECT_EQ(ChildProcess({STEADYBOOM_TELEMETRY, "--version"}, output_).wait(), 0);
    EXPECT_THAT(text_of(output_), HasSubstr("steadyboom-telemetry 0."));
}

}  // namespace
}  // namespace steadyboom::runtime
