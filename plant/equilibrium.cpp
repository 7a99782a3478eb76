#include "plant/equilibrium.hpp"

#include <cmath>
#include <numbers>
#include <sstream>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace steadyboom::plant {

namespace {

// Central differences: the forces are smooth and of order 1e6, so 1e-6 of a metre or radian balances truncation
// against rounding.
constexpr double difference_step = 1e-6;

template <class Boom>
typename CraneDynamicsOf<Boom>::MassMatrix force_gradient(const CraneDynamicsOf<Boom>& crane,
                                                          const typename CraneDynamicsOf<Boom>::Coordinates& p) {
    using Vector = typename CraneDynamicsOf<Boom>::Coordinates;
    typename CraneDynamicsOf<Boom>::MassMatrix gradient;
    for (int i = 0; i < CraneDynamicsOf<Boom>::Layout::coordinate_count; ++i) {
        Vector above = p;
        Vector below = p;
        above[i] += difference_step;
        below[i] -= difference_step;
        gradient.col(i) = (crane.generalized_force(above, Vector::Zero(), 0.0) -
                           crane.generalized_force(below, Vector::Zero(), 0.0)) /
                          (2.0 * difference_step);
    }
    return gradient;
}

}  // namespace

template <class Boom>
typename CraneDynamicsOf<Boom>::MassMatrix stiffness_matrix(
    const CraneDynamicsOf<Boom>& crane, const typename CraneDynamicsOf<Boom>::Coordinates& coordinates) {
    const typename CraneDynamicsOf<Boom>::MassMatrix gradient = force_gradient(crane, coordinates);
    return -0.5 * (gradient + gradient.transpose());
}

template <class Boom>
EquilibriumOf<Boom> find_equilibrium(const CraneDynamicsOf<Boom>& crane) {
    using Crane = CraneDynamicsOf<Boom>;
    using Vector = typename Crane::Coordinates;
    constexpr int phi6 = Crane::Layout::phi6_index;
    constexpr int max_iterations = 200;
    constexpr double converged = 1e-12;
    // Where the ropes are stiff, rounding of their lengths keeps the forces from balancing any better.
    constexpr double acceptable = 1e-9;
    const StructureParameters& structure = crane.parameters().structure;
    const double weight_N =
        (structure.track_mass_kg + structure.car_body_mass_kg + crane.boom().mass_kg() + structure.load_mass_kg) *
        gravity_m_s2;
    const auto residual_of = [&](const Vector& p) {
        return crane.generalized_force(p, Vector::Zero(), 0.0).cwiseAbs().template maxCoeff<Eigen::PropagateNaN>() /
               weight_N;
    };

    // From hanging weights and springs alone: ropes already taut and tracks already bearing, so that no gradient is
    // flat.
    Vector p = Vector::Zero();
    p[R1_m] = -weight_N / crane.soil().coefficients(1.0).vertical_stiffness_N_m;
    p[R9_m] = crane.parameters().ropes.load_line_length_m +
              structure.load_mass_kg * gravity_m_s2 / crane.parameters().ropes.load_line_stiffness_N_m;
    p[phi6] = structure.boom_angle_rad - 1e-3;

    double residual = residual_of(p);
    int iteration = 0;
    for (; iteration < max_iterations && residual > converged; ++iteration) {
        const Vector force = crane.generalized_force(p, Vector::Zero(), 0.0);
        const Vector step = force_gradient(crane, p).fullPivLu().solve(-force);
        if (!step.allFinite()) {
            break;
        }
        // A full step near the root, a shorter one where it would not reduce the residual.
        double share = 1.0;
        double tried = residual_of(p + share * step);
        while (!(tried < residual) && share > 1e-6) {
            share *= 0.5;
            tried = residual_of(p + share * step);
        }
        if (!(tried < residual)) {
            break;
        }
        p += share * step;
        residual = tried;
    }

    typename Crane::State state = Crane::State::Zero();
    coordinates_of(state) = p;
    const CraneOutputs outputs = crane.outputs(state);
    const auto fail = [&](const char* why) {
        std::ostringstream text;
        text << "the crane cannot stand: " << why << " (residual " << residual << " of the weight after " << iteration
             << " Newton steps, boom at " << p[phi6] * 180.0 / std::numbers::pi
             << " deg); check masses, boom angle, pendent stiffness and soil";
        throw EquilibriumError(text.str());
    };
    if (!(residual <= acceptable)) {
        fail("no static equilibrium was found");
    }
    if (outputs.pendent_tension_N <= 0.0) {
        fail("the pendent is slack at rest, the boom would fall backwards");
    }
    if (outputs.load_line_tension_N <= 0.0) {
        fail("the load line is slack at rest");
    }
    if (outputs.contact_fraction <= 0.0 || p[phi6] <= 0.0 || p[phi6] >= std::numbers::pi / 2.0) {
        fail("its tracks lift off or its boom leaves 0 to 90 deg");
    }
    if (Eigen::LDLT<typename Crane::MassMatrix>(stiffness_matrix(crane, p)).vectorD().minCoeff() <= 0.0) {
        fail("the equilibrium is unstable, the crane would tip");
    }
    return {.state = state,
            .pendent_tension_N = outputs.pendent_tension_N,
            .load_line_tension_N = outputs.load_line_tension_N,
            .residual = residual,
            .iterations = iteration};
}

template EquilibriumOf<LinkBoom> find_equilibrium(const CraneDynamicsOf<LinkBoom>&);
template CraneDynamicsOf<LinkBoom>::MassMatrix stiffness_matrix(const CraneDynamicsOf<LinkBoom>&,
                                                                const CraneDynamicsOf<LinkBoom>::Coordinates&);
template EquilibriumOf<BeamBoom> find_equilibrium(const CraneDynamicsOf<BeamBoom>&);
template CraneDynamicsOf<BeamBoom>::MassMatrix stiffness_matrix(const CraneDynamicsOf<BeamBoom>&,
                                                                const CraneDynamicsOf<BeamBoom>::Coordinates&);

}  // namespace steadyboom::plant
