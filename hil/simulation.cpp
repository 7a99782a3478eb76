#include "hil/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "hil/true_crane.hpp"
#include "plant/adaptive_runge_kutta.hpp"
#include "plant/runge_kutta.hpp"

namespace steadyboom::hil {

using namespace plant;

namespace {

template <class State>
typename AdaptiveRungeKutta<State>::Tolerances tolerances(double relative) {
    return {.relative = relative, .absolute = State::Constant(0.1 * relative), .max_step_s = 0.01};
}

void check(const SimulationOptions& options) {
    const auto require = [](bool good, const std::string& text) {
        if (!good) {
            throw std::invalid_argument(text);
        }
    };
    require(options.duration_s > 0.0 && std::isfinite(options.duration_s), "the duration must be positive, in s");
    require(options.output_period_s > 0.0 && std::isfinite(options.output_period_s),
            "the output period must be positive, in s");
    require(!options.step_s || (*options.step_s > 0.0 && *options.step_s <= options.duration_s),
            "the step must be positive and no longer than the duration, in s");
    require(options.tolerance >= 1e-13 && options.tolerance <= 1e-2, "the tolerance must be within 1e-13 and 1e-2");
}

template <class Boom>
RunFigures simulate_with(const SimulationOptions& options, const std::function<void(const TruthSample&)>& output) {
    using Crane = CraneDynamicsOf<Boom>;
    using State = typename Crane::State;
    constexpr int piston = Crane::Layout::piston_index;
    const TrueCrane<Boom> true_crane(options.crane_case.crane);
    const Crane& crane = true_crane.dynamics();
    const CraneState rest = true_crane.thesis_equilibrium().state;
    const controllers::Law law(options.law, options.crane_case.gains, rest);
    FigureAccumulator figures(rest, options.duration_s);

    const auto opening_m = [&](const State& x) {
        return crane.actuator().clamp_opening_m(law.command(crane.thesis_state(x)).opening_m);
    };
    const auto rate = [&](double, const State& x) { return crane.derivative(x, opening_m(x)); };
    const auto sample = [&](const State& x, double t_s) { return true_crane.sample(x, opening_m(x), t_s); };
    const auto finite = [](const State& x, double t_s) {
        if (!x.allFinite()) {
            throw IntegrationError("the state is no longer finite at t = " + std::to_string(t_s) +
                                   " s; a fixed step must be shorter than about 6 ms for this crane's fastest mode");
        }
    };

    State state = true_crane.equilibrium().state;
    state[Crane::Layout::velocity_offset + R9_m] = options.crane_case.manoeuvre.brake_rate_m_s();
    const TruthSample start = sample(state, 0.0);
    figures.add(start);
    output(start);

    // Outputs that fall into (t0, t1], in order; the last one is the end of the run itself.
    const auto last_output = static_cast<long>(std::ceil(options.duration_s / options.output_period_s - 1e-9));
    long next_output = 1;
    const auto emit = [&](double t1_s, const auto& interpolate) {
        while (next_output <= last_output) {
            const double due_s =
                std::min(static_cast<double>(next_output) * options.output_period_s, options.duration_s);
            if (due_s > t1_s * (1.0 + 1e-12)) {
                break;
            }
            const TruthSample at_output = sample(interpolate(due_s), due_s);
            figures.add(at_output);
            output(at_output);
            ++next_output;
        }
    };

    if (options.step_s) {
        const double h = *options.step_s;
        const auto steps = static_cast<long>(std::ceil(options.duration_s / h - 1e-9));
        for (long i = 0; i < steps; ++i) {
            const double t0_s = static_cast<double>(i) * h;
            const double t1_s = i + 1 == steps ? std::max(options.duration_s, t0_s + h) : t0_s + h;
            State next = runge_kutta_step(rate, t0_s, state, h);
            next[piston] = crane.actuator().clamp_piston_m(next[piston]);
            finite(next, t1_s);
            const State slope0 = h * rate(t0_s, state);
            const State slope1 = h * rate(t0_s + h, next);
            emit(t1_s, [&](double t_s) -> State {
                const double u = (t_s - t0_s) / h;
                return (1 + 2 * u) * (1 - u) * (1 - u) * state + u * (1 - u) * (1 - u) * slope0 +
                       u * u * (3 - 2 * u) * next - u * u * (1 - u) * slope1;
            });
            state = next;
            figures.add(sample(state, t0_s + h));
        }
    } else {
        AdaptiveRungeKutta<State> integrator(0.0, state, tolerances<State>(options.tolerance));
        while (integrator.time_s() < options.duration_s) {
            integrator.advance(rate);
            finite(integrator.state(), integrator.time_s());
            emit(integrator.time_s(), [&](double t_s) { return integrator.interpolate(t_s); });
            figures.add(sample(integrator.state(), integrator.time_s()));
            const double piston_m = crane.actuator().clamp_piston_m(integrator.state()[piston]);
            if (piston_m != integrator.state()[piston]) {
                State stopped = integrator.state();
                stopped[piston] = piston_m;
                integrator.restart(stopped);
            }
        }
    }
    return figures.figures();
}

}  // namespace

RunFigures simulate(const SimulationOptions& options, const std::function<void(const TruthSample&)>& output) {
    check(options);
    return with_boom(options.crane_case.boom,
                     [&]<class Boom>(std::type_identity<Boom>) { return simulate_with<Boom>(options, output); });
}

}  // namespace steadyboom::hil
