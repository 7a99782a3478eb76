#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "drivers/candump_log.hpp"
#include "drivers/socketcan_bus.hpp"
#include "hil/bus_monitor.hpp"
#include "hil/bus_monitor_view.hpp"
#include "hil/commands/commands.hpp"
#include "hil/commands/network_options.hpp"
#include "hil/commands/option_checks.hpp"

namespace steadyboom::hil {

namespace {

namespace fs = std::filesystem;

struct MonitorOptions {
    std::string source;
    NetworkOptions network;
    std::optional<double> duration_s;
    bool json = false;
};

constexpr std::int64_t refresh_ns = 500'000'000;
constexpr int poll_ms = 50;

volatile std::sig_atomic_t interrupted = 0;

void note_interrupt(int /*signal*/) {
    interrupted = 1;
}

std::int64_t steady_now_ns() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

/// The terminal that shows the view while it changes: a screen of its own, given back at the end.
class LiveScreen {
  public:
    LiveScreen() { std::cout << "\033[?1049h\033[?25l" << std::flush; }
    ~LiveScreen() { std::cout << "\033[?25h\033[?1049l" << std::flush; }
    LiveScreen(const LiveScreen&) = delete;
    LiveScreen& operator=(const LiveScreen&) = delete;

    static void show(const std::string& text) {
        winsize size{};
        if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) {
            size.ws_col = 80;
            size.ws_row = 24;
        }
        // Each line is cleared to its end as it is drawn, and what is left of the screen after the last: no flicker.
        std::string drawn = "\033[H";
        for (const char character : fit_to_terminal(text, size.ws_col, size.ws_row)) {
            drawn += character == '\n' ? std::string("\033[K\n") : std::string(1, character);
        }
        std::cout << drawn << "\033[K\033[J" << std::flush;
    }
};

std::string trouble_of(const drivers::SocketCanBus& bus) {
    const auto status = bus.status();
    std::string text;
    const auto append = [&text](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
    switch (status.receive_error) {
        case drivers::BusError::none:
        case drivers::BusError::no_room:
            break;
        case drivers::BusError::down:
            append("interface is down");
            break;
        case drivers::BusError::gone:
            append("interface is gone");
            break;
        case drivers::BusError::other:
            append("interface does not receive");
            break;
    }
    switch (status.link) {
        case drivers::LinkState::active:
            break;
        case drivers::LinkState::warning:
            append("link: error warning");
            break;
        case drivers::LinkState::passive:
            append("link: error passive");
            break;
        case drivers::LinkState::bus_off:
            append("link: bus off");
            break;
    }
    return text;
}

int print(const BusMonitor& monitor, const MonitorView& view, bool json) {
    std::cout << (json ? monitor_json(monitor, view) : monitor_text(monitor, view)) << std::flush;
    return exit_done;
}

int watch_interface(const MonitorOptions& options) {
    BusMonitor monitor(table_of(options.network));
    // It only looks, so what comes from this machine is as good as the rest.
    drivers::SocketCanBus bus(options.source, {.receive_buffer_frames = 4096, .expect_remote = false});
    std::signal(SIGINT, note_interrupt);
    std::signal(SIGTERM, note_interrupt);
    MonitorView view{.source = options.source};
    const auto begin_ns = steady_now_ns();
    const auto end_ns = options.duration_s ? begin_ns + static_cast<std::int64_t>(1.0e9 * *options.duration_s)
                                           : std::numeric_limits<std::int64_t>::max();
    {
        std::optional<LiveScreen> screen;
        if (!options.json && isatty(STDOUT_FILENO) == 1) {
            screen.emplace();
        }
        std::array<drivers::CanFrame, drivers::most_frames_a_tick> frames;
        auto next_refresh_ns = begin_ns;
        while (interrupted == 0 && steady_now_ns() < end_ns) {
            pollfd waiting{.fd = bus.fd(), .events = POLLIN, .revents = 0};
            poll(&waiting, 1, poll_ms);
            std::size_t count = 0;
            do {
                count = bus.receive(frames);
                for (std::size_t i = 0; i < count; ++i) {
                    monitor.take(frames[i]);
                }
            } while (count == frames.size() && interrupted == 0);
            if (bus.status().receive_error != drivers::BusError::none) {
                poll(nullptr, 0, poll_ms);  // a dead socket is readable at once, again and again
            }
            if (const auto now_ns = steady_now_ns(); now_ns >= next_refresh_ns) {
                next_refresh_ns = now_ns + refresh_ns;
                bus.tend();
                monitor.close_window(now_ns);
                if (screen) {
                    view.now_ns = now_ns;
                    view.recent = true;
                    view.colour = true;
                    view.lost_frames = bus.status().receive_overflow_frames;
                    view.interface_state = trouble_of(bus);
                    LiveScreen::show(monitor_text(monitor, view));
                }
            }
        }
    }
    view.now_ns = steady_now_ns();
    view.recent = false;
    view.colour = false;
    view.lost_frames = bus.status().receive_overflow_frames;
    view.interface_state = trouble_of(bus);
    print(monitor, view, options.json);
    if (bus.status().receive_error == drivers::BusError::gone) {
        throw std::runtime_error(fmt::format("CAN interface '{}' is gone", options.source));
    }
    return exit_done;
}

int read_log(const MonitorOptions& options) {
    BusMonitor monitor(table_of(options.network));
    std::ifstream log(options.source);
    if (!log) {
        throw std::invalid_argument(fmt::format("{}: cannot be read", options.source));
    }
    MonitorView view{.source = options.source};
    const auto most_ns = options.duration_s ? static_cast<std::int64_t>(1.0e9 * *options.duration_s)
                                            : std::numeric_limits<std::int64_t>::max();
    std::optional<std::int64_t> begin_ns;
    std::size_t number = 0;
    for (std::string line; std::getline(log, line);) {
        ++number;
        if (!line.empty() && line.back() == '\r') {
            line.pop_back();
        }
        const auto entry = drivers::read_candump_line(line);
        if (entry.kind == drivers::CandumpKind::malformed) {
            if (log.eof()) {
                ++view.cut_lines;  // candump was ended in the middle of it
                break;
            }
            throw std::invalid_argument(
                fmt::format("{}:{}:{}: {}; a line of `candump -L` reads "
                            "\"(1436509052.249713) can0 044#2A366C2BBA\"",
                            options.source, number, entry.column, entry.problem));
        }
        begin_ns = begin_ns.value_or(entry.frame.stamp_ns);
        if (entry.frame.stamp_ns - *begin_ns > most_ns) {
            break;
        }
        if (entry.kind == drivers::CandumpKind::fd_frame) {
            monitor.take_fd_frame(entry.frame.stamp_ns);
        } else {
            monitor.take(entry.frame);
        }
    }
    view.now_ns = monitor.last_ns();
    return print(monitor, view, options.json);
}

int monitor_bus(const MonitorOptions& options) {
    if (fs::is_regular_file(options.source) || fs::is_fifo(options.source)) {
        return read_log(options);
    }
    if (if_nametoindex(options.source.c_str()) == 0) {
        throw std::invalid_argument(fmt::format(
            "\"{}\" is neither a network interface nor a file: allowed is a CAN interface such as can0 (ip link show "
            "type can) or a log of candump -L",
            options.source));
    }
    return watch_interface(options);
}

}  // namespace

void add_bus_monitor_command(CLI::App& app, Action& selected) {
    const auto options = std::make_shared<MonitorOptions>();
    CLI::App* command = app.add_subcommand(
        "bus-monitor", "What is on the bus: values, rates, ages and errors per device, live or from a log");
    command->add_option("SOURCE", options->source, "CAN interface, or log of candump -L")->required();
    add_network_options(*command, options->network);
    command->add_option("--duration-s", options->duration_s, "Stop after this time; without it until interrupted")
        ->check(positive_up_to(86'400.0, "s"));
    command->add_flag("--json", options->json, "Print JSON at the end");
    command->callback([options, &selected] { selected = [options] { return monitor_bus(*options); }; });
}

}  // namespace steadyboom::hil
