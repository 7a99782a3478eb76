#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "hil/truth_sample.hpp"

namespace steadyboom::hil {

/// The true crane after one integration step, as the plant process broadcasts it through a runtime::TickRing.
struct PlantRecord {
    static constexpr std::uint32_t layout_version = 3;

    std::uint64_t step = 0;
    std::int64_t time_ns = 0;  ///< steady time that the state belongs to
    double t_s = 0.0;          ///< 0 at the brake event
    std::array<double, plant::state_count> state{};
    double spool_m = 0.0;
    double pendent_tension_N = 0.0;
    double load_line_tension_N = 0.0;
    double chord_m = 0.0;
    double contact_fraction = 0.0;
    double load_pressure_Pa = 0.0;
    double hydraulic_power_W = 0.0;
    double residual_energy_J = 0.0;
    double boom_energy_J = 0.0;
    std::uint64_t valve_timeouts = 0;  ///< times the valve centred itself since the start

    [[nodiscard]] TruthSample truth() const noexcept {
        return {.t_s = t_s,
                .state = plant::CraneState(state.data()),
                .spool_m = spool_m,
                .pendent_tension_N = pendent_tension_N,
                .load_line_tension_N = load_line_tension_N,
                .chord_m = chord_m,
                .contact_fraction = contact_fraction,
                .load_pressure_Pa = load_pressure_Pa,
                .hydraulic_power_W = hydraulic_power_W,
                .residual_energy_J = residual_energy_J,
                .boom_energy_J = boom_energy_J};
    }
};

static_assert(std::is_trivially_copyable_v<PlantRecord> && sizeof(PlantRecord) % sizeof(std::uint64_t) == 0);

}  // namespace steadyboom::hil
