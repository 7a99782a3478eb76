#pragma once

#include <cstdint>

namespace steadyboom::plant {

/// What a law wants. Positive takes the pendent in (raises its tension and the boom).
struct ValveCommand {
    double opening_m = 0.0;
};

/// Why a command was changed on its way to the valve. Bits; several may hold at once.
enum LimitReason : std::uint32_t {
    limit_none = 0,
    limit_not_finite = 1U << 0,     ///< the law gave NaN or infinity: neutral
    limit_no_permission = 1U << 1,  ///< the interlock does not permit motion: neutral
    limit_authority = 1U << 2,      ///< scaled while authority ramps up
    limit_absolute = 1U << 3,       ///< clipped to the largest opening
    limit_slew = 1U << 4,           ///< clipped to the largest change per tick
    limit_guard = 1U << 5,          ///< the guard rejected the command: neutral
};

/// What the valve is asked to be. Each value is the ValveState that it leads to; how a valve is asked is its driver's.
enum class ValveMode : std::uint8_t {
    disabled = 0b0000'1001,  ///< D and R
    hold = 0b0000'1011,      ///< D, H and R
    active = 0b0000'1111,    ///< D, H, M and R
};

/// The interlock's verdict for one tick. A refusal is an ordinary value.
struct Permission {
    ValveMode mode = ValveMode::disabled;
    bool cutoff_energised = false;  ///< true opens the cut-off valve
    double authority = 0.0;         ///< 0 (neutral) to 1 (full), ramps up after engaging
    bool valve_reset = false;       ///< with `disabled`: the valve may be asked to leave a fault state
    std::uint32_t reasons = 0;      ///< InterlockReason bits (controllers/interlock.hpp)

    [[nodiscard]] bool motion() const noexcept { return mode == ValveMode::active && authority > 0.0; }
};

/// A law's command after the performance limits.
struct LimitedCommand {
    double opening_m = 0.0;
    std::uint32_t reasons = limit_none;  ///< LimitReason bits
};

}  // namespace steadyboom::plant
