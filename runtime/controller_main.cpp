// steadyboom-controller: the deployed machine. Reads the crane over CAN, commands the servo valve, obeys the operator's
// socket, shows every tick in shared memory.
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include "drivers/emcy.hpp"
#include "drivers/socketcan_bus.hpp"
#include "runtime/bus_tender.hpp"
#include "runtime/can_link/link_watch.hpp"
#include "runtime/control_tick.hpp"
#include "runtime/controller_config.hpp"
#include "runtime/operator_socket.hpp"
#include "runtime/periodic_loop.hpp"
#include "runtime/realtime_thread.hpp"
#include "runtime/service_program.hpp"

using namespace steadyboom;

namespace {

using controllers::InterlockState;

constexpr int exit_done = 0;
constexpr int exit_failed = 1;

runtime::ControlTickConfig tick_config(const runtime::ControllerConfig& config) {
    return {.crane = config.crane.crane,
            .law = config.law,
            .gains = config.crane.gains,
            .network = config.network,
            .max_opening_m = config.max_opening_m,
            .max_slew_m_s = config.max_slew_m_s,
            .engage_ramp_s = config.engage_ramp_s,
            .overruns_are_faults = config.realtime_required};
}

/// "load_pin is lost, servo_valve reports RPDO timeout (8250h)"; empty if every device is operational and well.
std::string device_troubles(const runtime::OperatorStatus& status) {
    std::string text;
    for (std::size_t i = 1; i < drivers::device_count; ++i) {
        const auto name = drivers::name_of(static_cast<drivers::Device>(i));
        const auto state = static_cast<drivers::DeviceState>(status.device_state[i]);
        if (state != drivers::DeviceState::operational) {
            text += fmt::format("{}{} is {}", text.empty() ? "" : ", ", name, drivers::name_of(state));
        }
        if (const auto code = status.emergency_code[i]; code != drivers::emergency_none) {
            text += fmt::format("{}{} reports {} ({:04X}h)", text.empty() ? "" : ", ", name,
                                drivers::emergency_text(code), code);
        }
    }
    return text;
}

/// "STANDBY: a required device is not operational; load_pin is lost"
std::string describe(const runtime::OperatorStatus& status) {
    std::string text = controllers::name_of(static_cast<InterlockState>(status.state));
    const std::string reasons = controllers::reasons_in_words(status.reasons);
    const std::string devices = device_troubles(status);
    text += reasons.empty() ? "" : ": " + reasons;
    return devices.empty() ? text : text + "; " + devices;
}

/// Watches the tick from outside: logs what changed, and feeds the service manager's watchdog only while ticks go on.
class Supervisor {
  public:
    Supervisor(const runtime::OperatorMailbox& mailbox, const runtime::PeriodicLoop& loop)
        : mailbox_(mailbox), loop_(loop), thread_("supervisor", [this](std::stop_token stop) { watch(stop); }) {}

  private:
    void watch(const std::stop_token& stop) {
        bool ready = false;
        std::uint64_t last_ticks = 0;
        std::uint64_t last_skipped = 0;
        int rounds_since_skip_report = 0;
        std::uint32_t last_state = ~0U;
        std::uint32_t last_reasons = 0;
        std::string last_devices;
        while (!stop.stop_requested()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            const runtime::LoopStatistics& statistics = loop_.statistics();
            const std::uint64_t ticks = statistics.ticks.load(std::memory_order_relaxed);
            if (ticks != last_ticks) {
                sd_notify(0, ready ? "WATCHDOG=1" : "READY=1\nWATCHDOG=1");
                ready = true;
            }
            last_ticks = ticks;
            const std::uint64_t skipped = statistics.skipped.load(std::memory_order_relaxed);
            constexpr int rounds_between_skip_reports = 20;  // a second: a busy machine must not flood the log
            if (skipped != last_skipped && ++rounds_since_skip_report >= rounds_between_skip_reports) {
                spdlog::warn("{} control ticks skipped so far", skipped);
                last_skipped = skipped;
                rounds_since_skip_report = 0;
            }
            const runtime::OperatorStatus status = mailbox_.status();
            std::string devices = device_troubles(status);
            if (status.time_ns != 0 &&
                (status.state != last_state || status.reasons != last_reasons || devices != last_devices)) {
                spdlog::info("tick {}: {}", status.tick, describe(status));
                last_devices = std::move(devices);
                last_state = status.state;
                last_reasons = status.reasons;
            }
        }
    }

