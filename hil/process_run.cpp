#include "hil/process_run.hpp"

#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "drivers/device_table.hpp"
#include "drivers/socketcan_bus.hpp"
#include "hil/lockstep_run.hpp"
#include "hil/plant_config.hpp"
#include "hil/plant_record.hpp"
#include "hil/scratch_folder.hpp"
#include "hil/true_crane.hpp"
#include "hil/whole_file.hpp"
#include "runtime/clock.hpp"
#include "runtime/controller_config.hpp"
#include "runtime/network_file.hpp"
#include "runtime/operator_client.hpp"
#include "runtime/tick_ring.hpp"

namespace steadyboom::hil {

namespace {

namespace fs = std::filesystem;
using controllers::InterlockState;
using runtime::OperatorCommand;
using std::chrono::milliseconds;

/// A program beside this one, ended with this object. Its output goes where ours goes.
class Process {
  public:
    Process(std::string name, const fs::path& config) : name_(std::move(name)) {
        const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / name_;
        const std::string config_text = config.string();
        std::string program_text = program.string();
        std::string option = "--config";
        std::string value = config_text;
        char* arguments[] = {program_text.data(), option.data(), value.data(), nullptr};
        if (const int error = posix_spawn(&pid_, program.c_str(), nullptr, nullptr, arguments, environ); error != 0) {
            pid_ = -1;
            throw std::runtime_error("cannot start " + program_text + ": " + std::strerror(error) +
                                     "; it must lie beside the steadyboom command");
        }
    }
    ~Process() {
        if (!ended()) {
            kill(pid_, SIGKILL);
            waitpid(pid_, nullptr, 0);
        }
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    [[nodiscard]] bool ended() {
        if (!status_ && pid_ > 0) {
            int status = 0;
            if (waitpid(pid_, &status, WNOHANG) == pid_) {
                status_ = status;
            }
        }
        return status_.has_value();
    }

    void fail_if_ended() {
        if (ended()) {
            throw std::runtime_error(name_ + " ended early (" + how() + "); its own message is above");
        }
    }

    void ask_to_end() {
        if (!ended()) {
            kill(pid_, SIGTERM);
        }
    }

    /// Throws unless it ends well in time.
    void expect_end(milliseconds patience) {
        const auto deadline = std::chrono::steady_clock::now() + patience;
        while (!ended()) {
            if (std::chrono::steady_clock::now() > deadline) {
                throw std::runtime_error(name_ + " does not end");
            }
            std::this_thread::sleep_for(milliseconds(5));
        }
        if (!WIFEXITED(*status_) || WEXITSTATUS(*status_) != 0) {
            throw std::runtime_error(name_ + " failed (" + how() + "); its own message is above");
        }
    }

  private:
    [[nodiscard]] std::string how() const {
        return WIFSIGNALED(*status_) ? "signal " + std::to_string(WTERMSIG(*status_))
                                     : "exit code " + std::to_string(WEXITSTATUS(*status_));
    }

    std::string name_;
    pid_t pid_ = -1;
    std::optional<int> status_;
};

template <class Record>
runtime::TickRingReader<Record> open_ring(const fs::path& path, Process& writer) {
    for (int attempt = 0;; ++attempt) {
        writer.fail_if_ended();
        if (fs::exists(path)) {
            return runtime::TickRingReader<Record>(path);
        }
        if (attempt > 1000) {
            throw std::runtime_error(path.string() + " did not appear");
        }
        std::this_thread::sleep_for(milliseconds(10));
    }
}

/// Arms and engages over the operator's socket as soon as the controller lets it, on a thread of its own, so that
/// neither the bus log nor the rings wait for it.
class Operator {
  public:
    explicit Operator(fs::path socket)
        : thread_([this, socket = std::move(socket)](const std::stop_token& stop) {
              try {
                  work(socket, stop);
              } catch (const std::exception& error) {
                  trouble_ = error.what();
              }
          }) {}

    /// Ends the operator; why it did not engage, or empty.
    [[nodiscard]] std::string finish() {
        thread_.request_stop();
        thread_.join();
        return trouble_;
    }

