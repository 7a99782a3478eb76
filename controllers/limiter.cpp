#include "controllers/limiter.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace steadyboom::controllers {

namespace {

double checked(double value, const char* name, const char* unit) {
    if (!(std::isfinite(value) && value > 0.0)) {
        std::ostringstream text;
        text << "limiter: " << name << " = " << value << " " << unit << ": must be positive and finite";
        throw std::invalid_argument(text.str());
    }
    return value;
}

double reported(double opening_m, double limited_m, plant::LimitReason reason, std::uint32_t& reasons) noexcept {
    if (limited_m != opening_m) {
        reasons |= reason;
    }
    return limited_m;
}

}  // namespace

double limit_to_finite_m(double opening_m, std::uint32_t& reasons) noexcept {
    if (std::isfinite(opening_m)) {
        return opening_m;
    }
    reasons |= plant::limit_not_finite;
    return 0.0;
}

double limit_to_permission_m(double opening_m, const plant::Permission& permit, std::uint32_t& reasons) noexcept {
    return reported(opening_m, permit.motion() ? opening_m : 0.0, plant::limit_no_permission, reasons);
}

double limit_to_authority_m(double opening_m, double authority, std::uint32_t& reasons) noexcept {
    // Written so that an authority that is no number is none.
    const double share = authority > 0.0 ? std::min(authority, 1.0) : 0.0;
    return reported(opening_m, opening_m * share, plant::limit_authority, reasons);
}

double limit_to_absolute_m(double opening_m, double max_opening_m, std::uint32_t& reasons) noexcept {
    return reported(opening_m, std::clamp(opening_m, -max_opening_m, max_opening_m), plant::limit_absolute, reasons);
}

double limit_to_slew_m(double opening_m, double last_opening_m, double max_step_m, std::uint32_t& reasons) noexcept {
    return reported(opening_m, std::clamp(opening_m, last_opening_m - max_step_m, last_opening_m + max_step_m),
                    plant::limit_slew, reasons);
}

Limiter::Limiter(const LimiterConfig& config)
    : max_opening_m_(checked(config.max_opening_m, "max_opening_m", "m")),
      max_step_m_(checked(config.max_slew_m_s, "max_slew_m_s", "m/s") * checked(config.period_s, "period_s", "s")) {}

plant::LimitedCommand Limiter::apply(const plant::ValveCommand& wanted, const plant::Permission& permit) noexcept {
    plant::LimitedCommand limited;
    double opening_m = limit_to_finite_m(wanted.opening_m, limited.reasons);
    opening_m = limit_to_permission_m(opening_m, permit, limited.reasons);
    opening_m = limit_to_authority_m(opening_m, permit.authority, limited.reasons);
    opening_m = limit_to_absolute_m(opening_m, max_opening_m_, limited.reasons);
    if (permit.motion()) {
        opening_m = limit_to_slew_m(opening_m, last_opening_m_, max_step_m_, limited.reasons);
    }
    last_opening_m_ = opening_m;
    limited.opening_m = opening_m;
    return limited;
}

}  // namespace steadyboom::controllers
