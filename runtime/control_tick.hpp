#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "controllers/interlock.hpp"
#include "controllers/law.hpp"
#include "controllers/limiter.hpp"
#include "controllers/observer.hpp"
#include "controllers/valve_linearisation.hpp"
#include "drivers/can_bus.hpp"
#include "drivers/command_guard.hpp"
#include "drivers/crane_network.hpp"
#include "plant/equilibrium.hpp"
#include "runtime/bus_monitor.hpp"
#include "runtime/clock.hpp"
#include "runtime/operator_mailbox.hpp"
#include "runtime/overrun_monitor.hpp"
#include "runtime/periodic_loop.hpp"
#include "runtime/tick_record.hpp"
#include "runtime/tick_ring.hpp"

namespace steadyboom::runtime {

/// Everything a control tick is built from.
struct ControlTickConfig {
    plant::CraneParameters crane;  ///< the controller's own copy of the crane
    controllers::LawKind law = controllers::LawKind::none;
    controllers::ThesisGains gains;
    drivers::NetworkConfig network;  ///< its period is the tick's
    double max_opening_m = 0.0;      ///< performance limit on the command
    double max_slew_m_s = 0.0;       ///< performance limit on its rate
    double engage_ramp_s = 0.5;
    bool overruns_are_faults = true;  ///< false: soft real-time, a broken schedule is recorded and not acted on
};

/// One control tick, the heart of the program: frames in, estimate, permission, command, frames out, record.
///
///     read -> decode -> correct, predict -> interlock -> law, valve -> limiter -> guard -> send -> record
///
/// SYNC leaves with the command at the end of tick k, sensors sample on it, and what is read in tick k+1 belongs to
/// t_k. So the observer corrects x(t_k) with it and predicts x(t_k+1) with the command that was applied in between. The
/// law sees the crane as it will be when the spool has followed, and speaks in openings of a linear valve, which become
/// openings of the real one (docs/decisions.md).
///
/// Constructing allocates and may throw (plant::EquilibriumError, std::invalid_argument); run() does neither.
class ControlTick {
  public:
    /// `bus`, `clock`, `mailbox` and `ring` must outlive this. The clock times the stages only.
    ControlTick(const ControlTickConfig& config, drivers::CanBus& bus, const Clock& clock, OperatorMailbox& mailbox,
                TickRingWriter<TickRecord>& ring);

    void run(const TickStart& start) noexcept;

    /// From now on the operator's stop is in force, whatever else is asked: for the end of the program.
    void request_stop() noexcept { stopping_ = true; }

    /// InterlockReason bits that whoever watches the link from outside holds to be true. From any thread.
    void set_link_reasons(std::uint32_t reasons) noexcept { link_reasons_.store(reasons, std::memory_order_relaxed); }

    /// Of the newest tick.
    [[nodiscard]] const TickRecord& record() const noexcept { return record_; }
    [[nodiscard]] const plant::Equilibrium& equilibrium() const noexcept { return equilibrium_; }
    [[nodiscard]] const drivers::CraneNetwork& network() const noexcept { return network_; }
    [[nodiscard]] const controllers::Interlock& interlock() const noexcept { return interlock_; }

  private:
    [[nodiscard]] controllers::OperatorIntent next_intent() noexcept;
    void answer_operator() noexcept;
    void record_network() noexcept;
    [[nodiscard]] std::int64_t lap_ns() noexcept;

    drivers::CanBus& bus_;
    const Clock& clock_;
    OperatorMailbox& mailbox_;
    TickRingWriter<TickRecord>& ring_;

    plant::CraneDynamics crane_;
    plant::Equilibrium equilibrium_;
    drivers::CraneNetwork network_;
    controllers::Observer observer_;
    controllers::Interlock interlock_;
    controllers::Law law_;
    controllers::ValveLinearisation linearisation_;
    double actuation_lag_s_;
    controllers::Limiter limiter_;
    drivers::CommandGuard guard_;
    OverrunMonitor overruns_;
    bool overruns_are_faults_;

    BusMonitor bus_monitor_;
    std::atomic<std::uint32_t> link_reasons_{0};
    controllers::Health health_;
    double applied_linear_m_ = 0.0;  ///< linear-valve opening of the previous tick's flow, in force since then
    std::optional<OperatorRequest> request_;
    bool stopping_ = false;
    std::int64_t lap_start_ns_ = 0;
    std::array<drivers::CanFrame, drivers::most_frames_a_tick> frames_;
    TickRecord record_;
};

}  // namespace steadyboom::runtime
