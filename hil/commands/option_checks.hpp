#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "controllers/law.hpp"
#include "hil/boom_kind.hpp"

namespace steadyboom::hil {

/// Accepts a finite number in (0, most]; `unit` is for the message.
[[nodiscard]] CLI::Validator positive_up_to(double most, const std::string& unit);

/// Accepts a finite number in [least, most].
[[nodiscard]] CLI::Validator between(double least, double most, const std::string& unit);

/// Option --boom, set over what the case file says.
void add_boom_option(CLI::App& command, std::optional<BoomKind>& boom);

/// The laws' names, as one text "none, boom-angle, ...".
[[nodiscard]] std::string law_names();

/// Accepts the name of a law; with `all_too` also the word all.
[[nodiscard]] CLI::Validator law_name(bool all_too = false);

}  // namespace steadyboom::hil
