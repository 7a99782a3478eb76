#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace steadyboom::hil {

/// One line of a plot. A point that is not finite leaves a gap.
struct Curve {
    std::vector<double> x;
    std::vector<double> y;  ///< as many as x
    std::string colour;     ///< "#rrggbb"
    double width_px = 1.4;
    bool dashed = false;
    bool stepped = false;  ///< holds each value until the next
};

struct PlotRange {
    double low = 0.0;
    double high = 1.0;
};

/// A plot of curves over one horizontal axis. It carries no title and no key; those are the page's.
struct Plot {
    std::string x_label;
    std::string y_label;
    PlotRange x_range;
    std::optional<PlotRange> y_range;  ///< all that is in x_range if empty
    bool logarithmic = false;          ///< vertical axis
    std::vector<double> marks;         ///< horizontal lines at these heights
    std::vector<Curve> curves;
    int width_px = 560;
    int height_px = 250;
};

/// One SVG element for each plot, drawn by gnuplot, ready to stand inside an HTML page: it takes the width it is given,
/// and axes and texts take the colour of the page's text. Equal plots give equal bytes. Throws std::runtime_error if
/// gnuplot is not installed (the message names its package) or fails.
[[nodiscard]] std::vector<std::string> draw_plots(std::span<const Plot> plots);

/// A curve of at most about 2 `buckets` points that looks the same: of each of `buckets` equal spans of `range`, the
/// lowest and highest point, in the order of time. Points outside `range` are dropped. x ascends.
[[nodiscard]] Curve thinned(const Curve& curve, PlotRange range, int buckets);

}  // namespace steadyboom::hil
