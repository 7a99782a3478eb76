#include "drivers/crane_network.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "drivers/pdo_codec.hpp"

namespace steadyboom::drivers {
namespace {

constexpr std::uint8_t all_nodes = 0;
constexpr std::int64_t ns_per_ms = 1'000'000;

DeviceTable checked(DeviceTable table) {
    const double load_share = bus_load(table).worst_case_share;
    if (load_share > largest_bus_load_share) {
        throw std::invalid_argument("CAN load at bit_rate_bit_s = " + std::to_string(table.config().bit_rate_bit_s) +
                                    " and period_ns = " + std::to_string(table.config().period_ns) + " is " +
                                    std::to_string(std::lround(100.0 * load_share)) +
                                    " %: allowed is 70 %, so raise the bit rate or the period");
    }
    return table;
}

plant::ValveState valve_state(std::int64_t status_word_raw) noexcept {
    switch (const auto state = static_cast<plant::ValveState>(status_word_raw & 0x0F)) {
        case plant::ValveState::init:
        case plant::ValveState::disabled:
        case plant::ValveState::hold:
        case plant::ValveState::active:
        case plant::ValveState::fault_hold:
        case plant::ValveState::fault_reaction:
        case plant::ValveState::fault_disabled:
            return state;
        default:
            return plant::ValveState::not_ready;
    }
}

}  // namespace

CraneNetwork::CraneNetwork(const NetworkConfig& config) : table_(checked(DeviceTable(config))) {}

std::vector<CanFilter> CraneNetwork::filters() const {
    std::vector<CanFilter> filters;
    for (const auto& row : table_.messages()) {
        if (row.present && !row.from_controller) {
            filters.push_back({row.id});
        }
    }
    return filters;
}

plant::CraneMeasurement CraneNetwork::decode(std::span<const CanFrame> frames, std::int64_t now_ns) noexcept {
    const auto grow_older = [](std::uint32_t& age_ticks) {
        age_ticks += age_ticks < plant::CraneMeasurement::never - 1U ? 1U : 0U;
    };
    std::ranges::for_each(measurement_.age_ticks, grow_older);
    grow_older(measurement_.safety_inputs_age_ticks);

    newest_frame_.fill(-1);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const auto message = accepted_message(frames[i]);
        if (message == Message::none) {
            continue;
        }
        const auto& row = table_.row(message);
        if (row.kind == MessageKind::heartbeat) {
            // Every heartbeat counts: a boot-up may be followed by another state within one tick.
            decode_heartbeat(row.device, frames[i].data[0], now_ns);
            continue;
        }
        if (row.kind != MessageKind::pdo) {
            continue;
        }
        auto& newest = newest_frame_[index_of(message)];
        status_.superseded_frames += newest >= 0 ? 1U : 0U;
        newest = static_cast<std::int64_t>(i);
    }
    for (std::size_t i = 0; i < message_count; ++i) {
        if (newest_frame_[i] >= 0) {
            decode_pdo(static_cast<Message>(i), frames[static_cast<std::size_t>(newest_frame_[i])]);
        }
    }
    for (std::size_t i = 0; i < device_count; ++i) {
        auto& node = status_.nodes[i];
        if (node.state != NodeState::unknown) {
            node.heartbeat_age_ns = now_ns - heartbeat_stamp_ns_[i];
            const auto& device = table_.config(static_cast<Device>(i));
            node.alive = device.heartbeat_ms == 0 || node.heartbeat_age_ns <= device.heartbeat_timeout_ms * ns_per_ms;
        }
    }
    measurement_.stamp_ns = sync_stamp_ns_;
    return measurement_;
}

Message CraneNetwork::accepted_message(const CanFrame& frame) noexcept {
    if (frame.error) {
        ++status_.error_frames;
        status_.last_error_class = frame.id;
        return Message::none;
    }
    if (frame.extended || frame.remote) {
        ++status_.remote_or_extended_frames;
        return Message::none;
    }
    const auto message = table_.message_with(frame.id);
    if (message == Message::none || table_.row(message).from_controller) {
        ++status_.unknown_id_frames;
        return Message::none;
    }
    if (frame.length != table_.row(message).length_bytes) {
        ++status_.wrong_length_frames;
        return Message::none;
    }
    ++status_.accepted_frames;
    return message;
}

