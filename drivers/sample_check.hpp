#pragma once

#include <cstdint>
#include <optional>

namespace steadyboom::drivers {

/// Whether the samples of one channel can be true: inside its limits (the caller says), and no further from the last
/// good one than physics allows for the ticks between. One or two samples that cannot be are passed over and the last
/// good value is held; a third in a row makes the channel implausible. It is plausible again after ten samples in a row
/// that fit together, whatever value they settled on.
class SampleCheck {
  public:
    static constexpr std::uint32_t most_held = 2;
    static constexpr std::uint32_t good_in_a_row_to_recover = 10;

    enum class Verdict : std::uint8_t {
        good,         ///< take it
        held,         ///< pass it over, the channel is still believed
        implausible,  ///< the channel is not believed
    };

    /// `largest_step` is per tick, 0: any. No `value` stands for a sample out of range. `tick` counts up.
    [[nodiscard]] Verdict check(std::optional<double> value, double largest_step, std::uint64_t tick) noexcept;

    [[nodiscard]] bool plausible() const noexcept { return !implausible_; }

  private:
    std::optional<double> reference_;  ///< what the next sample is compared with
    std::uint64_t reference_tick_ = 0;
    std::uint32_t bad_in_a_row_ = 0;
    std::uint32_t good_in_a_row_ = 0;
    bool implausible_ = false;
};

}  // namespace steadyboom::drivers
