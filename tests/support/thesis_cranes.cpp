#include "support/thesis_cranes.hpp"

#include <numbers>
#include <stdexcept>
#include <string>

namespace steadyboom::test_support {

ThesisCase thesis_case(char name) {
    if (name != 'A' && name != 'B' && name != 'C') {
        throw std::invalid_argument(std::string("the thesis has cases A, B and C, not ") + name);
    }
    constexpr double degree_rad = std::numbers::pi / 180.0;
    const auto of = [name](double a, double b, double c) { return name == 'A' ? a : name == 'B' ? b : c; };

    ThesisCase result{};
    plant::StructureParameters& s = result.crane.structure;
    s.boom_length_m = of(45.7, 45.7, 91.4);
    s.boom_link_mass_kg = of(4730.0, 4730.0, 9460.0);
    s.boom_joint_stiffness_N_m = of(1.31e9, 1.31e9, 6.53e8);
    s.boom_damping_ratio = 0.007;
    s.boom_outer_chord_m = 1.22;
    s.boom_angle_rad = of(60.0, 70.0, 70.0) * degree_rad;
    s.load_mass_kg = 13600.0;
    s.track_mass_kg = 61300.0;
    s.car_body_mass_kg = 87600.0;
    s.track_inertia_kg_m2 = 3.95e5;
    s.car_body_inertia_kg_m2 = 3.39e5;
    s.track_centre_height_m = 0.762;
    s.car_body_height_m = 1.78;
    s.car_body_setback_m = 4.32;
    s.boom_butt_offset_m = 1.27;
    s.car_body_angle_rad = 2.86 * degree_rad;
    s.pendent_anchor_radius_m = 10.67;
    s.pendent_anchor_angle_rad = 40.1 * degree_rad;

    result.crane.soil = {.shear_modulus_Pa = of(82.7e6, 62.0e6, 41.4e6),
                         .poisson_ratio = 0.30,
                         .density_kg_m3 = 1780.0,
                         .track_half_length_m = 4.11,
                         .track_width_m = 1.22};
    result.crane.ropes = {.load_line_length_m = 12.2,
                          .load_line_stiffness_N_m = 3.83e6,
                          .pendent_stiffness_N_m = of(1.59e7, 1.031e7, 4.933e6)};

    plant::ActuatorParameters& a = result.crane.actuator;
    a.valve_model = plant::ValveModel::linear;
    a.piston_area_m2 = 0.0645;
    a.flow_gain_m2_s = 4.12;
    a.oil_volume_m3 = 1.31e-2;
    a.bulk_modulus_Pa = 700e6;
    a.leakage_m3_s_Pa = 0.0;
    a.spool_travel_m = 7.6e-3;
    a.piston_travel_m = 0.10;
    a.supply_pressure_Pa = 28e6;
    a.load_pressure_report_Pa = 21e6;
    a.discharge_coefficient = 0.61;
    a.oil_density_kg_m3 = 850.0;
    a.spool_diameter_m = 1.24e-2;

    result.load_drop_m = of(0.076, 0.305, 0.305);
    result.joint_gain = of(0.15, 0.15, 0.02);
    result.angle_gain_m_rad = 0.05;
    result.rate_gain_m_s_rad = 0.2;
    result.swing_gain_m_s_rad = 0.20;
    return result;
}

}  // namespace steadyboom::test_support
