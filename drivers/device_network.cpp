#include "drivers/device_network.hpp"

#include <algorithm>
#include <utility>

#include "drivers/pdo_codec.hpp"

namespace steadyboom::drivers {
namespace {

constexpr std::uint8_t all_nodes = 0;
constexpr std::int64_t ns_per_ms = 1'000'000;
constexpr std::uint8_t synchronous_each = 1;  ///< transmission types
constexpr std::uint8_t event_driven = 255;
constexpr std::uint32_t command_timeout_ms = 25;

constexpr ObjectAddress error_register{0x1001, 0};
constexpr ObjectAddress heartbeat_time{0x1017, 0};

/// Communication parameter of a TPDO.
constexpr ObjectAddress tpdo_parameter(const PdoConfig& pdo, std::uint8_t subindex) noexcept {
    return {static_cast<std::uint16_t>(0x1800 + pdo.number - 1), subindex};
}
constexpr std::uint8_t transmission_type = 2;
constexpr std::uint8_t event_timer = 5;

}  // namespace

DeviceNetwork::DeviceNetwork(const NetworkConfig& config) : table_(config) {
    if (table_.config(Device::servo_valve).profile == ValveProfile::j1939) {
        j1939_.emplace(table_);
    }
    for (const auto pdo : {Pdo::valve_command, Pdo::safety_outputs}) {
        if (table_.row(pdo).protection == Protection::e2e) {
            receivers_[index_of(pdo)].emplace(table_.row(pdo).data_id);
        }
    }
    for (std::size_t i = 1; i < device_count; ++i) {
        const auto device = static_cast<Device>(i);
        auto& node = nodes_[i];
        node.dictionary = dictionary_of(device);
        if (table_.config(device).canopen) {
            node.server.emplace(table_.node_id(device), node.dictionary);
        } else {
            node.state = NodeState::operational;
        }
    }
}

std::vector<ObjectEntry> DeviceNetwork::dictionary_of(Device device) const {
    constexpr auto writable = ObjectAccess::read_write;
    const auto& config = table_.config();
    const auto& d = config[device];
    std::vector<ObjectEntry> entries = {
        {.object = {0x1000, 0}, .value_raw = d.device_type},
        {.object = error_register, .size_bytes = 1, .highest_raw = 0xFF},
        {.object = {0x1018, 1}, .value_raw = d.vendor_id},
        {.object = {0x1018, 2}, .value_raw = d.product_code},
        {.object = heartbeat_time,
         .size_bytes = 2,
         .access = writable,
         .value_raw = d.configure ? 0U : static_cast<std::uint32_t>(d.heartbeat_ms),
         .highest_raw = 0xFFFF},
    };
    for (std::size_t i = 0; i < pdo_count; ++i) {
        const auto pdo = static_cast<Pdo>(i);
        const auto& p = config[pdo];
        if (p.device != device || from_controller(pdo) || !table_.row(pdo).present) {
            continue;
        }
        const bool on_sync = p.transmission == Transmission::sync && !d.configure;
        entries.push_back({.object = tpdo_parameter(p, transmission_type),
                           .size_bytes = 1,
                           .access = writable,
                           .value_raw = on_sync ? synchronous_each : event_driven,
                           .highest_raw = 0xFF});
        entries.push_back({.object = tpdo_parameter(p, event_timer),
                           .size_bytes = 2,
                           .access = writable,
                           .value_raw = d.configure ? 0U : static_cast<std::uint32_t>(p.event_ms),
                           .highest_raw = 0xFFFF});
    }
    if (device == Device::servo_valve) {
        const auto index = static_cast<std::uint16_t>(0x1400 + config[Pdo::valve_command].number - 1);
        entries.push_back(
            {.object = {index, 5}, .size_bytes = 2, .value_raw = command_timeout_ms, .highest_raw = 0xFFFF});
    }
    return entries;
}

ObjectEntry* DeviceNetwork::object(Device device, ObjectAddress address) noexcept {
    auto& dictionary = nodes_[index_of(device)].dictionary;
    const auto found =
        std::ranges::find_if(dictionary, [&](const ObjectEntry& entry) { return entry.object == address; });
    return found == dictionary.end() ? nullptr : &*found;
}

std::uint32_t DeviceNetwork::object_raw(Device device, ObjectAddress address) const noexcept {
    const auto& dictionary = nodes_[index_of(device)].dictionary;
    const auto found =
        std::ranges::find_if(dictionary, [&](const ObjectEntry& entry) { return entry.object == address; });
    return found == dictionary.end() ? 0U : found->value_raw;
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
        } else if (message != Message::none && table_.row(message).kind == MessageKind::sdo_request) {
            answer_sdo(table_.row(message).device, frame, now_ns);
        }
    }
}

