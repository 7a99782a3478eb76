#pragma once

#include <filesystem>
#include <string_view>

namespace steadyboom::hil {

/// Writes a file so that its name holds either the old content or all of the new: to a temporary name beside it, then
/// renamed. Creates the folder. Throws std::runtime_error that names the path and the cause, and leaves no temporary
/// file.
void write_whole_file(const std::filesystem::path& path, std::string_view content);

}  // namespace steadyboom::hil
