#include <algorithm>
#include <array>

#include <Eigen/Core>
#include <boost/numeric/odeint/algebra/array_algebra.hpp>
#include <boost/numeric/odeint/algebra/vector_space_algebra.hpp>
#include <boost/numeric/odeint/external/eigen/eigen_algebra.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>

#include "hil/benchmark/peers/integrators.hpp"

namespace steadyboom::hil::benchmark {

namespace {

namespace odeint = boost::numeric::odeint;

template <class Stepper, class Rate, class State>
void step(Stepper& stepper, const Rate& rate, State& state, double step_s, int steps) {
    for (int i = 0; i < steps; ++i) {
        stepper.do_step(rate, state, i * step_s, step_s);
    }
}

plant::CraneState with_eigen(const plant::CraneDynamics& crane, const plant::CraneState& start, double step_s,
                             int steps) {
    using State = plant::CraneState;
    odeint::runge_kutta4<State, double, State, double, odeint::vector_space_algebra> stepper;
    const auto rate = [&crane](const State& x, State& rate_out, double) { rate_out = crane.derivative(x, 0.0); };
    State state = start;
    step(stepper, rate, state, step_s, steps);
    return state;
}

plant::CraneState with_array(const plant::CraneDynamics& crane, const plant::CraneState& start, double step_s,
                             int steps) {
    using State = std::array<double, plant::state_count>;
    odeint::runge_kutta4<State, double, State, double, odeint::array_algebra> stepper;
    const auto rate = [&crane](const State& x, State& rate_out, double) {
        Eigen::Map<plant::CraneState> out(rate_out.data());
        out = crane.derivative(Eigen::Map<const plant::CraneState>(x.data()), 0.0);
    };
    State state;
    std::copy(start.begin(), start.end(), state.begin());
    step(stepper, rate, state, step_s, steps);
    return plant::CraneState(Eigen::Map<const plant::CraneState>(state.data()));
}

}  // namespace

const Integrate odeint_with_eigen = with_eigen;
const Integrate odeint_with_array = with_array;

}  // namespace steadyboom::hil::benchmark
