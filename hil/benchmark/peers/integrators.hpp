#pragma once

#include "plant/crane_dynamics.hpp"

namespace steadyboom::hil::benchmark {

/// Uncontrolled motion over `steps` fixed steps by another library, on our own right-hand side.
using Integrate = plant::CraneState (*)(const plant::CraneDynamics& crane, const plant::CraneState& start,
                                        double step_s, int steps);

/// Boost.odeint's runge_kutta4 by do_step, its state being what our right-hand side takes
/// (vector_space_algebra) or a std::array (array_algebra) that is copied for it.
extern const Integrate odeint_with_eigen;
extern const Integrate odeint_with_array;

/// GSL's rk4 by gsl_odeiv2_driver_apply_fixed_step. This stepper always estimates its error by doubling: a step of h is
/// two steps of h/2, whose result it returns, and one of h to compare, 12 right-hand sides in all. nullptr without GSL.
extern const Integrate gsl_rk4;

}  // namespace steadyboom::hil::benchmark
