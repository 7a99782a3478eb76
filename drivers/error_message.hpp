#pragma once

#include "drivers/can_bus.hpp"
#include "drivers/can_frame.hpp"

namespace steadyboom::drivers {

/// Takes what an interface's error message says (linux/can/error.h) into a bus's status. `frame.error` is set.
void note_error_message(const CanFrame& frame, BusStatus& status) noexcept;

}  // namespace steadyboom::drivers
