#pragma once

#include "runtime/tick_record.hpp"
#include "steadyboom/tick_t.hpp"

namespace steadyboom::runtime {

/// The LCM message of a tick record, field by field.
[[nodiscard]] steadyboom::tick_t to_message(const TickRecord& record);

}  // namespace steadyboom::runtime
