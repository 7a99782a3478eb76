#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "hil/boom_kind.hpp"
#include "runtime/crane_file.hpp"

namespace steadyboom::hil {

/// A true crane and what happens to it. The form of the file is documented in hil/cases/case-a.toml.
struct Case : runtime::CraneFile {
    BoomKind boom = BoomKind::links;
    runtime::Manoeuvre manoeuvre;
};

/// A shipped case by its name ("case-a") or any other by the path of its TOML file; a shipped name wins. Shipped cases
/// are found beside the installed program, else in the source folder, else below the install prefix. Throws
/// runtime::ConfigError.
[[nodiscard]] Case load_case(std::string_view name_or_path);

/// The file that load_case(name_or_path) would read. Throws runtime::ConfigError.
[[nodiscard]] std::filesystem::path find_case(std::string_view name_or_path);

/// A file that load_case reads back bit for bit, if `loaded` came from one or from runtime::apply_mismatch.
[[nodiscard]] std::string to_toml(const Case& loaded);

}  // namespace steadyboom::hil
