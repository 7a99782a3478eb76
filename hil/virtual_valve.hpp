#pragma once

#include <cstdint>
#include <vector>

#include "drivers/device_network.hpp"
#include "plant/crane_measurement.hpp"
#include "plant/crane_parameters.hpp"

namespace steadyboom::hil {

/// A CiA 408 servo valve with its cut-off valve: what the spool is driven to, by orders and by their absence.
///
/// All states but ACTIVE mean the closed centre; only an active valve follows its set-point. When no order came for
/// command_timeout_ns (5 missed at 200 Hz) the valve centres itself, drops the cut-off and falls to FAULT_REACTION,
/// with its spool centred to FAULT_HOLD or FAULT_DISABLED, until a reset edge lets it leave (drivers::Cia408Valve). The
/// cut-off valve opens only while energised and a valve that is not in a fault allows it; closed, it locks the
/// cylinder.
class VirtualValve {
  public:
    static constexpr std::int64_t command_timeout_ns = 25'000'000;

    /// `step_s` is the integration step between two calls of next_target_m(); the dead time is rounded to whole steps.
    VirtualValve(const plant::ActuatorParameters& actuator, double step_s);

    /// Weighs the newest orders; `spool_m` is where the spool is, m. Call it once per integration step.
    void obey(const drivers::ValveOrder& order, double spool_m, std::int64_t now_ns) noexcept;

    /// Opening that the spool is driven to during the next step, m, after the dead time. One call per step.
    [[nodiscard]] double next_target_m() noexcept;

    /// d2(spool)/dt2 in m/s^2: second order with the valve's bandwidth and damping.
    [[nodiscard]] double spool_acceleration_m_s2(double spool_m, double spool_rate_m_s,
                                                 double target_m) const noexcept {
        return omega_rad_s_ * omega_rad_s_ * (target_m - spool_m) -
               2.0 * damping_ratio_ * omega_rad_s_ * spool_rate_m_s;
    }

    [[nodiscard]] plant::ValveState state() const noexcept { return device_.state(); }
    /// What it reports with its spool at `spool_m`: a control deviation beyond a tenth of the travel.
    [[nodiscard]] drivers::ValveStatus status(double spool_m) const noexcept;
    [[nodiscard]] bool timed_out() const noexcept { return timed_out_; }

    /// Power off and on.
    void restart() noexcept { device_.restart(); }

    [[nodiscard]] bool cutoff_open() const noexcept { return cutoff_open_; }
    [[nodiscard]] std::uint64_t timeouts() const noexcept { return timeouts_; }

  private:
    double omega_rad_s_;
    double damping_ratio_;
    double travel_m_;
    std::vector<double> delayed_m_;  ///< commanded openings still under way, a ring
    std::size_t next_ = 0;
    double commanded_m_ = 0.0;
    drivers::Cia408Valve device_;
    bool timed_out_ = false;
    bool cutoff_open_ = false;
    std::uint64_t timeouts_ = 0;
};

}  // namespace steadyboom::hil
