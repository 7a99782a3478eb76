// What may pass from the bus into either side of the network: of every frame that there can be, exactly the table's.

#include <array>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/crane_network.hpp"
#include "drivers/device_network.hpp"
#include "tests/support/j1939_network.hpp"

namespace steadyboom::drivers {
namespace {

using LengthById = std::map<std::uint32_t, int>;

enum class Kind { standard, extended, remote, error_message };

struct GateCount {
    std::uint64_t accepted = 0;
    std::uint64_t unknown_id = 0;
    std::uint64_t wrong_length = 0;
    std::uint64_t remote_or_extended = 0;
    std::uint64_t error_message = 0;
    bool operator==(const GateCount&) const = default;
};

template <typename Status>
GateCount count_of(const Status& status) {
    return {status.accepted_frames, status.unknown_id_frames, status.wrong_length_frames,
            status.remote_or_extended_frames, status.error_frames};
}

NetworkConfig config_with(Protection protection) {
    NetworkConfig config;
    for (std::size_t i = 1; i < device_count; ++i) {
        config.devices[i].protection = protection;
    }
    config.bit_rate_bit_s = 1'000'000;
    return config;
}

/// What the devices send: PDOs, and for each node heartbeat, emergency and SDO answer.
LengthById from_devices(int protection_bytes_of_pdo) {
    LengthById lengths = {{0x190, 6}, {0x194, 4}, {0x198, 5}, {0x199, 4},
                          {0x19C, 4}, {0x1A0, 4}, {0x2A0, 6}, {0x1A8, 1}};
    for (auto& [id, length] : lengths) {
        length += protection_bytes_of_pdo;
    }
    for (const std::uint32_t node : {0x10U, 0x14U, 0x18U, 0x19U, 0x1CU, 0x20U, 0x28U}) {
        lengths[0x080 + node] = 8;
        lengths[0x580 + node] = 8;
        lengths[0x700 + node] = 1;
    }
    return lengths;
}

/// What the controller sends: NMT, SYNC, its heartbeat, orders, the twin of a protected valve's, SDO requests.
LengthById from_controller(int protection_bytes_of_pdo) {
    LengthById lengths = {
        {0x000, 2}, {0x080, 1}, {0x701, 1}, {0x220, 4 + protection_bytes_of_pdo}, {0x228, 1 + protection_bytes_of_pdo}};
    if (protection_bytes_of_pdo > 0) {
        lengths[0x320] = lengths[0x220];
    }
    for (const std::uint32_t node : {0x10U, 0x14U, 0x18U, 0x19U, 0x1CU, 0x20U, 0x28U}) {
        lengths[0x600 + node] = 8;
    }
    return lengths;
}

/// Every classic frame: each identifier, length and kind. A CAN FD frame cannot come so far: the bus drops what has not
/// the size of a classic one (BusStatus::malformed_frames). Lengths that only CAN FD has are tried all the same.
template <typename Feed, typename Count>
void expect_gate(const LengthById& length_by_id, Feed feed, Count count) {
    GateCount expected;
    const auto try_frame = [&](const CanFrame& frame, Kind kind) {
        const auto known = length_by_id.find(frame.id);
        switch (kind) {
            case Kind::error_message:
                ++expected.error_message;
                break;
            case Kind::extended:
            case Kind::remote:
                ++expected.remote_or_extended;
                break;
            case Kind::standard:
                ++(known == length_by_id.end()     ? expected.unknown_id
                   : known->second != frame.length ? expected.wrong_length
                                                   : expected.accepted);
                break;
        }
        feed(frame);
        ASSERT_EQ(count(), expected) << std::hex << frame.id << " length " << int{frame.length} << " kind "
                                     << static_cast<int>(kind);
    };
    constexpr std::array<std::uint8_t, 18> lengths = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 16, 20, 24, 32, 48, 64, 255};
    for (std::uint32_t id = 0; id < standard_id_count; ++id) {
        for (const auto length : lengths) {
            for (const auto kind : {Kind::standard, Kind::extended, Kind::remote, Kind::error_message}) {
                CanFrame frame{.id = id,
                               .length = length,
                               .extended = kind == Kind::extended,
                               .remote = kind == Kind::remote,
                               .error = kind == Kind::error_message};
                try_frame(frame, kind);
                if (kind == Kind::extended) {
                    for (const unsigned high : {1U << 11U, 1U << 18U, 1U << 28U}) {
                        frame.id = id | high;
                        try_frame(frame, kind);
                    }
                }
                if (::testing::Test::HasFatalFailure()) {
                    return;
                }
            }
        }
    }
    EXPECT_EQ(expected.accepted, length_by_id.size());
}

class ReceiveGateTest : public ::testing::TestWithParam<Protection> {
  protected:
    [[nodiscard]] static int pdo_trailer_bytes() { return GetParam() == Protection::e2e ? 2 : 0; }
};

TEST_P(ReceiveGateTest, ControllerTakesExactlyTheDevicesFramesOfAllThatThereCanBe) {
    CraneNetwork network(config_with(GetParam()));
    const auto lengths = from_devices(pdo_trailer_bytes());
    expect_gate(
        lengths,
        [&](const CanFrame& frame) {
            const std::array frames = {frame};
            (void)network.decode(frames, 0);
        },
        [&] { return count_of(network.status()); });
    std::map<std::uint32_t, bool> filtered;
    for (const auto& filter : network.filters()) {
        filtered[filter.id] = true;
    }
    EXPECT_EQ(filtered.size(), lengths.size()) << "the kernel lets through what the gate takes";
    for (const auto& [id, length] : lengths) {
        EXPECT_TRUE(filtered.contains(id)) << std::hex << id;
    }
}

TEST_P(ReceiveGateTest, DevicesTakeExactlyTheControllersFramesOfAllThatThereCanBe) {
    DeviceNetwork network(config_with(GetParam()));
    expect_gate(
        from_controller(pdo_trailer_bytes()),
        [&](const CanFrame& frame) {
            const std::array frames = {frame};
            network.receive(frames, 0);
        },
        [&] { return count_of(network.status()); });
}

TEST_P(ReceiveGateTest, WhatTheGateRefusesLeavesNoTraceInTheMeasurement) {
    CraneNetwork network(config_with(GetParam()));
    const auto lengths = from_devices(pdo_trailer_bytes());
    for (std::uint32_t id = 0; id < standard_id_count; ++id) {
        for (std::uint8_t length = 0; length <= 8; ++length) {
            for (const auto kind : {Kind::standard, Kind::extended, Kind::remote, Kind::error_message}) {
                const auto known = lengths.find(id);
                if (kind == Kind::standard && known != lengths.end() && known->second == length) {
                    continue;
                }
                const std::array frames = {CanFrame{.id = id,
                                                    .length = length,
                                                    .data = {1, 1, 1, 0, 0, 0, 0, 0},
                                                    .extended = kind == Kind::extended,
                                                    .remote = kind == Kind::remote,
                                                    .error = kind == Kind::error_message}};
                const auto measured = network.decode(frames, 0);
                for (int channel = 0; channel < plant::sensor_count; ++channel) {
                    const auto i = static_cast<std::size_t>(channel);
                    ASSERT_EQ(measured.age_ticks[i], plant::CraneMeasurement::never) << std::hex << id;
                    ASSERT_FALSE(measured.valid[i]);
                    ASSERT_EQ(measured.value[channel], 0.0);
                }
                ASSERT_EQ(measured.valve_state, plant::ValveState::not_ready);
                ASSERT_FALSE(measured.cutoff_open);
                ASSERT_FALSE(measured.emergency_stop_healthy);
                ASSERT_EQ(measured.safety_inputs_age_ticks, plant::CraneMeasurement::never);
            }
        }
    }
    for (std::size_t i = 0; i < device_count; ++i) {
        EXPECT_EQ(network.node(static_cast<Device>(i)).state, NodeState::unknown);
    }
}

TEST(ReceiveGateOfAJ1939Valve, TakesOneIdentifierOfAllOfItsGroupsEachWay) {
    NetworkConfig config;
    test_support::make_valve_j1939(config);
    CraneNetwork controller(config);
    DeviceNetwork devices(config);
    for (std::uint32_t low = 0; low <= 0xFFFF; ++low) {
        for (std::uint8_t length = 0; length <= 8; ++length) {
            const std::array frames = {CanFrame{.id = 0x0CFE'0000U | low, .length = length, .extended = true}};
            (void)controller.decode(frames, 0);
            devices.receive(frames, 0);
            const auto taken = [&](std::uint32_t id) {
                return frames[0].id > id || (frames[0].id == id && length == 8);
            };
            ASSERT_EQ(controller.status().accepted_frames, taken(0x0CFE1020) ? 1U : 0U) << std::hex << low;
            ASSERT_EQ(devices.status().accepted_frames, taken(0x0CFE3026) ? 1U : 0U) << std::hex << low;
        }
    }
    EXPECT_EQ(controller.status().wrong_length_frames, 8U);
    EXPECT_EQ(devices.status().wrong_length_frames, 8U);
}

INSTANTIATE_TEST_SUITE_P(Protection, ReceiveGateTest, ::testing::Values(Protection::none, Protection::e2e),
                         [](const auto& chosen) {
                             return std::string(chosen.param == Protection::none ? "Unprotected" : "Protected");
                         });

}  // namespace
}  // namespace steadyboom::drivers
