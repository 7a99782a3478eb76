#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "controllers/law_gains.hpp"
#include "plant/crane_parameters.hpp"
#include "runtime/toml_reader.hpp"

namespace steadyboom::runtime {

/// One crane and the gains tuned to it. The form of the file is documented in hil/cases/case-a.toml.
struct CraneFile {
    std::string name;
    std::string description;
    plant::CraneParameters crane;
    controllers::ThesisGains gains;
};

/// What happens to the crane in a case: the load drops freely, the brake stops it, the load line catches it.
struct Manoeuvre {
    double load_drop_m = 0.0;  ///< free fall before the brake catches the load
    double duration_s = 0.0;   ///< simulated time after the brake event

    /// R9' at the brake event, sqrt(2 g drop), m/s.
    [[nodiscard]] double brake_rate_m_s() const noexcept;
};

/// Reads and checks a crane file; a section [manoeuvre] may be there, is checked and dropped. So is `boom`, which must
/// be "links": the controller models no other, and a file of another crane is no mistake to pass over. Throws
/// ConfigError.
[[nodiscard]] CraneFile load_crane_file(const std::filesystem::path& path);

/// A file that load_crane_file reads back bit for bit, if `file` came from one or from apply_mismatch.
[[nodiscard]] std::string to_toml(const CraneFile& file);

/// Multiplies one number of the file: "soil.shear_modulus_Pa=1.2", or the key alone where it is unique. Angles scale in
/// degrees, as they stand in the file. Throws ConfigError and leaves `file` as it was.
void apply_mismatch(CraneFile& file, std::string_view change);

/// Fingerprint of every parameter of the crane; equal parameters give equal values on every machine.
[[nodiscard]] std::uint64_t crane_hash(const plant::CraneParameters& crane);

/// Declares the keys of a crane file, bound to `file`.
void declare_crane_file(TomlSchema& schema, CraneFile& file);

/// Declares the keys of section [manoeuvre], for the section that was declared last.
void declare_manoeuvre(TomlSchema& schema, Manoeuvre& manoeuvre);

}  // namespace steadyboom::runtime
