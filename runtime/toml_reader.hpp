#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace steadyboom::runtime {

/// Bad configuration. what() is one line: file, line, key, value and what is allowed. Programs end with exit code 2.
class ConfigError : public std::runtime_error {
  public:
    /// Control characters of `message` are replaced, so that it stays one line whatever the file held.
    explicit ConfigError(std::string_view message);
};

/// Allowed values of a number, in the unit of the file. Both bounds are finite, so it contains no NaN or infinity.
struct Range {
    double low = 0.0;
    double high = 0.0;
    bool low_open = false;   ///< `low` itself is not allowed
    bool high_open = false;  ///< `high` itself is not allowed

    [[nodiscard]] bool contains(double value) const noexcept;
    [[nodiscard]] std::string text() const;  ///< "[0, 90)"
};
[[nodiscard]] constexpr Range closed(double low, double high) {
    return {low, high, false, false};
}
[[nodiscard]] constexpr Range open(double low, double high) {
    return {low, high, true, true};
}
[[nodiscard]] constexpr Range above(double low, double high) {
    return {low, high, true, false};
}
[[nodiscard]] constexpr Range below(double low, double high) {
    return {low, high, false, true};
}

/// The keys of one kind of file, each bound to the variable that holds its value. The same list reads a file strictly,
/// writes it, scales one number of it and takes its fingerprint. Bound variables must outlive the schema.
///
/// Strict: every key is required unless it is declared optional, every other key or section is an error, an integer is
/// accepted where a number is asked and nothing else is converted.
class TomlSchema {
  public:
    /// Keys declared after this belong to `[name]`; dots in the name nest. Keys declared before any section stand at
    /// the top of the file.
    void section(std::string name);
    /// A section that may be left out as a whole. Its variables then keep their values.
    void optional_section(std::string name);

    /// `unit` is the file's; `si_per_file_unit` times the file's number is the variable's.
    void number(std::string key, double& variable, Range range, std::string unit, double si_per_file_unit = 1.0);
    template <class Whole>
    void integer(std::string key, Whole& variable, std::int64_t low, std::int64_t high, std::string unit = {}) {
        add(std::move(key),
            Integer{[&variable](std::int64_t value) { variable = static_cast<Whole>(value); },
                    [&variable] { return static_cast<std::int64_t>(variable); }, low, high},
            integer_allowed(low, high, unit));
    }
    void boolean(std::string key, bool& variable);
    /// `allowed` completes the sentence "must be ...".
    void text(std::string key, std::string& variable, std::function<bool(const std::string&)> accepts,
              std::string allowed);

    /// One of `words`, each of which stands for one value. The words must outlive the schema, as the variables do.
    template <class Value>
    void word(std::string key, Value& variable, std::span<const std::pair<std::string_view, Value>> words) {
        Word binding;
        for (const auto& [word, value] : words) {
            binding.words.emplace_back(word);
        }
        binding.set = [&variable, words](std::size_t i) { variable = words[i].second; };
        binding.get = [&variable, words] {
            std::size_t i = 0;
            while (i + 1 < words.size() && words[i].second != variable) {
                ++i;
            }
            return i;
        };
        add(std::move(key), std::move(binding), {});
    }

    /// The key declared last may be left out. Its variable then keeps its value.
    void optional();

    /// A condition on the key declared last that involves others; `requirement` completes the sentence "must ...".
    /// Checked once all keys are read.
    void rule(std::function<bool()> holds, std::string requirement);

    /// Throws ConfigError. Variables may be partly overwritten by then.
    void read_file(const std::filesystem::path& path);
    void read_text(std::string_view toml, std::string_view file_name);

    /// For what can be judged only after reading: throws ConfigError with the line of `full_name` unless it `holds`;
    /// `requirement` completes the sentence "must ...".
    void require(std::string_view full_name, bool holds, const std::string& requirement) const;

    /// A file that reads back to the same values, bit for bit, provided that they came from a file or scale().
    [[nodiscard]] std::string write() const;

    /// `change` is KEY=FACTOR; KEY is `section.key`, or `key` where that is unique. Multiplies the number as it stands
    /// in the file. Throws ConfigError for an unknown key, a key that is no number, a factor not finite and positive,
    /// or a result that no file could hold; the variable may be changed by then.
    void scale(std::string_view change);

    /// FNV-1a, 64 bits, over names and values of all keys.
    [[nodiscard]] std::uint64_t fingerprint() const;

  private:
    struct Number {
        double* variable;
        Range range;
        double si_per_file_unit;
        [[nodiscard]] double file_value() const;
    };
    struct Integer {
        std::function<void(std::int64_t)> set;
        std::function<std::int64_t()> get;
        std::int64_t low, high;
    };
    struct Boolean {
        bool* variable;
    };
    struct Text {
        std::string* variable;
        std::function<bool(const std::string&)> accepts;
    };
    struct Word {
        std::vector<std::string> words;
        std::function<void(std::size_t)> set;
        std::function<std::size_t()> get;
    };
    using Binding = std::variant<Number, Integer, Boolean, Text, Word>;
    struct Rule {
        std::function<bool()> holds;
        std::string requirement;
    };
    struct Key {
        std::size_t section;
        std::string name;
        Binding binding;
        std::string allowed;  ///< "a number in (0, 300] m"
        std::vector<Rule> rules;
        bool required = true;
        std::size_t line = 0;  ///< where the value was read; 0 when it was not
    };
    struct Section {
        std::string name;  ///< empty: top of the file
        bool required = true;
    };
    struct Document;

    [[nodiscard]] static std::string integer_allowed(std::int64_t low, std::int64_t high, const std::string& unit);
    void add(std::string name, Binding binding, std::string allowed);
    [[noreturn]] void fail(std::size_t line, const std::string& message) const;
    void read(const Document& document);
    void reject_unknown(const Document& document) const;
    void read_key(const Document& document, Key& key);
    [[nodiscard]] std::string full_name(const Key& key) const;
    [[nodiscard]] static std::string value_text(const Key& key);
    [[nodiscard]] std::string closest_names(std::string_view name, std::string_view section) const;
    [[nodiscard]] Key& find(std::string_view name, std::string_view change);

    std::vector<Section> sections_{Section{}};
    std::vector<Key> keys_;
    std::string file_name_;  ///< read last
};

}  // namespace steadyboom::runtime
