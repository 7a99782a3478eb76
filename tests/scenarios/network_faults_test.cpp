// What the network does to the closed loop when devices and frames misbehave, in lockstep: ticks are counted exactly.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/protection.hpp"
#include "hil/lockstep_run.hpp"

namespace {

using namespace steadyboom;
using controllers::InterlockState;
using drivers::CanFrame;
using drivers::Device;
using drivers::DeviceState;
using drivers::Pdo;
using ::testing::HasSubstr;

hil::RunOptions case_a() {
    hil::RunOptions options{.crane_case = hil::load_case("case-a"), .law = controllers::LawKind::joint_deflection};
    options.duration_s = 2.0;
    return options;
}

class NetworkFaults : public ::testing::Test {
  protected:
    /// Until the law is in command and the boom swings.
    void run_into_command() {
        while (bench.next_t_s() < 0.3) {
            bench.step();
        }
        ASSERT_EQ(state(), InterlockState::active);
        ASSERT_NE(record().applied_opening_m, 0.0);
    }

    [[nodiscard]] const runtime::TickRecord& record() const { return bench.ticks().back().record; }
    [[nodiscard]] InterlockState state() const { return static_cast<InterlockState>(record().interlock_state); }
    [[nodiscard]] std::string reasons() const { return controllers::reasons_in_words(record().permission_reasons); }
    [[nodiscard]] DeviceState device(Device device) const {
        return static_cast<DeviceState>(record().device_state[drivers::index_of(device)]);
    }
    [[nodiscard]] std::uint32_t id(Pdo pdo) const { return bench.tick().network().table().row(pdo).id; }

    /// From now on `change` happens to every frame of this PDO; false loses it.
    void on(Pdo pdo, std::function<bool(CanFrame&)> change) {
        bench.bus().set_wire([wanted = id(pdo), change = std::move(change)](CanFrame& frame) {
            return frame.id != wanted || change(frame);
        });
    }

    /// Ticks until the command is on its way down, counted from the first tick that can have seen the fault.
    int ticks_until_stopping() {
        bench.step();  // what is under way came before the fault
        int ticks = 0;
        while (state() == InterlockState::active && ticks < 1000) {
            bench.step();
            ++ticks;
        }
        return ticks;
    }

    void expect_neutral_within_the_ramp() {
        for (int tick = 0; tick < 21; ++tick) {
            bench.step();
        }
        EXPECT_EQ(state(), InterlockState::fault_hold);
        EXPECT_EQ(record().applied_opening_m, 0.0);
        EXPECT_EQ(record().cutoff_energised, 0);
        for (int tick = 0; tick < 20; ++tick) {
            bench.step();
        }
        EXPECT_LT(std::abs(bench.crane().truth(0.0).spool_m), 0.05 * 7.6e-3);
    }

