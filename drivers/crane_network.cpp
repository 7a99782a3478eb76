#include "drivers/crane_network.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "drivers/pdo_codec.hpp"

namespace steadyboom::drivers {
namespace {

std::unique_ptr<DeviceTable> checked(std::unique_ptr<DeviceTable> table) {
    const double load_share = bus_load(*table).worst_case_share;
    if (load_share > largest_bus_load_share) {
        throw std::invalid_argument("CAN load at bit_rate_bit_s = " + std::to_string(table->config().bit_rate_bit_s) +
                                    " and period_ns = " + std::to_string(table->config().period_ns) + " is " +
                                    std::to_string(std::lround(100.0 * load_share)) +
                                    " %: allowed is 70 %, so raise the bit rate or the period");
    }
    return table;
}

}  // namespace

CraneNetwork::CraneNetwork(const NetworkConfig& config)
    : table_(checked(std::make_unique<DeviceTable>(config))),
      manager_(std::make_unique<NetworkManager>(*table_)),
      valve_(make_valve_driver(*table_)) {
    for (const auto& row : table_->messages()) {
        if (row.kind == MessageKind::pdo && row.present && !row.from_controller && row.protection == Protection::e2e) {
            inputs_[index_of(row.pdo)].receiver.emplace(row.data_id);
        }
    }
}

std::vector<CanFilter> CraneNetwork::filters() const {
    std::vector<CanFilter> filters;
    for (const auto& row : table_->messages()) {
        if (row.present && !row.from_controller) {
            filters.push_back({.id = row.id, .extended = row.extended});
        }
    }
    return filters;
}

plant::CraneMeasurement CraneNetwork::decode(std::span<const CanFrame> frames, std::int64_t now_ns) noexcept {
    ++tick_;
    const auto grow_older = [](std::uint32_t& age_ticks) {
        age_ticks += age_ticks < plant::CraneMeasurement::never - 1U ? 1U : 0U;
    };
    std::ranges::for_each(measurement_.age_ticks, grow_older);
    grow_older(measurement_.safety_inputs_age_ticks);

    for (const auto& frame : frames) {
        const auto message = accepted_message(frame);
        if (message == Message::none) {
            continue;
        }
        const auto& row = table_->row(message);
        switch (row.kind) {
            case MessageKind::heartbeat:
                decode_heartbeat(row.device, frame.data[0], now_ns);
                break;
            case MessageKind::emergency:
                manager_->take_emergency(row.device, frame);
                break;
            case MessageKind::sdo_answer:
                manager_->take_sdo_answer(frame);
                break;
            case MessageKind::pdo:
                take_pdo(row, frame);
                break;
            default:
                break;
        }
    }
    manager_->update(now_ns);
    for (std::size_t i = 0; i < pdo_count; ++i) {
        close_pdo(table_->row(static_cast<Pdo>(i)));
    }
    measurement_.valve_state = valve_->status().state;
    measurement_.stamp_ns = sync_stamp_ns_;
    return measurement_;
}

Message CraneNetwork::accepted_message(const CanFrame& frame) noexcept {
    if (frame.error) {
        ++status_.error_frames;
        status_.last_error_class = frame.id;
        return Message::none;
    }
    const auto message = frame.remote ? Message::none : table_->message_with(frame.id, frame.extended);
    if (message == Message::none && (frame.extended || frame.remote)) {
        ++status_.remote_or_extended_frames;
        return Message::none;
    }
    if (message == Message::none || table_->row(message).from_controller) {
        ++status_.unknown_id_frames;
        return Message::none;
    }
    if (frame.length != table_->row(message).length_bytes) {
        ++status_.wrong_length_frames;
        return Message::none;
    }
    ++status_.accepted_frames;
    return message;
}

void CraneNetwork::decode_heartbeat(Device device, std::uint8_t state_raw, std::int64_t now_ns) noexcept {
    const auto state = static_cast<NodeState>(state_raw);
    switch (state) {
        case NodeState::boot_up:
        case NodeState::stopped:
        case NodeState::operational:
        case NodeState::pre_operational:
            manager_->take_heartbeat(device, state, now_ns);
            if (device == Device::servo_valve && state == NodeState::boot_up) {
                valve_->restarted();
            }
            break;
        default:
            ++status_.out_of_range_values;
    }
}

void CraneNetwork::take_pdo(const MessageRow& row, const CanFrame& frame) noexcept {
    manager_->take_process_data(row.device);
    if (!manager_->operational(row.device)) {
        ++status_.not_operational_frames;
        return;
    }
    auto& input = inputs_[index_of(row.pdo)];
    const auto verdict = input.receiver ? input.receiver->check(frame) : FrameVerdict::good;
    if (verdict != FrameVerdict::good && verdict != FrameVerdict::poor_quality) {
        ++status_.rejected_frames;
        return;
    }
    status_.superseded_frames += input.newest != nullptr ? 1U : 0U;
    input.newest = &frame;
    input.poor_quality = verdict == FrameVerdict::poor_quality;
}

void CraneNetwork::close_pdo(const MessageRow& row) noexcept {
    auto& input = inputs_[index_of(row.pdo)];
    const auto* newest = std::exchange(input.newest, nullptr);
    if (input.receiver) {
        input.receiver->close_tick();
        const bool answers_sync = row.cycle == Cycle::on_sync && sync_counter_ != 0;
        input.lag_ticks = answers_sync ? input.receiver->lag_ticks(sync_counter_) : std::uint8_t{0};
    }
    if (state(row.pdo) != ReceiverState::valid) {
        status_.unbelieved_frames += newest != nullptr ? 1U : 0U;
        disbelieve(row);
    } else if (newest != nullptr && input.lag_ticks > largest_counter_step) {
        ++status_.late_frames;
    } else if (newest != nullptr) {
        decode_pdo(row, *newest, input.poor_quality);
    }
}

ReceiverState CraneNetwork::state(Pdo pdo) const noexcept {
    const auto& receiver = inputs_[index_of(pdo)].receiver;
    return receiver ? receiver->state() : ReceiverState::valid;
}

std::uint8_t CraneNetwork::lag_ticks(Pdo pdo) const noexcept {
    return inputs_[index_of(pdo)].lag_ticks;
}

void CraneNetwork::disbelieve(const MessageRow& row) noexcept {
    for (const auto& signal : table_->signals()) {
        if (signal.message == row.message && signal.sensor != plant::sensor_count) {
            measurement_.valid[static_cast<std::size_t>(signal.sensor)] = false;
        }
    }
}

void CraneNetwork::decode_pdo(const MessageRow& row, const CanFrame& frame, bool poor_quality) noexcept {
    for (const auto& signal : table_->signals()) {
        if (signal.message == row.message && signal.sensor != plant::sensor_count) {
            decode_sensor(signal, frame, poor_quality);
        }
    }
    if (poor_quality) {
        return;
    }
    const auto is_set = [&](Signal signal) { return read_raw(table_->row(signal), frame) != 0; };
    if (row.pdo == Pdo::valve_status) {
        valve_->decode(frame);
    } else if (row.pdo == Pdo::safety_inputs) {
        measurement_.cutoff_open = is_set(Signal::cutoff_open);
        measurement_.emergency_stop_healthy = is_set(Signal::emergency_stop_healthy);
        measurement_.safety_inputs_age_ticks = 0;
    }
}

void CraneNetwork::decode_sensor(const SignalRow& row, const CanFrame& frame, bool poor_quality) noexcept {
    const auto channel = static_cast<std::size_t>(row.sensor);
    auto& valid = measurement_.valid[channel];
    const bool device_says_ok =
        !poor_quality &&
        (row.status == Signal::none || read_raw(table_->row(row.status), frame) == static_cast<int>(SampleStatus::ok));
    if (!device_says_ok) {
        ++status_.faulty_values;
        measurement_.age_ticks[channel] = 0;
        valid = false;
        return;
    }
    const auto value_unit = decode_value(row, frame);
    status_.out_of_range_values += value_unit.has_value() ? 0U : 1U;
    switch (checks_[channel].check(value_unit, row.largest_step_unit, tick_)) {
        case SampleCheck::Verdict::good:
            measurement_.value[row.sensor] = *value_unit;
            measurement_.age_ticks[channel] = 0;
            valid = true;
            break;
        case SampleCheck::Verdict::held:
            ++status_.implausible_values;
            break;
        case SampleCheck::Verdict::implausible:
            ++status_.implausible_values;
            measurement_.age_ticks[channel] = 0;
            valid = false;
            break;
    }
}

std::span<const CanFrame> CraneNetwork::encode(const GuardedCommand& command, std::int64_t now_ns) noexcept {
    frame_count_ = 0;
    if (const auto management = manager_->frame(now_ns)) {
        append(*management);
    }

    sync_counter_ = sync_counter_ < sync_counter_last ? static_cast<std::uint8_t>(sync_counter_ + 1) : std::uint8_t{1};
    const auto& safety_row = table_->row(Pdo::safety_outputs);
    auto safety = table_->blank(safety_row.message, now_ns);
    write_raw(table_->row(Signal::cutoff_energised), command.cutoff_energised() ? 1 : 0, safety);
    if (safety_row.protection == Protection::e2e) {
        protect(safety, safety_row.data_id, protection_counter(sync_counter_), protection_quality_good);
    }
    append(safety);

    std::ranges::for_each(valve_->encode(command, sync_counter_, now_ns), [this](const auto& frame) { append(frame); });

    auto sync = table_->blank(Message::sync, now_ns);
    sync.data[0] = sync_counter_;
    append(sync);
    sync_stamp_ns_ = now_ns;
    return {frames_.data(), frame_count_};
}

}  // namespace steadyboom::drivers
