// What protection is worth to both ends of the network, over the loopback bus.
#include <cmath>
#include <map>

#include "drivers/pdo_codec.hpp"
#include "network_loop.hpp"

namespace steadyboom::drivers {
namespace {

class ProtectedNetwork : public NetworkLoop {
  protected:
    void SetUp() override {
        start();
        ASSERT_EQ(controller_.state(Pdo::boom_angle), ReceiverState::valid);
    }

    [[nodiscard]] std::uint32_t id(Pdo pdo) const { return controller_.table().row(pdo).id; }

    /// From now on `change` happens to every frame of this PDO; false loses it.
    void on(Pdo pdo, std::function<bool(CanFrame&)> change) {
        bus_.set_wire([wanted = id(pdo), change = std::move(change)](CanFrame& frame) {
            return frame.id != wanted || change(frame);
        });
    }

    /// Ticks from the first frame of the wrong kind until the boom angle is no longer valid.
    int ticks_until_invalid() {
        (void)tick();  // the sample that is under way came before the fault
        int ticks = 1;
        while (tick().valid[plant::boom_angle_rad] && ticks < 100) {
            ++ticks;
        }
        return ticks;
    }
};

TEST_F(ProtectedNetwork, EveryDeviceIsBelievedAndNoAnswerLags) {
    for (std::size_t i = 0; i < pdo_count; ++i) {
        EXPECT_EQ(controller_.state(static_cast<Pdo>(i)), ReceiverState::valid) << name_of(static_cast<Pdo>(i));
        EXPECT_EQ(controller_.lag_ticks(static_cast<Pdo>(i)), 0);
    }
    EXPECT_EQ(controller_.status().rejected_frames, 0U);
    EXPECT_EQ(controller_.status().late_frames, 0U);
    EXPECT_EQ(devices_.status().rejected_orders, 0U);
}

TEST_F(ProtectedNetwork, WrongChecksumIsDroppedAndThreeInARowMakeTheChannelInvalid) {
    sensors_ = plausible(0.5);
    on(Pdo::boom_angle, [](CanFrame& frame) {
        frame.data[1] ^= 0x10;
        return true;
    });
    (void)tick();
    for (int bad = 1; bad <= 3; ++bad) {
        const auto measured = tick();
        EXPECT_NEAR(measured.value[plant::boom_angle_rad], 1.0, 2e-5) << "the corrupt value is never taken";
        EXPECT_EQ(measured.valid[plant::boom_angle_rad], bad < 3) << bad;
        EXPECT_TRUE(measured.valid[plant::line_angle_rad]);
    }
    EXPECT_EQ(controller_.status().rejected_frames, 3U);
    bus_.set_wire({});
    int good_ticks = 0;
    while (!tick().valid[plant::boom_angle_rad] && good_ticks < 100) {
        ++good_ticks;
    }
    EXPECT_EQ(good_ticks, 11) << "the last corrupt one is still under way, then ten good ones";
}

TEST_F(ProtectedNetwork, FrozenCounterIsNoNewDataAndMakesTheChannelInvalid) {
    std::optional<CanFrame> frozen;
    on(Pdo::boom_angle, [&frozen](CanFrame& frame) {
        frame = *(frozen = frozen.value_or(frame));
        return true;
    });
    (void)tick();
    (void)tick();
    for (std::uint32_t repeated = 1; repeated <= 3; ++repeated) {
        EXPECT_EQ(tick().age_ticks[plant::boom_angle_rad], repeated);
    }
    EXPECT_LE(ticks_until_invalid(), 3);
}

TEST_F(ProtectedNetwork, CounterThatJumpsOrIsReservedMakesTheChannelInvalidWithinFourTicks) {
    const auto data_id = controller_.table().row(Pdo::boom_angle).data_id;
    int k = 0;
    on(Pdo::boom_angle, [&k, data_id](CanFrame& frame) {
        protect(frame, data_id, static_cast<std::uint8_t>(7 * ++k % 15), protection_quality_good);
        return true;
    });
    EXPECT_LE(ticks_until_invalid(), 4);
    bus_.set_wire({});
    for (int i = 0; i < 20; ++i) {
        (void)tick();
    }
    on(Pdo::boom_angle, [data_id](CanFrame& frame) {
        protect(frame, data_id, 15, protection_quality_good);
        return true;
    });
    EXPECT_LE(ticks_until_invalid(), 4);
}

TEST_F(ProtectedNetwork, SwappedDevicesAreNoticedThoughEveryChecksumIsRightForItsSender) {
    // Two inclinometers whose node numbers were mixed up: same length, own data ids.
    bus_.set_wire([a = id(Pdo::boom_angle), b = id(Pdo::line_angle)](CanFrame& frame) {
        frame.id = frame.id == a ? b : frame.id == b ? a : frame.id;
        return true;
    });
    (void)tick();
    plant::CraneMeasurement measured;
    for (int i = 0; i < 3; ++i) {
        measured = tick();
        EXPECT_NEAR(measured.value[plant::boom_angle_rad], 1.0, 2e-5);
        EXPECT_NEAR(measured.value[plant::line_angle_rad], 0.0, 2e-5);
    }
    EXPECT_FALSE(measured.valid[plant::boom_angle_rad]);
    EXPECT_FALSE(measured.valid[plant::line_angle_rad]);
}

TEST_F(ProtectedNetwork, DeviceThatDistrustsItsSampleMakesTheChannelInvalidAtOnce) {
    const auto data_id = controller_.table().row(Pdo::boom_angle).data_id;
    on(Pdo::boom_angle, [data_id](CanFrame& frame) {
        protect(frame, data_id, frame.data[frame.length - 2U] & 0x0FU, 1);
        return true;
    });
    (void)tick();
    EXPECT_FALSE(tick().valid[plant::boom_angle_rad]);
    EXPECT_EQ(controller_.status().faulty_values, 1U);
}

TEST_F(ProtectedNetwork, ConstantDelayShowsAsLagAndBeyondTwoTicksTheSamplesAreOfNoUse) {
    for (const std::size_t delay_ticks : {1U, 2U, 3U, 5U}) {
        std::array<CanFrame, 8> line{};
        std::size_t next = 0;
        std::size_t filled = 0;
        on(Pdo::boom_angle, [&](CanFrame& frame) {
            std::swap(frame, line[next]);
            next = (next + 1) % delay_ticks;
            return ++filled > delay_ticks;
        });
        plant::CraneMeasurement measured;
        for (int i = 0; i < 40; ++i) {
            measured = tick();
        }
        EXPECT_EQ(controller_.lag_ticks(Pdo::boom_angle), delay_ticks);
        EXPECT_EQ(measured.fresh(plant::boom_angle_rad), delay_ticks <= 2) << delay_ticks;
        bus_.set_wire({});
        for (int i = 0; i < 40; ++i) {
            (void)tick();
        }
        EXPECT_EQ(controller_.lag_ticks(Pdo::boom_angle), 0);
    }
}

TEST_F(ProtectedNetwork, ValveActsOnlyOnACommandWhoseTwinIsItsInverse) {
    (void)tick(1.0e-3);
    EXPECT_EQ(devices_.valve_order().stamp_ns, now_ns_);
    const auto kept_m = devices_.valve_order().set_point_m;
    const auto kept_ns = now_ns_;
    const std::map<std::string, std::function<bool(CanFrame&)>> faults = {
        {"lost", [](CanFrame&) { return false; }},
        {"one bit", [](CanFrame& frame) { return (frame.data[2] ^= 1) != 0 || true; }},
        {"not inverted",
         [](CanFrame& frame) {
             invert(frame);
             return true;
         }},
    };
    for (const auto& [name, fault] : faults) {
        on(Pdo::valve_twin, fault);
        (void)tick(2.0e-3);
        EXPECT_EQ(devices_.valve_order().set_point_m, kept_m) << name;
        EXPECT_EQ(devices_.valve_order().stamp_ns, kept_ns) << name;
    }
    bus_.set_wire({});
    (void)tick(2.0e-3);
    EXPECT_EQ(devices_.valve_order().stamp_ns, now_ns_);
    EXPECT_GT(devices_.status().rejected_orders, 0U);
}

TEST_F(ProtectedNetwork, OrdersWithAWrongChecksumAreNotObeyed) {
    (void)tick(1.0e-3);
    const auto kept_ns = now_ns_;
    bus_.set_wire([command = id(Pdo::valve_command), cutoff = id(Pdo::safety_outputs)](CanFrame& frame) {
        if (frame.id == command || frame.id == cutoff) {
            frame.data[frame.length - 1U] ^= 0x80;
        }
        return true;
    });
    for (int i = 0; i < 5; ++i) {
        (void)tick(2.0e-3);
        EXPECT_EQ(devices_.valve_order().stamp_ns, kept_ns);
        EXPECT_EQ(devices_.valve_order().cutoff_stamp_ns, kept_ns);
    }
    bus_.set_wire({});
    int ticks = 1;
    for (; ticks < 100; ++ticks) {
        (void)tick(1.0e-3);
        if (devices_.valve_order().stamp_ns == now_ns_) {
            break;
        }
    }
    EXPECT_EQ(ticks, 12) << "one jump of the counter, ten good ticks, and no sooner is it obeyed again";
}

}  // namespace
}  // namespace steadyboom::drivers
