#include "hil/benchmark/row.hpp"

namespace steadyboom::hil::benchmark {

Verdict judge(const Bound& bound, const Measurement& measurement) noexcept {
    if (measurement.outcome == Outcome::absent) {
        return Verdict::absent;
    }
    if (measurement.outcome == Outcome::disagree) {
        return Verdict::disagree;
    }
    const auto reaches = [&](double limit) {
        return bound.at_most ? measurement.value <= limit : measurement.value >= limit;
    };
    return reaches(bound.aim) ? Verdict::aim : reaches(bound.must) ? Verdict::must : Verdict::missed;
}

std::string_view word(Verdict verdict) noexcept {
    switch (verdict) {
        case Verdict::aim:
            return "aim met";
        case Verdict::must:
            return "must met";
        case Verdict::missed:
            return "MISSED";
        case Verdict::absent:
            return "absent";
        case Verdict::disagree:
            return "DISAGREES";
    }
    return "";
}

}  // namespace steadyboom::hil::benchmark
