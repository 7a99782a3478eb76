#pragma once

#include <array>
#include <complex>
#include <vector>

#include <Eigen/Core>

#include "plant/crane_parameters.hpp"

namespace steadyboom::plant {

/// What a boom contributes to the second derivation, in a frame along its chord: z = x - i w, butt at zero, w positive
/// below the chord. `Own` are its own coordinates.
class LinkOracle {
  public:
    using Real = long double;
    using Point = std::complex<Real>;
    static constexpr int count = 2;
    using Own = Eigen::Matrix<Real, count, 1>;

    explicit LinkOracle(const StructureParameters& structure);
    [[nodiscard]] Point tip(const Own& q) const;
    [[nodiscard]] std::array<Point, 2> thirds(const Own& q) const;
    /// Where its mass is, and how much.
    [[nodiscard]] std::vector<Point> stations(const Own& q) const;
    [[nodiscard]] const std::vector<Real>& masses() const { return masses_; }
    /// By how much each station's section is turned against the chord, and its moment of inertia.
    [[nodiscard]] std::vector<Real> section_angles(const Own& q) const;
    [[nodiscard]] const std::vector<Real>& section_inertias() const { return section_inertias_; }
    [[nodiscard]] Real bending_energy(const Own& q) const;
    [[nodiscard]] Own damping_force(const Own& rate) const;
    [[nodiscard]] std::array<Real, 2> strain(const Own& q) const;

  private:
    StructureParameters structure_;
    std::vector<Real> masses_;
    std::vector<Real> section_inertias_;
};

/// The beam by dense quadrature: w and its slopes at every station, x by integrating 1 - w'^2 / 2 from the butt.
class BeamOracle {
  public:
    using Real = long double;
    using Point = std::complex<Real>;
    static constexpr int count = 3;
    using Own = Eigen::Matrix<Real, count, 1>;

    explicit BeamOracle(const StructureParameters& structure);
    [[nodiscard]] Point tip(const Own& a) const;
    [[nodiscard]] std::array<Point, 2> thirds(const Own& a) const;
    [[nodiscard]] std::vector<Point> stations(const Own& a) const;
    [[nodiscard]] const std::vector<Real>& masses() const { return masses_; }
    [[nodiscard]] std::vector<Real> section_angles(const Own& a) const;
    [[nodiscard]] const std::vector<Real>& section_inertias() const { return section_inertias_; }
    [[nodiscard]] Real bending_energy(const Own& a) const;
    [[nodiscard]] Own damping_force(const Own& rate) const;
    [[nodiscard]] std::array<Real, 2> strain(const Own& a) const;

  private:
    using Square = Eigen::Matrix<Real, count, count>;
    [[nodiscard]] Own shape(Real s, int derivative) const;
    [[nodiscard]] Square slope_integral(Real s) const;
    [[nodiscard]] Point at(Real s, const Own& shape, const Square& shortening, const Own& a) const;

    StructureParameters structure_;
    Real length_;
    std::vector<Real> s_, weights_, masses_, section_inertias_;
    std::vector<Own> shapes_, slopes_, curvatures_;
    std::vector<Square> shortenings_;
    Square tip_shortening_;
    std::array<Square, 2> third_shortenings_;
};

/// The crane written a second time, sharing no formula with plant/: points are complex numbers in long double, their
/// velocities, the mass matrix and every force follow from the kinetic energy T and the potential V by differences of
/// sixth order, and Lagrange's equation d/dt dT/dv - dT/dp + dV/dp = Q gives the motion. Slow and meant to be.
/// Coordinates are in the order of plant::CraneLayout.
template <class Boom>
class SecondDerivation {
  public:
    using Real = long double;
    using Point = std::complex<Real>;  ///< x forward + i y up, m
    static constexpr int own = 3;      ///< index of the boom's first
    static constexpr int phi6 = own + Boom::count;
    static constexpr int phi9 = phi6 + 1;
    static constexpr int count = phi9 + 1;
    using Vector = Eigen::Matrix<Real, count, 1>;
    using Matrix = Eigen::Matrix<Real, count, count>;

    explicit SecondDerivation(const CraneParameters& crane);

    struct Points {
        Point track, car_body, butt, anchor, lower, upper, tip, load;
        std::vector<Point> boom;
    };
    [[nodiscard]] Points points(const Vector& p) const;
    [[nodiscard]] const Boom& boom() const { return boom_; }

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
    Boom boom_;
    Real free_pendent_length_;
};

}  // namespace steadyboom::plant
