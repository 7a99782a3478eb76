#pragma once

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "hil/reproduction/thesis_runs.hpp"

namespace steadyboom::hil::reproduction {

enum class Verdict { holds, holds_in_kind, does_not_hold };

inline constexpr std::array all_verdicts{Verdict::holds, Verdict::holds_in_kind, Verdict::does_not_hold};

[[nodiscard]] std::string_view name_of(Verdict verdict) noexcept;

struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();

    [[nodiscard]] bool contains(double value) const noexcept { return value >= low && value <= high; }
};

/// One number taken from the runs and what the claim asks of it.
struct Measure {
    std::string name;  ///< what was measured, in words
    std::string unit;  ///< empty for a ratio
    double value = 0.0;
    Range holds;    ///< where the claim holds
    Range in_kind;  ///< where it holds in kind; never narrower than `holds`

    /// A number that is not finite does not hold.
    [[nodiscard]] Verdict verdict() const noexcept;
};

// The rules by which a claim turns into ranges.

/// A number of the thesis: holds within 10 %, in kind within a factor of 2, which asks for the sign too.
[[nodiscard]] Measure number(std::string name, std::string unit, double thesis, double value);
/// A frequency: holds within 10 %, in kind within 25 %; further off it is another mode.
[[nodiscard]] Measure frequency(std::string name, double thesis_Hz, double value_Hz);
/// A change in per cent: holds within 10 % of itself or 2 points, whichever is wider; in kind with the right sign.
[[nodiscard]] Measure change(std::string name, double thesis_percent, double value_percent);
/// A comparison in words: holds up to, or from, `limit`; in kind up to, or from, `in_kind`.
[[nodiscard]] Measure at_most(std::string name, std::string unit, double value, double limit, double in_kind);
[[nodiscard]] Measure at_least(std::string name, std::string unit, double value, double limit, double in_kind);
/// Plain yes or no: a ratio below, or above, one; there is nothing between.
[[nodiscard]] Measure smaller(std::string name, double ratio);
[[nodiscard]] Measure larger(std::string name, double ratio);
/// Two things said to be the same: holds within 10 %, in kind within 25 %.
[[nodiscard]] Measure same(std::string name, double ratio);

/// What would have to be true for a claim to hold: words, or words about the runs, whose numbers come from them.
class Condition {
  public:
    Condition(const char* words) : Condition(std::string(words)) {}
    Condition(std::string text) : words_([text = std::move(text)](const ThesisRuns&) { return text; }) {}
    template <typename Text>
    requires std::is_invocable_r_v<std::string, Text, const ThesisRuns&> Condition(Text text)
        : words_(std::move(text)) {}

    [[nodiscard]] std::string words(const ThesisRuns& runs) const { return words_(runs); }

  private:
    std::function<std::string(const ThesisRuns&)> words_;
};

/// The modes of a run's crane that are slower than 30 Hz: "0.14, 1.4, 3.7 Hz".
[[nodiscard]] std::string modes_in_words(const ThesisRun& run);
/// What would give a run's crane a mode of that frequency: the nearest one it has and how much stiffer or softer it
/// would have to be.
[[nodiscard]] std::string mode_would_have_to_be(const ThesisRun& run, double frequency_Hz);

/// How much stiffer the links are than the beam, in case A: why the two models differ.
[[nodiscard]] std::string booms_would_have_to_be_alike(const ThesisRuns& runs);
/// Of how many of R1, phi2, phi6, phi9 and R9 the spectra with links and beam are alike in case A, by a likeness of
/// 0.7.
[[nodiscard]] double alike_with_both_booms(const ThesisRuns& runs);

/// A sentence of the thesis about behaviour, and how the runs are asked about it.
struct Claim {
    std::string id;
    std::string section;  ///< chapter and case, "5, case A"
    std::string figures;  ///< numbers of the thesis's figures, "24, 25"; "-" if none
    std::string claim;    ///< in this project's words
    std::string thesis;   ///< its value with unit, or its word
    /// What would have to be true for it to hold; shown where it does not hold or holds in kind alone.
    Condition would_hold_if;
    /// At least one.
    std::function<std::vector<Measure>(const ThesisRuns&)> measures;
};

[[nodiscard]] std::vector<Claim> chapter_5_claims();
[[nodiscard]] std::vector<Claim> chapter_7_claims();
[[nodiscard]] std::vector<Claim> chapter_8_claims();

/// A claim with its answer.
struct Row {
    std::string id, section, figures, claim, thesis;
    std::vector<Measure> measures;
    Verdict verdict = Verdict::does_not_hold;
    std::string here;           ///< measured values with units
    std::string reason;         ///< which measure decided, where there are several, and its ranges
    std::string would_hold_if;  ///< empty where the claim holds, and perhaps where it does in kind
};

/// Asks the runs about every claim, in the thesis's order. A row is as good as the worst of its measures.
[[nodiscard]] std::vector<Row> judge(const ThesisRuns& runs);

[[nodiscard]] std::size_t count(const std::vector<Row>& rows, Verdict verdict) noexcept;

}  // namespace steadyboom::hil::reproduction
