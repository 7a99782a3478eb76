// SUNDIALS' CVODE (Adams, variable order) and KINSOL (Newton) against plant/'s own integrator and equilibrium.

#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

#include <cvode/cvode.h>
#include <gtest/gtest.h>
#include <kinsol/kinsol.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "crane_run.hpp"
#include "support/thesis_cranes.hpp"

namespace steadyboom::plant {
namespace {

void require(int code, const char* what) {
    if (code < 0) {
        throw std::runtime_error(std::string(what) + " returned " + std::to_string(code));
    }
}

class Context {
  public:
    Context() { require(SUNContext_Create(nullptr, &context_), "SUNContext_Create"); }
    ~Context() { SUNContext_Free(&context_); }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    operator SUNContext() const { return context_; }

  private:
    SUNContext context_ = nullptr;
};

using NVector = std::unique_ptr<std::remove_pointer_t<N_Vector>, decltype(&N_VDestroy)>;
NVector vector(int size, const Context& context) {
    return {N_VNew_Serial(size, context), &N_VDestroy};
}

template <int size>
Eigen::Map<Eigen::Matrix<double, size, 1>> mapped(N_Vector v) {
    return Eigen::Map<Eigen::Matrix<double, size, 1>>(N_VGetArrayPointer(v));
}

using Rate = std::function<CraneState(const CraneState&)>;
/// Functions whose zeros are the right-hand side's kinks.
using Kinks = std::function<Eigen::Vector3d(const CraneState&)>;

struct Problem {
    Rate rate;
    Kinks kinks;
};

int cvode_rate(realtype, N_Vector y, N_Vector ydot, void* user) {
    mapped<state_count>(ydot) = static_cast<Problem*>(user)->rate(CraneState(mapped<state_count>(y)));
    return 0;
}

int cvode_kinks(realtype, N_Vector y, realtype* values, void* user) {
    Eigen::Map<Eigen::Vector3d>{values} = static_cast<Problem*>(user)->kinks(CraneState(mapped<state_count>(y)));
    return 0;
}

/// States at every `period_s`; the multistep method starts afresh at each kink that its root finder meets.
std::vector<CraneState> cvode_run(Problem problem, const CraneState& start, double duration_s, double period_s) {
    const Context context;
    const NVector y = vector(state_count, context);
    mapped<state_count>(y.get()) = start;
    const std::unique_ptr<void, void (*)(void*)> memory(CVodeCreate(CV_ADAMS, context),
                                                        [](void* cvode) { CVodeFree(&cvode); });
    require(CVodeInit(memory.get(), cvode_rate, 0.0, y.get()), "CVodeInit");
    require(CVodeSStolerances(memory.get(), 1e-12, 1e-13), "CVodeSStolerances");
    require(CVodeSetUserData(memory.get(), &problem), "CVodeSetUserData");
    require(CVodeSetMaxNumSteps(memory.get(), 10'000'000), "CVodeSetMaxNumSteps");
    require(CVodeSetMaxStep(memory.get(), 1e-3), "CVodeSetMaxStep");
    require(CVodeRootInit(memory.get(), 3, cvode_kinks), "CVodeRootInit");
    const std::unique_ptr<std::remove_pointer_t<SUNNonlinearSolver>, int (*)(SUNNonlinearSolver)> solver(
        SUNNonlinSol_FixedPoint(y.get(), 0, context), &SUNNonlinSolFree);
    require(CVodeSetNonlinearSolver(memory.get(), solver.get()), "CVodeSetNonlinearSolver");

    std::vector<CraneState> samples{start};
    const long count = std::lround(duration_s / period_s);
    for (long i = 1; i <= count;) {
        realtype t_s = 0.0;
        const int code = CVode(memory.get(), static_cast<double>(i) * period_s, y.get(), &t_s, CV_NORMAL);
        require(code, "CVode");
        if (code == CV_ROOT_RETURN) {
            require(CVodeReInit(memory.get(), t_s, y.get()), "CVodeReInit");
            continue;
        }
        samples.emplace_back(mapped<state_count>(y.get()));
        ++i;
    }
    return samples;
}

constexpr double duration_s = 10.0;
constexpr double period_s = 0.05;

std::vector<CraneState> own_run(const CraneDynamics& crane, const CraneState& start, double tolerance,
                                const std::function<double(const CraneState&)>& law) {
    std::vector<CraneState> samples;
    run_crane(
        crane, start, duration_s, period_s, tolerance, [&](double, const CraneState& x) { return law(x); },
        [&](double, const CraneState& x, double) { samples.push_back(x); });
    return samples;
}

/// Largest distance over the run, each entry against the largest value it takes.
double distance(const std::vector<CraneState>& a, const std::vector<CraneState>& b) {
    CraneState scale = CraneState::Constant(1e-6);
    for (const CraneState& x : a) {
        scale = scale.cwiseMax(x.cwiseAbs());
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        worst = std::max(worst, (a[i] - b.at(i)).cwiseQuotient(scale).cwiseAbs().maxCoeff());
    }
    return worst;
}

class WholeTrajectory : public testing::Test {
  protected:
    /// The tolerance is measured, not guessed: each slack stretch of the load line multiplies a small difference. A
    /// start moved by 1e-9 shows by how much; local errors of 1e-12 in some 1e4 steps may grow by as much.
    void compare(const std::function<double(const CraneState&)>& law) {
        CraneState moved = start;
        moved[velocity_offset + R9_m] += 1e-9;
        const std::vector<CraneState> own = own_run(crane, start, 1e-12, law);
        const double growth = distance(own, own_run(crane, moved, 1e-12, law)) / 1e-9;
        const double tolerance = growth * 1e-12 * 1e4;
        ASSERT_LT(tolerance, 1e-5) << "the comparison would say nothing";

        const auto opening_m = [&](const CraneState& x) { return crane.actuator().clamp_opening_m(law(x)); };
        const std::vector<CraneState> cvode = cvode_run(
            {.rate = [&](const CraneState& x) { return crane.derivative(x, opening_m(x)); },
             .kinks =
                 [&](const CraneState& x) {
                     const double pendent_m = crane.outputs(x).pendent_length_m - crane.free_pendent_length_m();
                     return Eigen::Vector3d(x[R9_m] - crane.parameters().ropes.load_line_length_m,
                                            pendent_m + x[piston_index],
                                            -x[R1_m] - 4.11 * std::abs(std::sin(x[phi2_rad])));
                 }},
            start, duration_s, period_s);
        ASSERT_EQ(cvode.size(), own.size());
        const double difference = distance(own, cvode);
        RecordProperty("growth", std::to_string(growth));
        RecordProperty("difference", std::to_string(difference * 1e12) + "e-12");
        EXPECT_LT(difference, tolerance);
        // Far from trivial: the same test sees a thousandth of a percent of the load's mass.
        CraneParameters heavier = crane.parameters();
        heavier.structure.load_mass_kg *= 1.00001;
        EXPECT_GT(distance(own, own_run(CraneDynamics(heavier), start, 1e-12, law)), tolerance);
    }