  private:
    void work(const fs::path& socket, const std::stop_token& stop) {
        runtime::OperatorClient client(socket, milliseconds(10'000));
        while (!stop.stop_requested()) {
            const runtime::OperatorReply status = client.request(OperatorCommand::status);
            trouble_ = "the controller did not get ready: " + std::string(status.words());
            if (static_cast<InterlockState>(status.state) == InterlockState::ready) {
                const runtime::OperatorReply reply = client.arm_and_engage();
                if (reply.outcome() == runtime::OperatorResult::done) {
                    trouble_.clear();
                    return;
                }
                trouble_ = "the controller refused to engage: " + std::string(reply.words());
            }
            std::this_thread::sleep_for(milliseconds(50));
        }
    }

    std::string trouble_ = "the operator's socket did not open";
    std::jthread thread_;
};

runtime::ControllerConfig controller_config(const RunOptions& options, const std::string& interface,
                                            const fs::path& folder, const fs::path& sockets) {
    const runtime::ControlTickConfig tick = control_config(options);
    runtime::ControllerConfig config;
    config.crane_file = folder / "controller-crane.toml";
    config.network_file = folder / "network.toml";
    config.law = options.law;
    config.interface = interface;
    config.expect_remote = false;  // the crane is on this machine, whatever the interface
    config.rate_Hz = options.rate_Hz;
    config.realtime_required = false;
    config.max_opening_m = tick.max_opening_m;
    config.max_slew_m_s = tick.max_slew_m_s;
    config.engage_ramp_s = tick.engage_ramp_s;
    config.operator_socket_path = sockets / "command.sock";
    config.telemetry_ring_path = sockets / "ticks.ring";
    return config;
}

}  // namespace

RunResult run_on_interface(const RunOptions& options, const std::string& interface, const fs::path& folder,
                           const std::function<void(const std::string&)>& progress) {
    const ScratchFolder scratch("/dev/shm");  // sockets and rings, in memory
    const fs::path absolute = fs::absolute(folder);
    runtime::CraneFile controllers_copy = options.crane_case;
    for (const std::string& mismatch : options.mismatches) {
        runtime::apply_mismatch(controllers_copy, mismatch);
    }
    const runtime::ControllerConfig controller = controller_config(options, interface, absolute, scratch.path());
    PlantConfig plant;
    plant.case_file = absolute / "plant-case.toml";
    plant.network_file = controller.network_file;
    plant.interface = interface;
    plant.rate_Hz = options.rate_Hz;
    plant.seed = static_cast<int>(options.seed);
    plant.standing_s = RunResult::standing_s;
    plant.duration_s = options.duration_s;
    plant.ring_path = scratch.path() / "plant.ring";
    write_whole_file(absolute / "controller-crane.toml", runtime::to_toml(controllers_copy));
    write_whole_file(controller.network_file, runtime::to_toml(options.network));
    write_whole_file(absolute / "controller.toml", runtime::to_toml(controller));
    write_whole_file(absolute / "plant-case.toml", to_toml(options.crane_case));
    write_whole_file(absolute / "plant.toml", to_toml(plant));

    RunResult result{.options = options, .bus = interface};
    drivers::SocketCanBus log(interface, {.receive_buffer_frames = 1 << 14, .expect_remote = false});

    progress("starting steadyboom-plant and steadyboom-controller on " + interface);
    Process plant_process("steadyboom-plant", absolute / "plant.toml");
    auto plant_ring = open_ring<PlantRecord>(plant.ring_path, plant_process);
    Process controller_process("steadyboom-controller", absolute / "controller.toml");
    auto tick_ring = open_ring<runtime::TickRecord>(controller.telemetry_ring_path, controller_process);
    Operator bench_operator(controller.operator_socket_path);

    FigureAccumulator figures(rest_of(options.crane_case).state, options.duration_s);
    std::vector<PlantRecord> truth;
    std::vector<runtime::TickRecord> ticks;
    std::vector<drivers::CanFrame> frames(512);
    const auto drain = [&] {
        for (std::size_t count = frames.size(); count == frames.size();) {
            count = log.receive(frames);
            result.frames.insert(result.frames.end(), frames.begin(),
                                 frames.begin() + static_cast<std::ptrdiff_t>(count));
        }
        for (PlantRecord record; plant_ring.read(record);) {
            figures.add(record.truth());
            truth.push_back(record);
        }
        for (runtime::TickRecord record; tick_ring.read(record);) {
            ticks.push_back(record);
        }
    };

    bool braked = false;
    std::string operator_trouble;
    while (!plant_process.ended()) {
        controller_process.fail_if_ended();
        pollfd readable{.fd = log.fd(), .events = POLLIN, .revents = 0};
        poll(&readable, 1, 20);
        drain();
        if (!braked && !truth.empty() && truth.back().t_s >= 0.0) {
            braked = true;
            operator_trouble = bench_operator.finish();
            if (!operator_trouble.empty()) {
                throw std::runtime_error("not in command at the brake event: " + operator_trouble);
            }
            progress("brake event; " + std::to_string(options.duration_s) + " s to go");
        }
    }
    plant_process.expect_end(milliseconds(0));
    controller_process.ask_to_end();
    controller_process.expect_end(milliseconds(5000));
    drain();
    const std::uint64_t lost = plant_ring.lost() + tick_ring.lost() + log.status().receive_overflow_frames;
    if (lost != 0) {
        throw std::runtime_error(std::to_string(lost) +
                                 " records or frames were lost by the bench; the machine is "
                                 "too busy for a real-time run");
    }
    if (truth.empty()) {
        throw std::runtime_error("steadyboom-plant left no record");
    }

    // Each tick meets the true crane of the same instant; ticks outside the crane's time are the start and the
    // farewell.
    result.epoch_ns = truth.front().time_ns;
    result.stayed_engaged = true;
    std::uint32_t reasons = 0;
    std::size_t at = 0;
    for (const runtime::TickRecord& tick : ticks) {
        while (at + 1 < truth.size() && truth[at + 1].time_ns <= tick.time_ns) {
            ++at;
        }
        if (tick.time_ns < truth.front().time_ns || tick.time_ns > truth.back().time_ns) {
            continue;
        }
        result.ticks.push_back({.record = tick, .truth = truth[at].truth()});
        if (truth[at].t_s >= 0.0 && static_cast<InterlockState>(tick.interlock_state) != InterlockState::active) {
            result.stayed_engaged = false;
            reasons |= tick.permission_reasons;
        }
    }
    if (result.ticks.empty()) {
        throw std::runtime_error("steadyboom-controller left no record while the crane ran");
    }
    result.trouble = controllers::reasons_in_words(reasons);
    result.figures = figures.figures();
    return result;
}

}  // namespace steadyboom::hil
