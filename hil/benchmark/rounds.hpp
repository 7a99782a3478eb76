#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace steadyboom::hil::benchmark {

/// CPU time of the calling thread: other programs on a shared machine are not in it.
[[nodiscard]] std::int64_t thread_cpu_ns() noexcept;

/// One thing to be timed. `block_ns` does a fixed amount of work and returns what one unit of it took, ns.
struct Candidate {
    std::string name;
    std::function<double()> block_ns;
};

/// Runs `calls` calls of `call(index)` on this thread and returns the CPU time of one, ns. `call` returns a number that
/// depends on everything it computed; their sum is kept so that nothing can be left out.
template <class Call>
[[nodiscard]] double cpu_ns_per_call(int calls, const Call& call) {
    double sum = 0.0;
    const std::int64_t begin_ns = thread_cpu_ns();
    for (int index = 0; index < calls; ++index) {
        sum += call(index);
    }
    const std::int64_t end_ns = thread_cpu_ns();
    volatile double kept = sum;
    static_cast<void>(kept);
    return static_cast<double>(end_ns - begin_ns) / calls;
}

[[nodiscard]] double median(std::vector<double> values);

/// The smallest value that at least `share` (0 to 1) of `values` do not exceed.
[[nodiscard]] double quantile(std::vector<double> values, double share);

/// What each candidate took in each round. The candidates take turns within a round, so that whatever disturbs the
/// machine disturbs all of them; a ratio is formed inside each round and the median over the rounds is reported.
class Rounds {
  public:
    /// One round that is thrown away, then `rounds`; each starts with another candidate than the one before.
    Rounds(std::span<const Candidate> candidates, int rounds);

    [[nodiscard]] double median_ns(std::size_t candidate) const;
    [[nodiscard]] double median_ratio(std::size_t candidate, std::size_t to) const;

    /// ns of one candidate, by round.
    [[nodiscard]] const std::vector<double>& ns(std::size_t candidate) const { return ns_[candidate]; }

  private:
    std::vector<std::vector<double>> ns_;
};

}  // namespace steadyboom::hil::benchmark
