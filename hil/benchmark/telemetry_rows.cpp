#include <chrono>
#include <ctime>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "hil/benchmark/peers/lcm_publisher.hpp"
#include "hil/benchmark/rounds.hpp"
#include "hil/benchmark/row.hpp"
#include "runtime/tick_record.hpp"
#include "runtime/tick_ring.hpp"

namespace steadyboom::hil::benchmark {

namespace {

using Record = runtime::TickRecord;

constexpr int ticks_per_round = 64;
constexpr std::int64_t period_ns = 1'000'000;

std::int64_t steady_ns() noexcept {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

void wait_until(std::int64_t due_ns) noexcept {
    const timespec due{due_ns / 1'000'000'000, due_ns % 1'000'000'000};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) != 0) {
    }
}

template <class Call>
double call_ns(const Call& call) {
    const std::int64_t begin_ns = steady_ns();
    call();
    return static_cast<double>(steady_ns() - begin_ns);
}

/// Where the deployed controller keeps its ring: a file in memory, removed with this object.
struct RingFile {
    std::filesystem::path path = fmt::format("/dev/shm/steadyboom-benchmark-{}", getpid());
    runtime::TickRingWriter<Record> writer{path, runtime::TickRingOptions{}};
    RingFile() = default;
    RingFile(const RingFile&) = delete;
    RingFile& operator=(const RingFile&) = delete;
    ~RingFile() {
        std::error_code error;
        std::filesystem::remove(path, error);
    }
};

Measurement measure_push(int rounds) {
    Record record;
    record.estimate.fill(0.1);
    const auto bytes = [&record] { return std::as_bytes(std::span(&record, 1)); };
    if (!LcmPublisher::delivers(bytes())) {
        return Measurement::absence("LCM delivers nothing here: no multicast (ip route add 239.0.0.0/8 dev lo)");
    }
    RingFile ring;
    runtime::TickRingReader<Record> reader(ring.path);
    ring.writer.push(record);
    Record read;
    if (!reader.read(read) || read.estimate != record.estimate || reader.lost() != 0) {
        return Measurement::disagreement("the ring gave back another record than was pushed");
    }

    LcmPublisher lcm;
    std::vector<double> pushes_ns, publishes_ns, clocks_ns, ratios;
    bool sent = true;
    std::int64_t due_ns = steady_ns() + period_ns;
    for (int round = 0; round < rounds; ++round) {
        std::vector<double> push_ns, publish_ns;
        for (int tick = 0; tick < ticks_per_round; ++tick, due_ns += period_ns) {
            wait_until(due_ns);
            record.tick += 1;
            record.time_ns = due_ns;
            clocks_ns.push_back(call_ns([] {}));
            const auto push = [&] { push_ns.push_back(call_ns([&] { ring.writer.push(record); })); };
            const auto publish = [&] { publish_ns.push_back(call_ns([&] { sent = lcm.publish(bytes()) && sent; })); };
            if (tick % 2 == 0) {
                push();
                publish();
            } else {
                publish();
                push();
            }
        }
        ratios.push_back(median(push_ns) / median(publish_ns));
        pushes_ns.insert(pushes_ns.end(), push_ns.begin(), push_ns.end());
        publishes_ns.insert(publishes_ns.end(), publish_ns.begin(), publish_ns.end());
    }
    if (!sent) {
        return Measurement::disagreement("LCM lost messages on the way out");
    }
    Measurement result{.value = median(ratios), .figures = {}, .remark = "paced at 1 kHz; both hold one clock reading"};
    const auto add = [&result](const std::string& name, const std::vector<double>& ns) {
        for (const auto& [label, share] : {std::pair{"p50", 0.5}, std::pair{"p99", 0.99}, std::pair{"p99.9", 0.999}}) {
            result.figures.push_back({name + " " + label, quantile(ns, share), "ns"});
        }
    };
    add("push", pushes_ns);
    add("publish", publishes_ns);
    result.figures.push_back({"clock p50", median(clocks_ns), "ns"});
    return result;
}

}  // namespace

std::vector<Row> telemetry_rows() {
    return {{"ring-push",
             "ring push of a tick record",
             "lcm publish of the same bytes, same loop",
             {.at_most = true, .must = 1.0 / 20.0, .aim = 1.0 / 50.0},
             measure_push}};
}

}  // namespace steadyboom::hil::benchmark
