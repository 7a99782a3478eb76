#pragma once

#include "plant/actuator.hpp"
#include "plant/beam_boom.hpp"
#include "plant/crane_parameters.hpp"
#include "plant/crane_state.hpp"
#include "plant/link_boom.hpp"
#include "plant/soil.hpp"

namespace steadyboom::plant {

/// What one instant of the crane looks like from outside: forces, lengths and contact.
struct CraneOutputs {
    double pendent_tension_N;
    double load_line_tension_N;
    double pendent_length_m;  ///< L_p, anchor to tip, without the piston
    double pendent_rate_m_s;  ///< dL_p/dt
    double chord_m;           ///< R8
    double contact_fraction;  ///< beta
    double load_pressure_Pa;  ///< P_L
};

/// Where each mass is, in m, in the frame of the ground: x forward, y up, origin on the undisturbed track plane. The
/// joints are the points of the boom at a third and at two thirds of its length.
struct CranePoints {
    Eigen::Vector2d track_centre, car_body_centre, boom_butt, lower_joint, upper_joint, boom_tip, load;
    Eigen::Vector2d boom_centre;  ///< centre of the whole boom's mass
};

/// What differs from one lift or site to the next and is found out on the standing or moving crane.
struct CraneCalibration {
    double load_mass_kg;             ///< m_L
    double free_pendent_length_m;    ///< L_p(t0)
    double pendent_stiffness_N_m;    ///< K_WRP
    double load_line_length_m;       ///< R9(t0)
    double load_line_stiffness_N_m;  ///< K_WRL
    double soil_shear_modulus_Pa;    ///< G
};

/// The crane of the thesis with the piston, model page sections 1 to 4, on either boom: LinkBoom, the thesis's own with
/// seven degrees of freedom in all, or BeamBoom with eight.
///
///     M(p) p'' = Q(p, p', X_p),   M = sum m J^T J + inertia,   Q = Q_forces - sum m J^T (J' p')
///
/// Q holds gravity, ropes, boom, soil and the velocity terms. All members are pure and noexcept: no allocation, no
/// state. States outside the physical range give finite but meaningless numbers; a non-finite state gives non-finite
/// derivatives, never an error.
template <class BoomModel>
class CraneDynamicsOf {
  public:
    using Boom = BoomModel;
    using Layout = CraneLayout<Boom::coordinate_count>;
    using Coordinates = typename Layout::Coordinates;
    using MassMatrix = typename Layout::MassMatrix;
    using State = typename Layout::State;

    explicit CraneDynamicsOf(const CraneParameters& parameters);

    /// d(state)/dt with the spool at `valve_opening_m` (m, positive lengthens the piston), already within its travel.
    [[nodiscard]] State derivative(const State& state, double valve_opening_m) const noexcept;

    /// M(p), kg, kg m, kg m^2 as the coordinates ask; full symmetric matrix.
    [[nodiscard]] MassMatrix mass_matrix(const Coordinates& coordinates) const noexcept;

    /// Q of the header, N or N m, including gravity and velocity terms.
    [[nodiscard]] Coordinates generalized_force(const Coordinates& coordinates, const Coordinates& velocities,
                                                double piston_m) const noexcept;

    [[nodiscard]] CraneOutputs outputs(const State& state) const noexcept;

    [[nodiscard]] CranePoints points(const Coordinates& coordinates) const noexcept;

    /// The state in the thesis's coordinates, for whatever reads q1 and q2: the boom's deflections at its thirds.
    [[nodiscard]] CraneState thesis_state(const State& state) const noexcept;

    /// L_p(t0): unstretched pendent, geometry at phi6(t0) with phi2 = 0 and a straight boom.
    [[nodiscard]] double free_pendent_length_m() const noexcept { return free_pendent_length_m_; }

    [[nodiscard]] CraneCalibration calibration() const noexcept;
    /// Replaces these parameters. The caller keeps them positive and finite.
    void calibrate(const CraneCalibration& calibration) noexcept;

    [[nodiscard]] const CraneParameters& parameters() const noexcept { return parameters_; }
    [[nodiscard]] const Actuator& actuator() const noexcept { return actuator_; }
    [[nodiscard]] const Boom& boom() const noexcept { return boom_; }
    [[nodiscard]] const Soil& soil() const noexcept { return soil_; }

  private:
    using BoomVector = typename Boom::Vector;
    struct Kinematics;
    struct Pendent;
    [[nodiscard]] Kinematics kinematics(const Coordinates& p) const noexcept;
    [[nodiscard]] Pendent pendent(const Kinematics& k, double piston_m) const noexcept;
    [[nodiscard]] double pendent_rate_m_s(const Kinematics& k, const Pendent& pendent,
                                          const Coordinates& v) const noexcept;
    [[nodiscard]] typename Boom::Sums boom_sums(const Kinematics& k) const noexcept;
    [[nodiscard]] MassMatrix mass_matrix(const Kinematics& k, const typename Boom::Sums& boom) const noexcept;
    [[nodiscard]] Coordinates force(const Kinematics& k, const typename Boom::Sums& boom, const Pendent& pendent,
                                    const Coordinates& p, const Coordinates& v) const noexcept;

    CraneParameters parameters_;
    Boom boom_;
    Soil soil_;
    Actuator actuator_;
    double total_mass_kg_;
    double sin_phi3_, cos_phi3_;
    double sin_pendent_anchor_, cos_pendent_anchor_;  ///< of phi_A + pi/2
    double free_pendent_length_m_;
};

/// The thesis's crane: what the observer embeds, and the virtual crane unless a case asks for the beam.
using CraneDynamics = CraneDynamicsOf<LinkBoom>;
using BeamCraneDynamics = CraneDynamicsOf<BeamBoom>;

template <class Boom>
using StateOf = typename CraneDynamicsOf<Boom>::State;

extern template class CraneDynamicsOf<LinkBoom>;
extern template class CraneDynamicsOf<BeamBoom>;

}  // namespace steadyboom::plant
