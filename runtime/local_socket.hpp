#pragma once

#include <cstdint>
#include <filesystem>

#include "runtime/file_descriptor.hpp"

namespace steadyboom::runtime {

/// A SOCK_SEQPACKET socket that listens at a path with that file mode; it never blocks. What a program that ended left
/// there is replaced. Throws std::runtime_error that names the path and the remedy.
[[nodiscard]] FileDescriptor listen_at(const std::filesystem::path& path, std::uint32_t file_mode);

/// Connected to who listens there; not open, with errno, when nobody does. Throws std::runtime_error for a path that is
/// empty or too long.
[[nodiscard]] FileDescriptor connect_to(const std::filesystem::path& path);

}  // namespace steadyboom::runtime
