#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace steadyboom::hil::benchmark {

/// What a row must reach and what it aims at; `at_most` says which side of them is good.
struct Bound {
    bool at_most;
    double must;
    double aim;
};

enum class Outcome {
    measured,
    absent,    ///< the peer is not on this machine; `remark` says what is missing
    disagree,  ///< the peer computed something else than we did, so its speed means nothing; `remark` says how far off
};

struct Figure {
    std::string name;
    double value;
    std::string unit;
};

struct Measurement {
    Outcome outcome = Outcome::measured;
    double value = 0.0;           ///< in the row's unit
    std::vector<Figure> figures;  ///< what the value was made of; these vary from machine to machine
    std::string remark;

    [[nodiscard]] static Measurement absence(std::string what) { return {Outcome::absent, 0.0, {}, std::move(what)}; }
    [[nodiscard]] static Measurement disagreement(std::string how) {
        return {Outcome::disagree, 0.0, {}, std::move(how)};
    }
};

/// One line of the table: something of ours against something else, in the same run.
struct Row {
    std::string name;  ///< for --rows
    std::string subject;
    std::string against;
    Bound bound;
    std::function<Measurement(int rounds)> measure;
};

enum class Verdict { aim, must, missed, absent, disagree };

[[nodiscard]] Verdict judge(const Bound& bound, const Measurement& measurement) noexcept;
[[nodiscard]] std::string_view word(Verdict verdict) noexcept;

/// The table's rows, file by file.
[[nodiscard]] std::vector<Row> dynamics_rows();
[[nodiscard]] std::vector<Row> integration_rows();
[[nodiscard]] std::vector<Row> lockstep_rows();
[[nodiscard]] std::vector<Row> network_rows();
[[nodiscard]] std::vector<Row> telemetry_rows();
[[nodiscard]] std::vector<Row> bus_rows();

}  // namespace steadyboom::hil::benchmark
