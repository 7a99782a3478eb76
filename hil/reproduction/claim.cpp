#include "hil/reproduction/claim.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plant/pinned_boom.hpp"

namespace steadyboom::hil::reproduction {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

std::string with_unit(double value, const std::string& unit) {
    const std::string text = std::abs(value) >= 1000.0 && std::abs(value) < 1e7 ? fmt::format("{:.0f}", value)
                                                                                : fmt::format("{:.3g}", value);
    return unit.empty() ? text : text + " " + unit;
}

std::string words(const Range& range, const std::string& unit) {
    if (range.low == -infinite && range.high == infinite) {
        return "any value";
    }
    if (range.low == -infinite) {
        return "at most " + with_unit(range.high, unit);
    }
    if (range.high == infinite) {
        return "at least " + with_unit(range.low, unit);
    }
    return range.low == range.high ? "exactly " + with_unit(range.low, unit)
                                   : fmt::format("{} to {}", with_unit(range.low, ""), with_unit(range.high, unit));
}

Range around(double value, double share) {
    return {std::min(value * (1.0 - share), value * (1.0 + share)),
            std::max(value * (1.0 - share), value * (1.0 + share))};
}

Row answer(const Claim& claim, const ThesisRuns& runs) {
    Row row{.id = claim.id,
            .section = claim.section,
            .figures = claim.figures,
            .claim = claim.claim,
            .thesis = claim.thesis,
            .measures = claim.measures(runs),
            .here = {},
            .reason = {},
            .would_hold_if = claim.would_hold_if.words(runs)};
    const Measure& worst = *std::ranges::max_element(row.measures, {}, &Measure::verdict);
    row.verdict = worst.verdict();
    for (const Measure& measure : row.measures) {
        row.here +=
            fmt::format("{}{} {}", row.here.empty() ? "" : "; ", measure.name, with_unit(measure.value, measure.unit));
    }
    row.reason = fmt::format("{}holds for {}",
                             row.measures.size() == 1 ? "" : worst.name + " decides: ", words(worst.holds, worst.unit));
    if (worst.in_kind.low != worst.holds.low || worst.in_kind.high != worst.holds.high) {
        row.reason += fmt::format(", in kind for {}", words(worst.in_kind, worst.unit));
    }
    if (row.verdict == Verdict::holds) {
        row.would_hold_if.clear();
    } else if (row.verdict == Verdict::does_not_hold && row.would_hold_if.empty()) {
        row.would_hold_if = fmt::format("{} would have to be {}", worst.name, words(worst.holds, worst.unit));
    }
    return row;
}

}  // namespace

std::string_view name_of(Verdict verdict) noexcept {
    switch (verdict) {
        case Verdict::holds:
            return "holds";
        case Verdict::holds_in_kind:
            return "holds in kind";
        case Verdict::does_not_hold:
            break;
    }
    return "does not hold";
}

Verdict Measure::verdict() const noexcept {
    if (!std::isfinite(value)) {
        return Verdict::does_not_hold;
    }
    if (holds.contains(value)) {
        return Verdict::holds;
    }
    return in_kind.contains(value) ? Verdict::holds_in_kind : Verdict::does_not_hold;
}

Measure number(std::string name, std::string unit, double thesis, double value) {
    const Range kind{std::min(0.5 * thesis, 2.0 * thesis), std::max(0.5 * thesis, 2.0 * thesis)};
    return {std::move(name), std::move(unit), value, around(thesis, 0.1), kind};
}

Measure frequency(std::string name, double thesis_Hz, double value_Hz) {
    return {std::move(name), "Hz", value_Hz, around(thesis_Hz, 0.1), around(thesis_Hz, 0.25)};
}

Measure change(std::string name, double thesis_percent, double value_percent) {
    const double margin = std::max(0.1 * std::abs(thesis_percent), 2.0);
    const Range kind = thesis_percent > 0.0 ? Range{0.0, infinite} : Range{-infinite, 0.0};
    return {std::move(name), "%", value_percent, Range{thesis_percent - margin, thesis_percent + margin}, kind};
}

