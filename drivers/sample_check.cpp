#include "drivers/sample_check.hpp"

#include <algorithm>
#include <cmath>

namespace steadyboom::drivers {

SampleCheck::Verdict SampleCheck::check(std::optional<double> value, double largest_step, std::uint64_t tick) noexcept {
    const auto ticks = static_cast<double>(tick - reference_tick_);
    const bool fits =
        value && (!reference_ || largest_step <= 0.0 || std::abs(*value - *reference_) <= largest_step * ticks);
    if (!fits) {
        good_in_a_row_ = 0;
        if (!implausible_ && bad_in_a_row_ < most_held) {
            ++bad_in_a_row_;
            return Verdict::held;
        }
        implausible_ = true;
        if (value) {  // from here on a new level is one, if it stays
            reference_ = value;
            reference_tick_ = tick;
        }
        return Verdict::implausible;
    }
    reference_ = value;
    reference_tick_ = tick;
    bad_in_a_row_ = 0;
    if (implausible_ && ++good_in_a_row_ < good_in_a_row_to_recover) {
        return Verdict::implausible;
    }
    implausible_ = false;
    return Verdict::good;
}

}  // namespace steadyboom::drivers
