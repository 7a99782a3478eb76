#include "runtime/bus_monitor.hpp"

#include <gtest/gtest.h>

#include "controllers/interlock.hpp"

namespace steadyboom::runtime {
namespace {

using namespace controllers;
using drivers::BusError;
using drivers::BusStatus;
using drivers::LinkState;

TEST(BusMonitor, EachThingABusGoesThroughIsOneReasonInThatTick) {
    const struct {
        const char* what;
        InterlockReason reason;
        void (*happens)(BusStatus&);
        bool lasts;
    } rows[] = {
        {"ENETDOWN told to receive", reason_interface_down, [](BusStatus& s) { s.receive_error = BusError::down; },
         true},
        {"ENETDOWN told to send", reason_interface_down, [](BusStatus& s) { s.send_error = BusError::down; }, true},
        {"ENODEV", reason_interface_gone, [](BusStatus& s) { s.receive_error = BusError::gone; }, true},
        {"ENXIO", reason_interface_gone, [](BusStatus& s) { s.send_error = BusError::gone; }, true},
        {"bus-off", reason_bus_off, [](BusStatus& s) { s.link = LinkState::bus_off; }, true},
        {"bus-off and back within a tick", reason_bus_off, [](BusStatus& s) { ++s.bus_offs; }, false},
        {"error-passive", reason_error_passive, [](BusStatus& s) { s.link = LinkState::passive; }, true},
        {"error-passive and back", reason_error_passive, [](BusStatus& s) { ++s.passives; }, false},
        {"error-warning", reason_error_warning, [](BusStatus& s) { s.link = LinkState::warning; }, true},
        {"error-warning and back", reason_error_warning, [](BusStatus& s) { ++s.warnings; }, false},
        {"flood", reason_flood, [](BusStatus& s) { ++s.floods; }, false},
        {"overflow", reason_flood, [](BusStatus& s) { ++s.receive_overflow_frames; }, false},
        {"spoof", reason_spoof, [](BusStatus& s) { ++s.spoofed_frames; }, false},
        {"overrun of the controller", reason_frames_lost, [](BusStatus& s) { ++s.controller_overruns; }, false},
        {"one failed send: the interlock counts these", reason_none,
         [](BusStatus& s) { s.send_error = BusError::no_room; }, true},
        {"frames from this machine where they may come from", reason_none, [](BusStatus& s) { ++s.local_frames; },
         false},
    };
    for (const auto& row : rows) {
        BusMonitor monitor;
        BusStatus status;
        EXPECT_EQ(monitor.reasons(status), reason_none);
        row.happens(status);
        EXPECT_EQ(monitor.reasons(status), row.reason) << row.what;
        EXPECT_EQ(monitor.reasons(status), row.lasts ? row.reason : reason_none) << row.what << ", a tick later";
    }
}

}  // namespace
}  // namespace steadyboom::runtime
