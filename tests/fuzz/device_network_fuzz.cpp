// The crane's side of the network fed with whatever a bus can bring, round after round.

#include <cmath>
#include <limits>
#include <vector>

#include "drivers/device_network.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace steadyboom {
namespace {

using namespace drivers;
using tests::require;

constexpr std::size_t most_rounds = 400;
constexpr std::size_t most_frames_a_round = 16;

std::uint64_t frames_counted(const DeviceNetworkStatus& status) {
    return status.accepted_frames + status.unknown_id_frames + status.wrong_length_frames +
           status.remote_or_extended_frames + status.error_frames;
}

double sensor_value(tests::FuzzInput& input) {
    switch (input.byte() % 8) {
        case 0:
            return std::numeric_limits<double>::quiet_NaN();
        case 1:
            return std::numeric_limits<double>::infinity();
        case 2:
            return -std::numeric_limits<double>::max();
        case 3:
            return std::numeric_limits<double>::denorm_min();
        default:
            return 1.0e-4 * input.number<std::int32_t>();
    }
}

void check_sent(std::span<const CanFrame> frames, const DeviceTable& table) {
    for (const auto& frame : frames) {
        const auto message = table.message_with(frame.id, frame.extended);
        require(message != Message::none && !table.row(message).from_controller, "sent frames are the table's");
        require(frame.length == table.row(message).length_bytes, "and have its length");
        require(!frame.remote && !frame.error, "and carry data");
    }
}

void run(tests::FuzzInput input) {
    DeviceNetwork network(tests::network_config(input.byte()));
    const auto& table = network.table();
    const double travel_m = table.config().spool_travel_m;
    std::int64_t now_ns = input.number<std::int64_t>() >> 2U;
    std::uint64_t frames_fed = 0;
    for (std::size_t round = 0; round < most_rounds && !input.empty(); ++round) {
        std::vector<CanFrame> frames;
        const auto count = input.byte() % most_frames_a_round;
        for (std::size_t i = 0; i < count; ++i) {
            const auto choice = input.byte();
            auto frame = choice < 32 ? input.any_frame() : input.table_frame(table);
            if (choice >= 224) {  // most often an NMT command that means something
                constexpr std::array commands = {NmtCommand::start, NmtCommand::stop, NmtCommand::enter_pre_operational,
                                                 NmtCommand::reset_node, NmtCommand::reset_communication};
                frame = table.blank(Message::nmt, now_ns);
                frame.data[0] = static_cast<std::uint8_t>(commands[choice % commands.size()]);
                frame.data[1] = choice >= 240 ? std::uint8_t{0} : table.config().devices[input.below(8)].node_id;
            }
            const auto message = table.message_with(frame.id, frame.extended);
            if (choice >= 128 && message != Message::none && table.row(message).protection == Protection::e2e) {
                protect(frame, table.row(message).data_id, choice % 16U, 0);
            }
            frames.push_back(frame);
        }
        network.receive(frames, now_ns);
        frames_fed += frames.size();
        require(frames_counted(network.status()) == frames_fed, "every frame is counted once at the gate");

        const auto& order = network.valve_order();
        require(std::isfinite(order.set_point_m) && std::abs(order.set_point_m) <= travel_m * (1.0 + 1.0e-12),
                "no order beyond travel");
        require(!order.ever || network.state(Device::servo_valve) == NodeState::operational,
                "orders to a valve that is not operational are none");
        require(!order.cutoff_energised || network.state(Device::safety_io) == NodeState::operational,
                "a cut-off output that is not operational is off");

        check_sent(network.housekeeping(now_ns), table);
        if (network.sync_pending()) {
            plant::SensorVector sensors;
            for (auto& value : sensors) {
                value = sensor_value(input);
            }
            const ValveFeedback feedback{.status = valve_status(input.number<std::uint16_t>()),
                                         .cutoff_open = (input.byte() & 1U) != 0};
            check_sent(network.answer_sync(sensors, feedback, now_ns), table);
            require(!network.sync_pending(), "a SYNC is answered once");
        }
        now_ns += input.number<std::uint32_t>() % 60'000'000U;
    }
}

}  // namespace
}  // namespace steadyboom

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    steadyboom::run({data, size});
    return 0;
}
