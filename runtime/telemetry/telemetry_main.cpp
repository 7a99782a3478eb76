// steadyboom-telemetry: publishes every tick of a running controller on LCM. A process of its own, so that nothing the
// network does can reach the control tick: it only reads the tick ring.
#include <systemd/sd-daemon.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <exception>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <lcm/lcm-cpp.hpp>

#include "runtime/clock.hpp"
#include "runtime/controller_config.hpp"
#include "runtime/telemetry/tick_message.hpp"
#include "runtime/tick_ring.hpp"
#include "steadyboom/status_t.hpp"

namespace {

using steadyboom::runtime::MonotonicClock;
using steadyboom::runtime::TickRecord;
using steadyboom::runtime::TickRingReader;

constexpr int exit_done = 0;
constexpr int exit_failed = 1;
constexpr int exit_bad_input = 2;

constexpr std::int64_t status_interval_ns = 1'000'000'000;
constexpr std::int64_t ring_absent_wait_ns = 50'000'000;

void say(const std::string& line) {
    std::cerr << "steadyboom-telemetry: " << line << std::endl;
}

class Telemetry {
  public:
    Telemetry(lcm::LCM& lcm, std::filesystem::path ring, std::string channel, std::string status_channel)
        : lcm_(lcm), ring_(std::move(ring)), channel_(std::move(channel)), status_channel_(std::move(status_channel)) {}

    /// Publishes what is there. Throws std::runtime_error when the ring is not one this program can read.
    void step() {
        if (!reader_) {
            open();
        }
        if (reader_) {
            // Asked first: what the old writer pushed last is read before its ring is left.
            const bool replaced = reader_->replaced();
            publish_ticks();
            if (replaced) {
                leave();
            }
        }
        if (clock_.now_ns() >= next_status_ns_) {
            publish_status();
        }
    }

    /// How long step() has nothing to do.
    [[nodiscard]] std::int64_t idle_ns() const {
        return reader_ ? std::clamp<std::int64_t>(reader_->period_ns() / 2, 500'000, 20'000'000) : ring_absent_wait_ns;
    }

    void publish_status() {
        steadyboom::status_t status{};
        status.time_ns = clock_.now_ns();
        if (reader_) {
            status.writer_present = reader_->closed() ? 0 : 1;
            status.writer_epoch_bits = static_cast<std::int64_t>(reader_->epoch());
            status.crane_hash_bits = static_cast<std::int64_t>(reader_->crane_hash());
            status.period_ns = reader_->period_ns();
        }
        status.published_ticks = published_ticks_;
        status.lost_ticks = lost_ticks();
        status.publish_errors = publish_errors_;
        status.rings_opened = rings_opened_;
        lcm_.publish(status_channel_, &status);
        next_status_ns_ = status.time_ns + status_interval_ns;
    }

    [[nodiscard]] std::string summary() const {
        return std::to_string(published_ticks_) + " ticks published, " + std::to_string(lost_ticks()) + " lost, " +
               std::to_string(publish_errors_) + " not sent";
    }

  private:
    void open() {
        if (!std::filesystem::exists(ring_)) {
            return;
        }
        reader_.emplace(ring_);
        ++rings_opened_;
        say("reading " + ring_.string());
    }

    void leave() {
        lost_in_rings_left_ += static_cast<std::int64_t>(reader_->lost());
        reader_.reset();
    }

    void publish_ticks() {
        TickRecord record;
        while (reader_->read(record)) {
            const steadyboom::tick_t message = to_message(record);
            if (lcm_.publish(channel_, &message) == 0) {
                ++published_ticks_;
            } else if (publish_errors_++ == 0) {
                say("LCM cannot send; is there a route for its multicast group? Going on, counting in " +
                    status_channel_);
            }
        }
    }

    [[nodiscard]] std::int64_t lost_ticks() const {
        return lost_in_rings_left_ + (reader_ ? static_cast<std::int64_t>(reader_->lost()) : 0);
    }

    lcm::LCM& lcm_;
    std::filesystem::path ring_;
    std::string channel_;
    std::string status_channel_;
    MonotonicClock clock_;
    std::optional<TickRingReader<TickRecord>> reader_;
    std::int64_t next_status_ns_ = 0;
    std::int64_t published_ticks_ = 0;
    std::int64_t lost_in_rings_left_ = 0;
    std::int64_t publish_errors_ = 0;
    std::int64_t rings_opened_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Publishes each tick of a running steadyboom-controller on LCM, and once a second its own status.\n"
        "Waits for the controller's tick ring to appear and follows it when the controller starts anew.\n"
        "Exit codes: 0 done (SIGTERM, SIGINT), 1 failed, 2 bad input.",
        "steadyboom-telemetry");
    app.set_version_flag("--version", "steadyboom-telemetry " STEADYBOOM_VERSION);
    std::string ring = "/run/steadyboom/ticks.ring";
    std::string config;
    std::string url = "udpm://239.255.76.67:7667?ttl=0";
    std::string channel = "STEADYBOOM_TICK";
    std::string status_channel = "STEADYBOOM_STATUS";
    CLI::Option* ring_option = app.add_option("--ring", ring, "The controller's tick ring")->capture_default_str();
    app.add_option("--config", config, "Take the ring's path from this controller configuration")
        ->excludes(ring_option);
    app.add_option("--url", url, "LCM provider; ttl=0 keeps the messages on this machine")->capture_default_str();
    app.add_option("--channel", channel, "LCM channel of the ticks (steadyboom.tick_t)")->capture_default_str();
    app.add_option("--status-channel", status_channel, "LCM channel of the status (steadyboom.status_t)")
        ->capture_default_str();
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? exit_done : exit_bad_input;
    }
    if (!config.empty()) {
        try {
            ring = steadyboom::runtime::load_controller_config(config).telemetry_ring_path;
        } catch (const std::exception& error) {
            say(error.what());
            return exit_bad_input;
        }
    }

    // Blocked before LCM can start a thread; sigtimedwait is the loop's sleep.
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGTERM);
    sigaddset(&ends, SIGINT);
    sigprocmask(SIG_BLOCK, &ends, nullptr);

    try {
        lcm::LCM lcm(url);
        if (!lcm.good()) {
            say("cannot open LCM at " + url + "; give a provider such as udpm://239.255.76.67:7667?ttl=0");
            return exit_failed;
        }
        Telemetry telemetry(lcm, ring, channel, status_channel);
        sd_notify(0, "READY=1");
        for (int received = -1; received != SIGTERM && received != SIGINT;) {
            telemetry.step();
            const timespec idle{0, telemetry.idle_ns()};
            received = sigtimedwait(&ends, nullptr, &idle);
        }
        sd_notify(0, "STOPPING=1");
        telemetry.step();
        telemetry.publish_status();
        say(telemetry.summary());
        return exit_done;
    } catch (const std::exception& error) {
        say(error.what());
        return exit_failed;
    }
}
