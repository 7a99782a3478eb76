// The controller's side of the network fed with whatever a bus can bring, tick after tick.

#include <cmath>
#include <vector>

#include "drivers/crane_network.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace steadyboom {
namespace {

using namespace drivers;
using tests::require;

constexpr std::int64_t tick_ns = 5'000'000;
constexpr std::size_t most_ticks = 400;
constexpr std::size_t most_frames_a_tick = 24;

std::uint64_t frames_counted(const NetworkStatus& status) {
    return status.accepted_frames + status.unknown_id_frames + status.wrong_length_frames +
           status.remote_or_extended_frames + status.error_frames;
}

void check(const plant::CraneMeasurement& measured, const plant::CraneMeasurement& before, const DeviceTable& table) {
    for (const auto& row : table.signals()) {
        if (row.sensor == plant::sensor_count) {
            continue;
        }
        const auto channel = static_cast<std::size_t>(row.sensor);
        const double value = measured.value[row.sensor];
        require(std::isfinite(value), "every value is finite");
        const double tolerance = std::abs(row.scale_unit);
        const bool in_range = value >= row.lowest_unit - tolerance && value <= row.highest_unit + tolerance;
        require(!measured.valid[channel] || in_range, "a valid value is in range");
        const auto age = measured.age_ticks[channel];
        const auto age_before = before.age_ticks[channel];
        require(age == 0 || age == age_before || age == age_before + 1, "an age is 0 or grows by one");
        require(age == 0 || value == before.value[row.sensor], "a value changes with a new sample only");
        require(!measured.valid[channel] || age != plant::CraneMeasurement::never, "nothing is valid unheard");
    }
}

GuardedCommand command(CommandGuard& guard, tests::FuzzInput& input) {
    const auto choice = input.byte();
    const plant::Permission permit{
        .mode = static_cast<plant::ValveMode>(choice & 0x0FU),
        .cutoff_energised = (choice & 0x10U) != 0,
        .authority = (choice & 0x20U) != 0 ? 1.0 : 0.0,
    };
    return guard.pass({.opening_m = 1.0e-6 * input.number<std::int16_t>()}, permit);
}

void run(tests::FuzzInput input) {
    CraneNetwork network(tests::network_config(input.byte()));
    CommandGuard guard({.max_opening_m = 7.6e-3, .max_step_m = 7.6e-3});
    const auto& table = network.table();
    std::int64_t now_ns = input.number<std::int64_t>() >> 2U;
    std::uint64_t frames_fed = 0;
    std::uint8_t sync_counter = 0;
    plant::CraneMeasurement before;
    for (std::size_t tick = 0; tick < most_ticks && !input.empty(); ++tick) {
        std::vector<CanFrame> frames;
        const auto count = input.byte() % most_frames_a_tick;
        for (std::size_t i = 0; i < count; ++i) {
            const auto choice = input.byte();
            auto frame = choice < 32 ? input.any_frame() : input.table_frame(table);
            const auto& row = table.row(table.message_with(frame.id, frame.extended) == Message::none
                                            ? Message::nmt
                                            : table.message_with(frame.id, frame.extended));
            if (choice >= 128 && row.protection == Protection::e2e) {
                const auto counter = choice >= 160 ? protection_counter(sync_counter) : choice % 16U;
                protect(frame, row.data_id, static_cast<std::uint8_t>(counter), choice % 32U == 0 ? 1 : 0);
            }
            frames.push_back(frame);
        }
        const auto measured = network.decode(frames, now_ns);
        frames_fed += frames.size();
        require(frames_counted(network.status()) == frames_fed, "every frame is counted once at the gate");
        check(measured, before, table);
        before = measured;

        const auto sent = network.encode(command(guard, input), now_ns);
        require(!sent.empty() && sent.size() <= table.most_frames_a_tick(), "a tick's frames fit into the queue");
        for (const auto& frame : sent) {
            const auto message = table.message_with(frame.id, frame.extended);
            require(message != Message::none && table.row(message).from_controller, "sent frames are the table's");
            require(frame.length == table.row(message).length_bytes, "and have its length");
        }
        require(table.message_with(sent.back().id) == Message::sync, "SYNC leaves last");
        sync_counter = sent.back().data[0];
        require(sync_counter >= 1 && sync_counter <= sync_counter_last, "SYNC counts from 1 to 240");
        now_ns += input.byte() < 224 ? tick_ns : static_cast<std::int64_t>(input.number<std::uint32_t>());
    }
}

}  // namespace
}  // namespace steadyboom

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    steadyboom::run({data, size});
    return 0;
}