    const runtime::OperatorMailbox& mailbox_;
    const runtime::PeriodicLoop& loop_;
    runtime::HelperThread thread_;  ///< last: it uses the others
};

int control(const runtime::ControllerConfig& config) {
    drivers::CraneNetwork network(tick_config(config).network);
    drivers::SocketCanBus bus(config.interface, {.filters = network.filters(), .expect_remote = config.expect_remote});
    const runtime::BusTender tender(bus);
    runtime::MonotonicClock clock;
    runtime::OperatorMailbox mailbox;
    runtime::TickRingWriter<runtime::TickRecord> ring(
        config.telemetry_ring_path,
        {.period_ns = config.period_ns(), .crane_hash = runtime::crane_hash(config.crane.crane)});
    const auto tick = std::make_unique<runtime::ControlTick>(tick_config(config), bus, clock, mailbox, ring);

    runtime::OperatorSocketOptions socket_options;
    socket_options.path = config.operator_socket_path;
    socket_options.describe = describe;
    socket_options.log = [](const std::string& line) { spdlog::info("operator: {}", line); };
    const runtime::OperatorSocket socket(socket_options, mailbox, clock);

    std::optional<runtime::LinkWatch> link_watch;
    if (!config.link_socket_path.empty()) {
        link_watch.emplace(runtime::LinkWatchOptions{
            .socket_path = config.link_socket_path,
            .set_reasons = [&tick](std::uint32_t reasons) { tick->set_link_reasons(reasons); },
            .may_restart = [&mailbox] { return !moves(static_cast<InterlockState>(mailbox.status().state)); },
            .log = [](const std::string& line) { spdlog::info("link: {}", line); }});
    }

    runtime::PeriodicLoop loop(clock, config.period_ns());
    const Supervisor supervisor(mailbox, loop);

    const bool wants_fifo = config.realtime_priority > 0;
    const runtime::RealtimeGrant grant = runtime::become_realtime(
        {.policy = wants_fifo ? runtime::SchedulingPolicy::fifo : runtime::SchedulingPolicy::other,
         .priority = config.realtime_priority,
         .cpu = config.realtime_cpu >= 0 ? std::optional(config.realtime_cpu) : std::nullopt,
         .lock_memory = config.realtime_lock_memory});
    for (const runtime::RealtimeRefusal& refusal : grant.refusals) {
        spdlog::warn("not real-time: {}", refusal.message());
    }
    if (config.realtime_required && !grant.complete()) {
        spdlog::error("the kernel does not grant what [realtime] asks for and realtime.required is true: not starting");
        return exit_failed;
    }
    spdlog::info("{} at {} Hz on {}: {}", controllers::name_of(config.law), config.rate_Hz, config.interface,
                 grant.summary());
    spdlog::info("{}: receive buffer of {} frames; devices are {}", config.interface, bus.receive_buffer_frames(),
                 bus.expects_remote() ? "on other machines only" : "on this machine too");

    // After a stop request the operator's stop is in force: the command ramps down, then the valve hears a live
    // controller that wants nothing for a moment more.
    constexpr double farewell_s = 0.2;
    auto farewell_ticks = static_cast<std::int64_t>(farewell_s * config.rate_Hz) + 1;
    std::atomic<bool> over{false};
    loop.run(
        [&](const runtime::TickStart& start) noexcept {
            if (runtime::stop_requested().load(std::memory_order_relaxed)) {
                tick->request_stop();
                if (--farewell_ticks <= 0) {
                    over.store(true, std::memory_order_relaxed);
                }
            }
            tick->run(start);
        },
        over);

    sd_notify(0, "STOPPING=1");
    const runtime::LoopStatistics& statistics = loop.statistics();
    spdlog::info(
        "{} ticks, {} overruns, {} skipped; wake-up latency p50 {:.1f} us, p99 {:.1f} us, p99.9 {:.1f} us; "
        "execution p50 {:.1f} us, p99.9 {:.1f} us",
        statistics.ticks.load(), statistics.overruns.load(), statistics.skipped.load(),
        1e-3 * static_cast<double>(statistics.wake_up_latency.quantile_ns(0.5)),
        1e-3 * static_cast<double>(statistics.wake_up_latency.quantile_ns(0.99)),
        1e-3 * static_cast<double>(statistics.wake_up_latency.quantile_ns(0.999)),
        1e-3 * static_cast<double>(statistics.execution_time.quantile_ns(0.5)),
        1e-3 * static_cast<double>(statistics.execution_time.quantile_ns(0.999)));
    return exit_done;
}

}  // namespace

int main(int argc, char** argv) {
    return runtime::run_service(
        {.name = "steadyboom-controller",
         .purpose = "Steadyboom's real-time controller: keeps a crane's boom steady through the valve in its pendent.",
         .config_form = "systemd/controller.toml",
         .work = [](const std::filesystem::path& config) { return control(runtime::load_controller_config(config)); }},
        argc, argv);
}
