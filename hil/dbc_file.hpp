#pragma once

#include <string>

#include "drivers/device_table.hpp"

namespace steadyboom::hil {

/// The network as a DBC file: messages with senders and cycle times (GenMsgCycleTime, ms), signals in the units of the
/// network file with scale, range and receivers, words for states, COUNTER and CHECKSUM of protected frames.
[[nodiscard]] std::string dbc_of(const drivers::DeviceTable& table);

}  // namespace steadyboom::hil
