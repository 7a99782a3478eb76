#include "hil/virtual_crane.hpp"

#include <algorithm>
#include <cmath>

#include "hil/true_crane.hpp"
#include "plant/runge_kutta.hpp"
#include "plant/sensors.hpp"

namespace steadyboom::hil {

using namespace plant;

namespace {

CraneParameters with_nonlinear_valve(CraneParameters crane) {
    crane.actuator.valve_model = ValveModel::nonlinear;
    return crane;
}

}  // namespace

/// The crane's state with its spool's, and how it moves, whatever the boom.
class VirtualCrane::Motion {
  public:
    virtual ~Motion() = default;
    [[nodiscard]] virtual Equilibrium equilibrium() const noexcept = 0;
    virtual void advance(const VirtualValve& valve, double target_m, double step_s) noexcept = 0;
    virtual void brake(double rate_m_s) noexcept = 0;
    [[nodiscard]] virtual double spool_m() const noexcept = 0;
    [[nodiscard]] virtual SensorVector sensors() const noexcept = 0;
    [[nodiscard]] virtual TruthSample truth(double t_s) const noexcept = 0;
};

template <class Boom>
class VirtualCrane::MotionOf final : public Motion {
  public:
    explicit MotionOf(const CraneParameters& parameters)
        : crane_(with_nonlinear_valve(parameters)), travel_m_(parameters.actuator.spool_travel_m) {
        state_.template head<Layout::state_count>() = crane_.equilibrium().state;
    }

    [[nodiscard]] Equilibrium equilibrium() const noexcept override { return crane_.thesis_equilibrium(); }

    void advance(const VirtualValve& valve, double target_m, double step_s) noexcept override {
        const Actuator& actuator = crane_.dynamics().actuator();
        const bool flows = valve.cutoff_open();
        const auto rate = [&](double, const State& x) {
            State derivative;
            derivative.template head<Layout::state_count>() = crane_.dynamics().derivative(
                x.template head<Layout::state_count>(), flows ? actuator.clamp_opening_m(x[spool_index]) : 0.0);
            derivative[spool_index] = x[spool_rate_index];
            derivative[spool_rate_index] = valve.spool_acceleration_m_s2(x[spool_index], x[spool_rate_index], target_m);
            return derivative;
        };
        state_ = runge_kutta_step(rate, 0.0, state_, step_s);
        state_[Layout::piston_index] = actuator.clamp_piston_m(state_[Layout::piston_index]);
        if (std::abs(state_[spool_index]) > travel_m_) {
            state_[spool_index] = std::copysign(travel_m_, state_[spool_index]);
            state_[spool_rate_index] = 0.0;
        }
    }

    void brake(double rate_m_s) noexcept override { state_[Layout::velocity_offset + R9_m] = rate_m_s; }

    [[nodiscard]] double spool_m() const noexcept override { return state_[spool_index]; }

    [[nodiscard]] SensorVector sensors() const noexcept override {
        return ideal_sensors(crane_.dynamics(), state_.template head<Layout::state_count>(), state_[spool_index]);
    }

    [[nodiscard]] TruthSample truth(double t_s) const noexcept override {
        return crane_.sample(state_.template head<Layout::state_count>(), state_[spool_index], t_s);
    }

  private:
    using Layout = typename CraneDynamicsOf<Boom>::Layout;
    static constexpr int spool_index = Layout::state_count;
    static constexpr int spool_rate_index = Layout::state_count + 1;
    using State = Eigen::Matrix<double, Layout::state_count + 2, 1>;

    TrueCrane<Boom> crane_;
    double travel_m_;
    State state_ = State::Zero();
};

VirtualCrane::VirtualCrane(const VirtualCraneConfig& config)
    : motion_(with_boom(config.boom,
                        [&]<class Boom>(std::type_identity<Boom>) -> std::unique_ptr<Motion> {
                            return std::make_unique<MotionOf<Boom>>(config.crane);
                        })),
      equilibrium_(motion_->equilibrium()),
      network_(config.network),
      valve_(config.crane.actuator, config.step_s),
      noise_sigma_(sensor_noise(config.crane.actuator.spool_travel_m)),
      step_s_(config.step_s),
      random_(config.seed) {
    outbox_.reserve(2 * drivers::message_count);
}
VirtualCrane::~VirtualCrane() = default;

void VirtualCrane::receive(std::span<const drivers::CanFrame> frames, std::int64_t now_ns) noexcept {
    network_.receive(frames, now_ns);
}

SensorVector VirtualCrane::noisy_sensors() noexcept {
    SensorVector sensors = motion_->sensors();
    for (int i = 0; i < sensor_count; ++i) {
        sensors[i] += noise_sigma_[i] * normal_(random_);
    }
    // Load pin and pressure transducer read zero on a slack rope, not less than nothing.
    sensors[line_tension_N] = std::max(0.0, sensors[line_tension_N]);
    sensors[load_pressure_Pa] = std::max(0.0, sensors[load_pressure_Pa]);
    return sensors;
}

std::span<const drivers::CanFrame> VirtualCrane::frames_to_send(std::int64_t now_ns) noexcept {
    outbox_.clear();
    const auto append = [&](std::span<const drivers::CanFrame> frames) {
        outbox_.insert(outbox_.end(), frames.begin(), frames.end());
    };
    network_.set_fault(drivers::Device::servo_valve, drivers::emergency_rpdo_timeout, valve_.timed_out());
    append(network_.housekeeping(now_ns));
    if (network_.sync_pending() || network_.timer_due(now_ns)) {
        append(network_.answer_sync(noisy_sensors(),
                                    {.status = valve_.status(motion_->spool_m()),
                                     .cutoff_open = valve_.cutoff_open(),
                                     .emergency_stop_healthy = true},
                                    now_ns));
    }
    return outbox_;
}

void VirtualCrane::advance(std::int64_t now_ns) noexcept {
    valve_.obey(network_.valve_order(), motion_->spool_m(), now_ns);
    motion_->advance(valve_, valve_.next_target_m(), step_s_);
}

void VirtualCrane::brake(double rate_m_s) noexcept {
    motion_->brake(rate_m_s);
}

TruthSample VirtualCrane::truth(double t_s) const noexcept {
    return motion_->truth(t_s);
}

}  // namespace steadyboom::hil
