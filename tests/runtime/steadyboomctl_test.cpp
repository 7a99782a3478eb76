// steadyboomctl against a real socket whose tick answers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include <nlohmann/json.hpp>

#include "child_process.hpp"
#include "runtime/operator_socket.hpp"

namespace steadyboom::runtime {
namespace {

using testing::HasSubstr;

class Steadyboomctl : public testing::Test {
  protected:
    ~Steadyboomctl() override {
        stop_ = true;
        tick_.join();
        std::filesystem::remove_all(folder_);
    }

    int run(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {STEADYBOOMCTL, "--socket", path_.string()});
        const std::string output = folder_ / "output";
        const int code = ChildProcess(arguments, output).wait();
        std::ostringstream text;
        text << std::ifstream(output).rdbuf();
        output_ = text.str();
        return code;
    }

    std::filesystem::path folder_ = [] {
        std::string name = testing::TempDir() + "steadyboom-ctl-XXXXXX";
        return std::filesystem::path(mkdtemp(name.data()));
    }();
    std::filesystem::path path_ = folder_ / "command.sock";
    MonotonicClock clock_;
    OperatorMailbox mailbox_;
    OperatorSocketOptions options_ = [this] {
        OperatorSocketOptions options;
        options.path = path_;
        options.describe = [](const OperatorStatus& status) { return status.state == 3 ? "ENGAGING" : "READY"; };
        return options;
    }();
    OperatorSocket socket_{options_, mailbox_, clock_};
    std::atomic<bool> refuse_{false};
    std::atomic<bool> stop_{false};
    std::thread tick_{[this] {
        mailbox_.publish({.tick = 8, .time_ns = clock_.now_ns(), .state = 1, .reasons = 0});
        while (!stop_) {
            if (const auto request = mailbox_.try_pop()) {
                const bool engage = request->command == OperatorCommand::engage;
                mailbox_.publish({.tick = 9, .time_ns = clock_.now_ns(), .state = engage ? 3U : 1U, .reasons = 0});
                mailbox_.answer(*request, refuse_ ? OperatorResult::refused : OperatorResult::done);
            }
            std::this_thread::sleep_for(std::chrono::microseconds(100));
        }
    }};
    std::string output_;
};

TEST_F(Steadyboomctl, ArmPrintsTheTokenThatEngageTakes) {
    ASSERT_EQ(run({"arm"}), 0) << output_;
    ASSERT_EQ(output_.size(), 17U);
    const std::string token = output_.substr(0, 16);
    EXPECT_EQ(run({"engage", token}), 0) << output_;
    EXPECT_EQ(output_, "ENGAGING\n");
    EXPECT_EQ(run({"engage", token}), 1);
    EXPECT_THAT(output_, HasSubstr("engage: bad token"));
}

TEST_F(Steadyboomctl, EngageArmDoesBothSteps) {
    EXPECT_EQ(run({"engage", "--arm"}), 0) << output_;
}

TEST_F(Steadyboomctl, StatusSpeaksWordsOrJson) {
    EXPECT_EQ(run({"status"}), 0);
    EXPECT_THAT(output_, HasSubstr("READY\ntick 8, due "));
    EXPECT_EQ(run({"status", "--json"}), 0);
    const auto json = nlohmann::json::parse(output_);
    EXPECT_EQ(json["result"], "done");
    EXPECT_EQ(json["state"], 1);
    EXPECT_EQ(json["text"], "READY");
    EXPECT_EQ(json["tick"], 8);
    EXPECT_FALSE(json.contains("token"));
}

TEST_F(Steadyboomctl, ARefusalIsExitCodeOneWithTheReason) {
    refuse_ = true;
    EXPECT_EQ(run({"reset"}), 1);
    EXPECT_EQ(output_, "steadyboomctl: reset: refused: READY\n");
}

TEST_F(Steadyboomctl, BadInputIsExitCodeTwoAndNoControllerIsOne) {
    EXPECT_EQ(run({}), 2);
    EXPECT_EQ(run({"launch"}), 2);
    EXPECT_EQ(run({"engage"}), 2);
    EXPECT_EQ(run({"engage", "xyz"}), 2);
    EXPECT_THAT(output_, HasSubstr("16 hexadecimal digits"));
    EXPECT_EQ(run({"engage", "--arm", "0123456789abcdef"}), 2);
    EXPECT_EQ(run({"--help"}), 0);
    EXPECT_THAT(output_, HasSubstr("disengage"));
    path_ = folder_ / "nobody.sock";
    EXPECT_EQ(run({"stop"}), 1);
    EXPECT_THAT(output_, HasSubstr("start the controller first"));
}

}  // namespace
}  // namespace steadyboom::runtime
