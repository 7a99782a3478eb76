#pragma once

#include <string>

#include "drivers/device_table.hpp"

namespace steadyboom::hil {

/// The network for people: bus load, devices, messages, fields.
[[nodiscard]] std::string can_table_text(const drivers::DeviceTable& table);

/// The same as JSON; values in the units of the network file, each with its unit.
[[nodiscard]] std::string can_table_json(const drivers::DeviceTable& table);

}  // namespace steadyboom::hil
