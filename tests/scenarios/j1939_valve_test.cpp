// The closed loop over a J1939 valve, by the network file that docs/j1939-valve.md shows.

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "drivers/auxiliary_valve.hpp"
#include "hil/lockstep_run.hpp"
#include "hil/scratch_folder.hpp"
#include "runtime/network_file.hpp"

namespace {

using namespace steadyboom;

/// The page's network file.
drivers::NetworkConfig documented_network() {
    std::ifstream page(STEADYBOOM_J1939_PAGE);
    std::ostringstream text;
    text << page.rdbuf();
    const std::string whole = text.str();
    const std::string opening = "```toml\n";
    const auto begin = whole.find(opening) + opening.size();
    const auto end = whole.find("```", begin);
    EXPECT_NE(end, std::string::npos);
    const hil::ScratchFolder folder(std::filesystem::temp_directory_path());
    const auto path = folder.path() / "network.toml";
    std::ofstream(path) << whole.substr(begin, end - begin);
    return runtime::load_network_file(path, {});
}

hil::RunOptions options_for(const std::string& name, const drivers::NetworkConfig& network) {
    hil::RunOptions options{.crane_case = hil::load_case(name), .law = controllers::LawKind::joint_deflection};
    options.duration_s = options.crane_case.manoeuvre.duration_s;
    options.network = network;
    return options;
}

drivers::NetworkConfig extended(drivers::NetworkConfig network) {
    auto& set_point = network[drivers::Signal::valve_set_point];
    set_point.type = drivers::RawType::u16;
    set_point.byte_offset = 3;
    set_point.scale = 0.0015625;
    return network;
}

class J1939Valve : public testing::TestWithParam<std::string> {};

TEST_P(J1939Valve, LoopStaysEngagedAndDampsAsOverCia408) {
    const auto cia408 = hil::run_in_lockstep(options_for(GetParam(), {}));
    const auto standard = hil::run_in_lockstep(options_for(GetParam(), documented_network()));
    const auto fine = hil::run_in_lockstep(options_for(GetParam(), extended(documented_network())));
    EXPECT_TRUE(standard.stayed_engaged) << standard.trouble;
    EXPECT_TRUE(fine.stayed_engaged) << fine.trouble;
    const double residual_J = cia408.figures.residual_energy_J;
    EXPECT_NEAR(standard.figures.residual_energy_J, residual_J, 0.03 * residual_J) << "steps of 0.4 %";
    EXPECT_NEAR(fine.figures.residual_energy_J, residual_J, 0.002 * residual_J) << "steps of 0.0015625 %";
}

TEST_P(J1939Valve, ValveAtRestStaysShutWhereACia408ValveTrembles) {
    auto options = options_for(GetParam(), documented_network());
    options.duration_s = 0.1;
    hil::LockstepBench bench(options);
    while (bench.next_t_s() < 0.0) {
        bench.step();
        ASSERT_EQ(bench.ticks().back().truth.spool_m, 0.0);
    }
}

INSTANTIATE_TEST_SUITE_P(Thesis, J1939Valve, testing::Values("case-a", "case-b", "case-c"), [](const auto& tested) {
    std::string name = tested.param;
    std::erase(name, '-');
    return name;
});

TEST(J1939Bus, CommandsAndReportsAreTheOnlyValveFramesAndOneOfEachATick) {
    auto options = options_for("case-a", documented_network());
    options.duration_s = 1.0;
    const auto result = hil::run_in_lockstep(options);
    std::size_t commands = 0;
    std::size_t reports = 0;
    std::size_t moving = 0;
    for (const auto& frame : result.frames) {
        if (!frame.extended) {
            EXPECT_NE(frame.id, 0x220U);
            EXPECT_NE(frame.id, 0x320U);
            EXPECT_NE(frame.id, 0x1A0U);
            EXPECT_NE(frame.id, 0x720U) << "no heartbeat either";
            continue;
        }
        commands += frame.id == 0x0CFE3026U ? 1 : 0;
        reports += frame.id == 0x0CFE1020U ? 1 : 0;
        EXPECT_EQ(frame.length, 8);
        if (frame.id == 0x0CFE3026U) {
            const auto command = drivers::read_command(frame);
            ASSERT_TRUE(command.has_value());
            ASSERT_EQ(command->fail_safe, drivers::FailSafeMode::block);
            ASSERT_NE(command->state, drivers::PortState::floating);
            moving += command->state != drivers::PortState::blocked ? 1 : 0;
        }
    }
    EXPECT_EQ(commands, result.ticks.size());
    EXPECT_EQ(reports, result.ticks.size());
    EXPECT_GT(moving, 50U);
}

TEST(J1939Bus, SilentReportStopsTheMachineWithinFiveTicks) {
    hil::LockstepBench bench(options_for("case-a", documented_network()));
    while (bench.next_t_s() < 0.3) {
        bench.step();
    }
    using controllers::InterlockState;
    const auto state = [&] { return static_cast<InterlockState>(bench.ticks().back().record.interlock_state); };
    ASSERT_EQ(state(), InterlockState::active);
    bench.crane().network().set_silent(plant::spool_m, true);
    const auto silent_from = bench.ticks().size();
    while (state() == InterlockState::active) {
        bench.step();
        ASSERT_LE(bench.ticks().size(), silent_from + 6);
    }
    while (!bench.finished() && state() != InterlockState::fault_hold) {
        bench.step();
    }
    EXPECT_EQ(state(), InterlockState::fault_hold);
    for (int tick = 0; tick < 20; ++tick) {
        bench.step();
    }
    EXPECT_EQ(bench.ticks().back().record.applied_opening_m, 0.0);
    EXPECT_NEAR(bench.ticks().back().truth.spool_m, 0.0, 0.05 * 7.6e-3);
}

TEST(J1939Bus, ValveThatHearsNothingCentresItselfAndTakesCommandsAgainAfterABlock) {
    const auto network = documented_network();
    const auto crane_case = hil::load_case("case-a");
    hil::VirtualCrane crane({.crane = crane_case.crane, .network = network});
    drivers::CraneNetwork controller(network);
    drivers::CommandGuard guard({.max_opening_m = 7.6e-3, .max_step_m = 7.6e-3});
    std::int64_t now_ns = 0;
    const auto tick = [&](double opening_m, bool heard) {
        const plant::Permission permit{.mode = plant::ValveMode::active, .cutoff_energised = true, .authority = 1.0};
        const auto sent = controller.encode(guard.pass({opening_m}, permit), now_ns);
        if (heard) {
            crane.receive(sent, now_ns);
        }
        (void)controller.decode(crane.frames_to_send(now_ns), now_ns);
        for (int step = 0; step < 10; ++step) {
            crane.advance(now_ns + step * 500'000);
        }
        now_ns += 5'000'000;
        return crane.valve().state();
    };
    for (int i = 0; i < 20; ++i) {
        (void)tick(2e-3, true);
    }
    ASSERT_EQ(crane.valve().state(), plant::ValveState::active);
    ASSERT_NEAR(crane.truth(0.0).spool_m, 2e-3, 2e-5);
    for (int i = 0; i < 20; ++i) {
        (void)tick(2e-3, false);
    }
    EXPECT_TRUE(drivers::is_fault(crane.valve().state()));
    EXPECT_NEAR(crane.truth(0.0).spool_m, 0.0, 1e-5);
    EXPECT_FALSE(crane.valve().cutoff_open());
    for (int i = 0; i < 10; ++i) {
        EXPECT_TRUE(drivers::is_fault(tick(2e-3, true))) << "a command to move does not end a fault";
    }
    for (int i = 0; i < 3; ++i) {
        (void)tick(0.0, true);
    }
    EXPECT_EQ(tick(2e-3, true), plant::ValveState::active);
}

}  // namespace
