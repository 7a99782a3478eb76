#include "second_derivation.hpp"

#include <array>

#include <gtest/gtest.h>

#include "boom_cases.hpp"
#include "plant/energy.hpp"
#include "plant/equilibrium.hpp"
#include "plant/sensors.hpp"
#include "random_states.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

using Real = long double;
using test_support::thesis_crane;

constexpr int states = 100;
constexpr double relative = 1e-6;
/// What rounding of sums may add where terms cancel, as a share of the terms' magnitudes.
constexpr double rounding = 1e-12;

Contact contact_of(int i) {
    constexpr std::array kinds = {Contact::full, Contact::tilting, Contact::tilting, Contact::lifted, Contact::level};
    return kinds[static_cast<std::size_t>(i) % kinds.size()];
}

template <class Case>
class SecondDerivationOf : public testing::Test {
  protected:
    using Vector = typename Case::Oracle::Vector;
    using Matrix = typename Case::Oracle::Matrix;

    SecondDerivationOf() : parameters(with_leakage(thesis_crane(Case::name))), crane(parameters), oracle(parameters) {}

    static Vector widened(const typename Case::Coordinates& p) { return p.template cast<Real>(); }

    /// The thesis has no leakage; its term is proved all the same.
    static CraneParameters with_leakage(CraneParameters p) {
        p.actuator.leakage_m3_s_Pa = 3e-11;
        return p;
    }

    /// Calls `check(state, p, v)` at the seeded states and counts the branches they took.
    template <class Check>
    void at_random_states(const Check& check) {
        RandomStates random(crane, 1000U + static_cast<unsigned char>(Case::name));
        int pendent_taut = 0;
        int line_taut = 0;
        int partial = 0;
        for (int i = 0; i < states; ++i) {
            SCOPED_TRACE(testing::Message() << "state " << i);
            const typename Case::State x = random.state(contact_of(i));
            const CraneOutputs outputs = crane.outputs(x);
            pendent_taut += outputs.pendent_tension_N > 0.0 ? 1 : 0;
            line_taut += outputs.load_line_tension_N > 0.0 ? 1 : 0;
            partial += outputs.contact_fraction > 0.0 && outputs.contact_fraction < 1.0 ? 1 : 0;
            check(x, widened(coordinates_of(x)), widened(velocities_of(x)));
            if (testing::Test::HasFatalFailure()) {
                return;
            }
        }
        for (const int count : {pendent_taut, line_taut, partial}) {
            EXPECT_GE(count, states / 4);
            EXPECT_LE(count, states * 3 / 4);
        }
    }

    CraneParameters parameters;
    typename Case::Crane crane;
    typename Case::Oracle oracle;
};
TYPED_TEST_SUITE(SecondDerivationOf, BoomCases, BoomCaseName);

TYPED_TEST(SecondDerivationOf, KineticEnergyGivesTheMassMatrix) {
    this->at_random_states([&](const typename TypeParam::State& x, const typename TypeParam::Oracle::Vector& p,
                               const typename TypeParam::Oracle::Vector&) {
        const typename TypeParam::MassMatrix M =
            this->crane.mass_matrix(typename TypeParam::Coordinates(coordinates_of(x)));
        const typename TypeParam::MassMatrix expected = this->oracle.mass_matrix(p).template cast<double>();
        for (int i = 0; i < TypeParam::Layout::coordinate_count; ++i) {
            for (int j = 0; j < TypeParam::Layout::coordinate_count; ++j) {
                ASSERT_NEAR(M(i, j), expected(i, j),
                            relative * std::abs(expected(i, j)) + rounding * std::sqrt(expected(i, i) * expected(j, j)))
                    << "entry " << i << "," << j;
            }
        }
    });
}

TYPED_TEST(SecondDerivationOf, LagrangesEquationGivesTheForces) {
    this->at_random_states([&](const typename TypeParam::State& x, const typename TypeParam::Oracle::Vector& p,
                               const typename TypeParam::Oracle::Vector& v) {
        const typename TypeParam::Coordinates Q = this->crane.generalized_force(
            typename TypeParam::Coordinates(coordinates_of(x)), typename TypeParam::Coordinates(velocities_of(x)),
            x[TypeParam::Layout::piston_index]);
        const typename TypeParam::Oracle::Force expected = this->oracle.force(p, v, x[TypeParam::Layout::piston_index]);
        for (int i = 0; i < TypeParam::Layout::coordinate_count; ++i) {
            const auto wanted = static_cast<double>(expected.value[i]);
            ASSERT_NEAR(Q[i], wanted, relative * std::abs(wanted) + rounding * static_cast<double>(expected.scale[i]))
                << "coordinate " << i;
        }
    });
}

