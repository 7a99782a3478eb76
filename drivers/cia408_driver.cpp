#include "drivers/cia408_driver.hpp"

#include <algorithm>

#include "drivers/inverted_twin.hpp"
#include "drivers/pdo_codec.hpp"

namespace steadyboom::drivers {

std::span<const CanFrame> Cia408Driver::encode(const GuardedCommand& command, std::uint8_t sync_counter,
                                               std::int64_t now_ns) noexcept {
    const auto& row = table_.row(Pdo::valve_command);
    const auto& set_point = table_.row(Signal::valve_set_point);
    auto& plain = frames_[0];
    plain = table_.blank(row.message, now_ns);
    if (command.valve_reset() && is_fault(status_.state) && !control_.resetting()) {
        control_.request_reset();
    }
    const auto word = control_.control_word(command.mode(), status_.state);
    const double opening_m = (word & control_active) != 0 ? command.opening_m() : 0.0;
    write_raw(table_.row(Signal::valve_control_word), word, plain);
    encode_value(set_point, std::clamp(opening_m, set_point.lowest_unit, set_point.highest_unit), plain);
    if (row.protection == Protection::none) {
        return {frames_.data(), 1};
    }
    protect(plain, row.data_id, protection_counter(sync_counter), protection_quality_good);
    auto& twin = frames_[1];
    twin = plain;
    twin.id = table_.row(Pdo::valve_twin).id;
    invert(twin);
    return frames_;
}

void Cia408Driver::decode(const CanFrame& status) noexcept {
    status_ = valve_status(static_cast<std::uint16_t>(read_raw(table_.row(Signal::valve_status_word), status)));
}

void Cia408Driver::restarted() noexcept {
    status_ = {};
    control_ = {};
}

}  // namespace steadyboom::drivers
