#pragma once

#include <array>
#include <complex>

#include <Eigen/Core>

#include "plant/crane_parameters.hpp"

namespace steadyboom::plant {

/// The crane written a second time, sharing no formula with plant/: points are complex numbers in long double, their
/// velocities, the mass matrix and every force follow from the kinetic energy T and the potential V by differences of
/// sixth order, and Lagrange's equation d/dt dT/dv - dT/dp + dV/dp = Q gives the motion. Slow and meant to be.
/// Coordinates are in the order of plant::Coordinate.
class SecondDerivation {
  public:
    using Real = long double;
    using Point = std::complex<Real>;  ///< x forward + i y up, m
    using Vector = Eigen::Matrix<Real, 7, 1>;
    using Matrix = Eigen::Matrix<Real, 7, 7>;

    explicit SecondDerivation(const CraneParameters& crane);

    struct Points {
        Point track, car_body, butt, anchor, lower, upper, tip, load;
        std::array<Point, 3> links;
    };
    [[nodiscard]] Points points(const Vector& p) const;

    [[nodiscard]] Real kinetic_energy(const Vector& p, const Vector& v) const;
    /// Gravity, bending and ropes; the piston lengthens the pendent's pull by X_p.
    [[nodiscard]] Real potential_energy(const Vector& p, Real piston) const;
    /// M_ij = d2T / dv_i dv_j.
    [[nodiscard]] Matrix mass_matrix(const Vector& p) const;

    /// Everything but M p'' on the right-hand side, and the sum of its parts' magnitudes, against which an error
    /// counts.
    struct Force {
        Vector value, scale;
    };
    [[nodiscard]] Force force(const Vector& p, const Vector& v, Real piston) const;

    [[nodiscard]] Vector acceleration(const Vector& p, const Vector& v, Real piston) const;

    /// L_p as the distance from the anchor to the tip, and its rate.
    [[nodiscard]] Real pendent_length(const Vector& p) const;
    [[nodiscard]] Real pendent_rate(const Vector& p, const Vector& v) const;
    [[nodiscard]] Real free_pendent_length() const { return free_pendent_length_; }
    [[nodiscard]] Real pendent_tension(const Vector& p, Real piston) const;
    [[nodiscard]] Real load_line_tension(const Vector& p) const;

    /// X_p' from continuity and P_L' = T_P' / A_p, two equations in two unknowns; linear valve, no end stop.
    [[nodiscard]] Real piston_rate(const Vector& p, const Vector& v, Real piston, Real opening) const;

    /// The part of the track, as an interval of it, that lies below the ground.
    struct Contact {
        Real share, centre;
    };
    [[nodiscard]] Contact contact(Real height, Real tilt) const;
    /// Generalized forces of the soil on R1 and phi2.
    [[nodiscard]] std::array<Real, 2> soil_force(Real height, Real tilt, Real height_rate, Real tilt_rate) const;

  private:
    [[nodiscard]] Real momentum(const Vector& p, const Vector& v, int i) const;

    CraneParameters crane_;
    Real free_pendent_length_;
};

}  // namespace steadyboom::plant
