#pragma once

#include "controllers/crane_estimate.hpp"
#include "plant/crane_dynamics.hpp"
#include "plant/crane_measurement.hpp"

namespace steadyboom::controllers {

/// What the observer assumes beyond the crane model.
struct ObserverConfig {
    double period_s = 0.005;  ///< of the control tick
    int substeps = 2;         ///< Runge-Kutta steps of the embedded model per tick
    plant::SensorVector sensor_sigma = plant::SensorVector::Zero();  ///< noise and quantisation, units of Sensor
};

/// State observer with the embedded nonlinear crane model: a Kalman filter whose prior covariance is the steady one of
/// the crane about its equilibrium.
///
///     x(k|k)   = x(k|k-1) + K (y(k) - h(x(k|k-1)))       correct(), with whatever channels this tick brought
///     x(k+1|k) = f(x(k|k), u(k))                         predict(), Runge-Kutta 4 on the crane model, u applied
///     P        = F (P - P H^T (H P H^T + R)^-1 H P) F^T + Q      iterated to its limit at construction
///
/// F and H are central differences of f and h at the equilibrium. h is the nonlinear sensor model, so a slack rope in
/// the model and a tension of zero on the sensor agree and correct nothing. Line length and spool are not corrected
/// with: the one is a parameter of the model, the other follows the command within a tick.
///
/// Assumptions: the model's valve is linear and follows the command at once; process noise (observer.cpp) covers spool
/// lag, the brake's shock and moderate parameter errors.
class Observer {
  public:
    /// Starts at rest at `equilibrium` of the embedded model. Throws std::invalid_argument for a bad configuration and
    /// std::runtime_error if the covariance does not converge.
    Observer(const plant::CraneDynamics& model, const plant::CraneState& equilibrium, const ObserverConfig& config);

    /// Takes in the samples of the instant that the newest state belongs to. Channels that are not fresh are left out.
    void correct(const plant::CraneMeasurement& measured) noexcept;

    /// Moves the state on by one period with the opening of a linear valve that gives the flow applied during it, m.
    void predict(double opening_m) noexcept;

    /// The newest state moved on by `lead_s` with a linear-valve opening of `opening_m`; changes nothing.
    [[nodiscard]] plant::CraneState ahead(double opening_m, double lead_s) const noexcept;

    [[nodiscard]] const CraneEstimate& estimate() const noexcept { return estimate_; }

    /// One sigma of the prior (before the correction) at the equilibrium, units of the state.
    [[nodiscard]] plant::CraneState prior_sigma() const noexcept;

  private:
    using Covariance = Eigen::Matrix<double, plant::state_count, plant::state_count>;
    using SensorRows = Eigen::Matrix<double, plant::sensor_count, plant::state_count>;

    plant::CraneDynamics model_;
    double step_s_;
    int substeps_;
    plant::SensorVector variance_;
    SensorRows sensor_rows_;
    Covariance prior_;
    CraneEstimate estimate_;
};

}  // namespace steadyboom::controllers
