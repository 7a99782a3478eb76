#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "drivers/cia408.hpp"
#include "drivers/command_guard.hpp"
#include "drivers/device_table.hpp"

namespace steadyboom::drivers {

/// How one make of valve is spoken to: a guarded command becomes frames, the valve's frames become its status. What its
/// frames hold of spool, piston and pressure, the table alone says. Allocates nothing after construction.
class ValveDriver {
  public:
    ValveDriver() = default;
    ValveDriver(const ValveDriver&) = delete;
    ValveDriver& operator=(const ValveDriver&) = delete;
    virtual ~ValveDriver() = default;

    /// The frames of this tick's command, once a tick; at most two. Nothing but a GuardedCommand ever becomes a valve
    /// frame. `sync_counter` is that of the SYNC which leaves with them. Valid until the next call.
    [[nodiscard]] virtual std::span<const CanFrame> encode(const GuardedCommand& command, std::uint8_t sync_counter,
                                                           std::int64_t now_ns) noexcept = 0;

    /// A frame of Pdo::valve_status that is whole and, if protected, good.
    virtual void decode(const CanFrame& status) noexcept = 0;

    /// As last heard; not_ready before that.
    [[nodiscard]] virtual const ValveStatus& status() const noexcept = 0;

    /// The valve lost its memory: it booted.
    virtual void restarted() noexcept = 0;
};

/// The driver for the valve that the table describes. The table must outlive it.
[[nodiscard]] std::unique_ptr<ValveDriver> make_valve_driver(const DeviceTable& table);

}  // namespace steadyboom::drivers