    hil::LockstepBench bench{case_a()};
};

TEST_F(NetworkFaults, WithoutAnyAllDevicesAreOperationalBelievedAndUnreproached) {
    run_into_command();
    for (std::size_t i = 1; i < drivers::device_count; ++i) {
        EXPECT_EQ(device(static_cast<Device>(i)), DeviceState::operational) << i;
        EXPECT_EQ(record().emergency_code[i], 0);
    }
    for (std::size_t i = 0; i < drivers::tpdo_count; ++i) {
        EXPECT_EQ(record().message_state[i], static_cast<int>(drivers::ReceiverState::valid));
        EXPECT_EQ(record().message_lag_ticks[i], 0);
    }
    EXPECT_EQ(record().implausible_values, 0U) << "no limit of the table is too tight for the case";
    EXPECT_EQ(bench.crane().valve().timeouts(), 0U);
}

TEST_F(NetworkFaults, DeviceOfTheWrongTypeKeepsTheMachineFromReadyAndIsNamed) {
    bench.crane().network().object(Device::load_pin, {0x1000, 0})->value_raw = 410;
    while (bench.next_t_s() < 0.0) {
        bench.step();
        ASSERT_EQ(state(), InterlockState::standby);
    }
    EXPECT_EQ(device(Device::load_pin), DeviceState::wrong_identity);
    EXPECT_THAT(reasons(), HasSubstr("a required device is not operational"));
}

TEST_F(NetworkFaults, DeviceThatRefusesASettingKeepsTheMachineFromReady) {
    bench.crane().network().object(Device::strain_link, {0x1800, 2})->access = drivers::ObjectAccess::read_only;
    while (bench.next_t_s() < 0.0) {
        bench.step();
        ASSERT_EQ(state(), InterlockState::standby);
    }
    EXPECT_EQ(device(Device::strain_link), DeviceState::sdo_aborted);
}

TEST_F(NetworkFaults, ValveThatWouldNotCentreItselfKeepsTheMachineFromReady) {
    bench.crane().network().object(Device::servo_valve, {0x1400, 5})->value_raw = 0;
    while (bench.next_t_s() < 0.0) {
        bench.step();
        ASSERT_EQ(state(), InterlockState::standby);
    }
    EXPECT_EQ(device(Device::servo_valve), DeviceState::no_command_timeout);
}

TEST_F(NetworkFaults, LostHeartbeatStopsTheMachineThoughItsDataStillCome) {
    run_into_command();
    bench.crane().network().object(Device::load_pin, {0x1017, 0})->value_raw = 0;
    const int ticks = ticks_until_stopping();
    EXPECT_LE(ticks, 50) << "250 ms after the last one, which is up to 100 ms old";
    EXPECT_EQ(device(Device::load_pin), DeviceState::lost);
    EXPECT_THAT(reasons(), HasSubstr("a required device is not operational"));
    expect_neutral_within_the_ramp();
}

TEST_F(NetworkFaults, RebootInMidRunStopsTheMachineAndTheDeviceComesBackButNotTheCommand) {
    run_into_command();
    bench.crane().network().restart(Device::boom_inclinometer);
    EXPECT_LE(ticks_until_stopping(), 1);
    expect_neutral_within_the_ramp();
    EXPECT_EQ(device(Device::boom_inclinometer), DeviceState::operational);
    for (int tick = 0; tick < 200; ++tick) {
        bench.step();
        ASSERT_EQ(record().applied_opening_m, 0.0);
    }
    EXPECT_EQ(state(), InterlockState::fault_hold);
}

TEST_F(NetworkFaults, WrongChecksumsStopTheMachineWithinFourTicks) {
    run_into_command();
    on(Pdo::boom_angle, [](CanFrame& frame) {
        frame.data[0] ^= 0x04;
        return true;
    });
    EXPECT_LE(ticks_until_stopping(), 4);
    EXPECT_GE(record().rejected_frames, 3U);
    expect_neutral_within_the_ramp();
}

TEST_F(NetworkFaults, FrozenFrameStopsTheMachineWithinFiveTicks) {
    run_into_command();
    std::optional<CanFrame> frozen;
    on(Pdo::strain, [&frozen](CanFrame& frame) {
        frozen = frozen.value_or(frame);
        frame = *frozen;
        return true;
    });
    EXPECT_LE(ticks_until_stopping(), 5);
    expect_neutral_within_the_ramp();
}

TEST_F(NetworkFaults, SwappedInclinometersStopTheMachineWithinFourTicks) {
    run_into_command();
    bench.bus().set_wire([a = id(Pdo::boom_angle), b = id(Pdo::line_angle)](CanFrame& frame) {
        frame.id = frame.id == a ? b : frame.id == b ? a : frame.id;
        return true;
    });
    EXPECT_LE(ticks_until_stopping(), 4);
    expect_neutral_within_the_ramp();
}

TEST_F(NetworkFaults, DeviceThatDistrustsItsSampleStopsTheMachineAtOnce) {
    run_into_command();
    const auto data_id = bench.tick().network().table().row(Pdo::boom_angle).data_id;
    on(Pdo::boom_angle, [data_id](CanFrame& frame) {
        protect(frame, data_id, frame.data[frame.length - 2U] & 0x0FU, 7);
        return true;
    });
    EXPECT_LE(ticks_until_stopping(), 1);
    expect_neutral_within_the_ramp();
}

TEST_F(NetworkFaults, JumpThatPhysicsForbidsStopsTheMachineWithinThreeTicks) {
    run_into_command();
    const auto data_id = bench.tick().network().table().row(Pdo::boom_angle).data_id;
    on(Pdo::boom_angle, [data_id](CanFrame& frame) {
        frame.data[1] = static_cast<std::uint8_t>(frame.data[1] + 0x40);  // 16 degrees in one tick
        protect(frame, data_id, frame.data[frame.length - 2U] & 0x0FU, drivers::protection_quality_good);
        return true;
    });
    EXPECT_LE(ticks_until_stopping(), 3);
    EXPECT_GE(record().implausible_values, 3U);
    expect_neutral_within_the_ramp();
}

TEST_F(NetworkFaults, ConstantDelayOfSamplesStopsTheMachineWithinTwentyTicks) {
    run_into_command();
    std::array<CanFrame, 4> line{};
    std::size_t next = 0;
    std::size_t seen = 0;
    on(Pdo::boom_angle, [&](CanFrame& frame) {
        std::swap(frame, line[next]);
        next = (next + 1) % line.size();
        return ++seen > line.size();
    });
    EXPECT_LE(ticks_until_stopping(), 20);
    expect_neutral_within_the_ramp();
}

TEST_F(NetworkFaults, CommandWithoutItsTwinCentresTheValveWithin25MillisecondsAndStopsTheMachine) {
    run_into_command();
    on(Pdo::valve_twin, [](CanFrame& frame) {
        frame.data[0] ^= 0x01;
        return true;
    });
    for (int tick = 0; tick < 6; ++tick) {
        bench.step();
    }
    EXPECT_EQ(bench.crane().valve().state(), plant::ValveState::fault_hold);
    EXPECT_EQ(bench.crane().valve().timeouts(), 1U);
    EXPECT_FALSE(bench.crane().valve().cutoff_open());
    for (int tick = 0; tick < 7; ++tick) {
        bench.step();
    }
    EXPECT_NE(state(), InterlockState::active);
    EXPECT_THAT(reasons(), HasSubstr("the valve is not in the commanded state"));
    EXPECT_EQ(record().emergency_code[drivers::index_of(Device::servo_valve)], drivers::emergency_rpdo_timeout);
    expect_neutral_within_the_ramp();

    // Twins again: the valve stays down until the operator has reset the fault, and then comes back to DISABLED alone.
    bench.bus().set_wire({});
    for (int tick = 0; tick < 220; ++tick) {
        bench.step();
    }
    EXPECT_EQ(bench.crane().valve().state(), plant::ValveState::fault_disabled);
    EXPECT_TRUE(bench.mailbox().try_push({.serial = 1000, .command = runtime::OperatorCommand::reset}));
    for (int tick = 0; tick < 20; ++tick) {
        bench.step();
    }
    EXPECT_EQ(state(), InterlockState::standby) << reasons();
    EXPECT_EQ(bench.crane().valve().state(), plant::ValveState::disabled);
    EXPECT_EQ(record().applied_opening_m, 0.0);
}

// Figures of the same run before frames were protected, devices checked and configured and the valve a state machine:
// what the network changed is far below what its sensors resolve.
TEST(NetworkEffect, DampingIsWhatItWasWithAPlainNetwork) {
    hil::RunOptions options = case_a();
    options.duration_s = options.crane_case.manoeuvre.duration_s;
    const hil::RunResult run = hil::run_in_lockstep(options);
    ASSERT_TRUE(run.stayed_engaged) << run.trouble;
    constexpr double rad_per_step = 0.001 * 0.017453292519943295;
    EXPECT_NEAR(run.figures.peak_phi6_rad, 0.00325712, 0.5 * rad_per_step);
    EXPECT_NEAR(run.figures.peak_R1_m, 0.00179520, 1e-6);
    EXPECT_NEAR(run.figures.peak_q1_m, 0.00403780, 1e-6);
    EXPECT_NEAR(run.figures.residual_energy_J, 247.822, 1e-3 * 247.822);
}

}  // namespace
