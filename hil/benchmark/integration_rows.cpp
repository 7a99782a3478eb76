#include <algorithm>

#include <fmt/format.h>

#include "hil/benchmark/falling_load.hpp"
#include "hil/benchmark/peers/integrators.hpp"
#include "hil/benchmark/peers/scipy_peer.hpp"
#include "hil/benchmark/rounds.hpp"
#include "hil/benchmark/row.hpp"

namespace steadyboom::hil::benchmark {

namespace {

constexpr double step_s = 1e-3;
constexpr int steps = 1000;       ///< one simulated second
constexpr int scipy_steps = 200;  ///< Python is slow
constexpr double same = 1e-9;     ///< the same method and step: only rounding may differ

/// Simulated seconds per second of CPU time, from the time of one step.
Figure speed(const std::string& name, double step_ns) {
    return {name, step_s * 1e9 / step_ns, "simulated s/s"};
}

double our_step_ns(const FallingLoad& work, int count) {
    return cpu_ns_per_call(1, [&](int) { return simulate(work.crane, work.start, step_s, count).sum(); }) / count;
}

double peer_step_ns(const FallingLoad& work, Integrate integrate) {
    return cpu_ns_per_call(1, [&](int) { return integrate(work.crane, work.start, step_s, steps).sum(); }) / steps;
}

Measurement measure_odeint(int rounds) {
    const FallingLoad work;
    const plant::CraneState ours = simulate(work.crane, work.start, step_s, steps);
    const double off = std::max(distance(odeint_with_eigen(work.crane, work.start, step_s, steps), ours),
                                distance(odeint_with_array(work.crane, work.start, step_s, steps), ours));
    if (!(off < same)) {
        return Measurement::disagreement(fmt::format("after {} steps the states are {:.1e} apart", steps, off));
    }
    const Candidate candidates[] = {{"ours", [&] { return our_step_ns(work, steps); }},
                                    {"odeint, Eigen state", [&] { return peer_step_ns(work, odeint_with_eigen); }},
                                    {"odeint, array state", [&] { return peer_step_ns(work, odeint_with_array); }}};
    const Rounds timed(candidates, rounds);
    return {.value = std::min(timed.median_ratio(1, 0), timed.median_ratio(2, 0)),
            .figures = {speed("ours", timed.median_ns(0)), speed("odeint, Eigen state", timed.median_ns(1)),
                        speed("odeint, array state", timed.median_ns(2))},
            .remark = "against the faster of the two"};
}

Measurement measure_gsl(int rounds) {
    if (gsl_rk4 == nullptr) {
        return Measurement::absence("built without GSL (libgsl-dev)");
    }
    const FallingLoad work;
    const double off = distance(gsl_rk4(work.crane, work.start, step_s, steps),
                                simulate(work.crane, work.start, 0.5 * step_s, 2 * steps));
    if (!(off < same)) {
        return Measurement::disagreement(
            fmt::format("after {} steps GSL is {:.1e} from twice as many steps of half the size", steps, off));
    }
    const Candidate candidates[] = {
        {"ours", [&] { return our_step_ns(work, steps); }},
        {"GSL", [&] { return peer_step_ns(work, gsl_rk4); }},
        {"GSL, its half steps being ours", [&] {
             return cpu_ns_per_call(
                        1, [&](int) { return gsl_rk4(work.crane, work.start, 2.0 * step_s, steps / 2).sum(); }) /
                    steps;
         }}};
    const Rounds timed(candidates, rounds);
    return {.value = timed.median_ratio(1, 0),
            .figures = {speed("ours", timed.median_ns(0)),
                        speed("GSL", timed.median_ns(1)),
                        {"times faster at the same accuracy, GSL taking 2 ms", timed.median_ratio(2, 0), ""}},
            .remark = "GSL's rk4 doubles each step to estimate its error"};
}

Measurement measure_scipy(int rounds) {
    const FallingLoad work;
    const std::unique_ptr<ScipyPeer> scipy = ScipyPeer::start(work.crane.parameters());
    if (!scipy) {
        return Measurement::absence("/usr/bin/python3 has no NumPy and SciPy (python3-numpy, python3-scipy)");
    }
    constexpr double duration_s = step_s * scipy_steps;
    // RK45's error is then a little larger than that of RK4 with 1 ms.
    constexpr double relative = 3e-6;
    constexpr double absolute = 3e-8;
    const plant::CraneState ours = simulate(work.crane, work.start, step_s, scipy_steps);
    const plant::CraneState fine = simulate(work.crane, work.start, step_s / 32.0, 32 * scipy_steps);
    const double rk4_off = distance(scipy->rk4(work.start, step_s, scipy_steps).end, ours);
    if (!(rk4_off < same)) {
        return Measurement::disagreement(fmt::format("after {} steps NumPy's RK4 is {:.1e} off", scipy_steps, rk4_off));
    }
    const double our_error = distance(ours, fine);
    const double rk45_error = distance(scipy->rk45(work.start, duration_s, relative, absolute).end, fine);
    if (!(rk45_error < 10.0 * our_error)) {
        return Measurement::disagreement(
            fmt::format("RK45's error is {:.1e}, that of RK4 {:.1e}", rk45_error, our_error));
    }
    const Candidate candidates[] = {
        {"ours", [&] { return our_step_ns(work, scipy_steps); }},
        {"NumPy RK4", [&] { return scipy->rk4(work.start, step_s, scipy_steps).cpu_ns / scipy_steps; }},
        {"SciPy RK45", [&] { return scipy->rk45(work.start, duration_s, relative, absolute).cpu_ns / scipy_steps; }}};
    const Rounds timed(candidates, rounds);
    return {.value = std::min(timed.median_ratio(1, 0), timed.median_ratio(2, 0)),
            .figures = {speed("ours", timed.median_ns(0)),
                        speed("NumPy RK4", timed.median_ns(1)),
                        speed("SciPy RK45", timed.median_ns(2)),
                        {"error of RK4 1 ms", our_error, ""},
                        {"error of RK45", rk45_error, ""}},
            .remark = scipy->versions() + "; against the faster of RK4 and RK45"};
}

}  // namespace

std::vector<Row> integration_rows() {
    const std::string subject = "simulated s per CPU s, RK4 1 ms, times";
    return {
        {"odeint", subject, "Boost.odeint runge_kutta4", {.at_most = false, .must = 0.9, .aim = 1.0}, measure_odeint},
        {"gsl", subject, "GSL rk4", {.at_most = false, .must = 2.0, .aim = 2.5}, measure_gsl},
        {"scipy", subject, "NumPy and SciPy", {.at_most = false, .must = 80.0, .aim = 150.0}, measure_scipy}};
}

}  // namespace steadyboom::hil::benchmark
