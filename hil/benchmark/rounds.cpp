#include "hil/benchmark/rounds.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace steadyboom::hil::benchmark {

std::int64_t thread_cpu_ns() noexcept {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

double median(std::vector<double> values) {
    return quantile(std::move(values), 0.5);
}

double quantile(std::vector<double> values, double share) {
    const double rank = std::ceil(share * static_cast<double>(values.size()));
    const auto index = std::min(values.size() - 1, static_cast<std::size_t>(std::max(0.0, rank - 1.0)));
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
    return values[index];
}

Rounds::Rounds(std::span<const Candidate> candidates, int rounds) : ns_(candidates.size()) {
    for (const Candidate& candidate : candidates) {
        static_cast<void>(candidate.block_ns());
    }
    for (std::size_t round = 0; round < static_cast<std::size_t>(rounds); ++round) {
        for (std::size_t turn = 0; turn < candidates.size(); ++turn) {
            const std::size_t candidate = (round + turn) % candidates.size();
            ns_[candidate].push_back(candidates[candidate].block_ns());
        }
    }
}

double Rounds::median_ns(std::size_t candidate) const {
    return median(ns_[candidate]);
}

double Rounds::median_ratio(std::size_t candidate, std::size_t to) const {
    std::vector<double> ratios;
    for (std::size_t round = 0; round < ns_[candidate].size(); ++round) {
        ratios.push_back(ns_[candidate][round] / ns_[to][round]);
    }
    return median(std::move(ratios));
}

}  // namespace steadyboom::hil::benchmark
