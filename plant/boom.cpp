#include "plant/boom.hpp"

#include <cmath>
#include <numbers>

namespace steadyboom::plant {

Boom::Boom(const StructureParameters& structure)
    : length_m(structure.boom_length_m), inverse_link_length_1_m(1.0 / structure.link_length_m()) {
    using std::numbers::pi;
    const double L_B = structure.link_length_m();
    const double R_B = structure.boom_length_m;
    const double EI_N_m2 = structure.boom_joint_stiffness_N_m * L_B / 3.0;
    const double C_B_N_m_s = structure.boom_damping_ratio * pi * pi * (3.0 / 8.0) * R_B * R_B *
                             std::sqrt(EI_N_m2 * structure.boom_link_mass_kg / (3.0 * R_B * R_B * R_B));
    bending_stiffness_N_m = 3.0 * structure.boom_joint_stiffness_N_m / (L_B * L_B);
    damping_N_s_m = C_B_N_m_s / (L_B * L_B);
}

}  // namespace steadyboom::plant
