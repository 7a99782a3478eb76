#include "drivers/error_message.hpp"

#include <linux/can/error.h>

namespace steadyboom::drivers {

void note_error_message(const CanFrame& frame, BusStatus& status) noexcept {
    ++status.error_frames;
    const bool whole = frame.length == CAN_ERR_DLC;
    if (whole && (frame.id & CAN_ERR_CNT) != 0) {
        status.transmit_error_count = frame.data[6];
        status.receive_error_count = frame.data[7];
    }
    if (whole && (frame.id & CAN_ERR_CRTL) != 0) {
        const std::uint8_t told = frame.data[1];
        if ((told & (CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW)) != 0) {
            ++status.controller_overruns;
        }
        if ((told & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
            status.link = LinkState::passive;
            ++status.passives;
        } else if ((told & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
            status.link = LinkState::warning;
            ++status.warnings;
        } else if ((told & CAN_ERR_CRTL_ACTIVE) != 0) {
            status.link = LinkState::active;
        }
    }
    if ((frame.id & CAN_ERR_RESTARTED) != 0) {
        status.link = LinkState::active;
    }
    if ((frame.id & CAN_ERR_BUSOFF) != 0) {
        status.link = LinkState::bus_off;
        ++status.bus_offs;
    }
}

}  // namespace steadyboom::drivers