TYPED_TEST(SecondDerivationOf, DerivativeIsTheMotionAndThePistonRate) {
    this->at_random_states([&](const typename TypeParam::State& x, const typename TypeParam::Oracle::Vector& p,
                               const typename TypeParam::Oracle::Vector& v) {
        constexpr double opening_m = 2.5e-3;
        const typename TypeParam::State rate = this->crane.derivative(x, opening_m);
        const typename TypeParam::Oracle::Vector expected =
            this->oracle.acceleration(p, v, x[TypeParam::Layout::piston_index]);
        ASSERT_EQ(coordinates_of(rate), velocities_of(x));
        const auto largest = static_cast<double>(expected.cwiseAbs().maxCoeff());
        for (int i = 0; i < TypeParam::Layout::coordinate_count; ++i) {
            const auto wanted = static_cast<double>(expected[i]);
            ASSERT_NEAR(rate[TypeParam::Layout::velocity_offset + i], wanted,
                        relative * std::abs(wanted) + 1e-10 * largest)
                << "coordinate " << i;
        }
        const auto piston =
            static_cast<double>(this->oracle.piston_rate(p, v, x[TypeParam::Layout::piston_index], opening_m));
        ASSERT_NEAR(rate[TypeParam::Layout::piston_index], piston, relative * std::abs(piston));
    });
}

TYPED_TEST(SecondDerivationOf, PointsAndOutputsAreWhereTheGeometryPutsThem) {
    this->at_random_states([&](const typename TypeParam::State& x, const typename TypeParam::Oracle::Vector& p,
                               const typename TypeParam::Oracle::Vector& v) {
        const CranePoints points = this->crane.points(typename TypeParam::Coordinates(coordinates_of(x)));
        const typename TypeParam::Oracle::Points expected = this->oracle.points(p);
        const auto same = [](const Eigen::Vector2d& a, const typename TypeParam::Oracle::Point& b) {
            EXPECT_NEAR(a.x(), static_cast<double>(b.real()), 1e-12);
            EXPECT_NEAR(a.y(), static_cast<double>(b.imag()), 1e-12);
        };
        same(points.track_centre, expected.track);
        same(points.car_body_centre, expected.car_body);
        same(points.boom_butt, expected.butt);
        same(points.lower_joint, expected.lower);
        same(points.upper_joint, expected.upper);
        same(points.boom_tip, expected.tip);
        same(points.load, expected.load);
        Real mass_kg = 0.0L;
        typename TypeParam::Oracle::Point centre = 0.0L;
        for (std::size_t i = 0; i < expected.boom.size(); ++i) {
            mass_kg += this->oracle.boom().masses()[i];
            centre += this->oracle.boom().masses()[i] * expected.boom[i];
        }
        EXPECT_NEAR(this->crane.boom().mass_kg(), static_cast<double>(mass_kg), 1e-9);
        same(points.boom_centre, centre / mass_kg);

        const CraneOutputs outputs = this->crane.outputs(x);
        const auto tension_N = static_cast<double>(this->oracle.pendent_tension(p, x[TypeParam::Layout::piston_index]));
        EXPECT_NEAR(outputs.pendent_length_m, static_cast<double>(this->oracle.pendent_length(p)), 1e-11);
        EXPECT_NEAR(outputs.pendent_rate_m_s, static_cast<double>(this->oracle.pendent_rate(p, v)), 1e-11);
        EXPECT_NEAR(outputs.pendent_tension_N, tension_N, relative * tension_N);
        EXPECT_NEAR(outputs.load_pressure_Pa, tension_N / 0.0645, relative * tension_N / 0.0645);
        EXPECT_NEAR(outputs.load_line_tension_N, static_cast<double>(this->oracle.load_line_tension(p)), 1e-6);
        EXPECT_NEAR(outputs.chord_m, static_cast<double>(std::abs(expected.tip - expected.butt)), 1e-12);
        EXPECT_NEAR(outputs.contact_fraction, static_cast<double>(this->oracle.contact(p[R1_m], p[phi2_rad]).share),
                    1e-12);
    });
    EXPECT_NEAR(this->crane.free_pendent_length_m(), static_cast<double>(this->oracle.free_pendent_length()), 1e-12);
}

TYPED_TEST(SecondDerivationOf, SensorsReadStrainAnglesTensionLengthAndPressure) {
    this->at_random_states([&](const typename TypeParam::State& x, const typename TypeParam::Oracle::Vector& p,
                               const typename TypeParam::Oracle::Vector&) {
        const SensorVector y = ideal_sensors(this->crane, x, 1.25e-3);
        const auto strain = this->oracle.boom().strain(
            p.template segment<TypeParam::Boom::coordinate_count>(TypeParam::Layout::boom_index));
        EXPECT_NEAR(y[strain_lower_microstrain], static_cast<double>(1e6L * strain[0]), 1e-9 * 1e4);
        EXPECT_NEAR(y[strain_upper_microstrain], static_cast<double>(1e6L * strain[1]), 1e-9 * 1e4);
        EXPECT_EQ(y[boom_angle_rad], x[TypeParam::Layout::phi6_index]);
        EXPECT_EQ(y[line_angle_rad], x[TypeParam::Layout::phi9_index]);
        EXPECT_NEAR(y[line_tension_N], static_cast<double>(this->oracle.load_line_tension(p)), 1e-6);
        EXPECT_EQ(y[line_length_m], 12.2);
        EXPECT_EQ(y[piston_m], x[TypeParam::Layout::piston_index]);
        EXPECT_EQ(y[spool_m], 1.25e-3);
        const auto pressure_Pa =
            static_cast<double>(this->oracle.pendent_tension(p, x[TypeParam::Layout::piston_index])) / 0.0645;
        EXPECT_NEAR(y[load_pressure_Pa], pressure_Pa, relative * pressure_Pa);
    });
}

