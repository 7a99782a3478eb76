#include "runtime/duration_histogram.hpp"

#include <algorithm>
#include <cmath>

namespace steadyboom::runtime {

std::int64_t DurationHistogram::upper_edge_ns(std::size_t bucket) noexcept {
    if (bucket < 2 * parts) {
        return static_cast<std::int64_t>(bucket);
    }
    const std::size_t octave = (bucket >> part_bits) - 1;
    const std::uint64_t lower = (bucket - (octave << part_bits)) << octave;
    return static_cast<std::int64_t>(lower + (std::uint64_t{1} << octave) - 1);
}

std::uint64_t DurationHistogram::count() const noexcept {
    std::uint64_t sum = 0;
    for (const auto& bucket : buckets_) {
        sum += bucket.load(std::memory_order_relaxed);
    }
    return sum;
}

std::int64_t DurationHistogram::quantile_ns(double share) const noexcept {
    const auto total = static_cast<double>(count());
    const double wanted = std::max(1.0, std::ceil(std::clamp(share, 0.0, 1.0) * total));
    double below = 0.0;
    std::int64_t edge_ns = 0;
    for (std::size_t i = 0; i < buckets_.size() && below < wanted; ++i) {
        const std::uint64_t here = buckets_[i].load(std::memory_order_relaxed);
        if (here > 0) {
            below += static_cast<double>(here);
            edge_ns = upper_edge_ns(i);
        }
    }
    return edge_ns;
}

}  // namespace steadyboom::runtime
