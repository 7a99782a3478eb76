#pragma once

#include <cmath>

#include "plant/adaptive_runge_kutta.hpp"
#include "plant/crane_dynamics.hpp"
#include "plant/equilibrium.hpp"

namespace steadyboom::plant {

/// The manoeuvre's start: at rest but for the load line's paying-out rate after a fall through `load_drop_m`.
template <class Boom>
[[nodiscard]] StateOf<Boom> after_load_drop(const CraneDynamicsOf<Boom>& crane, double load_drop_m) {
    StateOf<Boom> start = find_equilibrium(crane).state;
    start[CraneDynamicsOf<Boom>::Layout::velocity_offset + R9_m] = std::sqrt(2.0 * gravity_m_s2 * load_drop_m);
    return start;
}

/// Integrates the crane under `law(t_s, state)` (spool opening, m, clamped here to its travel) and calls
/// `visit(t_s, state, opening_m)` every `period_s` from 0 to `duration_s`.
template <class Law, class Visit>
void run_crane(const CraneDynamics& crane, const CraneState& start, double duration_s, double period_s,
               double tolerance, const Law& law, const Visit& visit) {
    const auto opening_m = [&](double t_s, const CraneState& x) {
        return crane.actuator().clamp_opening_m(law(t_s, x));
    };
    const auto rate = [&](double t_s, const CraneState& x) { return crane.derivative(x, opening_m(t_s, x)); };
    AdaptiveRungeKutta<CraneState>::Tolerances tolerances;
    tolerances.relative = tolerance;
    tolerances.absolute.setConstant(0.1 * tolerance);
    AdaptiveRungeKutta<CraneState> integrator(0.0, start, tolerances);
    visit(0.0, start, opening_m(0.0, start));
    const long samples = std::lround(duration_s / period_s);
    for (long sample = 1; sample <= samples;) {
        integrator.advance(rate);
        for (; sample <= samples && static_cast<double>(sample) * period_s <= integrator.time_s(); ++sample) {
            const double t_s = static_cast<double>(sample) * period_s;
            const CraneState x = integrator.interpolate(t_s);
            visit(t_s, x, opening_m(t_s, x));
        }
        CraneState end = integrator.state();
        if (std::abs(end[piston_index]) > crane.parameters().actuator.piston_travel_m) {
            end[piston_index] = crane.actuator().clamp_piston_m(end[piston_index]);
            integrator.restart(end);
        }
    }
}

}  // namespace steadyboom::plant
