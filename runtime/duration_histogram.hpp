#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace steadyboom::runtime {

/// Counts durations in buckets of logarithmic octaves, each cut into 32 equal parts: fixed memory, and a quantile read
/// from it is never below the true one and at most 1/32 (3.1 %) above. One thread records; any thread reads at any
/// time, without locks, a state that is exact for a writer at rest and at most a few samples torn for a running one.
class DurationHistogram {
  public:
    /// Wait-free. Negative durations count as 0, those above 2^40 ns (18 min) as that.
    void record(std::int64_t duration_ns) noexcept {
        std::atomic<std::uint64_t>& bucket = buckets_[bucket_of(duration_ns)];
        bucket.store(bucket.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    }

    [[nodiscard]] std::uint64_t count() const noexcept;

    /// The smallest bucket's upper edge that at least `share` of all durations do not exceed; 0 when there are none.
    /// `share` from 0 to 1: 0.5 is the median, 0.999 is p99.9.
    [[nodiscard]] std::int64_t quantile_ns(double share) const noexcept;

  private:
    static constexpr int part_bits = 5;
    static constexpr std::uint64_t parts = 1U << part_bits;
    static constexpr int largest_bits = 40;
    static constexpr std::uint64_t largest_ns = (std::uint64_t{1} << largest_bits) - 1;

    static constexpr std::size_t bucket_of(std::int64_t duration_ns) noexcept {
        const std::uint64_t ns = duration_ns < 0 ? 0
                                 : static_cast<std::uint64_t>(duration_ns) > largest_ns
                                     ? largest_ns
                                     : static_cast<std::uint64_t>(duration_ns);
        if (ns < parts) {
            return ns;
        }
        const int octave = static_cast<int>(std::bit_width(ns)) - 1 - part_bits;
        return (static_cast<std::size_t>(octave) << part_bits) + static_cast<std::size_t>(ns >> octave);
    }
    static std::int64_t upper_edge_ns(std::size_t bucket) noexcept;

    std::array<std::atomic<std::uint64_t>, (largest_bits - part_bits + 1) * parts> buckets_{};
};

}  // namespace steadyboom::runtime
