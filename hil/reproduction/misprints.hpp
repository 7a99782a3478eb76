#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace steadyboom::hil {

/// K_WRP as Table 1 prints it for cases B and C, N/m.
inline constexpr double printed_pendent_stiffness_b_N_m = 3.49e5;
inline constexpr double printed_pendent_stiffness_c_N_m = 6.57e4;

/// One number that a row's text quotes, at full precision; the unit ends the key.
struct MisprintNumber {
    std::string key;
    double value = 0.0;
};

/// One place where the thesis contradicts itself, what this project uses instead, and the calculation that decides it.
/// All numbers are computed when the row is made, from the shipped cases and the values the thesis prints.
struct MisprintRow {
    std::string id;
    std::string where;  ///< equation, figure or table of the thesis
    std::string printed;
    std::string used;
    std::string calculation;  ///< what decides between them
    std::string consequence;  ///< what the printed form leads to
    std::vector<MisprintNumber> numbers;

    /// Throws std::out_of_range for a key that the row does not have.
    [[nodiscard]] double number(std::string_view key) const;
};

/// Every misprint that the model decides, in the order of the thesis. Takes about a second: three runs of case A are
/// simulated. Throws what load_case, find_equilibrium and simulate throw.
[[nodiscard]] std::vector<MisprintRow> misprint_rows();

/// The row of that id. Throws std::out_of_range.
[[nodiscard]] const MisprintRow& misprint_row(const std::vector<MisprintRow>& rows, std::string_view id);

}  // namespace steadyboom::hil
