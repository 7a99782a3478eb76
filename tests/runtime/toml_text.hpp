#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace steadyboom::runtime {

inline std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

/// A file alone in a temporary folder.
class TemporaryFile {
  public:
    TemporaryFile(std::string name, const std::string& text) : name_(std::move(name)) {
        std::string folder = (std::filesystem::temp_directory_path() / "steadyboom-test-XXXXXX").string();
        if (mkdtemp(folder.data()) == nullptr) {
            throw std::runtime_error("no temporary folder");
        }
        folder_ = folder;
        std::ofstream(path(), std::ios::binary) << text;
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() { std::filesystem::remove_all(folder_); }
    [[nodiscard]] std::filesystem::path path() const { return folder_ / name_; }
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  private:
    std::string name_;
    std::filesystem::path folder_;
};

/// One `key = value` line of a file.
struct Line {
    std::size_t number;
    std::string section, key, value;
    [[nodiscard]] std::string full_name() const { return section.empty() ? key : section + "." + key; }
};

inline std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line);
    }
    return lines;
}

inline std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) {
        text += line + "\n";
    }
    return text;
}

inline std::vector<Line> key_lines(const std::string& text) {
    static const std::regex header(R"(^\[(\w+)\].*)");
    static const std::regex key(R"(^(\w+) = ("[^"]*"|[^ #]+).*)");
    std::vector<Line> found;
    std::string section;
    const std::vector<std::string> lines = lines_of(text);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        std::smatch match;
        if (std::regex_match(lines[i], match, header)) {
            section = match[1];
        } else if (std::regex_match(lines[i], match, key)) {
            found.push_back({i + 1, section, match[1], match[2]});
        }
    }
    return found;
}

inline std::string with_value(const std::string& text, const Line& line, const std::string& value) {
    std::vector<std::string> lines = lines_of(text);
    lines[line.number - 1] = line.key + " = " + value;
    return joined(lines);
}

}  // namespace steadyboom::runtime
