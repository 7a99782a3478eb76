#include "plant/link_boom.hpp"

#include <cmath>
#include <numbers>

namespace steadyboom::plant {

LinkBoom::LinkBoom(const StructureParameters& structure)
    : length_m_(structure.boom_length_m),
      inverse_link_length_1_m_(1.0 / structure.link_length_m()),
      link_mass_kg_(structure.boom_link_mass_kg) {
    using std::numbers::pi;
    const double L_B = structure.link_length_m();
    const double R_B = structure.boom_length_m;
    const double C_B_N_m_s =
        structure.boom_damping_ratio * pi * pi * (3.0 / 8.0) * R_B * R_B *
        std::sqrt(structure.bending_stiffness_N_m2() * structure.boom_link_mass_kg / (3.0 * R_B * R_B * R_B));
    bending_stiffness_N_m_ = 3.0 * structure.boom_joint_stiffness_N_m / (L_B * L_B);
    damping_N_s_m_ = C_B_N_m_s / (L_B * L_B);
    strain_per_m_ = 9.0 * structure.boom_outer_chord_m / (L_B * L_B);
}

}  // namespace steadyboom::plant
