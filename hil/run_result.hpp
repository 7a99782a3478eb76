#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "controllers/law.hpp"
#include "drivers/can_frame.hpp"
#include "drivers/network_config.hpp"
#include "hil/case_file.hpp"
#include "hil/run_figures.hpp"
#include "hil/truth_sample.hpp"
#include "runtime/tick_record.hpp"

namespace steadyboom::hil {

/// What one closed-loop run is asked to be.
struct RunOptions {
    Case crane_case;  ///< the true crane, what happens to it, and the gains
    controllers::LawKind law = controllers::LawKind::none;
    double rate_Hz = 200.0;
    double duration_s = 10.0;             ///< after the brake event
    std::uint64_t seed = 1;               ///< of the sensor noise
    drivers::NetworkConfig network;       ///< of the devices; travel and period are the case's and the rate's
    std::vector<std::string> mismatches;  ///< KEY=FACTOR, falsify the controller's copy of the crane
};

/// One tick: what the controller recorded and the true crane at the same instant. The record's samples were taken one
/// tick earlier.
struct RunTick {
    runtime::TickRecord record;
    TruthSample truth;
};

/// A run that came to its end. t_s runs from -standing_s; the brake event is at t_s = 0.
struct RunResult {
    RunOptions options;
    std::string bus;  ///< "loopback" or the interface
    RunFigures figures;
    std::vector<RunTick> ticks;
    std::vector<drivers::CanFrame> frames;  ///< everything on the bus, in order, stamped with steady time
    std::int64_t epoch_ns = 0;              ///< steady time of t_s = -standing_s
    bool stayed_engaged = false;            ///< in command from before the brake event to the end
    std::string trouble;                    ///< why not, in words; empty otherwise

    static constexpr double standing_s = 5.0;  ///< at equilibrium before the brake event: arm, engage, settle
};

}  // namespace steadyboom::hil
