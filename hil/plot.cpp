#include "hil/plot.hpp"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "runtime/file_descriptor.hpp"

namespace steadyboom::hil {

namespace {

// Colours that stand for the page's text and for the grid until gnuplot is done; no curve uses them.
constexpr std::string_view ink = "#010203";
constexpr std::string_view grid = "#040506";

[[noreturn]] void fail(std::string_view what, int error) {
    throw std::runtime_error(fmt::format("plots: {}: {}", what, std::strerror(error)));
}

/// A file in memory, so that no pipe can fill up while the other end waits.
runtime::FileDescriptor memory_file(const char* name) {
    runtime::FileDescriptor file(memfd_create(name, MFD_CLOEXEC));
    if (!file.is_open()) {
        fail("no memory for gnuplot's input and output", errno);
    }
    return file;
}

void write_all(int descriptor, std::string_view text) {
    while (!text.empty()) {
        const ssize_t count = write(descriptor, text.data(), text.size());
        if (count < 0 && errno != EINTR) {
            fail("no memory for gnuplot's input and output", errno);
        }
        text.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    }
}

std::string read_all(int descriptor) {
    std::string text;
    std::array<char, 65536> part{};
    for (;;) {
        const ssize_t count = pread(descriptor, part.data(), part.size(), static_cast<off_t>(text.size()));
        if (count <= 0) {
            return text;
        }
        text.append(part.data(), static_cast<std::size_t>(count));
    }
}

/// What gnuplot prints for a script; its own settings and the caller's environment play no part.
std::string gnuplot(std::string_view script) {
    const runtime::FileDescriptor input = memory_file("gnuplot-script");
    const runtime::FileDescriptor output = memory_file("gnuplot-output");
    const runtime::FileDescriptor errors = memory_file("gnuplot-errors");
    write_all(input.get(), script);
    lseek(input.get(), 0, SEEK_SET);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input.get(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, output.get(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, errors.get(), STDERR_FILENO);
    std::string program = "gnuplot";
    std::string defaults = "--default-settings";
    std::string from_input = "-";
    std::string locale = "LC_ALL=C.UTF-8";
    const std::array<char*, 4> arguments{program.data(), defaults.data(), from_input.data(), nullptr};
    const std::array<char*, 2> environment{locale.data(), nullptr};
    pid_t process = 0;
    const int error = posix_spawnp(&process, program.c_str(), &actions, nullptr, arguments.data(), environment.data());
    posix_spawn_file_actions_destroy(&actions);
    if (error == ENOENT) {
        throw std::runtime_error("plots: gnuplot is not installed; install the Debian package gnuplot-nox");
    }
    if (error != 0) {
        fail("gnuplot cannot be started", error);
    }
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        throw std::runtime_error(fmt::format("plots: gnuplot failed: {}", read_all(errors.get())));
    }
    return read_all(output.get());
}

/// In single quotes gnuplot takes every character as it stands but the quote itself.
std::string quoted(std::string_view text) {
    std::string result = "'";
    for (const char character : text) {
        result += character == '\n' ? ' ' : character;
        if (character == '\'') {
            result += '\'';
        }
    }
    return result + '\'';
}

/// 1, 2 or 5 times a power of ten, so that `span` holds about `count` steps.
double step_of(double span, double count) {
    const double raw = span / count;
    const double power = std::pow(10.0, std::floor(std::log10(raw)));
    const double lead = raw / power;
    return power * (lead < 1.5 ? 1.0 : lead < 3.5 ? 2.0 : lead < 7.5 ? 5.0 : 10.0);
}

PlotRange range_of(const Plot& plot) {
    if (plot.y_range) {
        return *plot.y_range;
    }
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Curve& curve : plot.curves) {
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            const bool inside = curve.x[i] >= plot.x_range.low && curve.x[i] <= plot.x_range.high;
            if (inside && std::isfinite(curve.y[i]) && (!plot.logarithmic || curve.y[i] > 0.0)) {
                low = std::min(low, curve.y[i]);
                high = std::max(high, curve.y[i]);
            }
        }
    }
    if (!(low <= high)) {
        return plot.logarithmic ? PlotRange{0.1, 10.0} : PlotRange{-1.0, 1.0};
    }
    if (plot.logarithmic) {
        return {low / 1.5, high * 1.5};
    }
    const double margin = high > low ? 0.06 * (high - low) : std::max(1.0, 0.1 * std::abs(high));
    return {low - margin, high + margin};
}

