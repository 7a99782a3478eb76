#include "plant/equilibrium.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "random_states.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

using test_support::thesis_crane;

void expect_cannot_stand(const CraneParameters& parameters, const char* why) {
    try {
        const Equilibrium found = find_equilibrium(CraneDynamics(parameters));
        ADD_FAILURE() << why << ": stands at " << found.state.transpose();
    } catch (const EquilibriumError& error) {
        EXPECT_THAT(error.what(), testing::StartsWith("the crane cannot stand: ")) << why;
        EXPECT_THAT(error.what(), testing::HasSubstr("residual")) << why;
    }
}

TEST(Equilibrium, OfTheThesisCasesIsConvergedAndAtRest) {
    for (const char name : {'A', 'B', 'C'}) {
        const CraneDynamics crane(thesis_crane(name));
        const Equilibrium found = find_equilibrium(crane);
        EXPECT_LE(found.residual, 1e-11);
        EXPECT_EQ(velocities_of(found.state), Coordinates(Coordinates::Zero()));
        EXPECT_EQ(found.state[piston_index], 0.0);
        // The load hangs straight down and its line carries just its weight.
        EXPECT_NEAR(found.state[phi9_rad], 0.0, 1e-12);
        EXPECT_NEAR(found.load_line_tension_N, 13600.0 * 9.81, 1e-4);
        EXPECT_NEAR(found.pendent_tension_N, crane.outputs(found.state).pendent_tension_N, 1e-9);
        EXPECT_LT(crane.derivative(found.state, 0.0).cwiseAbs().maxCoeff(), 1e-9);
    }
}

TEST(Equilibrium, ThrowsWhereTheBoomIsTooHeavy) {
    CraneParameters parameters = thesis_crane('A');
    parameters.structure.boom_link_mass_kg *= 30.0;
    expect_cannot_stand(parameters, "boom links of 142 t");
}

TEST(Equilibrium, ThrowsAtThePendentStiffnessPrintedForCaseC) {
    CraneParameters parameters = thesis_crane('C');
    parameters.ropes.pendent_stiffness_N_m = 6.57e4;
    expect_cannot_stand(parameters, "pendent of 6.57e4 N/m");
}

TEST(Equilibrium, ThrowsWhereTheSoilIsTooWeak) {
    for (const double modulus_Pa : {1e2, 1e4, 1e5}) {
        CraneParameters parameters = thesis_crane('A');
        parameters.soil.shear_modulus_Pa = modulus_Pa;
        expect_cannot_stand(parameters, "bog");
    }
}

TEST(Equilibrium, ThrowsWhereTheCraneTips) {
    CraneParameters parameters = thesis_crane('A');
    parameters.structure.load_mass_kg *= 8.0;
    expect_cannot_stand(parameters, "load of 109 t");
    parameters = thesis_crane('C');
    parameters.structure.car_body_mass_kg = 10000.0;
    expect_cannot_stand(parameters, "no counterweight");
}

TEST(Equilibrium, ThrowsWhereTheBoomWouldFallBackwards) {
    CraneParameters parameters = thesis_crane('A');
    parameters.structure.boom_angle_rad = 1.6;
    expect_cannot_stand(parameters, "boom past the vertical");
}

TEST(Equilibrium, ThrowsOnParametersThatAreNoNumbers) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (double StructureParameters::*field :
         {&StructureParameters::load_mass_kg, &StructureParameters::boom_length_m, &StructureParameters::boom_angle_rad,
          &StructureParameters::boom_joint_stiffness_N_m, &StructureParameters::car_body_mass_kg}) {
        CraneParameters parameters = thesis_crane('A');
        parameters.structure.*field = nan;
        expect_cannot_stand(parameters, "NaN");
    }
    for (double RopeParameters::*field :
         {&RopeParameters::load_line_stiffness_N_m, &RopeParameters::pendent_stiffness_N_m,
          &RopeParameters::load_line_length_m}) {
        CraneParameters parameters = thesis_crane('A');
        parameters.ropes.*field = nan;
        expect_cannot_stand(parameters, "NaN");
    }
    CraneParameters parameters = thesis_crane('A');
    parameters.soil.shear_modulus_Pa = nan;
    expect_cannot_stand(parameters, "NaN");
}

// Whatever the crane: an error that says why, or an equilibrium that is one.
TEST(Equilibrium, OfAnyCraneIsProvedOrRefused) {
    const CraneDynamics seed_crane(thesis_crane('A'));
    RandomStates random(seed_crane, 11);
    int stood = 0;
    int refused = 0;
    for (int i = 0; i < 600; ++i) {
        SCOPED_TRACE(testing::Message() << "crane " << i);
        CraneParameters parameters = thesis_crane("ABC"[i % 3]);
        const auto vary = [&](double& value, double factor) {
            value *= std::exp(random.between(-std::log(factor), std::log(factor)));
        };
        vary(parameters.structure.boom_link_mass_kg, 4.0);
        vary(parameters.structure.load_mass_kg, 4.0);
        vary(parameters.structure.car_body_mass_kg, 4.0);
        vary(parameters.structure.boom_joint_stiffness_N_m, 20.0);
        vary(parameters.structure.boom_angle_rad, 1.5);
        vary(parameters.ropes.pendent_stiffness_N_m, 30.0);
        vary(parameters.ropes.load_line_stiffness_N_m, 30.0);
        vary(parameters.soil.shear_modulus_Pa, 30.0);
        const CraneDynamics crane(parameters);
        try {
            const Equilibrium found = find_equilibrium(crane);
            ++stood;
            ASSERT_TRUE(found.state.allFinite());
            ASSERT_GT(found.pendent_tension_N, 0.0);
            ASSERT_GT(found.load_line_tension_N, 0.0);
            ASSERT_LT(crane.derivative(found.state, 0.0).segment<coordinate_count>(velocity_offset).norm(), 1e-5);
            const Eigen::SelfAdjointEigenSolver<MassMatrix> stiffness(
                stiffness_matrix(crane, Coordinates(coordinates_of(found.state))), Eigen::EigenvaluesOnly);
            ASSERT_GT(stiffness.eigenvalues().minCoeff(), 0.0);
        } catch (const EquilibriumError& error) {
            ++refused;
            ASSERT_THAT(error.what(), testing::StartsWith("the crane cannot stand: "));
        }
    }
    EXPECT_GT(stood, 200);
    EXPECT_GT(refused, 50);
}

// Ropes as stiff as anyone might fit: rounding of L_p then shows in the forces, which is no reason to refuse the crane.
TEST(Equilibrium, IsFoundWithStiffRopesToo) {
    double before_rad = 0.0;
    for (const double factor : {1.0, 3.0, 10.0, 30.0, 100.0, 300.0}) {
        SCOPED_TRACE(factor);
        CraneParameters parameters = thesis_crane('A');
        parameters.ropes.pendent_stiffness_N_m *= factor;
        parameters.ropes.load_line_stiffness_N_m *= factor;
        const Equilibrium found = find_equilibrium(CraneDynamics(parameters));
        EXPECT_GT(found.state[phi6_rad], before_rad) << "the stiffer pendent sags less";
        EXPECT_LT(found.state[phi6_rad], parameters.structure.boom_angle_rad);
        EXPECT_NEAR(found.load_line_tension_N, 13600.0 * 9.81, 1e-2);
        before_rad = found.state[phi6_rad];
    }
}

}  // namespace
}  // namespace steadyboom::plant
