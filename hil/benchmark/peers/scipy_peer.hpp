#pragma once

#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "plant/crane_dynamics.hpp"

namespace steadyboom::hil::benchmark {

/// The crane written in Python with NumPy (crane_peer.py), in a process of its own that waits for work on a pipe.
/// It derives its mass matrix from the Jacobians of the bodies, so it also checks our hand-derived one.
class ScipyPeer {
  public:
    /// nullptr where /usr/bin/python3 cannot import NumPy and SciPy. Throws std::runtime_error when it cannot start.
    static std::unique_ptr<ScipyPeer> start(const plant::CraneParameters& crane);

    ScipyPeer(const ScipyPeer&) = delete;
    ScipyPeer& operator=(const ScipyPeer&) = delete;
    ~ScipyPeer();

    [[nodiscard]] const std::string& versions() const noexcept { return versions_; }

    struct Run {
        plant::CraneState end;
        double cpu_ns;  ///< thread CPU time of the integration alone, as the child measured it
    };
    /// Fixed-step RK4 in NumPy.
    [[nodiscard]] Run rk4(const plant::CraneState& start, double step_s, int steps);
    /// scipy.integrate.solve_ivp(method="RK45").
    [[nodiscard]] Run rk45(const plant::CraneState& start, double duration_s, double relative, double absolute);

  private:
    ScipyPeer(int pid, int to_child, int from_child);
    int end() noexcept;
    [[nodiscard]] std::optional<nlohmann::json> exchange(const nlohmann::json& request);
    [[nodiscard]] Run run(nlohmann::json request, const plant::CraneState& start);

    int pid_;
    int to_child_;
    int from_child_;
    std::string unread_;
    std::string versions_;
};

}  // namespace steadyboom::hil::benchmark
