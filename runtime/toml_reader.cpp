#include "runtime/toml_reader.hpp"

#include <toml++/toml.h>
#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numeric>
#include <optional>

namespace steadyboom::runtime {

namespace {

constexpr std::size_t largest_file_bytes = 1U << 20U;
// A dotted key nests one table a dot, and the parser's tables are freed recursively: this bounds the depth.
constexpr std::size_t longest_line_bytes = 8192;
constexpr std::size_t longest_shown_text = 60;

std::string printable(std::string_view text) {
    std::string line(text);
    for (char& c : line) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7F) {
            c = '?';
        }
    }
    return line;
}

std::string shortened(std::string_view text) {
    if (text.size() <= longest_shown_text) {
        return std::string(text);
    }
    std::size_t end = longest_shown_text;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) {
        --end;
    }
    return std::string(text.substr(0, end)) + "...";
}

/// Shortest text that reads back to the same double.
std::string number_text(double value) {
    if (!std::isfinite(value)) {
        return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
    }
    char buffer[32];
    const auto [end, error] = std::to_chars(std::begin(buffer), std::end(buffer), value);
    return {buffer, end};
}

/// As number_text, but a float to TOML whatever its size: an integer literal beyond 64 bits is an error there.
std::string float_literal(double value) {
    std::string text = number_text(value);
    if (text.find_first_of(".en") == std::string::npos) {
        text += ".0";
    }
    return text;
}

std::string string_literal(std::string_view text) {
    std::string literal = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            literal += '\\';
            literal += c;
        } else if (byte < 0x20 || byte == 0x7F) {
            constexpr std::string_view digits = "0123456789ABCDEF";
            literal += "\\u00";
            literal += digits[byte >> 4U];
            literal += digits[byte & 0xFU];
        } else {
            literal += c;
        }
    }
    return literal + '"';
}

std::string node_text(const toml::node& node) {
    if (const auto* integer = node.as_integer()) {
        return std::to_string(integer->get());
    }
    if (const auto* number = node.as_floating_point()) {
        return number_text(number->get());
    }
    if (const auto* boolean = node.as_boolean()) {
        return boolean->get() ? "true" : "false";
    }
    if (const auto* text = node.as_string()) {
        return string_literal(shortened(text->get()));
    }
    if (node.is_table()) {
        return "a section";
    }
    return node.is_array() ? "an array" : "a date or time";
}

std::size_t line_of(const toml::node& node) {
    return std::max<std::size_t>(1, node.source().begin.line);
}

std::string joined(const std::string& section, std::string_view key) {
    return section.empty() ? std::string(key) : section + "." + std::string(key);
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

std::string read_whole_file(const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) {
        throw ConfigError(path.string() + ": cannot be read: is a directory; name a TOML file");
    }
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw ConfigError(path.string() + ": cannot be read: " + std::strerror(errno));
    }
    std::string text(largest_file_bytes + 1, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (file.bad()) {
        throw ConfigError(path.string() + ": cannot be read: " + std::strerror(errno));
    }
    text.resize(static_cast<std::size_t>(file.gcount()));
    if (text.size() > largest_file_bytes) {
        throw ConfigError(path.string() + ": is larger than 1 MiB, so it is no configuration file");
    }
    return text;
}

}  // namespace

ConfigError::ConfigError(std::string_view message) : std::runtime_error(printable(message)) {}

