#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "drivers/device_network.hpp"
#include "hil/boom_kind.hpp"
#include "hil/truth_sample.hpp"
#include "hil/virtual_valve.hpp"
#include "plant/equilibrium.hpp"

namespace steadyboom::hil {

struct VirtualCraneConfig {
    plant::CraneParameters crane;  ///< the true one; its valve is always the nonlinear one here
    BoomKind boom = BoomKind::links;
    drivers::NetworkConfig network;
    double step_s = 0.0005;  ///< integration step; four and more times finer than the observer's
    std::uint64_t seed = 1;  ///< of the sensor noise
};

/// The crane's side of the bus: the true crane, its sensors with noise and quantisation, and its valve, behind CAN
/// frames. It differs from the observer's model on purpose: finer steps, the nonlinear valve (6-22), spool lag and dead
/// time, noise, the bus's resolution. Allocates nothing after construction. The same seed gives the same bits.
///
/// The state moves only in advance(); all other members happen at the present instant. Time is the caller's.
class VirtualCrane {
  public:
    /// Stands at static equilibrium. Throws plant::EquilibriumError, std::invalid_argument.
    explicit VirtualCrane(const VirtualCraneConfig& config);
    ~VirtualCrane();

    /// Frames that reached the devices.
    void receive(std::span<const drivers::CanFrame> frames, std::int64_t now_ns) noexcept;

    /// What the devices send now: boot-up and heartbeats, and the samples if a SYNC came. Valid until the next call.
    [[nodiscard]] std::span<const drivers::CanFrame> frames_to_send(std::int64_t now_ns) noexcept;

    /// One integration step from `now_ns`, with the orders that have come by then.
    void advance(std::int64_t now_ns) noexcept;

    /// The drum brake stops the falling load: R9' jumps to `rate_m_s`.
    void brake(double rate_m_s) noexcept;

    [[nodiscard]] TruthSample truth(double t_s) const noexcept;

    /// In the thesis's coordinates.
    [[nodiscard]] const plant::Equilibrium& equilibrium() const noexcept { return equilibrium_; }
    [[nodiscard]] drivers::DeviceNetwork& network() noexcept { return network_; }
    [[nodiscard]] const VirtualValve& valve() const noexcept { return valve_; }
    [[nodiscard]] double step_s() const noexcept { return step_s_; }

  private:
    class Motion;
    template <class Boom>
    class MotionOf;

    [[nodiscard]] plant::SensorVector noisy_sensors() noexcept;

    std::unique_ptr<Motion> motion_;
    plant::Equilibrium equilibrium_;
    drivers::DeviceNetwork network_;
    VirtualValve valve_;
    plant::SensorVector noise_sigma_;
    double step_s_;
    std::mt19937_64 random_;
    std::normal_distribution<double> normal_;
    std::vector<drivers::CanFrame> outbox_;
};

}  // namespace steadyboom::hil
