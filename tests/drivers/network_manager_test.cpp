// The NMT manager against the devices' side of the network, over the loopback bus.
#include <map>
#include <set>
#include <vector>

#include "network_loop.hpp"

namespace steadyboom::drivers {
namespace {

constexpr ObjectAddress heartbeat_time{0x1017, 0};
constexpr ObjectAddress strain_transmission{0x1800, 2};

class NetworkManagerTest : public NetworkLoop {
  protected:
    void SetUp() override {
        bus_.set_tap([this](const CanFrame& frame) {
            const auto message = controller_.table().message_with(frame.id);
            if (message != Message::none && log_count_ < log_.size()) {
                log_[log_count_++] = {now_ns_ / tick_ns, frame};
            }
        });
    }

    struct Logged {
        std::int64_t tick = 0;
        CanFrame frame;
    };

    [[nodiscard]] std::vector<Logged> logged(std::uint32_t id) const {
        std::vector<Logged> found;
        for (std::size_t i = 0; i < log_count_; ++i) {
            if (log_[i].frame.id == id) {
                found.push_back(log_[i]);
            }
        }
        return found;
    }

    /// Ticks until the device is in this state, at most a thousand.
    int ticks_until(Device device, DeviceState state) {
        int ticks = 0;
        while (controller_.node(device).managed != state && ticks < 1000) {
            (void)tick();
            ++ticks;
        }
        return ticks;
    }

