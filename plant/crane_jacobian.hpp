#pragma once

#include "plant/crane_dynamics.hpp"

namespace steadyboom::plant {

/// Parameters of the crane that no weighing at rest tells exactly, and whose slopes the Jacobian has beside the
/// states'.
enum UncertainParameter : int {
    soil_log_modulus,         ///< ln G: stiffness goes with G, radiation damping with its root
    pendent_log_stiffness,    ///< ln K_WRP about the tension at rest: the standing crane does not show it
    load_line_log_stiffness,  ///< ln K_WRL likewise
    uncertain_parameter_count
};

/// How the derivative of the crane's state depends on the state and on uncertain parameters. Rows are contiguous.
struct CraneJacobian {
    static constexpr int column_count = state_count + uncertain_parameter_count;
    using Columns = Eigen::Matrix<double, state_count, column_count, Eigen::RowMajor>;

    CraneState derivative;  ///< the right-hand side itself
    Columns columns;        ///< d(derivative)/d(state), then d(derivative)/d(parameter); units of the two
};

/// Tensions about which the rope stiffnesses are uncertain, N: at them a softer rope is only a longer one.
struct RestTensions {
    double pendent_N = 0.0;
    double load_line_N = 0.0;
};

/// Analytic Jacobian of CraneDynamics::derivative at `state`. With F = M p'' - Q the forces that are missing,
///
///     dp''/dx = -M^-1 dF/dx,   d/dp of a body's part of F = m (J' dr''/dp + H : r''),   d/dv = 2 m J' J',
///     dr''/dp = J''            because d/dp of a second time derivative is the second time derivative of d/dp
///
/// It follows the mode: slack ropes, lifted and tilting tracks, end stops. Exactly on a kink it is the slope of the
/// side that the right-hand side computes with.
void crane_jacobian(const CraneDynamics& crane, const CraneState& state, double valve_opening_m,
                    const RestTensions& rest, CraneJacobian& result) noexcept;

}  // namespace steadyboom::plant
