#pragma once

#include "plant/crane_dynamics.hpp"

namespace steadyboom::plant {

/// 1/2 p'^T M p', J.
template <class Boom>
[[nodiscard]] double kinetic_energy_J(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& state);

/// Gravity (zero on the undisturbed track plane), boom bending, load line and pendent, J. The soil and the oil are not
/// in it: the tilting soil has no potential (model page, section 9).
template <class Boom>
[[nodiscard]] double potential_energy_J(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& state);

/// Potential of the soil while the whole track bears (contact fraction 1), J: 1/2 K_V R1^2 + 1/2 K_R phi2^2.
[[nodiscard]] double full_contact_energy_J(const Soil& soil, double height_m, double tilt_rad) noexcept;

/// Power of the soil on the crane, W; negative takes energy out.
[[nodiscard]] double soil_power_W(const Soil& soil, double height_m, double tilt_rad, double height_rate_m_s,
                                  double tilt_rate_rad_s) noexcept;

/// Energy in the compressed oil, V_t / (8 beta_e) P_L^2, J.
template <class Boom>
[[nodiscard]] double oil_energy_J(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& state);

/// Power of everything that kinetic plus potential energy does not hold, W; positive feeds the crane.
struct NonConservativePower {
    double boom_damping_W;
    double soil_W;
    double piston_W;  ///< T_P X_p'
    [[nodiscard]] double total_W() const noexcept { return boom_damping_W + soil_W + piston_W; }
};
template <class Boom>
[[nodiscard]] NonConservativePower non_conservative_power(const CraneDynamicsOf<Boom>& crane,
                                                          const StateOf<Boom>& state, double valve_opening_m);

/// The figure by which laws are compared (model page, section 9): a fixed quadratic form of the deviation from an
/// equilibrium, E = 1/2 v^T M(p0) v + 1/2 d^T K d, d = p - p0. The piston is not in it, so moving it cannot lower E.
template <class Boom>
class ResidualEnergyOf {
  public:
    /// `equilibrium` is the true crane's, at X_p = 0.
    ResidualEnergyOf(const CraneDynamicsOf<Boom>& crane, const StateOf<Boom>& equilibrium);

    [[nodiscard]] double energy_J(const StateOf<Boom>& state) const noexcept;

  private:
    typename CraneDynamicsOf<Boom>::Coordinates reference_;
    typename CraneDynamicsOf<Boom>::MassMatrix mass_;
    typename CraneDynamicsOf<Boom>::MassMatrix stiffness_;
};
using ResidualEnergy = ResidualEnergyOf<LinkBoom>;

}  // namespace steadyboom::plant