TYPED_TEST(SecondDerivationOf, EnergiesAreTheSame) {
    this->at_random_states([&](const typename TypeParam::State& x, const typename TypeParam::Oracle::Vector& p,
                               const typename TypeParam::Oracle::Vector& v) {
        const auto kinetic_J = static_cast<double>(this->oracle.kinetic_energy(p, v));
        const auto potential_J =
            static_cast<double>(this->oracle.potential_energy(p, x[TypeParam::Layout::piston_index]));
        EXPECT_NEAR(kinetic_energy_J(this->crane, x), kinetic_J, 1e-12 * kinetic_J);
        EXPECT_NEAR(potential_energy_J(this->crane, x), potential_J, 1e-12 * std::abs(potential_J) + 1e-6);
        EXPECT_NEAR(
            oil_energy_J(this->crane, x),
            std::pow(static_cast<double>(this->oracle.pendent_tension(p, x[TypeParam::Layout::piston_index])) / 0.0645,
                     2) *
                1.31e-2 / (8.0 * 700e6),
            1e-6);
    });
}

TYPED_TEST(SecondDerivationOf, ThesisStateReadsTheBoomAtItsThirds) {
    this->at_random_states([&](const typename TypeParam::State& x, const typename TypeParam::Oracle::Vector& p,
                               const typename TypeParam::Oracle::Vector& v) {
        const CraneState thesis = this->crane.thesis_state(x);
        const auto deflection = [&](Real time, std::size_t third) {
            const typename TypeParam::Oracle::Vector now = p + time * v;
            return -this->oracle.boom()
                        .thirds(now.template segment<TypeParam::Boom::coordinate_count>(
                            TypeParam::Layout::boom_index))[third]
                        .imag();
        };
        for (const std::size_t third : {0U, 1U}) {
            const int q = q1_m + static_cast<int>(third);
            EXPECT_NEAR(thesis[q], static_cast<double>(deflection(0.0L, third)), 1e-14);
            EXPECT_NEAR(thesis[velocity_offset + q],
                        static_cast<double>((deflection(0.5L, third) - deflection(-0.5L, third))), 1e-13);
        }
        for (const int same : {R1_m, phi2_rad, R9_m}) {
            EXPECT_EQ(thesis[same], x[same]);
            EXPECT_EQ(thesis[velocity_offset + same], x[TypeParam::Layout::velocity_offset + same]);
        }
        EXPECT_EQ(thesis[phi6_rad], x[TypeParam::Layout::phi6_index]);
        EXPECT_EQ(thesis[phi9_rad], x[TypeParam::Layout::phi9_index]);
        EXPECT_EQ(thesis[velocity_offset + phi6_rad],
                  x[TypeParam::Layout::velocity_offset + TypeParam::Layout::phi6_index]);
        EXPECT_EQ(thesis[velocity_offset + phi9_rad],
                  x[TypeParam::Layout::velocity_offset + TypeParam::Layout::phi9_index]);
        EXPECT_EQ(thesis[piston_index], x[TypeParam::Layout::piston_index]);
    });
}

// The stiffness of the residual energy, a second time: -dQ/dp by differences of the other derivation.
TYPED_TEST(SecondDerivationOf, StiffnessAtEquilibriumIsTheForcesGradient) {
    const auto rest = find_equilibrium(this->crane);
    const typename TypeParam::MassMatrix K =
        stiffness_matrix(this->crane, typename TypeParam::Coordinates(coordinates_of(rest.state)));
    const typename TypeParam::Oracle::Vector p = this->widened(coordinates_of(rest.state));
    typename TypeParam::Oracle::Matrix gradient;
    for (int j = 0; j < TypeParam::Layout::coordinate_count; ++j) {
        constexpr Real h = 1e-6L;
        const typename TypeParam::Oracle::Vector step = h * TypeParam::Oracle::Vector::Unit(j);
        gradient.col(j) = (this->oracle.force(p + step, TypeParam::Oracle::Vector::Zero(), 0.0L).value -
                           this->oracle.force(p - step, TypeParam::Oracle::Vector::Zero(), 0.0L).value) /
                          (2.0L * h);
    }
    const typename TypeParam::MassMatrix expected = (-0.5L * (gradient + gradient.transpose())).template cast<double>();
    for (int i = 0; i < TypeParam::Layout::coordinate_count; ++i) {
        for (int j = 0; j < TypeParam::Layout::coordinate_count; ++j) {
            EXPECT_NEAR(K(i, j), expected(i, j), 1e-6 * std::sqrt(std::abs(expected(i, i) * expected(j, j))))
                << i << "," << j;
        }
    }
}

}  // namespace
}  // namespace steadyboom::plant
