#pragma once

#include <string>
#include <string_view>

namespace steadyboom::hil {

/// `text` as HTML shows it letter by letter, inside elements and quoted attributes alike.
[[nodiscard]] std::string html_text(std::string_view text);

}  // namespace steadyboom::hil
