#include "hil/commands/option_checks.hpp"

#include <cmath>

#include <fmt/format.h>

namespace steadyboom::hil {

namespace {

CLI::Validator number(const std::string& allowed, auto accepts) {
    return CLI::Validator(
        [=](const std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && accepts(value);
            return good ? std::string() : fmt::format("\"{}\": must be a number {}", text, allowed);
        },
        allowed);
}

}  // namespace

CLI::Validator positive_up_to(double most, const std::string& unit) {
    return number(fmt::format("in (0, {}] {}", most, unit),
                  [most](double value) { return value > 0.0 && value <= most; });
}

CLI::Validator between(double least, double most, const std::string& unit) {
    return number(fmt::format("in [{}, {}] {}", least, most, unit),
                  [least, most](double value) { return value >= least && value <= most; });
}

void add_boom_option(CLI::App& command, std::optional<BoomKind>& boom) {
    command
        .add_option_function<std::string>(
            "--boom",
            [&boom](const std::string& name) {
                boom = name == name_of(BoomKind::beam) ? BoomKind::beam : BoomKind::links;
            },
            "Of the true crane, instead of the case's own: links, the thesis's three, or beam, a continuum with three "
            "bending modes")
        ->check([](const std::string& text) {
            const bool good = text == name_of(BoomKind::links) || text == name_of(BoomKind::beam);
            return good ? std::string() : fmt::format("\"{}\": must be links or beam", text);
        });
}

std::string law_names() {
    std::string names;
    for (const controllers::LawKind law : controllers::all_laws) {
        names += (names.empty() ? "" : ", ") + std::string(controllers::name_of(law));
    }
    return names;
}

CLI::Validator law_name(bool all_too) {
    const std::string allowed = law_names() + (all_too ? " or all" : "");
    return CLI::Validator(
        [=](const std::string& text) {
            const bool good = controllers::law_named(text).has_value() || (all_too && text == "all");
            return good ? std::string() : fmt::format("\"{}\": must be one of {}", text, allowed);
        },
        "LAW");
}

}  // namespace steadyboom::hil
