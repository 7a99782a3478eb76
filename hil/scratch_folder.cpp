#include "hil/scratch_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

namespace steadyboom::hil {

ScratchFolder::ScratchFolder(const std::filesystem::path& parent) {
    std::string name = (parent / "steadyboom.XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
        throw std::runtime_error("cannot make a folder in " + parent.string() + ": " + std::strerror(errno));
    }
    path_ = name;
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace steadyboom::hil
