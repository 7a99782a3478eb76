#include "controllers/observer.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "plant/runge_kutta.hpp"
#include "plant/sensors.hpp"

namespace steadyboom::controllers {

using namespace plant;

namespace {

constexpr std::array corrected_channels = {strain_lower_microstrain, strain_upper_microstrain, boom_angle_rad,
                                           line_tension_N,           line_angle_rad,           Sensor::piston_m,
                                           load_pressure_Pa};

CraneState model_step(const CraneDynamics& model, const CraneState& state, double opening_m, double step_s,
                      int substeps) noexcept {
    const auto rate = [&](double, const CraneState& x) { return model.derivative(x, opening_m); };
    CraneState next = state;
    for (int i = 0; i < substeps; ++i) {
        next = runge_kutta_step(rate, 0.0, next, step_s);
    }
    next[piston_index] = model.actuator().clamp_piston_m(next[piston_index]);
    return next;
}

/// One sigma per square root of a second of what the model does not know: shocks of the load line (the brake event
/// alone is 1 to 2.5 m/s), unmodelled soil, valve and spool.
CraneState process_sigma() {
    CraneState sigma = CraneState::Constant(1e-5);
    sigma[velocity_offset + R1_m] = 1e-2;
    sigma[velocity_offset + phi2_rad] = 2e-3;
    sigma[velocity_offset + R9_m] = 2.0;
    sigma[velocity_offset + q1_m] = 1e-2;
    sigma[velocity_offset + q2_m] = 1e-2;
    sigma[velocity_offset + phi6_rad] = 2e-3;
    sigma[velocity_offset + phi9_rad] = 2e-3;
    sigma[piston_index] = 2e-3;
    return sigma;
}

}  // namespace

Observer::Observer(const CraneDynamics& model, const CraneState& equilibrium, const ObserverConfig& config)
    : model_(model),
      step_s_(config.period_s / config.substeps),
      substeps_(config.substeps),
      variance_(config.sensor_sigma.cwiseAbs2()) {
    const auto positive = [](double value) { return value > 0.0 && std::isfinite(value); };
    if (!positive(config.period_s) || config.substeps < 1) {
        throw std::invalid_argument("observer: period_s and substeps must be positive and finite");
    }
    for (const Sensor channel : corrected_channels) {
        if (!positive(config.sensor_sigma[channel])) {
            throw std::invalid_argument("observer: every sensor's sigma must be positive and finite");
        }
    }
    estimate_.state = equilibrium;

    constexpr double difference = 1e-7;
    Covariance F;
    for (int i = 0; i < state_count; ++i) {
        CraneState above = equilibrium;
        CraneState below = equilibrium;
        above[i] += difference;
        below[i] -= difference;
        F.col(i) =
            (model_step(model_, above, 0.0, step_s_, substeps_) - model_step(model_, below, 0.0, step_s_, substeps_)) /
            (2.0 * difference);
        sensor_rows_.col(i) =
            (ideal_sensors(model_, above, 0.0) - ideal_sensors(model_, below, 0.0)) / (2.0 * difference);
    }

    const Covariance Q = (process_sigma().cwiseAbs2() * config.period_s).asDiagonal();
    prior_ = Q * 100.0;
    constexpr int max_iterations = 100'000;
    constexpr double settled = 1e-9;
    for (int iteration = 0;; ++iteration) {
        Covariance P = prior_;
        for (const Sensor channel : corrected_channels) {
            const CraneState PH = P * sensor_rows_.row(channel).transpose();
            P -= PH * PH.transpose() / (sensor_rows_.row(channel).dot(PH) + variance_[channel]);
        }
        Covariance next = F * P * F.transpose() + Q;
        next = 0.5 * (next + next.transpose().eval());
        const double change =
            ((next - prior_).diagonal().cwiseAbs().cwiseQuotient(next.diagonal().cwiseAbs())).maxCoeff();
        prior_ = next;
        if (change < settled) {
            break;
        }
        if (iteration == max_iterations || !prior_.allFinite()) {
            throw std::runtime_error("observer: the steady covariance does not converge for this crane and rate");
        }
    }
}

void Observer::correct(const CraneMeasurement& measured) noexcept {
    // One channel after the other is the same as all at once, needs no matrix inverse and takes any subset.
    const SensorVector expected = ideal_sensors(model_, estimate_.state, 0.0);
    Covariance P = prior_;
    CraneState correction = CraneState::Zero();
    estimate_.nis = 0.0;
    estimate_.used_channels = 0;
    for (const Sensor channel : corrected_channels) {
        if (!measured.fresh(channel)) {
            continue;
        }
        const auto row = sensor_rows_.row(channel);
        const CraneState PH = P * row.transpose();
        const double innovation_variance = row.dot(PH) + variance_[channel];
        const double innovation = measured.value[channel] - expected[channel] - row.dot(correction);
        correction += PH * (innovation / innovation_variance);
        P.noalias() -= PH * (PH / innovation_variance).transpose();
        estimate_.nis += innovation * innovation / innovation_variance;
        ++estimate_.used_channels;
    }
    estimate_.state += correction;
    estimate_.state[piston_index] = model_.actuator().clamp_piston_m(estimate_.state[piston_index]);
    estimate_.finite = estimate_.state.allFinite();
}

void Observer::predict(double opening_m) noexcept {
    estimate_.state = model_step(model_, estimate_.state, opening_m, step_s_, substeps_);
    estimate_.finite = estimate_.state.allFinite();
}

CraneState Observer::ahead(double opening_m, double lead_s) const noexcept {
    return model_step(model_, estimate_.state, opening_m, lead_s / substeps_, substeps_);
}

CraneState Observer::prior_sigma() const noexcept {
    return prior_.diagonal().cwiseSqrt();
}

}  // namespace steadyboom::controllers
