#include "runtime/crane_file.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace steadyboom::runtime {

namespace {

constexpr double rad_per_deg = std::numbers::pi / 180.0;

constexpr std::array<std::pair<std::string_view, plant::ValveModel>, 2> valve_models{
    {{"linear", plant::ValveModel::linear}, {"nonlinear", plant::ValveModel::nonlinear}}};

void declare_crane(TomlSchema& schema, plant::CraneParameters& crane) {
    plant::StructureParameters& structure = crane.structure;
    schema.section("crane");
    schema.number("boom_length_m", structure.boom_length_m, closed(3, 300), "m");
    schema.number("boom_link_mass_kg", structure.boom_link_mass_kg, closed(50, 5e5), "kg");
    schema.number("boom_joint_stiffness_N_m", structure.boom_joint_stiffness_N_m, closed(1e6, 1e12), "N m");
    schema.number("boom_damping_ratio", structure.boom_damping_ratio, closed(0, 0.2), "");
    schema.number("boom_outer_chord_m", structure.boom_outer_chord_m, closed(0.05, 10), "m");
    schema.number("boom_angle_deg", structure.boom_angle_rad, open(0, 90), "deg", rad_per_deg);
    schema.number("load_mass_kg", structure.load_mass_kg, closed(10, 3e6), "kg");
    schema.number("track_mass_kg", structure.track_mass_kg, closed(1e3, 5e6), "kg");
    schema.number("car_body_mass_kg", structure.car_body_mass_kg, closed(1e3, 5e6), "kg");
    schema.number("track_inertia_kg_m2", structure.track_inertia_kg_m2, closed(100, 1e9), "kg m^2");
    schema.number("car_body_inertia_kg_m2", structure.car_body_inertia_kg_m2, closed(100, 1e9), "kg m^2");
    schema.number("track_centre_height_m", structure.track_centre_height_m, closed(0.05, 10), "m");
    schema.number("car_body_height_m", structure.car_body_height_m, closed(0.1, 20), "m");
    schema.number("car_body_setback_m", structure.car_body_setback_m, closed(0, 40), "m");
    schema.number("boom_butt_offset_m", structure.boom_butt_offset_m, closed(-10, 20), "m");
    schema.number("car_body_angle_deg", structure.car_body_angle_rad, open(-90, 90), "deg", rad_per_deg);
    schema.number("pendent_anchor_radius_m", structure.pendent_anchor_radius_m, closed(0.5, 100), "m");
    schema.rule([&structure] { return structure.pendent_anchor_radius_m < structure.boom_length_m; },
                "be less than crane.boom_length_m");
    schema.number("pendent_anchor_angle_deg", structure.pendent_anchor_angle_rad, open(-90, 90), "deg", rad_per_deg);
    schema.rule(
        [&structure] {
            const double phi_B_rad =
                structure.pendent_anchor_angle_rad + std::numbers::pi / 2 - structure.boom_angle_rad;
            return closed(10, 170).contains(phi_B_rad / rad_per_deg);
        },
        "keep the angle between boom and anchor, this + 90 - crane.boom_angle_deg, within [10, 170] deg");

    plant::SoilParameters& soil = crane.soil;
    schema.section("soil");
    schema.number("shear_modulus_Pa", soil.shear_modulus_Pa, closed(1e5, 1e11), "Pa");
    schema.number("poisson_ratio", soil.poisson_ratio, below(0, 0.5), "");
    schema.number("density_kg_m3", soil.density_kg_m3, closed(500, 5e3), "kg/m^3");
    schema.number("track_half_length_m", soil.track_half_length_m, closed(0.3, 20), "m");
    schema.number("track_width_m", soil.track_width_m, closed(0.1, 10), "m");
    schema.rule([&soil] { return soil.track_width_m <= 2.0 * soil.track_half_length_m; },
                "not exceed twice soil.track_half_length_m");

    plant::RopeParameters& ropes = crane.ropes;
    schema.section("ropes");
    schema.number("load_line_length_m", ropes.load_line_length_m, closed(0.5, 500), "m");
    schema.number("load_line_stiffness_N_m", ropes.load_line_stiffness_N_m, closed(1e4, 1e10), "N/m");
    schema.number("pendent_stiffness_N_m", ropes.pendent_stiffness_N_m, closed(1e4, 1e10), "N/m");

    plant::ActuatorParameters& actuator = crane.actuator;
    schema.section("actuator");
    schema.word<plant::ValveModel>("valve_model", actuator.valve_model, valve_models);
    schema.number("piston_area_m2", actuator.piston_area_m2, closed(1e-4, 5), "m^2");
    schema.number("flow_gain_m2_s", actuator.flow_gain_m2_s, closed(1e-4, 1e3), "m^2/s");
    schema.number("oil_volume_m3", actuator.oil_volume_m3, closed(1e-6, 10), "m^3");
    schema.number("bulk_modulus_Pa", actuator.bulk_modulus_Pa, closed(1e8, 5e9), "Pa");
    schema.number("leakage_m3_s_Pa", actuator.leakage_m3_s_Pa, closed(0, 1e-6), "m^3/s/Pa");
    schema.number("spool_travel_m", actuator.spool_travel_m, closed(1e-4, 0.1), "m");
    schema.number("piston_travel_m", actuator.piston_travel_m, closed(1e-3, 5), "m");
    schema.number("supply_pressure_Pa", actuator.supply_pressure_Pa, closed(1e6, 1e8), "Pa");
    schema.number("load_pressure_report_Pa", actuator.load_pressure_report_Pa, closed(1e5, 1e8), "Pa");
    schema.rule([&actuator] { return actuator.load_pressure_report_Pa <= actuator.supply_pressure_Pa; },
                "not exceed actuator.supply_pressure_Pa");
    schema.number("discharge_coefficient", actuator.discharge_coefficient, closed(0.1, 1), "");
    schema.number("oil_density_kg_m3", actuator.oil_density_kg_m3, closed(600, 1500), "kg/m^3");
    schema.number("spool_diameter_m", actuator.spool_diameter_m, closed(1e-3, 0.5), "m");
    schema.number("spool_bandwidth_Hz", actuator.spool_bandwidth_Hz, closed(1, 1e3), "Hz");
    schema.number("spool_damping_ratio", actuator.spool_damping_ratio, closed(0.1, 5), "");
    schema.number("spool_delay_s", actuator.spool_delay_s, closed(0, 0.1), "s");
}

}  // namespace

