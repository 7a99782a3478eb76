#include "hil/case_file.hpp"

#include <algorithm>
#include <array>
#include <system_error>
#include <vector>

namespace steadyboom::hil {

namespace {

namespace fs = std::filesystem;

void declare_case(runtime::TomlSchema& schema, Case& loaded) {
    schema.word<BoomKind>("boom", loaded.boom, boom_kinds);
    schema.optional();
    runtime::declare_crane_file(schema, loaded);
    schema.section("manoeuvre");
    runtime::declare_manoeuvre(schema, loaded.manoeuvre);
}

/// The program's own folder first: an install prefix may be chosen, or moved, after the build.
std::array<fs::path, 3> case_folders() {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    return {program.parent_path().parent_path() / "share/steadyboom/cases", STEADYBOOM_CASE_SOURCE_FOLDER,
            STEADYBOOM_CASE_INSTALL_FOLDER};
}

std::string known_cases() {
    std::vector<std::string> names;
    for (const fs::path& folder : case_folders()) {
        std::error_code error;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
            if (entry.path().extension() == ".toml") {
                names.push_back(entry.path().stem().string());
            }
        }
    }
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    std::string list;
    for (const std::string& name : names) {
        list += (list.empty() ? "" : ", ") + name;
    }
    return list.empty() ? "none is installed" : list;
}

}  // namespace

fs::path find_case(std::string_view name_or_path) {
    std::error_code error;
    const fs::path given(name_or_path);
    if (!given.has_parent_path()) {
        for (const fs::path& folder : case_folders()) {
            const fs::path file = folder / (std::string(name_or_path) + ".toml");
            if (fs::is_regular_file(file, error)) {
                return file;
            }
        }
    }
    if (fs::exists(given, error)) {
        return given;
    }
    throw runtime::ConfigError("case \"" + std::string(name_or_path) +
                               "\": must be the path of a TOML file or a known case: " + known_cases());
}

Case load_case(std::string_view name_or_path) {
    Case loaded;
    runtime::TomlSchema schema;
    declare_case(schema, loaded);
    schema.read_file(find_case(name_or_path));
    return loaded;
}

std::string to_toml(const Case& loaded) {
    Case copy = loaded;
    runtime::TomlSchema schema;
    declare_case(schema, copy);
    return schema.write();
}

}  // namespace steadyboom::hil
