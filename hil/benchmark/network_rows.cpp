#include <array>
#include <cmath>
#include <cstring>
#include <memory>

#include "drivers/crane_network.hpp"
#include "drivers/device_network.hpp"
#include "hil/benchmark/rounds.hpp"
#include "hil/benchmark/row.hpp"

namespace steadyboom::hil::benchmark {

namespace {

using drivers::CanFrame;

/// One turn of the SYNC counter: what arrives in it may be fed again and again, counters and heartbeats fit together.
constexpr std::size_t turn_ticks = drivers::sync_counter_last;
constexpr std::size_t start_ticks = 2 * turn_ticks;
constexpr plant::Permission engaged{.mode = plant::ValveMode::active, .cutoff_energised = true, .authority = 1.0};

/// The controller's side of the protected network in full work, fed with what the devices said in one turn.
class NetworkAtWork {
  public:
    NetworkAtWork() {
        drivers::DeviceNetwork devices(config_);
        drivers::Cia408Valve valve;
        plant::SensorVector sensors;
        sensors << 300.0, -120.0, 1.0, 133.4e3, 0.05, 12.2, -0.01, 3.0e-3, 6.8e6;
        std::vector<CanFrame> arrived;
        for (std::size_t k = 0; k < start_ticks + turn_ticks; ++k) {
            if (k >= start_ticks) {
                turn_.push_back(arrived);
            }
            devices.receive(tick(arrived), now_ns_);
            const auto state = valve.step({.control_word_raw = devices.valve_order().control_word});
            const auto beats = devices.housekeeping(now_ns_);
            arrived.assign(beats.begin(), beats.end());
            const auto answers = devices.answer_sync(sensors, {.status = {.state = state}}, now_ns_);
            arrived.insert(arrived.end(), answers.begin(), answers.end());
        }
    }

    std::span<const CanFrame> tick(std::span<const CanFrame> arrived) {
        now_ns_ += config_.period_ns;
        measured_ = network_.decode(arrived, now_ns_);
        return network_.encode(guard_.pass({1.0e-6 * static_cast<double>(++count_ % 100)}, engaged), now_ns_);
    }

    [[nodiscard]] const std::vector<std::vector<CanFrame>>& turn() const { return turn_; }
    [[nodiscard]] std::int64_t period_ns() const { return config_.period_ns; }

    /// Everything that came was believed, and the valve is in command.
    [[nodiscard]] bool sound() const {
        return network_.status().rejected_frames == 0 && network_.status().implausible_values == 0 &&
               network_.manager().all_required_operational() && measured_.fresh(plant::boom_angle_rad) &&
               network_.valve().state == plant::ValveState::active;
    }

  private:
    drivers::NetworkConfig config_;
    drivers::CraneNetwork network_{config_};
    drivers::CommandGuard guard_{{.max_opening_m = 7.6e-3, .max_step_m = 7.6e-3}};
    plant::CraneMeasurement measured_;
    std::int64_t now_ns_ = 0;
    std::uint64_t count_ = 0;
    std::vector<std::vector<CanFrame>> turn_;
};

Measurement measure_network(int rounds) {
    NetworkAtWork work;
    constexpr int calls = 20 * static_cast<int>(turn_ticks);
    std::array<CanFrame, 64> copy;
    const std::array candidates = {
        Candidate{"decode and encode",
                  [&] {
                      return cpu_ns_per_call(calls, [&](int k) {
                          const auto out = work.tick(work.turn()[static_cast<std::size_t>(k) % turn_ticks]);
                          return static_cast<double>(out.back().data[0]);
                      });
                  }},
        Candidate{"copy of the same frames", [&] {
                      return cpu_ns_per_call(calls, [&](int k) {
                          const auto& frames = work.turn()[static_cast<std::size_t>(k) % turn_ticks];
                          for (std::size_t i = 0; i < frames.size(); ++i) {
                              std::memcpy(&copy[i], &frames[i], sizeof(CanFrame));
                          }
                          return static_cast<double>(copy[static_cast<std::size_t>(k) % frames.size()].data[0]);
                      });
                  }}};
    const Rounds measured(candidates, rounds);
    if (!work.sound()) {
        return Measurement::disagreement("a frame of the recorded turn was not believed");
    }
    const double tick_ns = measured.median_ns(0);
    return {.value = 100.0 * tick_ns / static_cast<double>(work.period_ns()),
            .figures = {{"decode and encode of a tick", tick_ns, "ns"},
                        {"copying the frames that came", measured.median_ns(1), "ns"},
                        {"ratio of the two", measured.median_ratio(0, 1), ""}},
            .remark = "all devices protected: eight PDOs in, cut-off, command, twin and SYNC out, in % of 5 ms"};
}

}  // namespace

std::vector<Row> network_rows() {
    return {{"network",
             "decode and encode of a tick's frames, % of the tick",
             "the tick's period",
             {.at_most = true, .must = 0.05, .aim = 0.02},
             measure_network}};
}

}  // namespace steadyboom::hil::benchmark
