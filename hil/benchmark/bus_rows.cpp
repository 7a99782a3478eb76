#include <algorithm>
#include <array>
#include <ctime>
#include <limits>
#include <stdexcept>
#include <vector>

#include "drivers/socketcan_bus.hpp"
#include "hil/benchmark/peers/bare_can_socket.hpp"
#include "hil/benchmark/rounds.hpp"
#include "hil/benchmark/row.hpp"

namespace steadyboom::hil::benchmark {

namespace {

using drivers::CanFrame;
using drivers::SocketCanBus;

constexpr const char* interface = "vcan0";
constexpr int fills_per_block = 8;
constexpr int ticks_per_block = 200;
constexpr std::size_t frames_a_tick = 8;

/// Not CPU time: the kernel that brings a vcan where there is none counts it in steps of 10 ms.
std::int64_t steady_ns() noexcept {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

bool there_is_a_bus() {
    return BareCanSocket(interface).fd() >= 0;
}

Measurement no_bus() {
    return Measurement::absence("no vcan0 here: tests/vcan/with-vcan steadyboom-benchmark --rows receive,batched-io");
}

/// The quickest of a block's ticks.
template <class Tick>
double tick_ns(const Tick& tick) {
    std::int64_t least_ns = std::numeric_limits<std::int64_t>::max();
    for (int i = 0; i < ticks_per_block; ++i) {
        const std::int64_t begin_ns = steady_ns();
        tick();
        least_ns = std::min(least_ns, steady_ns() - begin_ns);
    }
    return static_cast<double>(least_ns);
}

/// As many frames as a tick reads, numbered.
std::vector<CanFrame> numbered(std::size_t count) {
    std::vector<CanFrame> frames(count, CanFrame{.id = 0x190, .length = 8});
    for (std::size_t i = 0; i < count; ++i) {
        frames[i].data[0] = static_cast<std::uint8_t>(i);
        frames[i].data[1] = static_cast<std::uint8_t>(i >> 8U);
    }
    return frames;
}

std::uint32_t number_of(const CanFrame& frame) {
    return frame.data[0] + 256U * frame.data[1];
}

void require(bool agreed) {
    if (!agreed) {
        throw std::runtime_error("frames were lost or came in another order");
    }
}

/// What `drain` takes for one of the frames that `fill` has put into a socket; sending is not in it. The quickest of a
/// block's drains: whatever else the machine does only adds.
template <class Fill, class Drain>
double receive_ns(const Fill& fill, const Drain& drain) {
    std::int64_t least_ns = std::numeric_limits<std::int64_t>::max();
    for (int i = 0; i < fills_per_block; ++i) {
        fill();
        const std::int64_t begin_ns = steady_ns();
        const std::size_t count = drain();
        least_ns = std::min(least_ns, steady_ns() - begin_ns);
        require(count == drivers::most_frames_a_tick);
    }
    return static_cast<double>(least_ns) / drivers::most_frames_a_tick;
}

Measurement measure_receive(int rounds) {
    if (!there_is_a_bus()) {
        return no_bus();
    }
    SocketCanBus sender(interface);
    const std::vector<CanFrame> sent = numbered(drivers::most_frames_a_tick);
    std::vector<CanFrame> received(drivers::most_frames_a_tick);
    const auto fill = [&] { require(sender.send(sent).dropped == 0); };
    const Candidate candidates[] = {
        {"ours",
         [&] {
             SocketCanBus bus(interface, {.filters = {{0x190}}});
             const double ns = receive_ns(fill, [&] { return bus.receive(received); });
             require(number_of(received.back()) == sent.size() - 1 && bus.status().receive_overflow_frames == 0);
             return ns;
         }},
        {"bare", [&] {
             BareCanSocket bare(interface);
             const double ns = receive_ns(fill, [&] { return bare.drain(); });
             require(bare.newest() == sent.size() - 1);
             return ns;
         }}};
    try {
        const Rounds result(candidates, rounds);
        return {.value = result.median_ratio(1, 0),
                .figures = {{"ours", 1e9 / result.median_ns(0), "frames/s"},
                            {"bare recvmmsg", 1e9 / result.median_ns(1), "frames/s"}},
                .remark = "ours has filters, both stamps, loss count, flags, checks and conversion in it"};
    } catch (const std::runtime_error& error) {
        return Measurement::disagreement(error.what());
    }
}

Measurement measure_batched_io(int rounds) {
    if (!there_is_a_bus()) {
        return no_bus();
    }
    const std::vector<CanFrame> sent = numbered(frames_a_tick);
    std::vector<CanFrame> received(drivers::most_frames_a_tick);
    // Each pair is alone on the bus while it is timed: a socket more would cost the sender.
    const Candidate candidates[] = {
        {"batched",
         [&] {
             SocketCanBus one(interface);
             SocketCanBus other(interface);
             return tick_ns(
                 [&] { require(one.send(sent).sent == frames_a_tick && other.receive(received) == frames_a_tick); });
         }},
        {"one call a frame", [&] {
             BareCanSocket one(interface);
             BareCanSocket other(interface);
             return tick_ns([&] {
                 require(one.write_one_by_one(frames_a_tick) == frames_a_tick &&
                         other.read_one_by_one() == frames_a_tick);
             });
         }}};
    try {
        const Rounds result(candidates, rounds);
        return {.value = result.median_ratio(0, 1),
                .figures = {{"batched", result.median_ns(0), "ns"}, {"one call a frame", result.median_ns(1), "ns"}},
                .remark = "8 frames out and 8 in"};
    } catch (const std::runtime_error& error) {
        return Measurement::disagreement(error.what());
    }
}

}  // namespace

std::vector<Row> bus_rows() {
    return {{"receive",
             "frames/s of the receive path, times",
             "bare recvmmsg loop",
             {.at_most = false, .must = 0.8, .aim = 0.9},
             measure_receive},
            {"batched-io",
             "8 frames in and out by the bus",
             "one read or write for each frame",
             {.at_most = true, .must = 0.5, .aim = 0.4},
             measure_batched_io}};
}

}  // namespace steadyboom::hil::benchmark
