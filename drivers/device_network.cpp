#include "drivers/device_network.hpp"

#include <algorithm>

#include "drivers/pdo_codec.hpp"

namespace steadyboom::drivers {
namespace {

constexpr std::uint8_t all_nodes = 0;

}  // namespace

DeviceNetwork::DeviceNetwork(const NetworkConfig& config) : table_(config) {
    for (const auto pdo : {Pdo::valve_command, Pdo::safety_outputs}) {
        if (table_.row(pdo).protection == Protection::e2e) {
            receivers_[index_of(pdo)].emplace(table_.row(pdo).data_id);
        }
    }
}

std::vector<CanFilter> DeviceNetwork::filters() const {
    std::vector<CanFilter> filters;
    for (const auto& row : table_.messages()) {
        if (row.present && row.from_controller && row.kind != MessageKind::heartbeat) {
            filters.push_back({.id = row.id, .extended = row.extended});
        }
    }
    return filters;
}

void DeviceNetwork::receive(std::span<const CanFrame> frames, std::int64_t now_ns) noexcept {
    for (const auto& frame : frames) {
        const Message message = accepted_message(frame);
        if (message == Message::nmt) {
            obey_nmt(frame);
        } else if (message == Message::sync) {
            sync_pending_ = true;
            sync_counter_ = frame.data[0];
            for (auto& receiver : receivers_) {
                if (receiver) {
                    receiver->close_tick();
                }
            }
        } else if (message != Message::none && table_.row(message).kind == MessageKind::pdo) {
            take_order(table_.row(message), frame, now_ns);
        }
    }
}

void DeviceNetwork::take_order(const MessageRow& row, const CanFrame& frame, std::int64_t now_ns) noexcept {
    if (!operational(row.device)) {
        ++status_.not_operational_frames;
        return;
    }
    switch (row.pdo) {
        case Pdo::safety_outputs:
            if (believed(row, frame)) {
                order_.cutoff_energised = read_raw(table_.row(Signal::cutoff_energised), frame) != 0;
                order_.cutoff_stamp_ns = now_ns;
                order_.cutoff_ever = true;
            }
            break;
        case Pdo::valve_command:
            if (!believed(row, frame)) {
                twin_.forget();
            } else if (row.protection == Protection::e2e) {
                twin_.take_plain(frame, now_ns);
            } else {
                take_valve_order(frame, now_ns);
            }
            break;
        case Pdo::valve_twin:
            if (twin_.take_inverted(frame, now_ns)) {
                take_valve_order(twin_.plain(), now_ns);
            } else {
                const auto& command = receivers_[index_of(Pdo::valve_command)];
                status_.rejected_orders += command && command->state() == ReceiverState::valid ? 1U : 0U;
            }
            break;
        default:
            break;
    }
}

bool DeviceNetwork::believed(const MessageRow& row, const CanFrame& frame) noexcept {
    auto& receiver = receivers_[index_of(row.pdo)];
    if (!receiver) {
        return true;
    }
    const bool good = receiver->check(frame) == FrameVerdict::good;
    status_.rejected_orders += good ? 0U : 1U;
    return good && receiver->state() == ReceiverState::valid;
}

Message DeviceNetwork::accepted_message(const CanFrame& frame) noexcept {
    if (frame.error) {
        ++status_.error_frames;
        return Message::none;
    }
    const auto message = frame.remote ? Message::none : table_.message_with(frame.id, frame.extended);
    if (message == Message::none && (frame.extended || frame.remote)) {
        ++status_.remote_or_extended_frames;
        return Message::none;
    }
    if (message == Message::none || !table_.row(message).from_controller) {
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

void DeviceNetwork::obey_nmt(const CanFrame& frame) noexcept {
    const auto command = static_cast<NmtCommand>(frame.data[0]);
    switch (command) {
        case NmtCommand::start:
        case NmtCommand::stop:
        case NmtCommand::enter_pre_operational:
        case NmtCommand::reset_node:
        case NmtCommand::reset_communication:
            break;
        default:
            ++status_.unknown_orders;
            return;
    }
    for (std::size_t i = index_of(Device::controller) + 1; i < device_count; ++i) {
        const auto device = static_cast<Device>(i);
        if (frame.data[1] == all_nodes || frame.data[1] == table_.node_id(device)) {
            obey_nmt(device, command);
        }
    }
}

void DeviceNetwork::obey_nmt(Device device, NmtCommand command) noexcept {
    auto& node = nodes_[index_of(device)];
    if (node.state == NodeState::boot_up) {
        return;  // CiA 301: a node hears nothing before its boot-up message
    }
    switch (command) {
        case NmtCommand::start:
            node.state = NodeState::operational;
            break;
        case NmtCommand::stop:
            node.state = NodeState::stopped;
            forget_orders(device);
            break;
        case NmtCommand::enter_pre_operational:
            node.state = NodeState::pre_operational;
            forget_orders(device);
            break;
        case NmtCommand::reset_node:
        case NmtCommand::reset_communication:
            restart(device);
            break;
    }
}

void DeviceNetwork::restart(Device device) noexcept {
    nodes_[index_of(device)].state = NodeState::boot_up;
    forget_orders(device);
}

void DeviceNetwork::forget_orders(Device device) noexcept {
    if (device == Device::servo_valve) {
        order_.control_word = 0;
        order_.set_point_m = 0.0;
        order_.ever = false;
        twin_.forget();
    } else if (device == Device::safety_io) {
        order_.cutoff_energised = false;
        order_.cutoff_ever = false;
    }
}

void DeviceNetwork::take_valve_order(const CanFrame& frame, std::int64_t now_ns) noexcept {
    order_.control_word = static_cast<std::uint16_t>(read_raw(table_.row(Signal::valve_control_word), frame));
    const auto& set_point = table_.row(Signal::valve_set_point);
    order_.set_point_m =
        std::clamp(static_cast<double>(read_raw(set_point, frame)) * set_point.scale_unit + set_point.offset_unit,
                   set_point.lowest_unit, set_point.highest_unit);
    order_.stamp_ns = now_ns;
    order_.ever = true;
}

std::span<const CanFrame> DeviceNetwork::answer_sync(const plant::SensorVector& sensors, const ValveFeedback& feedback,
                                                     std::int64_t now_ns) noexcept {
    if (!sync_pending_) {
        return {};
    }
    sync_pending_ = false;
    std::size_t count = 0;
    for (const auto& message : table_.messages()) {
        const auto& node = nodes_[index_of(message.device)];
        if (message.cycle != Cycle::on_sync || node.silent || message_silent_[index_of(message.message)] ||
            !operational(message.device)) {
            continue;
        }
        auto frame = table_.blank(message.message, now_ns);
        for (const auto& row : table_.signals()) {
            if (row.message != message.message || row.sensor == plant::sensor_count) {
                continue;
            }
            const auto sample = encode_value(row, sensors[row.sensor], frame);
            if (row.status != Signal::none) {
                write_raw(table_.row(row.status), static_cast<std::int64_t>(sample), frame);
            }
        }
        if (message.pdo == Pdo::valve_status) {
            write_raw(table_.row(Signal::valve_status_word), status_word(feedback.status), frame);
        } else if (message.pdo == Pdo::safety_inputs) {
            write_raw(table_.row(Signal::cutoff_open), feedback.cutoff_open ? 1 : 0, frame);
            write_raw(table_.row(Signal::emergency_stop_healthy), feedback.emergency_stop_healthy ? 1 : 0, frame);
        }
        if (message.protection == Protection::e2e) {
            protect(frame, message.data_id, protection_counter(sync_counter_), protection_quality_good);
        }
        answers_[count++] = frame;
    }
    return {answers_.data(), count};
}

std::span<const CanFrame> DeviceNetwork::housekeeping(std::int64_t now_ns) noexcept {
    std::size_t count = 0;
    for (const auto& message : table_.messages()) {
        if (message.kind != MessageKind::heartbeat || message.from_controller) {
            continue;
        }
        auto& node = nodes_[index_of(message.device)];
        const bool booting = node.state == NodeState::boot_up;
        if (!booting && (message.interval_ns == 0 || now_ns < node.next_heartbeat_ns)) {
            continue;
        }
        const bool on_time = !booting && now_ns - node.next_heartbeat_ns < message.interval_ns;
        node.next_heartbeat_ns = (on_time ? node.next_heartbeat_ns : now_ns) + message.interval_ns;
        auto frame = table_.blank(message.message, now_ns);
        frame.data[0] = static_cast<std::uint8_t>(node.state);
        if (booting) {
            node.state = NodeState::pre_operational;
        }
        if (!node.silent) {
            heartbeats_[count++] = frame;
        }
    }
    return {heartbeats_.data(), count};
}

void DeviceNetwork::set_silent(plant::Sensor sensor, bool silent) noexcept {
    for (const auto& row : table_.signals()) {
        if (row.sensor == sensor && sensor != plant::sensor_count) {
            message_silent_[index_of(row.message)] = silent;
        }
    }
}

}  // namespace steadyboom::drivers
