#pragma once

#include <random>

#include "plant/crane_dynamics.hpp"

namespace steadyboom::plant {

/// How the track of a random state meets the ground.
enum class Contact { full, tilting, lifted, level };

/// Seeded states far beyond what a run reaches, yet each on a known side of every kink.
template <class Boom>
class RandomStates {
  public:
    using State = StateOf<Boom>;
    using Layout = typename CraneDynamicsOf<Boom>::Layout;

    RandomStates(const CraneDynamicsOf<Boom>& crane, std::uint64_t seed) : crane_(crane), random_(seed) {}

    [[nodiscard]] double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    [[nodiscard]] bool coin() { return between(0.0, 1.0) < 0.5; }

    /// Either sign, magnitude within the bounds.
    [[nodiscard]] double away_from_zero(double low, double high) {
        const double magnitude = between(low, high);
        return coin() ? magnitude : -magnitude;
    }

    /// Ropes taut or slack by a millimetre or more, the piston within its travel, the track as asked.
    [[nodiscard]] State state(Contact contact) {
        State x = State::Zero();
        const double d_t = crane_.parameters().soil.track_half_length_m;
        switch (contact) {
            case Contact::full:
                x[R1_m] = between(-0.03, -0.005);
                x[phi2_rad] = away_from_zero(1e-6, 0.9) * -x[R1_m] / d_t;
                break;
            case Contact::tilting:
                x[phi2_rad] = away_from_zero(1e-3, 0.05);
                x[R1_m] = between(-0.9, 0.9) * d_t * std::abs(x[phi2_rad]);
                break;
            case Contact::lifted:
                x[phi2_rad] = away_from_zero(1e-3, 0.05);
                x[R1_m] = between(1.1, 2.0) * d_t * std::abs(x[phi2_rad]);
                break;
            case Contact::level:
                x[phi2_rad] = away_from_zero(0.0, 0.9e-12);
                x[R1_m] = away_from_zero(1e-4, 0.03);
                break;
        }
        x[R9_m] = crane_.parameters().ropes.load_line_length_m + away_from_zero(1e-3, 0.3);
        for (int i = Layout::boom_index; i < Layout::phi6_index; ++i) {
            x[i] = between(-0.5, 0.5);
        }
        x[Layout::phi9_index] = between(-1.2, 1.2);
        x[Layout::piston_index] = between(-0.099, 0.099);
        x[Layout::phi6_index] = angle_for(x, away_from_zero(1e-3, 0.05));
        for (int i = 0; i < Layout::coordinate_count; ++i) {
            const double span = i == R1_m || i == Layout::phi6_index ? 0.5
                                : i == phi2_rad                      ? 0.3
                                : i == Layout::phi9_index            ? 1.0
                                                                     : 3.0;
            x[Layout::velocity_offset + i] = between(-span, span);
        }
        return x;
    }

  private:
    /// phi6 at which the pendent and piston are `stretch_m` longer than free; L_p falls as the boom rises.
    [[nodiscard]] double angle_for(State x, double stretch_m) const {
        double low = 0.1;
        double high = 2.2;
        for (int i = 0; i < 60; ++i) {
            x[Layout::phi6_index] = 0.5 * (low + high);
            const double now_m =
                crane_.outputs(x).pendent_length_m - crane_.free_pendent_length_m() + x[Layout::piston_index];
            (now_m > stretch_m ? low : high) = x[Layout::phi6_index];
        }
        return x[Layout::phi6_index];
    }

    const CraneDynamicsOf<Boom>& crane_;
    std::mt19937_64 random_;
};

}  // namespace steadyboom::plant