double Manoeuvre::brake_rate_m_s() const noexcept {
    return std::sqrt(2.0 * plant::gravity_m_s2 * load_drop_m);
}

void declare_crane_file(TomlSchema& schema, CraneFile& file) {
    schema.text(
        "name", file.name, [](const std::string& text) { return !text.empty() && text.size() <= 100; },
        "a text of 1 to 100 bytes");
    schema.text(
        "description", file.description, [](const std::string& text) { return text.size() <= 1000; },
        "a text of at most 1000 bytes");
    declare_crane(schema, file.crane);

    controllers::ThesisGains& gains = file.gains;
    schema.section("gains");
    schema.number("boom_angle_gain_m_rad", gains.boom_angle_gain_m_rad, closed(0, 100), "m/rad");
    schema.number("boom_rate_gain_m_s_rad", gains.boom_rate_gain_m_s_rad, closed(0, 100), "m s/rad");
    schema.number("joint_gain_m_m", gains.joint_gain_m_m, closed(0, 100), "m/m");
    schema.number("swing_rate_gain_m_s_rad", gains.swing_rate_gain_m_s_rad, closed(0, 100), "m s/rad");
}

void declare_manoeuvre(TomlSchema& schema, Manoeuvre& manoeuvre) {
    schema.number("load_drop_m", manoeuvre.load_drop_m, closed(0, 10), "m");
    schema.number("duration_s", manoeuvre.duration_s, above(0, 3600), "s");
}

CraneFile load_crane_file(const std::filesystem::path& path) {
    CraneFile file;
    Manoeuvre dropped;
    std::string boom = "links";
    TomlSchema schema;
    schema.text(
        "boom", boom, [](const std::string& text) { return text == "links"; },
        "\"links\", the boom that the controller models, or left out; another boom is for the virtual crane's file");
    schema.optional();
    declare_crane_file(schema, file);
    schema.optional_section("manoeuvre");
    declare_manoeuvre(schema, dropped);
    schema.read_file(path);
    return file;
}

std::string to_toml(const CraneFile& file) {
    CraneFile copy = file;
    TomlSchema schema;
    declare_crane_file(schema, copy);
    return schema.write();
}

void apply_mismatch(CraneFile& file, std::string_view change) {
    CraneFile changed = file;
    TomlSchema schema;
    declare_crane_file(schema, changed);
    schema.scale(change);
    file = changed;
}

std::uint64_t crane_hash(const plant::CraneParameters& crane) {
    plant::CraneParameters copy = crane;
    TomlSchema schema;
    declare_crane(schema, copy);
    return schema.fingerprint();
}

}  // namespace steadyboom::runtime
