#pragma once

#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/plot.hpp"

namespace steadyboom::hil {

/// `text` as HTML shows it letter by letter, inside elements and quoted attributes alike.
[[nodiscard]] std::string html_text(std::string_view text);

/// One entry of the key to a plot's lines.
struct KeyEntry {
    std::string_view colour;  ///< "#rrggbb"
    std::string_view words;   ///< HTML
    bool dashed = false;
};

/// A self-contained HTML page, put together piece by piece: one look for every page, on screens wide and narrow, light
/// and dark, and on paper. Loads nothing.
class HtmlPage {
  public:
    /// `title` is text, `own_style` is CSS that follows the common one.
    HtmlPage(std::string_view title, std::string_view own_style);

    /// Appends HTML.
    template <typename... Values>
    void put(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    }

    /// A sticky key stays in sight while its plots scroll by.
    void put_key(std::span<const KeyEntry> entries, bool sticky);

    /// A figure whose caption is HTML: `symbol` stands out, `words` follow. Its curves are thinned to about one point
    /// for each of `buckets` parts of the plot's width.
    void put_plot(Plot plot, std::string_view symbol, std::string_view words, int buckets);

    /// The page, with all plots drawn by one gnuplot. Throws std::runtime_error if gnuplot is missing or fails.
    [[nodiscard]] std::string finished() &&;

  private:
    std::string text_;
    std::vector<Plot> plots_;
    std::vector<std::size_t> places_;  ///< in text_, of each plot
};

}  // namespace steadyboom::hil
