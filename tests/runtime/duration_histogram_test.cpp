#include "runtime/duration_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

namespace steadyboom::runtime {
namespace {

std::int64_t exact_quantile(std::vector<std::int64_t> durations, double share) {
    std::sort(durations.begin(), durations.end());
    const auto rank = static_cast<std::size_t>(std::max(1.0, std::ceil(share * static_cast<double>(durations.size()))));
    return durations[rank - 1];
}

TEST(DurationHistogram, QuantilesAreTheSortedDatasOrAtMostOneThirtySecondAbove) {
    std::mt19937_64 random(7);
    std::lognormal_distribution<double> durations(10.0, 2.5);
    DurationHistogram histogram;
    std::vector<std::int64_t> all;
    for (int i = 0; i < 100'000; ++i) {
        all.push_back(static_cast<std::int64_t>(durations(random)));
        histogram.record(all.back());
    }
    for (const double share : {0.0, 0.001, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999, 1.0}) {
        const std::int64_t exact_ns = exact_quantile(all, share);
        EXPECT_GE(histogram.quantile_ns(share), exact_ns) << share;
        EXPECT_LE(histogram.quantile_ns(share), exact_ns + exact_ns / 32) << share;
    }
    EXPECT_EQ(histogram.count(), all.size());
}

TEST(DurationHistogram, EveryBucketEdgeKeepsItsPlace) {
    for (int bit = 0; bit < 40; ++bit) {
        for (const std::int64_t off : {-1, 0, 1}) {
            const std::int64_t duration_ns = (std::int64_t{1} << bit) + off;
            DurationHistogram histogram;
            histogram.record(duration_ns);
            EXPECT_GE(histogram.quantile_ns(1.0), duration_ns);
            EXPECT_LE(histogram.quantile_ns(1.0), duration_ns + duration_ns / 32);
        }
    }
}

TEST(DurationHistogram, DurationsOffTheScaleCountAtItsEnds) {
    DurationHistogram histogram;
    histogram.record(-5);
    EXPECT_EQ(histogram.quantile_ns(1.0), 0);
    histogram.record(std::numeric_limits<std::int64_t>::max());
    EXPECT_EQ(histogram.quantile_ns(1.0), (std::int64_t{1} << 40) - 1);
    EXPECT_EQ(histogram.count(), 2U);
}

TEST(DurationHistogram, AnEmptyOneSaysZero) {
    EXPECT_EQ(DurationHistogram().quantile_ns(0.99), 0);
}

TEST(DurationHistogram, ReadsWhileAnotherThreadRecordsNeverGoBack) {
    DurationHistogram histogram;
    std::thread writer([&] {
        for (int i = 0; i < 200'000; ++i) {
            histogram.record(i % 1000);
        }
    });
    std::uint64_t before = 0;
    while (before < 200'000) {
        const std::uint64_t now = histogram.count();
        ASSERT_GE(now, before);
        ASSERT_LE(histogram.quantile_ns(0.999), 1023);
        before = now;
    }
    writer.join();
}

}  // namespace
}  // namespace steadyboom::runtime
