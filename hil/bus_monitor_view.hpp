#pragma once

#include <cstdint>
#include <string>

#include "hil/bus_monitor.hpp"

namespace steadyboom::hil {

/// What a view shows beside the monitor's own figures.
struct MonitorView {
    std::string source;             ///< interface or file
    std::int64_t now_ns = 0;        ///< ages count from here
    bool recent = false;            ///< rates of the last window, not of the whole time
    bool colour = false;            ///< mark with terminal colours
    std::uint64_t lost_frames = 0;  ///< came while the receive buffer was full
    std::uint64_t cut_lines = 0;    ///< a log's last line without an end
    std::string interface_state;    ///< what is wrong with the interface, empty if nothing
};

/// For people: one line a device, one a message with its newest values in the units of the network file.
[[nodiscard]] std::string monitor_text(const BusMonitor& monitor, const MonitorView& view);

/// The same and more as JSON; times in s, rates in Hz, null where nothing came.
[[nodiscard]] std::string monitor_json(const BusMonitor& monitor, const MonitorView& view);

/// The text cut to a terminal's size, colour codes not counted; lines that do not fit are told of in the last one.
[[nodiscard]] std::string fit_to_terminal(const std::string& text, std::size_t columns, std::size_t rows);

}  // namespace steadyboom::hil
