#include "hil/reproduction/sensitivity.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <thread>

#include <fmt/format.h>

#include "hil/case_file.hpp"
#include "hil/reproduction/misprints.hpp"
#include "hil/simulation.hpp"

namespace steadyboom::hil {

using controllers::LawKind;

namespace {

constexpr std::array case_names{"case-a", "case-b", "case-c"};
constexpr std::array laws{LawKind::none, LawKind::joint_deflection};
constexpr std::string_view nominal = "nominal";

/// Values that replace one number of the case file, or factors on it.
struct Variation {
    std::string_view key;
    double& (*number)(plant::CraneParameters&);
    std::vector<double> values;
    bool are_factors;
    bool in_case_a;
    std::string_view range;
    std::string_view reason;
};

const std::array<Variation, 4>& variations() {
    static const std::array<Variation, 4> all{
        Variation{.key = "soil.poisson_ratio",
                  .number = [](plant::CraneParameters& crane) -> double& { return crane.soil.poisson_ratio; },
                  .values = {0.20, 0.40, 0.49},
                  .are_factors = false,
                  .in_case_a = true,
                  .range = "0.20 to 0.49",
                  .reason = "not in the thesis; dry sand to saturated clay, which hardly changes its volume"},
        Variation{.key = "soil.density_kg_m3",
                  .number = [](plant::CraneParameters& crane) -> double& { return crane.soil.density_kg_m3; },
                  .values = {1400.0, 2200.0},
                  .are_factors = false,
                  .in_case_a = true,
                  .range = "1400 to 2200 kg/m^3",
                  .reason = "not in the thesis; loose dry sand to dense wet gravel"},
        Variation{
            .key = "actuator.bulk_modulus_Pa",
            .number = [](plant::CraneParameters& crane) -> double& { return crane.actuator.bulk_modulus_Pa; },
            .values = {0.25, 0.5, 2.0},
            .are_factors = true,
            .in_case_a = true,
            .range = "a quarter to twice 700 MPa",
            .reason = "not in the thesis; from oil with trapped air and long hoses to plain mineral oil in steel"},
        Variation{.key = "ropes.pendent_stiffness_N_m",
                  .number = [](plant::CraneParameters& crane) -> double& { return crane.ropes.pendent_stiffness_N_m; },
                  .values = {0.5, 0.75, 1.5, 2.0},
                  .are_factors = true,
                  .in_case_a = false,
                  .range = "half to twice the rope law's value and the printed value, cases B and C",
                  .reason = "the printed values cannot be; the rope law takes modulus and number of parts from case A, "
                            "where half or twice the parts are as likely"},
    };
    return all;
}

constexpr std::string_view valve_key = "actuator.valve_model";

struct Job {
    Case crane_case;
    SensitivityRow row;
};

std::vector<Job> jobs_of(std::string_view case_name) {
    const Case shipped = load_case(case_name);
    std::vector<Job> jobs;
    const auto add = [&](std::string_view key, std::string value, double factor, const Case& changed) {
        for (const LawKind law : laws) {
            jobs.push_back({.crane_case = changed,
                            .row = {.parameter = std::string(key),
                                    .value = value,
                                    .factor = factor,
                                    .case_name = std::string(case_name),
                                    .law = law,
                                    .figures = {},
                                    .failure = {}}});
        }
    };
    add(nominal, "as shipped", 1.0, shipped);
    for (const Variation& variation : variations()) {
        if (case_name == case_names[0] && !variation.in_case_a) {
            continue;
        }
        for (const double value : variation.values) {
            Case changed = shipped;
            double& number = variation.number(changed.crane);
            const double before = number;
            number = variation.are_factors ? value * before : value;
            add(variation.key, fmt::format("{:.4g}", number), number / before, changed);
        }
    }
    if (case_name != case_names[0]) {
        Case printed = shipped;
        double& stiffness_N_m = printed.crane.ropes.pendent_stiffness_N_m;
        const double before_N_m = stiffness_N_m;
        stiffness_N_m = case_name == case_names[1] ? printed_pendent_stiffness_b_N_m : printed_pendent_stiffness_c_N_m;
        add("ropes.pendent_stiffness_N_m", fmt::format("{:.4g}", stiffness_N_m), stiffness_N_m / before_N_m, printed);
    }
    Case truer = shipped;
    truer.crane.actuator.valve_model = plant::ValveModel::nonlinear;
    add(valve_key, "nonlinear", 1.0, truer);
    return jobs;
}

void run(Job& job, double duration_s) {
    try {
        job.row.figures =
            simulate({.crane_case = job.crane_case, .law = job.row.law, .duration_s = duration_s, .step_s = {}},
                     [](const TruthSample&) {});
    } catch (const std::runtime_error& error) {
        job.row.failure = error.what();
    }
}

struct Claim {
    std::string_view text;
    bool (*holds)(const RunFigures& free, const RunFigures& law2, const Case& crane_case);
};

constexpr std::array claims{
    Claim{"the pendent goes slack, uncontrolled",
          [](const RunFigures& free, const RunFigures&, const Case&) { return free.pendent_slack_share > 0.0; }},
    Claim{"the load line goes slack, uncontrolled",
          [](const RunFigures& free, const RunFigures&, const Case&) { return free.load_line_slack_share > 0.0; }},
    Claim{"the largest R1 comes within the first 0.5 s, uncontrolled",
          [](const RunFigures& free, const RunFigures&, const Case&) { return free.peak_R1_time_s < 0.5; }},
    Claim{"law 2 leaves less than half the residual energy",
          [](const RunFigures& free, const RunFigures& law2, const Case&) {
              return law2.residual_energy_J < 0.5 * free.residual_energy_J;
          }},
    Claim{"law 2 lowers the residual energy",
          [](const RunFigures& free, const RunFigures& law2, const Case&) {
              return law2.residual_energy_J < free.residual_energy_J;
          }},
    Claim{"law 2 keeps the pendent taut",
          [](const RunFigures&, const RunFigures& law2, const Case&) { return law2.pendent_slack_share == 0.0; }},
    Claim{"law 2 more than halves the late motion of the lower joint, q1",
          [](const RunFigures& free, const RunFigures& law2, const Case&) {
              return law2.late_rms_q1_m < 0.5 * free.late_rms_q1_m;
          }},
    Claim{"law 2 lowers the largest R1",
          [](const RunFigures& free, const RunFigures& law2, const Case&) { return law2.peak_R1_m < free.peak_R1_m; }},
    Claim{"law 2 lowers the largest phi2", [](const RunFigures& free, const RunFigures& law2,
                                              const Case&) { return law2.peak_phi2_rad < free.peak_phi2_rad; }},
    Claim{"law 2 stays off the valve's limits",
          [](const RunFigures&, const RunFigures& law2, const Case& crane_case) {
              return law2.peak_opening_m < crane_case.crane.actuator.spool_travel_m;
          }},
    Claim{"law 2 stays below the thesis's 21 MPa of load pressure",
          [](const RunFigures&, const RunFigures& law2, const Case& crane_case) {
              return law2.peak_load_pressure_Pa < crane_case.crane.actuator.load_pressure_report_Pa;
          }},
};

/// Jobs of one case lie in pairs, without and with law 2; the shipped case is the first pair.
std::vector<SensitivityVerdict> verdicts_of(const std::vector<Job>& jobs) {
    const auto holds = [&](const Claim& claim, std::size_t pair) {
        return claim.holds(jobs[pair].row.figures, jobs[pair + 1].row.figures, jobs[pair].crane_case);
    };
    std::vector<SensitivityVerdict> verdicts;
    for (const Claim& claim : claims) {
        SensitivityVerdict verdict{.claim = std::string(claim.text),
                                   .case_name = jobs.front().row.case_name,
                                   .nominal = holds(claim, 0),
                                   .changed = {}};
        for (std::size_t pair = laws.size(); pair < jobs.size(); pair += laws.size()) {
            const SensitivityRow& row = jobs[pair].row;
            const bool ran = row.failure.empty() && jobs[pair + 1].row.failure.empty();
            if (!ran || holds(claim, pair) != verdict.nominal) {
                verdict.changed.push_back(fmt::format("{} = {}{}", row.parameter, row.value, ran ? "" : " (no run)"));
            }
        }
        verdicts.push_back(std::move(verdict));
    }
    return verdicts;
}

}  // namespace

Sensitivity run_sensitivity(const std::function<void(int done, int all)>& progress, double duration_s) {
    if (!(duration_s > 0.0 && std::isfinite(duration_s))) {
        throw std::invalid_argument("the duration must be positive, in s");
    }
    std::array<std::vector<Job>, case_names.size()> cases;
    std::vector<Job*> all;
    for (std::size_t i = 0; i < case_names.size(); ++i) {
        cases[i] = jobs_of(case_names[i]);
        for (Job& job : cases[i]) {
            all.push_back(&job);
        }
    }

    std::atomic<std::size_t> next = 0;
    std::mutex reporting;
    int done = 0;
    const auto work = [&] {
        for (std::size_t i = next++; i < all.size(); i = next++) {
            run(*all[i], duration_s);
            const std::lock_guard lock(reporting);
            progress(++done, static_cast<int>(all.size()));
        }
    };
    {
        const std::jthread second(work);
        work();
    }

    Sensitivity result;
    for (const Variation& variation : variations()) {
        result.ranges.push_back({.parameter = std::string(variation.key),
                                 .range = std::string(variation.range),
                                 .reason = std::string(variation.reason)});
    }
    result.ranges.push_back({.parameter = std::string(valve_key),
                             .range = "linear (6-11) or nonlinear (6-22)",
                             .reason = "the thesis's own cases are linear; a real valve is not"});
    for (const std::vector<Job>& jobs : cases) {
        for (const Job& job : jobs) {
            result.rows.push_back(job.row);
        }
        const std::vector<SensitivityVerdict> verdicts = verdicts_of(jobs);
        result.verdicts.insert(result.verdicts.end(), verdicts.begin(), verdicts.end());
    }
    return result;
}

}  // namespace steadyboom::hil
