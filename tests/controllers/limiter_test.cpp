#include "controllers/limiter.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace steadyboom::controllers {
namespace {

using namespace plant;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr LimiterConfig limits{.max_opening_m = 7e-3, .max_slew_m_s = 0.2, .period_s = 0.005};
constexpr double max_step_m = 1e-3;

constexpr Permission engaged(double authority = 1.0) {
    return {.mode = ValveMode::active, .cutoff_energised = true, .authority = authority};
}

/// A limiter whose last command is `opening_m`.
Limiter limiter_at(double opening_m) {
    Limiter limiter(limits);
    const int steps = static_cast<int>(std::ceil(std::abs(opening_m) / (0.99 * max_step_m)));
    for (int i = 1; i <= steps; ++i) {
        EXPECT_EQ(limiter.apply({opening_m * i / steps}, engaged()).reasons, limit_none);
    }
    return limiter;
}

TEST(PureLimits, FiniteLimitTakesAnyNumberAndMakesTheRestNeutral) {
    for (const double fine : {0.0, -0.0, 1e300, -1e300, std::numeric_limits<double>::denorm_min()}) {
        std::uint32_t reasons = limit_none;
        EXPECT_EQ(limit_to_finite_m(fine, reasons), fine);
        EXPECT_EQ(reasons, limit_none);
    }
    for (const double bad : {nan, infinity, -infinity}) {
        std::uint32_t reasons = limit_none;
        EXPECT_EQ(limit_to_finite_m(bad, reasons), 0.0);
        EXPECT_EQ(reasons, limit_not_finite);
    }
}

TEST(PureLimits, PermissionIsAnActiveValveWithAnyAuthorityAndNothingLess) {
    std::uint32_t reasons = limit_none;
    EXPECT_EQ(limit_to_permission_m(1e-3, engaged(1e-9), reasons), 1e-3);
    EXPECT_EQ(reasons, limit_none);
    for (const Permission& refused :
         {engaged(0.0), engaged(-1.0), engaged(nan), Permission{.mode = ValveMode::hold, .authority = 1.0},
          Permission{.mode = ValveMode::disabled, .authority = 1.0}, Permission{}}) {
        reasons = limit_none;
        EXPECT_EQ(limit_to_permission_m(1e-3, refused, reasons), 0.0);
        EXPECT_EQ(reasons, limit_no_permission);
        reasons = limit_none;
        EXPECT_EQ(limit_to_permission_m(0.0, refused, reasons), 0.0);
        EXPECT_EQ(reasons, limit_none) << "neutral already";
    }
}

TEST(PureLimits, AuthorityScalesBelowOneAndLeavesAloneAtOneAndAbove) {
    std::uint32_t reasons = limit_none;
    EXPECT_EQ(limit_to_authority_m(-4e-3, 1.0, reasons), -4e-3);
    EXPECT_EQ(limit_to_authority_m(-4e-3, 7.0, reasons), -4e-3);
    EXPECT_EQ(limit_to_authority_m(0.0, 0.3, reasons), 0.0);
    EXPECT_EQ(reasons, limit_none);
    EXPECT_EQ(limit_to_authority_m(-4e-3, 0.25, reasons), -1e-3);
    EXPECT_EQ(reasons, limit_authority);
    reasons = limit_none;
    EXPECT_EQ(limit_to_authority_m(4e-3, std::nextafter(1.0, 0.0), reasons), 4e-3 * std::nextafter(1.0, 0.0));
    EXPECT_EQ(reasons, limit_authority);
}

TEST(PureLimits, AuthorityThatIsNegativeOrNoNumberIsNone) {
    for (const double bad : {-0.5, -infinity, nan}) {
        std::uint32_t reasons = limit_none;
        EXPECT_EQ(limit_to_authority_m(4e-3, bad, reasons), 0.0) << bad;
        EXPECT_EQ(reasons, limit_authority);
    }
}

TEST(PureLimits, AbsoluteLimitItselfPassesAndTheNextNumberBeyondIsClipped) {
    for (const double sign : {1.0, -1.0}) {
        std::uint32_t reasons = limit_none;
        EXPECT_EQ(limit_to_absolute_m(sign * 7e-3, 7e-3, reasons), sign * 7e-3);
        EXPECT_EQ(reasons, limit_none);
        EXPECT_EQ(limit_to_absolute_m(sign * std::nextafter(7e-3, 1.0), 7e-3, reasons), sign * 7e-3);
        EXPECT_EQ(reasons, limit_absolute);
    }
}

TEST(PureLimits, LargestStepPassesAndTheNextNumberBeyondIsClipped) {
    for (const double sign : {1.0, -1.0}) {
        const double last_m = sign * 2e-3;
        for (const double step_m : {1e-3, -1e-3}) {
            const double edge_m = last_m + step_m;
            std::uint32_t reasons = limit_none;
            EXPECT_EQ(limit_to_slew_m(edge_m, last_m, 1e-3, reasons), edge_m);
            EXPECT_EQ(reasons, limit_none);
            const double beyond_m = std::nextafter(edge_m, step_m > 0.0 ? 1.0 : -1.0);
            EXPECT_EQ(limit_to_slew_m(beyond_m, last_m, 1e-3, reasons), edge_m);
            EXPECT_EQ(reasons, limit_slew);
        }
    }
}

TEST(PureLimits, AddTheirReasonToThoseBefore) {
    std::uint32_t reasons = limit_authority;
    (void)limit_to_absolute_m(1.0, 7e-3, reasons);
    EXPECT_EQ(reasons, limit_authority | limit_absolute);
}

/// Openings around the limits, far beyond them, and what is no number.
rc::Gen<double> openings() {
    const auto between = [](double low, double high) {
        return rc::gen::map(rc::gen::inRange(-1'000'000, 1'000'001),
                            [=](int share) { return 0.5 * (low + high) + 0.5 * (high - low) * 1e-6 * share; });
    };
    return rc::gen::weightedOneOf<double>({{6, between(-8e-3, 8e-3)},
                                           {3, between(-0.5e-3, 0.5e-3)},
                                           {1, between(-1e3, 1e3)},
                                           {1, rc::gen::element(nan, infinity, -infinity, 7e-3, -7e-3, 0.0, -0.0)}});
}

rc::Gen<Permission> permissions() {
    return rc::gen::apply(
        [](int mode, double authority) {
            Permission permit = engaged(authority);
            permit.mode = mode == 0 ? ValveMode::disabled : mode == 1 ? ValveMode::hold : ValveMode::active;
            return permit;
        },
        rc::gen::weightedElement<int>({{1, 0}, {1, 1}, {10, 2}}),
        rc::gen::weightedElement<double>({{10, 1.0}, {3, 0.5}, {1, 1e-3}, {1, 0.0}, {1, -1.0}, {1, 2.0}, {1, nan}}));
}

TEST(Limiter, NoSequenceOfCommandsAndPermissionsBreaksALimit) {
    EXPECT_TRUE(rc::check("limits hold", [] {
        Limiter limiter(limits);
        double last_m = 0.0;
        const int length = *rc::gen::inRange(1, 60);
        for (int i = 0; i < length; ++i) {
            const double wanted_m = *openings();
            const Permission permit = *permissions();
            const LimitedCommand limited = limiter.apply({wanted_m}, permit);

            RC_ASSERT(std::isfinite(limited.opening_m));
            RC_ASSERT(std::abs(limited.opening_m) <= limits.max_opening_m);
            RC_ASSERT(std::isfinite(wanted_m) != ((limited.reasons & limit_not_finite) != 0));
            if (!permit.motion()) {
                RC_ASSERT(limited.opening_m == 0.0);
                RC_ASSERT((limited.reasons & limit_no_permission) != 0 || !std::isfinite(wanted_m) || wanted_m == 0.0);
            } else {
                RC_ASSERT(std::abs(limited.opening_m - last_m) <= max_step_m * (1.0 + 1e-12));
                if (!std::isfinite(wanted_m)) {
                    RC_ASSERT(std::abs(limited.opening_m) <= std::max(0.0, std::abs(last_m) - max_step_m) + 1e-15);
                }
                const bool inside = std::abs(wanted_m) <= limits.max_opening_m &&
                                    std::abs(wanted_m - last_m) < max_step_m * (1.0 - 1e-12) && permit.authority >= 1.0;
                if (inside) {
                    RC_ASSERT(limited.opening_m == wanted_m);
                    RC_ASSERT(limited.reasons == limit_none);
                }
                if (limited.opening_m != wanted_m) {
                    RC_ASSERT(limited.reasons != limit_none);
                }
            }
            last_m = limited.opening_m;
        }
    }));
}

TEST(Limiter, NumberThatIsNoneIsNeutralWithItsReasonAlone) {
    for (const double bad : {nan, infinity, -infinity}) {
        const LimitedCommand limited = Limiter(limits).apply({bad}, engaged());
        EXPECT_EQ(limited.opening_m, 0.0);
        EXPECT_EQ(limited.reasons, limit_not_finite);
    }
}

TEST(Limiter, LostPermissionIsNeutralAtOnceHoweverFarTheSlewLimitIs) {
    for (const double opening_m : {6.5e-3, -6.5e-3}) {
        Limiter limiter = limiter_at(opening_m);
        const LimitedCommand limited =
            limiter.apply({opening_m}, Permission{.mode = ValveMode::hold, .authority = 1.0});
        EXPECT_EQ(limited.opening_m, 0.0);
        EXPECT_EQ(limited.reasons, limit_no_permission);
    }
}

TEST(Limiter, PermissionThatReturnsStartsFromNeutral) {
    Limiter limiter = limiter_at(6.5e-3);
    (void)limiter.apply({6.5e-3}, Permission{});
    const LimitedCommand limited = limiter.apply({6.5e-3}, engaged());
    EXPECT_DOUBLE_EQ(limited.opening_m, max_step_m);
    EXPECT_EQ(limited.reasons, limit_slew);
}

TEST(Limiter, LosingAuthorityWithoutANumberIsStillNeutral) {
    Limiter limiter = limiter_at(3e-3);
    EXPECT_EQ(limiter.apply({3e-3}, engaged(nan)).opening_m, 0.0);
    EXPECT_EQ(limiter.apply({0.5e-3}, engaged()).opening_m, 0.5e-3) << "and leaves nothing behind";
}

// Authority before the absolute limit: half of 12 mm is 6 mm and passes; the other way round it would be 3.5 mm.
TEST(Limiter, ScalesBeforeItClipsAndSlewsLast) {
    Limiter limiter = limiter_at(5.5e-3);
    const LimitedCommand scaled = limiter.apply({12e-3}, engaged(0.5));
    EXPECT_DOUBLE_EQ(scaled.opening_m, 6e-3);
    EXPECT_EQ(scaled.reasons, limit_authority);
    const LimitedCommand clipped = limiter.apply({12e-3}, engaged());
    EXPECT_DOUBLE_EQ(clipped.opening_m, 7e-3);
    EXPECT_EQ(clipped.reasons, limit_absolute) << "7 mm is exactly one step from 6 mm";
    Limiter far = limiter_at(-2e-3);
    const LimitedCommand all = far.apply({20e-3}, engaged(0.9));
    EXPECT_DOUBLE_EQ(all.opening_m, -1e-3);
    EXPECT_EQ(all.reasons, limit_authority | limit_absolute | limit_slew);
}

std::string complaint(const LimiterConfig& config) {
    try {
        const Limiter limiter(config);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

TEST(Limiter, LimitThatIsNonePositiveOrNoNumberIsRefusedByName) {
    EXPECT_EQ(complaint(limits), "");
    for (const double bad : {0.0, -1e-3, nan, infinity}) {
        LimiterConfig config = limits;
        config.max_opening_m = bad;
        EXPECT_THAT(complaint(config), testing::HasSubstr("max_opening_m")) << bad;
        config = limits;
        config.max_slew_m_s = bad;
        EXPECT_THAT(complaint(config), testing::HasSubstr("max_slew_m_s")) << bad;
        config = limits;
        config.period_s = bad;
        EXPECT_THAT(complaint(config), testing::HasSubstr("period_s")) << bad;
    }
    LimiterConfig config = limits;
    config.max_opening_m = -0.25;
    EXPECT_THAT(complaint(config), testing::HasSubstr("-0.25 m")) << "names the value";
}

}  // namespace
}  // namespace steadyboom::controllers
