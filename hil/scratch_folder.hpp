#pragma once

#include <filesystem>

namespace steadyboom::hil {

/// A new folder that only this user can enter, gone with all it holds when this object is.
class ScratchFolder {
  public:
    /// Throws std::runtime_error that names `parent` and the cause.
    explicit ScratchFolder(const std::filesystem::path& parent);
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

  private:
    std::filesystem::path path_;
};

}  // namespace steadyboom::hil
