#include "hil/run_folder.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "controllers/interlock.hpp"
#include "drivers/candump_log.hpp"
#include "hil/figure_table.hpp"
#include "hil/state_names.hpp"
#include "hil/whole_file.hpp"

namespace steadyboom::hil {

namespace {

constexpr std::string_view output_columns =
    ",valve_m_true,pendent_tension_N_true,load_line_tension_N_true,chord_m_true,contact_fraction_true"
    ",hydraulic_power_W_true";
constexpr std::string_view command_columns =
    ",wanted_opening_m,limited_opening_m,applied_opening_m,authority,interlock_state,limit_reasons,permission_reasons"
    ",observer_nis,sampled_t_s";

/// Text that grows by cells.
class Lines {
  public:
    explicit Lines(std::size_t bytes) { text_.reserve(bytes); }

    template <typename... Values>
    void put(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    }
    void cell(double value) { put(",{}", value); }
    void line(std::string_view text) {
        text_ += text;
        text_ += '\n';
    }
    [[nodiscard]] std::string take() { return std::move(text_); }

  private:
    std::string text_;
};

bool is_fresh(const runtime::TickRecord& record, std::size_t sensor) {
    return record.measured_age_ticks[sensor] == 0 && ((record.measured_valid_bits >> sensor) & 1U) != 0;
}

bool ever_sampled(const runtime::TickRecord& record) {
    return std::ranges::any_of(record.measured_age_ticks,
                               [](std::uint32_t age) { return age != plant::CraneMeasurement::never; });
}

}  // namespace

std::string ticks_csv(const RunResult& run) {
    Lines lines(1024 * (run.ticks.size() + 1));
    lines.put("t_s");
    for (const std::string_view name : sensor_names) {
        lines.put(",{}_meas", name);
    }
    for (const std::string_view suffix : {"est", "true"}) {
        for (const std::string_view name : state_names) {
            lines.put(",{}_{}", name, suffix);
        }
    }
    lines.put("{}", output_columns);
    lines.line(command_columns);

    for (const auto& [record, truth] : run.ticks) {
        lines.put("{}", truth.t_s);
        for (std::size_t sensor = 0; sensor < plant::sensor_count; ++sensor) {
            if (is_fresh(record, sensor)) {
                lines.cell(record.measured[sensor]);
            } else {
                lines.put(",");
            }
        }
        for (const double value : record.estimate) {
            lines.cell(value);
        }
        for (const double value : truth.state) {
            lines.cell(value);
        }
        for (const double value : {truth.spool_m, truth.pendent_tension_N, truth.load_line_tension_N, truth.chord_m,
                                   truth.contact_fraction, truth.hydraulic_power_W, record.wanted_opening_m,
                                   record.limited_opening_m, record.applied_opening_m, record.authority}) {
            lines.cell(value);
        }
        lines.put(",{},{},{},{},",
                  controllers::name_of(static_cast<controllers::InterlockState>(record.interlock_state)),
                  record.limit_reasons, record.permission_reasons, record.observer_nis);
        if (ever_sampled(record)) {
            lines.put("{}", 1e-9 * static_cast<double>(record.samples_stamp_ns - run.epoch_ns) - RunResult::standing_s);
        }
        lines.line("");
    }
    return lines.take();
}

std::string can_log(std::span<const drivers::CanFrame> frames, std::string_view bus) {
    const std::string_view interface = bus == "loopback" ? "can0" : bus;
    Lines lines(64 * frames.size());
    for (const drivers::CanFrame& frame : frames) {
        lines.line(drivers::candump_line(frame, interface).view());
    }
    return lines.take();
}

void write_run_folder(const std::filesystem::path& folder, const RunResult& run, const RunFigures* uncontrolled) {
    write_whole_file(folder / "ticks.csv", ticks_csv(run));
    write_whole_file(folder / "can.log", can_log(run.frames, run.bus));
    write_whole_file(folder / "figures.json", figures_json(run, uncontrolled));
}

}  // namespace steadyboom::hil
