#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/command_guard.hpp"
#include "drivers/crane_network.hpp"
#include "hil/virtual_crane.hpp"

namespace steadyboom::test_support {

/// The virtual crane and the controller's side of its network, tick by tick and without a controller between them.
class CraneOnTheBus {
  public:
    static constexpr std::int64_t period_ns = 5'000'000;
    static constexpr plant::Permission holding{.mode = plant::ValveMode::hold, .cutoff_energised = true};
    static constexpr plant::Permission engaged{
        .mode = plant::ValveMode::active, .cutoff_energised = true, .authority = 1.0};

    explicit CraneOnTheBus(const plant::CraneParameters& parameters, std::uint64_t seed = 1, int steps_per_tick = 10,
                           hil::BoomKind boom = hil::BoomKind::links)
        : crane({.crane = parameters,
                 .boom = boom,
                 .network = {.spool_travel_m = parameters.actuator.spool_travel_m, .period_ns = period_ns},
                 .step_s = 1e-9 * static_cast<double>(period_ns) / steps_per_tick,
                 .seed = seed}),
          network({.spool_travel_m = parameters.actuator.spool_travel_m, .period_ns = period_ns}),
          guard_(
              {.max_opening_m = parameters.actuator.spool_travel_m, .max_step_m = parameters.actuator.spool_travel_m}),
          steps_per_tick_(steps_per_tick) {
        arrived_.reserve(64);
    }

    /// What arrived since the last tick, then orders and SYNC out, samples taken, one period onward.
    plant::CraneMeasurement tick(double opening_m = 0.0, const plant::Permission& permit = holding) {
        const plant::CraneMeasurement measured = sample(opening_m, permit);
        advance();
        return measured;
    }

    /// tick() in no time.
    plant::CraneMeasurement sample(double opening_m = 0.0, const plant::Permission& permit = holding) {
        const plant::CraneMeasurement measured = network.decode(arrived_, now_ns);
        crane.receive(network.encode(guard_.pass({opening_m}, permit), now_ns), now_ns);
        const std::span<const drivers::CanFrame> sent = crane.frames_to_send(now_ns);
        arrived_.assign(sent.begin(), sent.end());
        return measured;
    }

    /// One period without any frame.
    void advance() {
        for (int step = 0; step < steps_per_tick_; ++step) {
            crane.advance(now_ns + step * period_ns / steps_per_tick_);
        }
        now_ns += period_ns;
    }

    /// Until every device is operational, heard and believed.
    void start() {
        for (int i = 0; i < 200; ++i) {
            (void)tick();
        }
    }

    [[nodiscard]] plant::CraneState state() const { return crane.truth(0.0).state; }

    hil::VirtualCrane crane;
    drivers::CraneNetwork network;
    std::int64_t now_ns = 0;

  private:
    drivers::CommandGuard guard_;
    int steps_per_tick_;
    std::vector<drivers::CanFrame> arrived_;
};

/// Sensor noise and what the bus's resolution adds to it, one sigma in the units of plant::Sensor.
[[nodiscard]] inline plant::SensorVector noise_on_the_bus(const plant::SensorVector& sensor_sigma,
                                                          const drivers::DeviceTable& table) {
    plant::SensorVector sigma = sensor_sigma;
    for (const drivers::SignalRow& row : table.signals()) {
        if (row.sensor != plant::sensor_count) {
            sigma[row.sensor] = std::hypot(sigma[row.sensor], row.scale_unit / std::sqrt(12.0));
        }
    }
    return sigma;
}

}  // namespace steadyboom::test_support
