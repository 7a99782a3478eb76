#pragma once

#include <array>
#include <cstdint>

#include <gtest/gtest.h>

#include "drivers/crane_network.hpp"
#include "drivers/device_network.hpp"
#include "drivers/loopback_bus.hpp"
#include "runtime/realtime_section.hpp"

namespace steadyboom::drivers {

inline constexpr std::int64_t tick_ns = 5'000'000;
inline constexpr plant::Permission engaged{
    .mode = plant::ValveMode::active, .cutoff_energised = true, .authority = 1.0};

/// Controller and crane on one loopback bus; each tick runs the controller, then the crane, inside a RealtimeSection.
class NetworkLoop : public ::testing::Test {
  protected:
    plant::CraneMeasurement tick(double opening_m = 0.0, const plant::Permission& permit = engaged) {
        const runtime::RealtimeSection no_allocation;
        now_ns_ += tick_ns;
        auto& controller_bus = bus_.endpoint(0);
        auto& crane_bus = bus_.endpoint(1);

        auto count = controller_bus.receive(frames_);
        const auto measured = controller_.decode({frames_.data(), count}, now_ns_);
        (void)controller_bus.send(controller_.encode(guard_.pass({opening_m}, permit), now_ns_));

        count = crane_bus.receive(frames_);
        devices_.receive({frames_.data(), count}, now_ns_);
        if (valve_follows_) {
            feedback_.status.state = valve_.step({.control_word_raw = devices_.valve_order().control_word});
        }
        (void)crane_bus.send(devices_.housekeeping(now_ns_));
        if (devices_.sync_pending()) {
            (void)crane_bus.send(devices_.answer_sync(sensors_, feedback_, now_ns_));
        }
        return measured;
    }

    /// Until every device is operational, heard and believed.
    void start() {
        for (int i = 0; i < 200; ++i) {
            (void)tick();
        }
    }

    [[nodiscard]] static plant::SensorVector plausible(double share) {
        plant::SensorVector sensors;
        sensors << 300.0 * share, -120.0 * share, 1.0 + 0.1 * share, 133.4e3 * (1.0 + share), 0.05 * share,
            12.2 + share, -0.01 * share, 3.0e-3 * share, 6.8e6 * (1.0 + 0.5 * share);
        return sensors;
    }

    std::int64_t now_ns_ = 0;
    LoopbackBus bus_;
    CraneNetwork controller_{NetworkConfig{}};
    DeviceNetwork devices_{NetworkConfig{}};
    CommandGuard guard_{{.max_opening_m = 7.6e-3, .max_step_m = 7.6e-3}};
    plant::SensorVector sensors_ = plausible(0.0);
    plant::SensorVector resolution_ =
        (plant::SensorVector() << 0.1, 0.1, 1.75e-5, 1.0, 1.75e-5, 1.0e-4, 1.0e-6, 4.64e-7, 1.0e4).finished();
    Cia408Valve valve_;
    bool valve_follows_ = true;
    ValveFeedback feedback_;
    std::array<CanFrame, 64> frames_;
};

}  // namespace steadyboom::drivers
