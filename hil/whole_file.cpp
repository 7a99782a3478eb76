#include "hil/whole_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

namespace steadyboom::hil {

void write_whole_file(const std::filesystem::path& path, std::string_view content) {
    const auto fail = [&](const std::string& cause) {
        throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), cause));
    };
    std::error_code trouble;
    if (path.has_parent_path()) {
        std::filesystem::create_directories(path.parent_path(), trouble);
        if (trouble) {
            fail(trouble.message());
        }
    }
    std::filesystem::path temporary = path;
    temporary += fmt::format(".{}.part", getpid());
    struct Removal {
        const std::filesystem::path& name;
        ~Removal() { std::remove(name.c_str()); }
    } const removal{temporary};

    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(temporary.c_str(), "wbe"), &std::fclose);
    if (!file) {
        fail(std::strerror(errno));
    }
    const bool written = std::fwrite(content.data(), 1, content.size(), file.get()) == content.size();
    const int write_error = errno;
    if (!written) {
        fail(std::strerror(write_error));
    }
    if (std::fclose(file.release()) != 0 || std::rename(temporary.c_str(), path.c_str()) != 0) {
        fail(std::strerror(errno));
    }
}

}  // namespace steadyboom::hil