class Script {
  public:
    Script() {
        put("set encoding utf8\nset border 3 lw 1 lc rgb '{0}'\nset grid noxtics ytics lw 0.7 dt solid lc rgb '{1}'\n"
            "set tics nomirror out scale 0.5\nset xtics offset 0,0.4\nset xzeroaxis lw 0.8 dt solid lc rgb "
            "'{0}'\nunset key\n",
            ink, grid);
    }

    void add(const Plot& plot) {
        const PlotRange y = range_of(plot);
        const auto from_px = [](int distance_px, int size_px) { return static_cast<double>(distance_px) / size_px; };
        put("set terminal svg size {},{} dynamic noenhanced font 'sans-serif,13' name 'plot{}'\n", plot.width_px,
            plot.height_px, count_++);
        put("set lmargin at screen {:.6f}\nset rmargin at screen {:.6f}\n", from_px(64, plot.width_px),
            1.0 - from_px(14, plot.width_px));
        put("set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\n", 1.0 - from_px(12, plot.height_px),
            from_px(46, plot.height_px));
        put("set label 1 {} at graph 0.5, screen {:.6f} center tc rgb '{}'\n", quoted(plot.x_label),
            from_px(8, plot.height_px), ink);
        put("set label 2 {} at screen {:.6f}, graph 0.5 center rotate by 90 tc rgb '{}'\n", quoted(plot.y_label),
            from_px(9, plot.width_px), ink);
        put("set xrange [{}:{}]\nset yrange [{}:{}]\n", plot.x_range.low, plot.x_range.high, y.low, y.high);
        put("set xtics {}\n", step_of(plot.x_range.high - plot.x_range.low, 8.0));
        if (plot.logarithmic) {
            put("set logscale y\nset ytics 1e-12,10,1e12\n");
        } else {
            put("unset logscale y\nset ytics {}\n", step_of(y.high - y.low, 5.0));
        }
        put("unset arrow\n");
        for (const double mark : plot.marks) {
            put("set arrow from graph 0, first {0} to graph 1, first {0} nohead lw 1 dt (3,4) lc rgb '{1}'\n", mark,
                ink);
        }
        std::string lines;
        for (std::size_t i = 0; i < plot.curves.size(); ++i) {
            const Curve& curve = plot.curves[i];
            put("$curve{} << END\n", i);
            for (std::size_t k = 0; k < curve.x.size(); ++k) {
                if (std::isfinite(curve.x[k]) && std::isfinite(curve.y[k])) {
                    put("{:.7g} {:.7g}\n", curve.x[k], curve.y[k]);
                } else {
                    put("\n");
                }
            }
            put("END\n");
            fmt::format_to(std::back_inserter(lines), "{}$curve{} using 1:2 with {} lw {} lc rgb '{}' {}",
                           i == 0 ? "plot " : ", ", i, curve.stepped ? "steps" : "lines", curve.width_px, curve.colour,
                           curve.dashed ? "dt (5,3)" : "dt solid");
        }
        put("{}\n", plot.curves.empty() ? "plot NaN" : lines);
    }

    [[nodiscard]] const std::string& text() const { return text_; }

  private:
    template <typename... Values>
    void put(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    }

    std::string text_;
    int count_ = 0;
};

void replace_all(std::string& text, std::string_view from, std::string_view to) {
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
        text.replace(at, from.size(), to);
    }
}

/// Erases every piece from `first` up to and including the next `last`.
void erase_all(std::string& text, std::string_view first, std::string_view last) {
    for (auto at = text.find(first); at != std::string::npos; at = text.find(first, at)) {
        const auto end = text.find(last, at + first.size());
        if (end == std::string::npos) {
            return;
        }
        text.erase(at, end + last.size() - at);
    }
}

