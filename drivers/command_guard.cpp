#include "drivers/command_guard.hpp"

#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace steadyboom::drivers {
namespace {

constexpr double nm_per_m = 1.0e9;
constexpr double largest_opening_m = 1.0;
constexpr std::int64_t rounding_nm = 1;  // both ends of a step of exactly max_step_m round on their own

bool is_mode(plant::ValveMode mode) noexcept {
    switch (mode) {
        case plant::ValveMode::disabled:
        case plant::ValveMode::hold:
        case plant::ValveMode::active:
            return true;
    }
    return false;
}

std::int32_t whole_nm(double length_m) noexcept {
    return static_cast<std::int32_t>(std::lround(length_m * nm_per_m));
}

const GuardLimits& checked(const GuardLimits& limits) {
    // Written so that NaN fails.
    const bool good = limits.max_step_m > 0.0 && limits.max_step_m <= limits.max_opening_m &&
                      limits.max_opening_m <= largest_opening_m;
    if (!good) {
        throw std::invalid_argument("guard limits max_step_m = " + std::to_string(limits.max_step_m) +
                                    ", max_opening_m = " + std::to_string(limits.max_opening_m) +
                                    ": allowed is 0 < max_step_m <= max_opening_m <= 1");
    }
    return limits;
}

}  // namespace

CommandGuard::CommandGuard(const GuardLimits& limits)
    : max_opening_nm_(whole_nm(checked(limits).max_opening_m)), max_step_nm_(whole_nm(limits.max_step_m)) {}

GuardedCommand CommandGuard::pass(const plant::LimitedCommand& command, const plant::Permission& permit) noexcept {
    const bool representable = std::abs(command.opening_m) <= largest_opening_m;  // false for NaN
    const std::int32_t opening_nm = representable ? whole_nm(command.opening_m) : 0;
    const bool small_enough = std::abs(opening_nm) <= max_opening_nm_;
    const bool towards_zero = last_nm_ >= 0 ? opening_nm >= 0 && opening_nm <= last_nm_  //
                                            : opening_nm <= 0 && opening_nm >= last_nm_;
    const bool near_last = std::abs(std::int64_t{opening_nm} - last_nm_) <= max_step_nm_ + rounding_nm;
    const bool permitted = opening_nm == 0 || permit.motion();

    if (!representable || !small_enough || !(near_last || towards_zero) || !permitted || !is_mode(permit.mode)) {
        ++violations_;
        auto refused = neutral();
        refused.reasons_ = command.reasons | plant::limit_guard;
        if (!std::isfinite(command.opening_m)) {
            refused.reasons_ |= plant::limit_not_finite;
        }
        return refused;
    }
    last_nm_ = opening_nm;
    GuardedCommand passed;
    passed.opening_nm_ = opening_nm;
    passed.mode_ = permit.mode;
    passed.cutoff_energised_ = permit.cutoff_energised;
    passed.valve_reset_ = permit.valve_reset && permit.mode == plant::ValveMode::disabled;
    passed.reasons_ = command.reasons;
    return passed;
}

GuardedCommand CommandGuard::neutral() noexcept {
    last_nm_ = 0;
    return {};
}

}  // namespace steadyboom::drivers