void CraneNetwork::decode_heartbeat(Device device, std::uint8_t state_raw, std::int64_t now_ns) noexcept {
    const auto state = static_cast<NodeState>(state_raw);
    auto& node = status_.nodes[index_of(device)];
    switch (state) {
        case NodeState::boot_up:
            ++node.boot_ups;
            needs_start_[index_of(device)] = true;
            break;
        case NodeState::pre_operational:
            needs_start_[index_of(device)] = true;
            break;
        case NodeState::stopped:
        case NodeState::operational:
            needs_start_[index_of(device)] = false;
            break;
        default:
            ++status_.out_of_range_values;
            return;
    }
    node.state = state;
    heartbeat_stamp_ns_[index_of(device)] = now_ns;
}

void CraneNetwork::decode_pdo(Message message, const CanFrame& frame) noexcept {
    for (const auto& row : table_.signals()) {
        if (row.message == message && row.sensor != plant::sensor_count) {
            decode_sensor(row, frame);
        }
    }
    const auto is_set = [&](Signal signal) { return read_raw(table_.row(signal), frame) != 0; };
    if (message == message_of(Pdo::valve_status)) {
        measurement_.valve_state = valve_state(read_raw(table_.row(Signal::valve_status_word), frame));
    } else if (message == message_of(Pdo::safety_inputs)) {
        measurement_.cutoff_open = is_set(Signal::cutoff_open);
        measurement_.emergency_stop_healthy = is_set(Signal::emergency_stop_healthy);
        measurement_.safety_inputs_age_ticks = 0;
    }
}

void CraneNetwork::decode_sensor(const SignalRow& row, const CanFrame& frame) noexcept {
    const auto channel = static_cast<std::size_t>(row.sensor);
    const bool device_says_ok =
        row.status == Signal::none || read_raw(table_.row(row.status), frame) == static_cast<int>(SampleStatus::ok);
    const auto value_unit = decode_value(row, frame);
    status_.faulty_values += device_says_ok ? 0U : 1U;
    status_.out_of_range_values += value_unit.has_value() ? 0U : 1U;
    measurement_.age_ticks[channel] = 0;
    measurement_.valid[channel] = device_says_ok && value_unit.has_value();
    if (measurement_.valid[channel]) {
        measurement_.value[row.sensor] = *value_unit;
    }
}

std::span<const CanFrame> CraneNetwork::encode(const GuardedCommand& command, std::int64_t now_ns) noexcept {
    frame_count_ = 0;
    append_housekeeping(now_ns);

    auto safety = table_.blank(message_of(Pdo::safety_outputs), now_ns);
    write_raw(table_.row(Signal::cutoff_energised), command.cutoff_energised() ? 1 : 0, safety);
    append(safety);

    auto valve = table_.blank(message_of(Pdo::valve_command), now_ns);
    const auto& set_point = table_.row(Signal::valve_set_point);
    write_raw(table_.row(Signal::valve_control_word), static_cast<std::int64_t>(command.mode()), valve);
    encode_value(set_point, std::clamp(command.opening_m(), set_point.lowest_unit, set_point.highest_unit), valve);
    append(valve);

    auto sync = table_.blank(Message::sync, now_ns);
    sync_counter_ = sync_counter_ < sync_counter_last ? static_cast<std::uint8_t>(sync_counter_ + 1) : std::uint8_t{1};
    sync.data[0] = sync_counter_;
    append(sync);
    sync_stamp_ns_ = now_ns;
    return {frames_.data(), frame_count_};
}

void CraneNetwork::append_housekeeping(std::int64_t now_ns) noexcept {
    if (!booted_ || now_ns >= next_heartbeat_ns_) {
        const auto interval_ns = table_.row(heartbeat_of(Device::controller)).interval_ns;
        const bool on_time = booted_ && now_ns - next_heartbeat_ns_ < interval_ns;
        next_heartbeat_ns_ = (on_time ? next_heartbeat_ns_ : now_ns) + interval_ns;
        auto heartbeat = table_.blank(heartbeat_of(Device::controller), now_ns);
        heartbeat.data[0] = static_cast<std::uint8_t>(booted_ ? NodeState::operational : NodeState::boot_up);
        booted_ = true;
        append(heartbeat);
        return;
    }
    if (!started_all_) {
        started_all_ = true;
        needs_start_.fill(false);
        append_nmt_start(all_nodes, now_ns);
        return;
    }
    const auto waiting = std::ranges::find(needs_start_, true);
    if (waiting != needs_start_.end()) {
        *waiting = false;
        append_nmt_start(table_.node_id(static_cast<Device>(waiting - needs_start_.begin())), now_ns);
    }
}

void CraneNetwork::append_nmt_start(std::uint8_t node, std::int64_t now_ns) noexcept {
    auto start = table_.blank(Message::nmt, now_ns);
    start.data[0] = static_cast<std::uint8_t>(NmtCommand::start);
    start.data[1] = node;
    ++status_.nmt_starts;
    append(start);
}

}  // namespace steadyboom::drivers
