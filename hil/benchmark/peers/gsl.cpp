#include "hil/benchmark/peers/integrators.hpp"

#ifdef STEADYBOOM_WITH_GSL

#include <memory>
#include <stdexcept>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

namespace steadyboom::hil::benchmark {

namespace {

int rate(double, const double state[], double rate_out[], void* crane) {
    const auto& dynamics = *static_cast<const plant::CraneDynamics*>(crane);
    Eigen::Map<plant::CraneState> out(rate_out);
    out = dynamics.derivative(Eigen::Map<const plant::CraneState>(state), 0.0);
    return GSL_SUCCESS;
}

plant::CraneState integrate(const plant::CraneDynamics& crane, const plant::CraneState& start, double step_s,
                            int steps) {
    gsl_odeiv2_system system{rate, nullptr, plant::state_count, const_cast<plant::CraneDynamics*>(&crane)};
    const std::unique_ptr<gsl_odeiv2_driver, decltype(&gsl_odeiv2_driver_free)> driver(
        gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk4, step_s, 1.0, 0.0), gsl_odeiv2_driver_free);
    plant::CraneState state = start;
    double t_s = 0.0;
    if (gsl_odeiv2_driver_apply_fixed_step(driver.get(), &t_s, step_s, static_cast<unsigned long>(steps),
                                           state.data()) != GSL_SUCCESS) {
        throw std::runtime_error("GSL's rk4 gave up");
    }
    return state;
}

}  // namespace

const Integrate gsl_rk4 = integrate;

}  // namespace steadyboom::hil::benchmark

#else

namespace steadyboom::hil::benchmark {

const Integrate gsl_rk4 = nullptr;

}  // namespace steadyboom::hil::benchmark

#endif