    std::array<Logged, 40'000> log_{};
    std::size_t log_count_ = 0;
};

TEST_F(NetworkManagerTest, AnnouncesItselfQuietensTheBusAsksConfiguresAndStartsEachDevice) {
    for (int i = 0; i < 60; ++i) {
        (void)tick();
    }
    const auto nmt = logged(0x000);
    ASSERT_EQ(nmt.size(), 1U + 7U);
    EXPECT_EQ(logged(0x701).front().frame.data[0], 0x00) << "boot-up first";
    EXPECT_EQ(logged(0x701).front().tick, 1);
    EXPECT_EQ(nmt[0].tick, 2);
    EXPECT_EQ(nmt[0].frame.data[0], 0x80);
    EXPECT_EQ(nmt[0].frame.data[1], 0x00);
    std::set<int> started;
    for (std::size_t i = 1; i < nmt.size(); ++i) {
        EXPECT_EQ(nmt[i].frame.data[0], 0x01);
        EXPECT_TRUE(started.insert(nmt[i].frame.data[1]).second);
    }
    EXPECT_EQ(started, (std::set<int>{0x10, 0x14, 0x18, 0x19, 0x1C, 0x20, 0x28}));
    EXPECT_TRUE(controller_.manager().all_required_operational());
    for (std::size_t i = 1; i < device_count; ++i) {
        EXPECT_EQ(controller_.node(static_cast<Device>(i)).managed, DeviceState::operational);
    }
    const auto asked = logged(0x610);
    ASSERT_EQ(asked.size(), 3U);
    EXPECT_EQ(asked[0].frame.data, (std::array<std::uint8_t, 8>{0x40, 0x00, 0x10, 0, 0, 0, 0, 0}));
    EXPECT_EQ(asked[1].frame.data, (std::array<std::uint8_t, 8>{0x2F, 0x00, 0x18, 2, 1, 0, 0, 0}));
    EXPECT_EQ(asked[2].frame.data, (std::array<std::uint8_t, 8>{0x2B, 0x17, 0x10, 0, 100, 0, 0, 0}));
    EXPECT_EQ(logged(0x590)[0].frame.data, (std::array<std::uint8_t, 8>{0x43, 0x00, 0x10, 0, 0x94, 0x01, 0, 0}));
    EXPECT_EQ(logged(0x620)[1].frame.data, (std::array<std::uint8_t, 8>{0x40, 0x00, 0x14, 5, 0, 0, 0, 0}))
        << "a valve is asked for its command timeout";
}

TEST_F(NetworkManagerTest, SendsNoMoreThanOneManagementFrameATick) {
    for (int i = 0; i < 500; ++i) {
        if (i == 250) {
            for (std::size_t d = 1; d < device_count; ++d) {
                devices_.restart(static_cast<Device>(d));
            }
        }
        (void)tick();
    }
    std::map<std::int64_t, int> management_by_tick;
    for (std::size_t i = 0; i < log_count_; ++i) {
        const auto& row = controller_.table().row(controller_.table().message_with(log_[i].frame.id));
        const bool management = row.from_controller && row.kind != MessageKind::pdo && row.kind != MessageKind::sync;
        EXPECT_LE(management_by_tick[log_[i].tick] += management ? 1 : 0, 1);
    }
    EXPECT_TRUE(controller_.manager().all_required_operational());
}

TEST_F(NetworkManagerTest, DevicesThatMayNotBeConfiguredAreOnlyAsked) {
    NetworkConfig config;
    for (auto& device : config.devices) {
        device.configure = false;
    }
    CraneNetwork controller(config);
    DeviceNetwork devices(config);
    std::vector<CanFrame> arrived;
    for (int i = 0; i < 60; ++i) {
        now_ns_ += tick_ns;
        (void)controller.decode(arrived, now_ns_);
        const auto sent = controller.encode(guard_.neutral(), now_ns_);
        for (const auto& frame : sent) {
            EXPECT_FALSE((frame.id & 0x780U) == 0x600U && (frame.data[0] & 0xE0U) == 0x20U) << "no setting is written";
        }
        devices.receive(sent, now_ns_);
        const auto beats = devices.housekeeping(now_ns_);
        arrived.assign(beats.begin(), beats.end());
        const auto answers = devices.answer_sync(sensors_, feedback_, now_ns_);
        arrived.insert(arrived.end(), answers.begin(), answers.end());
    }
    EXPECT_TRUE(controller.manager().all_required_operational());
}

TEST_F(NetworkManagerTest, DeviceOfAnotherTypeIsNeverStartedAndItsDataAreNotBelieved) {
    devices_.object(Device::boom_inclinometer, {0x1000, 0})->value_raw = 406;
    for (int i = 0; i < 200; ++i) {
        EXPECT_FALSE(tick().fresh(plant::boom_angle_rad));
    }
    const auto& node = controller_.node(Device::boom_inclinometer);
    EXPECT_EQ(node.managed, DeviceState::wrong_identity);
    EXPECT_EQ(node.failed_object, (ObjectAddress{0x1000, 0}));
    EXPECT_EQ(node.read_raw, 406U);
    EXPECT_FALSE(controller_.manager().all_required_operational());
    EXPECT_EQ(devices_.state(Device::boom_inclinometer), NodeState::stopped);
    EXPECT_TRUE(tick().fresh(plant::line_angle_rad));
    // The right device in its place is found within the next second's question.
    devices_.object(Device::boom_inclinometer, {0x1000, 0})->value_raw = 410;
    EXPECT_LT(ticks_until(Device::boom_inclinometer, DeviceState::operational), 250);
}

TEST_F(NetworkManagerTest, DeviceThatStartsItselfIsNotBelievedWhileItIsTheWrongOne) {
    devices_.object(Device::boom_inclinometer, {0x1000, 0})->value_raw = 406;
    for (int i = 0; i < 100; ++i) {
        (void)tick();
    }
    const std::array start = {CanFrame{.id = 0, .length = 2, .data = {0x01, 0x14}}};
    devices_.object(Device::boom_inclinometer, {0x1800, 2})->value_raw = 1;
    devices_.receive(start, now_ns_);
    for (int i = 0; i < 20; ++i) {
        EXPECT_FALSE(tick().valid[plant::boom_angle_rad]);
    }
    EXPECT_GT(controller_.status().not_operational_frames, 10U);
}

TEST_F(NetworkManagerTest, VendorAndProductAreAskedWhereTheyAreExpected) {
    NetworkConfig config;
    config[Device::load_pin].vendor_id = 0x1234;
    config[Device::load_pin].product_code = 7;
    NetworkConfig other = config;
    other[Device::load_pin].product_code = 8;
    CraneNetwork controller(config);
    DeviceNetwork devices(other);
    std::vector<CanFrame> arrived;
    for (int i = 0; i < 80; ++i) {
        now_ns_ += tick_ns;
        (void)controller.decode(arrived, now_ns_);
        devices.receive(controller.encode(guard_.neutral(), now_ns_), now_ns_);
        const auto beats = devices.housekeeping(now_ns_);
        arrived.assign(beats.begin(), beats.end());
    }
    EXPECT_EQ(controller.node(Device::load_pin).managed, DeviceState::wrong_identity);
    EXPECT_EQ(controller.node(Device::load_pin).failed_object, (ObjectAddress{0x1018, 2}));
    EXPECT_EQ(controller.node(Device::load_pin).read_raw, 8U);
}

TEST_F(NetworkManagerTest, ValveWithoutACommandTimeoutInTimeIsNeverStarted) {
    for (const std::uint32_t timeout_ms : {0U, 26U, 1000U}) {
        devices_.object(Device::servo_valve, {0x1400, 5})->value_raw = timeout_ms;
        devices_.restart(Device::servo_valve);
        for (int i = 0; i < 100; ++i) {
            (void)tick();
        }
        EXPECT_EQ(controller_.node(Device::servo_valve).managed, DeviceState::no_command_timeout) << timeout_ms;
        EXPECT_EQ(controller_.node(Device::servo_valve).read_raw, timeout_ms);
    }
    devices_.object(Device::servo_valve, {0x1400, 5})->value_raw = 20;
    EXPECT_LT(ticks_until(Device::servo_valve, DeviceState::operational), 250);
}

TEST_F(NetworkManagerTest, RefusedSettingIsToldWithObjectAndReason) {
    devices_.object(Device::strain_link, strain_transmission)->access = ObjectAccess::read_only;
    EXPECT_LT(ticks_until(Device::strain_link, DeviceState::sdo_aborted), 60);
    EXPECT_EQ(controller_.node(Device::strain_link).failed_object, strain_transmission);
    EXPECT_EQ(controller_.node(Device::strain_link).abort, SdoAbort::read_only);
    devices_.object(Device::strain_link, strain_transmission)->access = ObjectAccess::read_write;
    EXPECT_LT(ticks_until(Device::strain_link, DeviceState::operational), 250);
}

TEST_F(NetworkManagerTest, AbsentDeviceStaysUnknownAndHoldsUpNoOther) {
    devices_.set_silent(Device::load_pin, true);
    for (int i = 0; i < 120; ++i) {
        (void)tick();
    }
    EXPECT_EQ(controller_.node(Device::load_pin).managed, DeviceState::unknown);
    EXPECT_EQ(controller_.node(Device::load_pin).abort, SdoAbort::timeout);
    for (std::size_t i = 1; i < device_count; ++i) {
        if (static_cast<Device>(i) != Device::load_pin) {
            EXPECT_TRUE(controller_.manager().operational(static_cast<Device>(i))) << i;
        }
    }
    EXPECT_FALSE(controller_.manager().all_required_operational());
    devices_.set_silent(Device::load_pin, false);
    EXPECT_LT(ticks_until(Device::load_pin, DeviceState::operational), 300);
}

TEST_F(NetworkManagerTest, DeviceThatIsNotRequiredMayBeAbsent) {
    devices_.set_silent(Device::drum_encoder, true);
    start();
    EXPECT_EQ(controller_.node(Device::drum_encoder).managed, DeviceState::unknown);
    EXPECT_TRUE(controller_.manager().all_required_operational());
}

TEST_F(NetworkManagerTest, MissingHeartbeatMeansLostAfterTheConsumerTimeAndComesBackWithItsIdentity) {
    start();
    devices_.object(Device::load_pin, heartbeat_time)->value_raw = 0;
    const int ticks = ticks_until(Device::load_pin, DeviceState::lost);
    EXPECT_GE(ticks, 30);
    EXPECT_LE(ticks, 52) << "250 ms after the last heartbeat";
    EXPECT_FALSE(controller_.node(Device::load_pin).alive);
    EXPECT_FALSE(tick().valid[plant::line_tension_N] && controller_.status().not_operational_frames == 0);
    EXPECT_LT(ticks_until(Device::load_pin, DeviceState::operational), 250) << "asked again, configured, started";
}

TEST_F(NetworkManagerTest, RebootInMidRunIsCheckedConfiguredAndStartedAgain) {
    start();
    devices_.restart(Device::boom_inclinometer);
    (void)tick();
    (void)tick();
    EXPECT_NE(controller_.node(Device::boom_inclinometer).managed, DeviceState::operational);
    EXPECT_LT(ticks_until(Device::boom_inclinometer, DeviceState::operational), 15);
    EXPECT_EQ(controller_.node(Device::boom_inclinometer).boot_ups, 2U);
}

TEST_F(NetworkManagerTest, DeviceThatAnotherStoppedStaysSoUntilAReset) {
    start();
    const auto nmt = [&](std::uint8_t command) {
        devices_.receive(std::array{CanFrame{.id = 0, .length = 2, .data = {command, 0x18}}}, now_ns_);
    };
    nmt(0x02);
    for (int i = 0; i < 200; ++i) {
        (void)tick();
    }
    EXPECT_EQ(devices_.state(Device::load_pin), NodeState::stopped);
    EXPECT_EQ(controller_.node(Device::load_pin).managed, DeviceState::stopped);
    nmt(0x81);
    EXPECT_LT(ticks_until(Device::load_pin, DeviceState::operational), 30);
    EXPECT_EQ(controller_.node(Device::load_pin).boot_ups, 2U);
}

TEST_F(NetworkManagerTest, DeviceThatFallsSilentInTheMidstOfItsAnswersIsResetAndBeginsAnew) {
    bus_.set_wire([](CanFrame& frame) { return frame.id != 0x598; });  // its SDO answers
    EXPECT_LT(ticks_until(Device::load_pin, DeviceState::sdo_timed_out), 200);
    for (int i = 0; i < 250; ++i) {
        (void)tick();
    }
    int resets = 0;
    for (const auto& entry : logged(0x000)) {
        resets += entry.frame.data[0] == 0x82 ? 1 : 0;
        EXPECT_TRUE(entry.frame.data[0] != 0x82 || entry.frame.data[1] == 0x18) << "nobody else";
    }
    EXPECT_GE(resets, 1);
    EXPECT_EQ(controller_.node(Device::load_pin).boot_ups, 1U + static_cast<unsigned>(resets));
    bus_.set_wire(nullptr);
    EXPECT_LT(ticks_until(Device::load_pin, DeviceState::operational), 300);
}

TEST_F(NetworkManagerTest, EmergencyIsKeptUntilTheDeviceSaysThatItIsOver) {
    start();
    devices_.set_fault(Device::servo_valve, emergency_rpdo_timeout, true);
    (void)tick();
    (void)tick();
    const auto& node = controller_.node(Device::servo_valve);
    EXPECT_EQ(node.emergency.code, emergency_rpdo_timeout);
    EXPECT_EQ(node.emergency.error_register, error_generic | error_communication);
    EXPECT_EQ(node.emergencies, 1U);
    devices_.set_fault(Device::servo_valve, emergency_rpdo_timeout, true);
    (void)tick();
    (void)tick();
    EXPECT_EQ(node.emergencies, 1U) << "told once";
    devices_.set_fault(Device::servo_valve, emergency_rpdo_timeout, false);
    (void)tick();
    (void)tick();
    EXPECT_EQ(node.emergency.code, emergency_none);
    EXPECT_EQ(node.emergencies, 2U);
}

TEST_F(NetworkManagerTest, OrderOfTheWrongLengthIsAnsweredByAnEmergency) {
    start();
    bus_.set_wire([id = controller_.table().row(Pdo::safety_outputs).id](CanFrame& frame) {
        frame.length = frame.id == id ? std::uint8_t{2} : frame.length;
        return true;
    });
    (void)tick();
    (void)tick();
    EXPECT_EQ(controller_.node(Device::safety_io).emergency.code, emergency_pdo_length);
}

TEST_F(NetworkManagerTest, DeviceSendsByItsOwnTimerIfSoConfigured) {
    NetworkConfig config;
    config[Pdo::drum].transmission = Transmission::event;
    config[Pdo::drum].event_ms = 5;
    CraneNetwork controller(config);
    DeviceNetwork devices(config);
    std::vector<CanFrame> arrived;
    int fresh_ticks = 0;
    for (int i = 0; i < 200; ++i) {
        now_ns_ += tick_ns;
        const auto measured = controller.decode(arrived, now_ns_);
        fresh_ticks += i >= 100 && measured.fresh(plant::line_length_m) ? 1 : 0;
        devices.receive(controller.encode(guard_.neutral(), now_ns_), now_ns_);
        const auto beats = devices.housekeeping(now_ns_);
        arrived.assign(beats.begin(), beats.end());
        const auto answers = devices.answer_sync(sensors_, feedback_, now_ns_);
        arrived.insert(arrived.end(), answers.begin(), answers.end());
    }
    EXPECT_EQ(fresh_ticks, 100);
    EXPECT_EQ(devices.object(Device::drum_encoder, {0x1800, 2})->value_raw, 255U);
    EXPECT_EQ(devices.object(Device::drum_encoder, {0x1800, 5})->value_raw, 5U);
}

TEST_F(NetworkManagerTest, PdoOfAnotherDeviceIsConfiguredThereAndAnEmptyOneNowhere) {
    NetworkConfig config;
    config[Pdo::valve_piston].device = Device::drum_encoder;
    config[Signal::line_length].mapped = false;
    CraneNetwork controller(config);
    DeviceNetwork devices(config);
    EXPECT_EQ(devices.object(Device::servo_valve, {0x1801, 2}), nullptr);
    EXPECT_EQ(devices.object(Device::drum_encoder, {0x1800, 2}), nullptr);
    std::vector<CanFrame> arrived;
    plant::CraneMeasurement measured;
    for (int i = 0; i < 200; ++i) {
        now_ns_ += tick_ns;
        measured = controller.decode(arrived, now_ns_);
        devices.receive(controller.encode(guard_.neutral(), now_ns_), now_ns_);
        const auto beats = devices.housekeeping(now_ns_);
        arrived.assign(beats.begin(), beats.end());
        const auto answers = devices.answer_sync(sensors_, feedback_, now_ns_);
        arrived.insert(arrived.end(), answers.begin(), answers.end());
    }
    EXPECT_TRUE(controller.manager().operational(Device::servo_valve));
    EXPECT_TRUE(controller.manager().operational(Device::drum_encoder));
    EXPECT_EQ(devices.object(Device::drum_encoder, {0x1801, 2})->value_raw, 1U);
    EXPECT_TRUE(measured.fresh(plant::piston_m));
    EXPECT_NEAR(measured.value[plant::piston_m], sensors_[plant::piston_m], 0.5e-6);
    EXPECT_EQ(measured.age_ticks[plant::line_length_m], plant::CraneMeasurement::never);
}

TEST_F(NetworkManagerTest, HeartbeatKeepsItsPaceOnALateClockAndTheClockMayStartBelowZero) {
    CraneNetwork controller{NetworkConfig{}};
    std::int64_t now_ns = -5'000'000'000;
    int heartbeats = 0;
    for (int i = 0; i < 2000; ++i) {
        now_ns += tick_ns;
        (void)controller.decode({}, now_ns);
        heartbeats += controller.encode(guard_.neutral(), now_ns + (i % 3) * 100'000).front().id == 0x701 ? 1 : 0;
    }
    EXPECT_EQ(heartbeats, 100);
}

}  // namespace
}  // namespace steadyboom::drivers
