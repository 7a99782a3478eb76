#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <Eigen/Core>

namespace steadyboom::plant {

/// The adaptive integrator could not go on: its step fell below what the time's own resolution carries, or the state
/// stopped being finite.
struct IntegrationError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Explicit Runge-Kutta 5(4) of Dormand and Prince (1980) with error control and the fourth-order continuous extension
/// of Hairer, Norsett and Wanner (Solving ODEs I, II.6). Allocates nothing. State is a fixed-size Eigen vector.
template <class State>
class AdaptiveRungeKutta {
  public:
    struct Tolerances {
        double relative = 1e-9;
        State absolute;            ///< one per entry, in the entry's unit
        double max_step_s = 0.01;  ///< keeps the error estimate honest across kinks of the ropes and the soil
    };

    AdaptiveRungeKutta(double t_s, const State& state, const Tolerances& tolerances, double first_step_s = 1e-4)
        : tolerances_(tolerances), begin_s_(t_s), end_s_(t_s), step_s_(first_step_s), begin_(state), end_(state) {
        c_[0] = state;
    }

    [[nodiscard]] double time_s() const noexcept { return end_s_; }
    [[nodiscard]] const State& state() const noexcept { return end_; }
    [[nodiscard]] long accepted_steps() const noexcept { return accepted_; }
    [[nodiscard]] long rejected_steps() const noexcept { return rejected_; }

    /// Takes one accepted step; `rate(t_s, state)`. Throws IntegrationError.
    template <class Rate>
    void advance(const Rate& rate) {
        if (!rate_known_) {
            k_[0] = rate(end_s_, end_);
            rate_known_ = true;
        }
        for (;;) {
            const double h = std::min(step_s_, tolerances_.max_step_s);
            if (!(h > 1e-14 * std::max(1.0, std::abs(end_s_)))) {
                throw IntegrationError(
                    "the adaptive step shrank to nothing; the state is not finite or the tolerance "
                    "cannot be met");
            }
            const State next = stages(rate, h);
            const double error = error_norm(next, h);
            // Order 5: the step that would just have met the tolerance, with a margin, within a factor of five.
            const double factor =
                std::isfinite(error) ? std::clamp(0.9 * std::pow(std::max(error, 1e-10), -0.2), 0.2, 5.0) : 0.2;
            if (error <= 1.0) {
                begin_s_ = end_s_;
                begin_ = end_;
                begin_rate_ = k_[0];
                width_s_ = h;
                end_s_ += h;
                end_ = next;
                make_extension(h);
                k_[0] = k_[6];
                step_s_ = h * factor;
                ++accepted_;
                return;
            }
            step_s_ = h * std::min(1.0, factor);
            ++rejected_;
        }
    }

    /// The solution inside the last accepted step, begin <= t_s <= time_s(); before the first step the start.
    [[nodiscard]] State interpolate(double t_s) const noexcept {
        const double theta = (t_s - begin_s_) / width_s_;
        const double rest = 1.0 - theta;
        return c_[0] + theta * (c_[1] + rest * (c_[2] + theta * (c_[3] + rest * c_[4])));
    }

    /// Replaces the state at the present time (a discontinuity such as an impulse or an end stop).
    void restart(const State& state) noexcept {
        end_ = state;
        rate_known_ = false;
    }

  private:
    template <std::size_t count>
    static std::array<State, count> filled() {
        std::array<State, count> zeros;
        zeros.fill(State::Zero());
        return zeros;
    }

    template <class Rate>
    State stages(const Rate& rate, double h) {
        const State& y = end_;
        k_[1] = rate(end_s_ + h * 1 / 5, State(y + h * (1.0 / 5 * k_[0])));
        k_[2] = rate(end_s_ + h * 3 / 10, State(y + h * (3.0 / 40 * k_[0] + 9.0 / 40 * k_[1])));
        k_[3] = rate(end_s_ + h * 4 / 5, State(y + h * (44.0 / 45 * k_[0] - 56.0 / 15 * k_[1] + 32.0 / 9 * k_[2])));
        k_[4] = rate(end_s_ + h * 8 / 9, State(y + h * (19372.0 / 6561 * k_[0] - 25360.0 / 2187 * k_[1] +
                                                        64448.0 / 6561 * k_[2] - 212.0 / 729 * k_[3])));
        k_[5] = rate(end_s_ + h, State(y + h * (9017.0 / 3168 * k_[0] - 355.0 / 33 * k_[1] + 46732.0 / 5247 * k_[2] +
                                                49.0 / 176 * k_[3] - 5103.0 / 18656 * k_[4])));
        const State next = y + h * (35.0 / 384 * k_[0] + 500.0 / 1113 * k_[2] + 125.0 / 192 * k_[3] -
                                    2187.0 / 6784 * k_[4] + 11.0 / 84 * k_[5]);
        k_[6] = rate(end_s_ + h, next);
        return next;
    }

    [[nodiscard]] double error_norm(const State& next, double h) const {
        const State error = h * (71.0 / 57600 * k_[0] - 71.0 / 16695 * k_[2] + 71.0 / 1920 * k_[3] -
                                 17253.0 / 339200 * k_[4] + 22.0 / 525 * k_[5] - 1.0 / 40 * k_[6]);
        const State scale = tolerances_.absolute + tolerances_.relative * end_.cwiseAbs().cwiseMax(next.cwiseAbs());
        // A plain maxCoeff may pass over a NaN.
        return error.cwiseQuotient(scale).cwiseAbs().template maxCoeff<Eigen::PropagateNaN>();
    }

    void make_extension(double h) {
        const State difference = end_ - begin_;
        const State bulge = h * begin_rate_ - difference;
        c_[0] = begin_;
        c_[1] = difference;
        c_[2] = bulge;
        c_[3] = difference - h * k_[6] - bulge;
        c_[4] = h * (-12715105075.0 / 11282082432 * k_[0] + 87487479700.0 / 32700410799 * k_[2] -
                     10690763975.0 / 1880347072 * k_[3] + 701980252875.0 / 199316789632 * k_[4] -
                     1453857185.0 / 822651844 * k_[5] + 69997945.0 / 29380423 * k_[6]);
    }

    Tolerances tolerances_;
    double begin_s_, end_s_, step_s_;
    double width_s_ = 1.0;
    State begin_, end_;
    State begin_rate_ = State::Zero();
    std::array<State, 7> k_ = filled<7>();
    std::array<State, 5> c_ = filled<5>();
    bool rate_known_ = false;  ///< k_[0] is the rate at end_
    long accepted_ = 0;
    long rejected_ = 0;
};

}  // namespace steadyboom::plant
