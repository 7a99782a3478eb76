#pragma once

#include "hil/case_file.hpp"
#include "hil/truth_sample.hpp"
#include "plant/energy.hpp"
#include "plant/equilibrium.hpp"

namespace steadyboom::hil {

/// A crane of one kind of boom, its equilibrium, and what is told of it in the thesis's coordinates.
template <class Boom>
class TrueCrane {
  public:
    /// Throws plant::EquilibriumError.
    explicit TrueCrane(const plant::CraneParameters& parameters);

    [[nodiscard]] const plant::CraneDynamicsOf<Boom>& dynamics() const noexcept { return dynamics_; }
    [[nodiscard]] const plant::EquilibriumOf<Boom>& equilibrium() const noexcept { return equilibrium_; }

    /// The equilibrium with CraneDynamicsOf::thesis_state.
    [[nodiscard]] plant::Equilibrium thesis_equilibrium() const noexcept;

    [[nodiscard]] TruthSample sample(const plant::StateOf<Boom>& state, double spool_m, double t_s) const noexcept;

  private:
    using Layout = typename plant::CraneDynamicsOf<Boom>::Layout;
    plant::CraneDynamicsOf<Boom> dynamics_;
    plant::EquilibriumOf<Boom> equilibrium_;
    plant::ResidualEnergyOf<Boom> energy_;
    Eigen::Matrix<double, Boom::coordinate_count, Boom::coordinate_count> boom_mass_;  ///< at the equilibrium
};

/// TrueCrane::thesis_equilibrium of the crane of a case. Throws plant::EquilibriumError.
[[nodiscard]] plant::Equilibrium rest_of(const Case& crane_case);

extern template class TrueCrane<plant::LinkBoom>;
extern template class TrueCrane<plant::BeamBoom>;

}  // namespace steadyboom::hil