/// Leaves of a document of gnuplot's what an element inside a page needs.
std::string page_element(std::string_view document) {
    std::string svg(document.substr(document.find("<svg")));
    erase_all(svg, "<title>", "</title>\n");
    erase_all(svg, "<desc>", "</desc>\n");
    erase_all(svg, "<defs>", "</defs>\n");
    erase_all(svg, " xmlns", "\"\n");
    erase_all(svg, " xmlns:xlink=\"", "\"\n");
    erase_all(svg, " id=\"", "\"");
    erase_all(svg, " color=\"", "\"");
    erase_all(svg, " font-family=\"", "\"");
    erase_all(svg, " class=\"", "\"");
    erase_all(svg, " stroke-dasharray='2,4'", "");  // gnuplot's own, of grid and zero line
    replace_all(svg, "stroke-width=\"1.00\" stroke-linecap=\"butt\" stroke-linejoin=\"miter\"", "");
    replace_all(svg, "stroke-linecap=\"butt\" stroke-linejoin=\"miter\"", "");
    replace_all(svg, "'rgb(  1,   2,   3)'", "'currentColor'");
    replace_all(svg, "\"rgb(  1,   2,   3)\"", "\"currentColor\"");
    replace_all(svg, "\"rgb(1,2,3)\"", "\"currentColor\"");
    replace_all(svg, "'rgb(  4,   5,   6)'", "'currentColor' stroke-opacity='0.16'");
    replace_all(svg, "\"rgb(  4,   5,   6)\"", "\"currentColor\" stroke-opacity=\"0.16\"");

    std::string kept;
    kept.reserve(svg.size());
    std::string_view rest = svg;
    std::string_view pending;  // an opening <g>, kept back until it has content
    while (!rest.empty()) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(line.size() + 1, rest.size()));
        if (line.empty()) {
            continue;
        }
        if (!pending.empty()) {
            const bool hollow = line == "</g>";
            if (!hollow) {
                kept.append(pending) += '\n';
            }
            pending = {};
            if (hollow) {
                continue;
            }
        }
        if (line.starts_with("<g") && line.ends_with(">")) {
            pending = line;
        } else {
            kept.append(line) += '\n';
        }
    }
    return kept;
}

}  // namespace

Curve thinned(const Curve& curve, PlotRange range, int buckets) {
    Curve result = curve;
    result.x.clear();
    result.y.clear();
    const auto keep = [&](std::size_t i) {
        result.x.push_back(curve.x[i]);
        result.y.push_back(curve.y[i]);
    };
    const double width = (range.high - range.low) / buckets;
    std::size_t i = 0;
    while (i < curve.x.size() && curve.x[i] < range.low) {
        ++i;
    }
    while (i < curve.x.size() && curve.x[i] <= range.high) {
        const double bucket = std::floor((curve.x[i] - range.low) / width);
        std::size_t lowest = i;
        std::size_t highest = i;
        bool gap = false;
        for (; i < curve.x.size() && curve.x[i] <= range.high && std::floor((curve.x[i] - range.low) / width) == bucket;
             ++i) {
            if (!std::isfinite(curve.y[i])) {
                gap = true;
                continue;
            }
            lowest = !std::isfinite(curve.y[lowest]) || curve.y[i] < curve.y[lowest] ? i : lowest;
            highest = !std::isfinite(curve.y[highest]) || curve.y[i] > curve.y[highest] ? i : highest;
        }
        keep(std::min(lowest, highest));
        if (lowest != highest) {
            keep(std::max(lowest, highest));
        }
        if (gap && std::isfinite(result.y.back())) {
            result.x.push_back(result.x.back());
            result.y.push_back(std::numeric_limits<double>::quiet_NaN());
        }
    }
    return result;
}

std::vector<std::string> draw_plots(std::span<const Plot> plots) {
    Script script;
    for (const Plot& plot : plots) {
        script.add(plot);
    }
    const std::string output = gnuplot(script.text());
    std::vector<std::string> elements;
    std::string_view rest = output;
    constexpr std::string_view last = "</svg>\n";
    for (auto end = rest.find(last); end != std::string_view::npos; end = rest.find(last)) {
        const std::string_view document = rest.substr(0, end + last.size());
        if (document.find("<svg") == std::string_view::npos) {
            break;
        }
        elements.push_back(page_element(document));
        rest.remove_prefix(document.size());
    }
    if (elements.size() != plots.size()) {
        throw std::runtime_error(fmt::format("plots: gnuplot drew {} of {} plots; is it the version of Debian 12?",
                                             elements.size(), plots.size()));
    }
    return elements;
}

}  // namespace steadyboom::hil
