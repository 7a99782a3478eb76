#include "hil/reproduction/sensitivity.hpp"

#include <array>
#include <atomic>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <thread>

#include <fmt/format.h>

#include "hil/reproduction/misprints.hpp"

namespace steadyboom::hil::reproduction {

namespace {

using plant::CraneParameters;

/// Values that replace one number of the case file, or factors on it.
struct Varied {
    std::string_view key;
    std::string_view symbol;
    double& (*number)(CraneParameters&);
    std::vector<double> values;
    bool are_factors;
    std::vector<std::string_view> cases;  ///< varied one by one; empty: all at once
    std::string_view range;
    std::string_view reason;
};

constexpr std::string_view pendent_key = "ropes.pendent_stiffness_N_m";
constexpr std::string_view valve_key = "actuator.valve_model";

double& pendent_stiffness_N_m(CraneParameters& crane) {
    return crane.ropes.pendent_stiffness_N_m;
}

std::vector<Varied> varied() {
    return {
        {.key = "soil.poisson_ratio",
         .symbol = "nu",
         .number = [](CraneParameters& crane) -> double& { return crane.soil.poisson_ratio; },
         .values = {0.20, 0.40, 0.49},
         .are_factors = false,
         .cases = {},
         .range = "0.20 to 0.49",
         .reason = "not in the thesis; dry sand to saturated clay, which hardly changes its volume"},
        {.key = "soil.density_kg_m3",
         .symbol = "rho",
         .number = [](CraneParameters& crane) -> double& { return crane.soil.density_kg_m3; },
         .values = {1400.0, 2200.0},
         .are_factors = false,
         .cases = {},
         .range = "1400 to 2200 kg/m^3",
         .reason = "not in the thesis; loose dry sand to dense wet gravel"},
        {.key = "actuator.bulk_modulus_Pa",
         .symbol = "beta_e",
         .number = [](CraneParameters& crane) -> double& { return crane.actuator.bulk_modulus_Pa; },
         .values = {0.25, 0.5, 2.0},
         .are_factors = true,
         .cases = {},
         .range = "a quarter to twice 700 MPa",
         .reason = "not in the thesis; from oil with trapped air and long hoses to plain mineral oil in steel"},
        {.key = pendent_key,
         .symbol = "K_WRP",
         .number = pendent_stiffness_N_m,
         .values = {0.5, 0.75, 1.5, 2.0},
         .are_factors = true,
         .cases = {"case-b", "case-c"},
         .range = "half to twice the rope law's value and the printed value, cases B and C",
         .reason = "the printed values cannot be; the rope law takes modulus and number of parts from case A, where "
                   "half or twice the parts are as likely"}};
}

struct Job {
    Variation variation;
    std::function<void(CraneParameters&)> change;
};

/// A crane of that case, as it is without any variation.
const CraneParameters& crane_of(const ThesisRuns& runs, std::string_view case_name) {
    return (case_name == "case-c" ? runs.c : case_name == "case-b" ? runs.b : runs.a).options().crane_case.crane;
}

std::vector<Job> all_jobs(const ThesisRuns& nominal) {
    std::vector<Job> jobs;
    const auto add = [&](std::string_view key, std::string value, std::string symbol, double factor,
                         std::string_view case_name, std::function<void(CraneParameters&)> change) {
        jobs.push_back({.variation = {.parameter = std::string(key),
                                      .value = std::move(value),
                                      .symbol = std::move(symbol),
                                      .factor = factor,
                                      .case_name = std::string(case_name),
                                      .rows = {},
                                      .failure = {}},
                        .change = std::move(change)});
    };
    const auto add_number = [&](const Varied& one, double value, bool is_factor, std::string_view case_name) {
        CraneParameters shipped = crane_of(nominal, case_name);
        const double before = one.number(shipped);
        const double after = is_factor ? value * before : value;
        const std::string of = case_name == "case-b" ? " of B" : case_name == "case-c" ? " of C" : "";
        add(one.key, fmt::format("{:.4g}", after),
            fmt::format("{}{} {} {:g}", one.symbol, of, is_factor ? "x" : "=", value), after / before, case_name,
            [number = one.number, after](CraneParameters& crane) { number(crane) = after; });
    };
    for (const Varied& one : varied()) {
        const std::vector<std::string_view> at_once{""};
        for (const std::string_view case_name : one.cases.empty() ? at_once : one.cases) {
            for (const double value : one.values) {
                add_number(one, value, one.are_factors, case_name);
            }
            if (one.key == pendent_key) {
                add_number(one,
                           case_name == "case-b" ? printed_pendent_stiffness_b_N_m : printed_pendent_stiffness_c_N_m,
                           false, case_name);
            }
        }
    }
    add(valve_key, "nonlinear", "valve nonlinear", 1.0, "",
        [](CraneParameters& crane) { crane.actuator.valve_model = plant::ValveModel::nonlinear; });
    return jobs;
}

}  // namespace

Sensitivity run_sensitivity(const ThesisRuns& nominal, const std::function<void(int done, int all)>& progress) {
    std::vector<Job> jobs = all_jobs(nominal);
    std::atomic<std::size_t> next = 0;
    std::mutex reporting;
    int done = 0;
    std::exception_ptr unforeseen;
    const auto work = [&] {
        for (std::size_t i = next++; i < jobs.size(); i = next++) {
            Variation& variation = jobs[i].variation;
            try {
                variation.rows = judge(rerun(nominal, variation.case_name, jobs[i].change));
            } catch (const std::runtime_error& error) {
                variation.failure = error.what();
            } catch (...) {
                const std::lock_guard lock(reporting);
                unforeseen = std::current_exception();
            }
            const std::lock_guard lock(reporting);
            progress(++done, static_cast<int>(jobs.size()));
        }
    };
    {
        const std::jthread second(work);
        work();
    }
    if (unforeseen) {
        std::rethrow_exception(unforeseen);
    }

    Sensitivity result;
    for (const Varied& one : varied()) {
        result.ranges.push_back(
            {.parameter = std::string(one.key), .range = std::string(one.range), .reason = std::string(one.reason)});
    }
    result.ranges.push_back({.parameter = std::string(valve_key),
                             .range = "linear (6-11) or nonlinear (6-22)",
                             .reason = "the thesis's own cases are linear; a real valve is not"});
    for (Job& job : jobs) {
        result.variations.push_back(std::move(job.variation));
    }
    return result;
}

std::string name_of(const Variation& variation) {
    return fmt::format("{} = {}{}", variation.parameter, variation.value,
                       variation.case_name.empty() ? "" : " in " + variation.case_name);
}

std::vector<TurnedRow> turned_rows(const std::vector<Row>& rows, const Sensitivity& sensitivity) {
    std::vector<TurnedRow> turned;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        TurnedRow row{.row = &rows[i], .turns = {}};
        for (const Variation& variation : sensitivity.variations) {
            if (!variation.rows.empty() && variation.rows[i].verdict != rows[i].verdict) {
                row.turns.push_back({.variation = &variation, .to = variation.rows[i].verdict});
            }
        }
        if (!row.turns.empty()) {
            turned.push_back(std::move(row));
        }
    }
    return turned;
}

}  // namespace steadyboom::hil::reproduction