bool Range::contains(double value) const noexcept {
    return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::text() const {
    return (low_open ? "(" : "[") + number_text(low) + ", " + number_text(high) + (high_open ? ")" : "]");
}

struct TomlSchema::Document {
    const toml::table& root;

    [[nodiscard]] const toml::table* section(const std::string& name) const {
        return name.empty() ? &root : toml::at_path(root, name).as_table();
    }
};

void TomlSchema::fail(std::size_t line, const std::string& message) const {
    throw ConfigError(file_name_ + ":" + std::to_string(line) + ": " + message);
}

void TomlSchema::section(std::string name) {
    sections_.push_back({std::move(name), true});
}

void TomlSchema::optional_section(std::string name) {
    sections_.push_back({std::move(name), false});
}

void TomlSchema::number(std::string key, double& variable, Range range, std::string unit, double si_per_file_unit) {
    add(std::move(key), Number{&variable, range, si_per_file_unit},
        "a number in " + range.text() + (unit.empty() ? "" : " " + unit));
}

std::string TomlSchema::integer_allowed(std::int64_t low, std::int64_t high, const std::string& unit) {
    return "an integer in [" + std::to_string(low) + ", " + std::to_string(high) + "]" +
           (unit.empty() ? "" : " " + unit);
}

void TomlSchema::boolean(std::string key, bool& variable) {
    add(std::move(key), Boolean{&variable}, "true or false");
}

void TomlSchema::text(std::string key, std::string& variable, std::function<bool(const std::string&)> accepts,
                      std::string allowed) {
    add(std::move(key), Text{&variable, std::move(accepts)}, std::move(allowed));
}

void TomlSchema::optional() {
    keys_.back().required = false;
}

void TomlSchema::rule(std::function<bool()> holds, std::string requirement) {
    keys_.back().rules.push_back({std::move(holds), std::move(requirement)});
}

void TomlSchema::add(std::string name, Binding binding, std::string allowed) {
    if (const auto* word = std::get_if<Word>(&binding)) {
        for (const std::string& choice : word->words) {
            allowed += (allowed.empty() ? "" : &choice == &word->words.back() ? " or " : ", ") + string_literal(choice);
        }
    }
    keys_.push_back({sections_.size() - 1, std::move(name), std::move(binding), std::move(allowed), {}});
}

void TomlSchema::read_file(const std::filesystem::path& path) {
    read_text(read_whole_file(path), path.string());
}

void TomlSchema::read_text(std::string_view toml, std::string_view file_name) {
    file_name_ = file_name;
    std::size_t line = 1;
    for (std::size_t start = 0; start < toml.size(); ++line) {
        const std::size_t end = std::min(toml.find('\n', start), toml.size());
        if (end - start > longest_line_bytes) {
            fail(line, "is longer than " + std::to_string(longest_line_bytes) + " bytes, so this is no configuration");
        }
        start = end + 1;
    }
    try {
        const toml::table root = toml::parse(toml, file_name);
        read({root});
    } catch (const toml::parse_error& error) {
        fail(std::max<std::size_t>(1, error.source().begin.line),
             "not valid TOML: " + std::string(error.description()));
    }
}

void TomlSchema::read(const Document& document) {
    reject_unknown(document);
    for (Key& key : keys_) {
        key.line = 0;
        read_key(document, key);
    }
    for (const Key& key : keys_) {
        for (const Rule& rule : key.rules) {
            require(full_name(key), key.line == 0 || rule.holds(), rule.requirement);
        }
    }
}

void TomlSchema::require(std::string_view name, bool holds, const std::string& requirement) const {
    for (const Key& key : keys_) {
        if (!holds && full_name(key) == name) {
            fail(key.line, full_name(key) + " = " + shortened(value_text(key)) + ": must " + requirement);
        }
    }
}

void TomlSchema::reject_unknown(const Document& document) const {
    std::size_t line = std::numeric_limits<std::size_t>::max();
    std::string message;
    const auto inspect = [&](const auto& again, const toml::table& table, const std::string& section) -> void {
        for (const auto& [node_key, node] : table) {
            const std::string_view name = node_key.str();
            const std::string whole = joined(section, name);
            const bool known_key = std::any_of(keys_.begin(), keys_.end(), [&](const Key& key) {
                return sections_[key.section].name == section && key.name == name;
            });
            const bool known_section = std::any_of(sections_.begin() + 1, sections_.end(), [&](const Section& s) {
                return s.name == whole || s.name.starts_with(whole + ".");
            });
            if (known_section && node.is_table()) {
                again(again, *node.as_table(), whole);
                continue;
            }
            if (known_key || node_key.source().begin.line >= line) {
                continue;
            }
            line = std::max<std::size_t>(1, node_key.source().begin.line);
            const std::string full = joined(section, shortened(name));
            const bool takes_sections =
                section.empty() || std::any_of(sections_.begin(), sections_.end(),
                                               [&](const Section& s) { return s.name.starts_with(section + "."); });
            if (known_section) {
                message = full + " = " + node_text(node) + ": must be a section [" + full + "]";
            } else if (takes_sections && node.is_table()) {
                message = "[" + full + "]: unknown section; known are";
                for (std::size_t i = 1; i < sections_.size(); ++i) {
                    message += (i == 1 ? " [" : ", [") + sections_[i].name + "]";
                }
            } else {
                message = full + " = " + node_text(node) + ": unknown key; did you mean " +
                          closest_names(name, section) + "?";
            }
        }
    };
    inspect(inspect, document.root, "");
    if (!message.empty()) {
        fail(line, message);
    }
}

void TomlSchema::read_key(const Document& document, Key& key) {
    const Section& section = sections_[key.section];
    const toml::table* table = document.section(section.name);
    if (table == nullptr) {
        if (!section.required) {
            return;
        }
        fail(1, "[" + section.name + "]: section is missing");
    }
    const toml::node* node = table->get(key.name);
    if (node == nullptr && !key.required) {
        return;
    }
    if (node == nullptr) {
        fail(section.name.empty() ? 1 : line_of(*table), full_name(key) + ": is missing; must be " + key.allowed);
    }
    key.line = line_of(*node);

    const auto accepted = [&node](auto& binding) {
        using T = std::decay_t<decltype(binding)>;
        if constexpr (std::is_same_v<T, Number>) {
            const std::optional<double> value = node->is_number() ? node->value<double>() : std::nullopt;
            if (!value || !binding.range.contains(*value)) {
                return false;
            }
            *binding.variable = *value * binding.si_per_file_unit;
        } else if constexpr (std::is_same_v<T, Integer>) {
            const auto* value = node->as_integer();
            if (value == nullptr || value->get() < binding.low || value->get() > binding.high) {
                return false;
            }
            binding.set(value->get());
        } else if constexpr (std::is_same_v<T, Boolean>) {
            const auto* value = node->as_boolean();
            if (value == nullptr) {
                return false;
            }
            *binding.variable = value->get();
        } else if constexpr (std::is_same_v<T, Text>) {
            const auto* value = node->as_string();
            if (value == nullptr || !binding.accepts(value->get())) {
                return false;
            }
            *binding.variable = value->get();
        } else {
            const auto* value = node->as_string();
            const auto word = value == nullptr ? binding.words.end()
                                               : std::find(binding.words.begin(), binding.words.end(), value->get());
            if (word == binding.words.end()) {
                return false;
            }
            binding.set(static_cast<std::size_t>(word - binding.words.begin()));
        }
        return true;
    };
    if (!std::visit(accepted, key.binding)) {
        fail(key.line, full_name(key) + " = " + node_text(*node) + ": must be " + key.allowed);
    }
}

double TomlSchema::Number::file_value() const {
    // Division may miss the number that multiplies back to the variable by a unit in the last place, and two
    // neighbours may both do so: the one with the fewest digits is what somebody wrote.
    const double guess = *variable / si_per_file_unit;
    double best = guess;
    for (const double towards : {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()}) {
        double candidate = guess;
        for (int step = 0; step < 2; ++step) {
            candidate = std::nextafter(candidate, towards);
            const bool better =
                best * si_per_file_unit != *variable || number_text(candidate).size() < number_text(best).size();
            if (candidate * si_per_file_unit == *variable && better) {
                best = candidate;
            }
        }
    }
    return best;
}

std::string TomlSchema::full_name(const Key& key) const {
    return joined(sections_[key.section].name, key.name);
}

std::string TomlSchema::value_text(const Key& key) {
    return std::visit(
        [](const auto& binding) -> std::string {
            using T = std::decay_t<decltype(binding)>;
            if constexpr (std::is_same_v<T, Number>) {
                return float_literal(binding.file_value());
            } else if constexpr (std::is_same_v<T, Integer>) {
                return std::to_string(binding.get());
            } else if constexpr (std::is_same_v<T, Boolean>) {
                return *binding.variable ? "true" : "false";
            } else if constexpr (std::is_same_v<T, Text>) {
                return string_literal(*binding.variable);
            } else {
                return string_literal(binding.words[binding.get()]);
            }
        },
        key.binding);
}

std::string TomlSchema::write() const {
    std::string file;
    std::size_t section = 0;
    for (const Key& key : keys_) {
        if (key.section != section) {
            section = key.section;
            file += "\n[" + sections_[section].name + "]\n";
        }
        file += key.name + " = " + value_text(key) + "\n";
    }
    return file;
}

std::string TomlSchema::closest_names(std::string_view name, std::string_view section) const {
    const std::string_view compared = name.substr(0, 2 * longest_shown_text);
    const auto distance = [&](const Key& key) {
        const std::size_t elsewhere = sections_[key.section].name == section ? 0 : 2;
        const bool forgot_the_end = key.name != compared && key.name.starts_with(compared);
        return (forgot_the_end ? 1 : edit_distance(compared, key.name)) + elsewhere;
    };
    const auto closest = std::min_element(keys_.begin(), keys_.end(),
                                          [&](const Key& a, const Key& b) { return distance(a) < distance(b); });
    return full_name(*closest);
}

TomlSchema::Key& TomlSchema::find(std::string_view name, std::string_view change) {
    std::vector<Key*> found;
    for (Key& key : keys_) {
        if (full_name(key) == name || key.name == name) {
            found.push_back(&key);
        }
    }
    if (found.size() == 1) {
        return *found.front();
    }
    if (found.empty()) {
        const std::size_t dot = name.find('.');
        const std::string_view section = dot == std::string_view::npos ? "" : name.substr(0, dot);
        const std::string_view bare = dot == std::string_view::npos ? name : name.substr(dot + 1);
        throw ConfigError(shortened(change) + ": unknown key; did you mean " + closest_names(bare, section) + "?");
    }
    std::string message = shortened(change) + ": several keys have this name:";
    for (const Key* key : found) {
        message += " " + full_name(*key);
    }
    throw ConfigError(message);
}

void TomlSchema::scale(std::string_view change) {
    const std::size_t equals = change.find('=');
    if (equals == std::string_view::npos) {
        throw ConfigError(shortened(change) + ": must be KEY=FACTOR, for example soil.shear_modulus_Pa=1.2");
    }
    Key& key = find(change.substr(0, equals), change);
    auto* number = std::get_if<Number>(&key.binding);
    if (number == nullptr) {
        throw ConfigError(shortened(change) + ": " + full_name(key) + " is no number, so it cannot be scaled");
    }
    const std::string_view text = change.substr(equals + 1);
    double factor = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), factor);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(factor) || factor <= 0.0) {
        throw ConfigError(shortened(change) + ": the factor must be a finite number above 0");
    }
    const double scaled = number->file_value() * factor;
    const std::string result =
        shortened(change) + ": gives " + full_name(key) + " = " + number_text(scaled) + ": must ";
    if (!number->range.contains(scaled)) {
        throw ConfigError(result + "be " + key.allowed);
    }
    *number->variable = scaled * number->si_per_file_unit;
    for (const Key& other : keys_) {
        for (const Rule& rule : other.rules) {
            if (!rule.holds()) {
                throw ConfigError(&other == &key ? result + rule.requirement
                                                 : shortened(change) + ": " + full_name(other) + " = " +
                                                       value_text(other) + ": must " + rule.requirement);
            }
        }
    }
}

std::uint64_t TomlSchema::fingerprint() const {
    std::uint64_t hash = 0xCBF2'9CE4'8422'2325U;
    const auto mix = [&hash](std::uint8_t byte) { hash = (hash ^ byte) * 0x0000'0100'0000'01B3U; };
    const auto mix_text = [&mix](const std::string& text) {
        for (const char c : text) {
            mix(static_cast<std::uint8_t>(c));
        }
        mix(0);
    };
    for (const Key& key : keys_) {
        mix_text(full_name(key));
        if (const auto* number = std::get_if<Number>(&key.binding)) {
            const auto bits = std::bit_cast<std::uint64_t>(*number->variable + 0.0);
            for (unsigned shift = 0; shift < 64; shift += 8) {
                mix(static_cast<std::uint8_t>(bits >> shift));
            }
        } else {
            mix_text(value_text(key));
        }
    }
    return hash;
}

}  // namespace steadyboom::runtime