Measure at_most(std::string name, std::string unit, double value, double limit, double in_kind) {
    return {std::move(name), std::move(unit), value, Range{-infinite, limit}, Range{-infinite, in_kind}};
}

Measure at_least(std::string name, std::string unit, double value, double limit, double in_kind) {
    return {std::move(name), std::move(unit), value, Range{limit, infinite}, Range{in_kind, infinite}};
}

Measure smaller(std::string name, double ratio) {
    return at_most(std::move(name), "", ratio, 1.0, 1.0);
}

Measure larger(std::string name, double ratio) {
    return at_least(std::move(name), "", ratio, 1.0, 1.0);
}

Measure same(std::string name, double ratio) {
    return {std::move(name), "", ratio, Range{1.0 / 1.1, 1.1}, Range{0.8, 1.25}};
}

std::string modes_in_words(const ThesisRun& run) {
    std::string words;
    for (const RunMode& mode : run.modes()) {
        if (mode.frequency_Hz < 30.0) {
            words += fmt::format("{}{:.2g}", words.empty() ? "" : ", ", mode.frequency_Hz);
        }
    }
    return words + " Hz";
}

std::string mode_would_have_to_be(const ThesisRun& run, double frequency_Hz) {
    const RunMode& nearest = *std::ranges::min_element(
        run.modes(), {}, [&](const RunMode& mode) { return std::abs(std::log(mode.frequency_Hz / frequency_Hz)); });
    const double ratio = frequency_Hz / nearest.frequency_Hz;
    const std::string modes = fmt::format("the linear modes of {} are at {}", run.name(), modes_in_words(run));
    if (std::abs(ratio - 1.0) <= 0.1) {
        return fmt::format("The mode in {}, at {:.3g} Hz, would have to be what is excited most; {}", nearest.dominant,
                           nearest.frequency_Hz, modes);
    }
    return fmt::format(
        "A mode would have to be at {:.3g} Hz and be excited most. The nearest, in {}, is at {:.3g} Hz and would need "
        "{:.2g} times its stiffness for its mass; {}",
        frequency_Hz, nearest.dominant, nearest.frequency_Hz, ratio * ratio, modes);
}

std::string booms_would_have_to_be_alike(const ThesisRuns& runs) {
    const plant::PinnedBoom boom = plant::pinned_boom(runs.a.options().crane_case.crane.structure);
    return fmt::format(
        "The two booms would have to differ no more than in the thesis. The condensation of 3.1.1-12 makes the links' "
        "first mode {:.3g} times as stiff as that of a beam of the same E I: alone they vibrate at {:.3g} Hz and it at "
        "{:.3g} Hz",
        std::pow(boom.links_Hz[0] / boom.beam_Hz[0], 2), boom.links_Hz[0], boom.beam_Hz[0]);
}

double alike_with_both_booms(const ThesisRuns& runs) {
    using enum Signal;
    constexpr std::array shown{R1_m, phi2_rad, phi6_rad, phi9_rad, R9_m};
    return static_cast<double>(std::ranges::count_if(
        shown, [&](Signal signal) { return spectral_likeness(runs.a, signal, runs.a_beam, signal) >= 0.7; }));
}

std::vector<Row> judge(const ThesisRuns& runs) {
    std::vector<Row> rows;
    for (const auto& claims : {chapter_5_claims(), chapter_7_claims(), chapter_8_claims()}) {
        for (const Claim& claim : claims) {
            rows.push_back(answer(claim, runs));
        }
    }
    return rows;
}

std::size_t count(const std::vector<Row>& rows, Verdict verdict) noexcept {
    return static_cast<std::size_t>(std::ranges::count(rows, verdict, &Row::verdict));
}

}  // namespace steadyboom::hil::reproduction
