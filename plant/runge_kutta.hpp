#pragma once

namespace steadyboom::plant {

/// One classical fourth-order Runge-Kutta step of `h_s` seconds from `t_s`. `rate(t_s, state)` returns d(state)/dt.
template <class State, class Rate>
[[nodiscard]] State runge_kutta_step(const Rate& rate, double t_s, const State& state, double h_s) {
    const double half_s = 0.5 * h_s;
    const State k1 = rate(t_s, state);
    const State k2 = rate(t_s + half_s, State(state + half_s * k1));
    const State k3 = rate(t_s + half_s, State(state + half_s * k2));
    const State k4 = rate(t_s + h_s, State(state + h_s * k3));
    return state + (h_s / 6.0) * (k1 + 2.0 * (k2 + k3) + k4);
}

}  // namespace steadyboom::plant