void DeviceNetwork::answer_sdo(Device device, const CanFrame& frame, std::int64_t now_ns) noexcept {
    auto& node = nodes_[index_of(device)];
    if (!node.server || node.state == NodeState::boot_up || node.state == NodeState::stopped || node.silent) {
        return;
    }
    if (const auto answer = node.server->answer(frame, now_ns)) {
        reply(*answer);
    }
}

void DeviceNetwork::reply(const CanFrame& frame) noexcept {
    if (reply_count_ == replies_.size()) {
        ++status_.lost_replies;
        return;
    }
    replies_[reply_count_++] = frame;
}

void DeviceNetwork::set_fault(Device device, std::uint16_t fault_code, bool present) noexcept {
    auto& node = nodes_[index_of(device)];
    const bool told = node.emergency_code == fault_code;
    if (present == told || (!present && node.emergency_code == emergency_none) || !node.server ||
        node.state == NodeState::boot_up || node.state == NodeState::stopped) {
        return;
    }
    node.emergency_code = present ? fault_code : emergency_none;
    const auto reg = static_cast<std::uint8_t>(present ? error_generic | error_communication : 0);
    object(device, error_register)->value_raw = reg;
    if (!node.silent) {
        reply(emergency_frame({.node = table_.node_id(device), .code = node.emergency_code, .error_register = reg}, 0));
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
    const auto& row = table_.row(message);
    const bool right_length = frame.length == row.length_bytes;
    if (row.kind == MessageKind::pdo && operational(row.device)) {
        set_fault(row.device, emergency_pdo_length, !right_length);
    }
    if (!right_length) {
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
    if (node.state == NodeState::boot_up || !table_.config(device).canopen) {
        return;  // CiA 301: a node hears nothing before its boot-up message; others know no NMT at all
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
    auto& node = nodes_[index_of(device)];
    if (!table_.config(device).canopen) {
        forget_orders(device);
        return;
    }
    node.state = NodeState::boot_up;
    node.emergency_code = emergency_none;
    if (auto* heartbeat = object(device, heartbeat_time); heartbeat != nullptr && table_.config(device).configure) {
        heartbeat->value_raw = 0;
    }
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
    if (j1939_) {
        const auto order = j1939_->take(frame);
        if (!order) {
            ++status_.rejected_orders;
            return;
        }
        order_.control_word = order->control_word;
        order_.set_point_m = order->set_point_m;
    } else {
        order_.control_word = static_cast<std::uint16_t>(read_raw(table_.row(Signal::valve_control_word), frame));
        const auto& set_point = table_.row(Signal::valve_set_point);
        order_.set_point_m =
            std::clamp(static_cast<double>(read_raw(set_point, frame)) * set_point.scale_unit + set_point.offset_unit,
                       set_point.lowest_unit, set_point.highest_unit);
    }
    order_.stamp_ns = now_ns;
    order_.ever = true;
}

std::int64_t DeviceNetwork::event_interval_ns(Pdo pdo) const noexcept {
    const auto& p = table_.config()[pdo];
    const Device device = p.device;
    if (!table_.config(device).canopen) {
        return p.event_ms * ns_per_ms;
    }
    const bool by_event = object_raw(device, tpdo_parameter(p, transmission_type)) == event_driven;
    return by_event ? object_raw(device, tpdo_parameter(p, event_timer)) * ns_per_ms : 0;
}

bool DeviceNetwork::timer_due(std::int64_t now_ns) const noexcept {
    for (std::size_t i = 0; i < pdo_count; ++i) {
        const auto pdo = static_cast<Pdo>(i);
        if (!from_controller(pdo) && table_.row(pdo).present && operational(table_.row(pdo).device) &&
            event_interval_ns(pdo) > 0 && now_ns >= next_event_ns_[i]) {
            return true;
        }
    }
    return false;
}

bool DeviceNetwork::due(const MessageRow& row, bool synchronous, std::int64_t now_ns) noexcept {
    const auto& p = table_.config()[row.pdo];
    const bool by_sync = table_.config(row.device).canopen
                             ? object_raw(row.device, tpdo_parameter(p, transmission_type)) == synchronous_each
                             : row.cycle == Cycle::on_sync;
    if (by_sync) {
        return synchronous;
    }
    const auto interval_ns = event_interval_ns(row.pdo);
    auto& next_ns = next_event_ns_[index_of(row.pdo)];
    if (interval_ns == 0 || now_ns < next_ns) {
        return false;
    }
    next_ns = (now_ns - next_ns < interval_ns ? next_ns : now_ns) + interval_ns;
    return true;
}

std::span<const CanFrame> DeviceNetwork::answer_sync(const plant::SensorVector& sensors, const ValveFeedback& feedback,
                                                     std::int64_t now_ns) noexcept {
    const bool synchronous = std::exchange(sync_pending_, false);
    std::size_t count = 0;
    for (const auto& message : table_.messages()) {
        const auto& node = nodes_[index_of(message.device)];
        if (message.kind != MessageKind::pdo || message.from_controller || !message.present ||
            !operational(message.device) || !due(message, synchronous, now_ns) || node.silent ||
            message_silent_[index_of(message.message)]) {
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
        if (message.pdo == Pdo::valve_status && j1939_) {
            j1939_->report(feedback.status, sensors[plant::spool_m], frame);
        } else if (message.pdo == Pdo::valve_status) {
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
    for (std::size_t i = 1; i < device_count; ++i) {
        const auto device = static_cast<Device>(i);
        auto& node = nodes_[i];
        if (!table_.config(device).canopen) {
            continue;
        }
        const bool booting = node.state == NodeState::boot_up;
        const auto interval_ns = object_raw(device, heartbeat_time) * ns_per_ms;
        if (!booting && (interval_ns == 0 || now_ns < node.next_heartbeat_ns)) {
            continue;
        }
        const bool on_time = !booting && now_ns - node.next_heartbeat_ns < interval_ns;
        node.next_heartbeat_ns = (on_time ? node.next_heartbeat_ns : now_ns) + interval_ns;
        auto frame = table_.blank(heartbeat_of(device), now_ns);
        frame.data[0] = static_cast<std::uint8_t>(node.state);
        if (booting) {
            node.state = NodeState::pre_operational;
        }
        if (!node.silent) {
            outbox_[count++] = frame;
        }
    }
    for (std::size_t i = 0; i < reply_count_; ++i) {
        outbox_[count] = replies_[i];
        outbox_[count++].stamp_ns = now_ns;
    }
    reply_count_ = 0;
    return {outbox_.data(), count};
}

void DeviceNetwork::set_silent(plant::Sensor sensor, bool silent) noexcept {
    for (const auto& row : table_.signals()) {
        if (row.sensor == sensor && sensor != plant::sensor_count) {
            message_silent_[index_of(row.message)] = silent;
        }
    }
}

}  // namespace steadyboom::drivers
