#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace steadyboom::plant {

/// Index and unit of each sensor channel (model page, section 8).
enum Sensor : int {
    strain_lower_microstrain,  ///< bending strain of the outer chord at the lower boom joint
    strain_upper_microstrain,  ///< the same at the upper joint
    boom_angle_rad,            ///< phi6
    line_tension_N,            ///< load-pin force T_L
    line_angle_rad,            ///< phi9
    line_length_m,             ///< unstretched load line R9(t0), from the drum encoder
    piston_m,                  ///< X_p, from the valve's electronics
    spool_m,                   ///< X_v, the spool's true opening
    load_pressure_Pa,          ///< P_L = T_P / A_p
    sensor_count
};

using SensorVector = Eigen::Matrix<double, sensor_count, 1>;

/// CiA 408 device states by the bits R M H D of the status word.
enum class ValveState : std::uint8_t {
    not_ready = 0b0000,
    init = 0b1000,
    disabled = 0b1001,
    hold = 0b1011,
    active = 0b1111,
    fault_hold = 0b0011,
    fault_reaction = 0b0111,
    fault_disabled = 0b0001,
};

/// What one tick's frames brought, in SI. `value[i]` holds the newest good sample; `fresh` says which came
/// this tick. Before the first sample `value[i]` is 0 and `age_ticks[i]` is `never`.
struct CraneMeasurement {
    static constexpr std::uint32_t never = 0xFFFF'FFFFU;

    std::int64_t stamp_ns = 0;  ///< steady time of the SYNC on which these samples were taken
    SensorVector value = SensorVector::Zero();
    std::array<std::uint32_t, sensor_count> age_ticks = filled(never);  ///< ticks since a sample came; 0 = this tick
    std::array<bool, sensor_count> valid{};  ///< the device says the sample is good and it passed the range check
    ValveState valve_state = ValveState::not_ready;
    bool cutoff_open = false;                       ///< safety input: the cut-off valve is open
    bool emergency_stop_healthy = false;            ///< safety input: false when pressed, unwired or never heard
    std::uint32_t safety_inputs_age_ticks = never;  ///< ticks since the safety inputs came

    /// A sample of this channel came with this tick and is good.
    [[nodiscard]] bool fresh(Sensor sensor) const noexcept {
        const auto i = static_cast<std::size_t>(sensor);
        return valid[i] && age_ticks[i] == 0;
    }

  private:
    static constexpr std::array<std::uint32_t, sensor_count> filled(std::uint32_t ticks) {
        std::array<std::uint32_t, sensor_count> ages{};
        ages.fill(ticks);
        return ages;
    }
};

}  // namespace steadyboom::plant