    CraneDynamics crane{test_support::thesis_crane('A')};
    CraneState start = after_load_drop(crane, 0.076);
};

TEST_F(WholeTrajectory, UncontrolledCaseAIsCvodes) {
    compare([](const CraneState&) { return 0.0; });
}

TEST_F(WholeTrajectory, CaseAUnderLawTwoIsCvodes) {
    compare([this](const CraneState& x) { return 0.15 * (start[q1_m] - x[q1_m]); });
}

int kinsol_force(N_Vector p, N_Vector force, void* user) {
    const auto& crane = *static_cast<const CraneDynamics*>(user);
    mapped<coordinate_count>(force) =
        crane.generalized_force(Coordinates(mapped<coordinate_count>(p)), Coordinates::Zero(), 0.0);
    return 0;
}

class EquilibriumOf : public testing::TestWithParam<char> {};

TEST_P(EquilibriumOf, TheThesisCaseIsKinsols) {
    CraneDynamics crane(test_support::thesis_crane(GetParam()));
    const Context context;
    const NVector p = vector(coordinate_count, context);
    auto guess = mapped<coordinate_count>(p.get());
    guess << -2e-3, 1e-5, 12.23, 0.0, 0.0, crane.parameters().structure.boom_angle_rad - 1e-3, 0.0;
    const NVector ones = vector(coordinate_count, context);
    N_VConst(1.0, ones.get());
    const NVector force_scale = vector(coordinate_count, context);
    N_VConst(1e-6, force_scale.get());

    const std::unique_ptr<void, void (*)(void*)> memory(KINCreate(context), [](void* kinsol) { KINFree(&kinsol); });
    require(KINInit(memory.get(), kinsol_force, p.get()), "KINInit");
    require(KINSetUserData(memory.get(), &crane), "KINSetUserData");
    require(KINSetFuncNormTol(memory.get(), 1e-11), "KINSetFuncNormTol");
    require(KINSetScaledStepTol(memory.get(), 1e-15), "KINSetScaledStepTol");
    require(KINSetMaxSetupCalls(memory.get(), 1), "KINSetMaxSetupCalls");
    const std::unique_ptr<std::remove_pointer_t<SUNMatrix>, void (*)(SUNMatrix)> jacobian(
        SUNDenseMatrix(coordinate_count, coordinate_count, context), &SUNMatDestroy);
    const std::unique_ptr<std::remove_pointer_t<SUNLinearSolver>, int (*)(SUNLinearSolver)> solver(
        SUNLinSol_Dense(p.get(), jacobian.get(), context), &SUNLinSolFree);
    require(KINSetLinearSolver(memory.get(), solver.get(), jacobian.get()), "KINSetLinearSolver");
    ASSERT_EQ(KINSol(memory.get(), p.get(), KIN_LINESEARCH, ones.get(), force_scale.get()), KIN_SUCCESS);

    const Equilibrium own = find_equilibrium(crane);
    for (int i = 0; i < coordinate_count; ++i) {
        EXPECT_NEAR(own.state[i], guess[i], 1e-10) << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Thesis, EquilibriumOf, testing::Values('A', 'B', 'C'),
                         [](const auto& test) { return std::string("Case") + test.param; });

}  // namespace
}  // namespace steadyboom::plant
