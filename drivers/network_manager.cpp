#include "drivers/network_manager.hpp"

#include <algorithm>

namespace steadyboom::drivers {
namespace {

constexpr std::uint8_t all_nodes = 0;
constexpr std::int64_t ns_per_ms = 1'000'000;
constexpr std::int64_t retry_interval_ns = 1'000 * ns_per_ms;
constexpr std::int64_t sdo_timeout_ns = 100 * ns_per_ms;

constexpr ObjectAddress device_type{0x1000, 0};
constexpr ObjectAddress heartbeat_time{0x1017, 0};
constexpr ObjectAddress vendor_id{0x1018, 1};
constexpr ObjectAddress product_code{0x1018, 2};

constexpr std::uint8_t synchronous_each = 1;  ///< transmission types
constexpr std::uint8_t event_driven = 255;

}  // namespace

std::string_view name_of(DeviceState state) noexcept {
    constexpr std::array<std::string_view, 12> names = {
        "unknown", "boot-up",        "checking",           "configuring", "pre-operational", "operational",
        "stopped", "wrong identity", "no command timeout", "SDO aborted", "SDO timed out",   "lost"};
    return index_of(state) < names.size() ? names[index_of(state)] : "?";
}

NetworkManager::NetworkManager(const DeviceTable& table) : table_(table), sdo_(sdo_timeout_ns) {
    for (std::size_t i = 1; i < device_count; ++i) {
        const auto device = static_cast<Device>(i);
        nodes_[i].steps = steps_of(device);
        if (!table.config(device).canopen) {
            nodes_[i].status.managed = DeviceState::operational;
            nodes_[i].status.alive = true;
            nodes_[i].due = false;
        }
    }
}

std::vector<NetworkManager::Step> NetworkManager::steps_of(Device device) const {
    const auto& config = table_.config();
    const auto& d = config[device];
    std::vector<Step> steps;
    const auto ask = [&steps](ObjectAddress object, std::uint32_t lowest, std::uint32_t highest,
                              DeviceState otherwise) {
        steps.push_back({.object = object, .lowest = lowest, .highest = highest, .otherwise = otherwise});
    };
    const auto ask_identity = [&ask](ObjectAddress object, std::uint32_t expected) {
        const bool any = expected == 0;
        ask(object, any ? 0U : expected, any ? 0xFFFF'FFFFU : expected, DeviceState::wrong_identity);
    };
    const auto tell = [&steps](ObjectAddress object, std::uint32_t value, std::uint8_t size_bytes) {
        steps.push_back({.object = object, .writes = true, .value = value, .size_bytes = size_bytes});
    };
    // The device type is asked even if any will do: the answer shows that the device is there.
    ask_identity(device_type, d.device_type);
    if (d.vendor_id != 0) {
        ask_identity(vendor_id, d.vendor_id);
    }
    if (d.product_code != 0) {
        ask_identity(product_code, d.product_code);
    }
    const auto& timeout = config.valve_timeout;
    if (device == Device::servo_valve && timeout.object != 0) {
        ask({timeout.object, timeout.subindex}, 1, timeout.longest_raw, DeviceState::no_command_timeout);
    }
    if (!d.configure) {
        return steps;
    }
    for (std::size_t i = 0; i < pdo_count; ++i) {
        const auto pdo = static_cast<Pdo>(i);
        const auto& p = config[pdo];
        if (p.device != device || from_controller(pdo) || !table_.row(pdo).present) {
            continue;
        }
        const auto parameters = static_cast<std::uint16_t>(0x1800 + p.number - 1);
        const bool timer = p.transmission == Transmission::event;
        tell({parameters, 2}, timer ? event_driven : synchronous_each, 1);
        if (timer) {
            tell({parameters, 5}, static_cast<std::uint32_t>(p.event_ms), 2);
        }
    }
    tell(heartbeat_time, static_cast<std::uint32_t>(d.heartbeat_ms), 2);
    return steps;
}

void NetworkManager::begin_anew(Node& node, DeviceState state) noexcept {
    node.status.managed = state;
    node.due = true;
    node.restarted = true;
    node.next_step = 0;
}

void NetworkManager::fail(Node& node, DeviceState state, std::int64_t now_ns) noexcept {
    node.status.managed = state;
    node.due = false;
    node.next_step = 0;
    node.retry_ns = now_ns + retry_interval_ns;
}

void NetworkManager::take_heartbeat(Device device, NodeState state, std::int64_t now_ns) noexcept {
    auto& node = nodes_[index_of(device)];
    auto& managed = node.status.managed;
    const bool had_stopped = managed == DeviceState::stopped && node.status.state == NodeState::stopped;
    const bool nobody_asks = managed == DeviceState::unknown && !node.due && current_ != device;
    node.status.state = state;
    node.heard_ns = now_ns;
    switch (state) {
        case NodeState::boot_up:
            ++node.status.boot_ups;
            node.command.reset();
            begin_anew(node, DeviceState::boot_up);
            break;
        case NodeState::operational:
            if (managed == DeviceState::pre_operational && !node.command) {
                managed = DeviceState::operational;
            } else if (managed == DeviceState::lost || had_stopped || nobody_asks) {
                node.command = NmtCommand::enter_pre_operational;
                begin_anew(node, DeviceState::boot_up);
            }
            break;
        case NodeState::pre_operational:
            if (managed == DeviceState::operational || managed == DeviceState::lost || had_stopped || nobody_asks) {
                begin_anew(node, DeviceState::boot_up);
            }
            break;
        case NodeState::stopped:
            if (managed == DeviceState::operational || managed == DeviceState::lost) {
                managed = DeviceState::stopped;
            }
            break;
        case NodeState::unknown:
            break;
    }
}

void NetworkManager::take_emergency(Device device, const CanFrame& frame) noexcept {
    const auto emergency = decode_emergency(frame);
    if (emergency) {
        auto& status = nodes_[index_of(device)].status;
        ++status.emergencies;
        status.emergency = *emergency;
        status.emergency.code = emergency->is_reset() ? emergency_none : emergency->code;
    }
}

void NetworkManager::take_sdo_answer(const CanFrame& frame) noexcept {
    (void)sdo_.receive(frame);
}

void NetworkManager::take_process_data(Device device) noexcept {
    auto& node = nodes_[index_of(device)];
    if (node.status.managed == DeviceState::pre_operational && !node.command) {
        node.status.managed = DeviceState::operational;
    }
}

void NetworkManager::update(std::int64_t now_ns) noexcept {
    for (std::size_t i = 1; i < device_count; ++i) {
        if (table_.config(static_cast<Device>(i)).canopen) {
            watch(static_cast<Device>(i), now_ns);
        }
    }
    if (current_ && !sdo_.busy()) {
        advance(now_ns);
    }
    if (quietened_ && !current_) {
        choose_next();
    }
}

void NetworkManager::watch(Device device, std::int64_t now_ns) noexcept {
    auto& node = nodes_[index_of(device)];
    const auto& config = table_.config(device);
    const bool heard = node.status.state != NodeState::unknown;
    node.status.heartbeat_age_ns = heard ? now_ns - node.heard_ns : 0;
    const bool in_time = node.status.heartbeat_age_ns <= config.heartbeat_timeout_ms * ns_per_ms;
    node.status.alive = config.heartbeat_ms == 0 || (heard && in_time);
    switch (node.status.managed) {
        case DeviceState::operational:
        case DeviceState::stopped:
            if (config.heartbeat_ms != 0 && heard && !in_time) {
                fail(node, DeviceState::lost, now_ns);
                node.status.state = NodeState::unknown;
            }
            break;
        case DeviceState::pre_operational:
            if (now_ns >= node.retry_ns) {  // started, and yet it says nothing
                fail(node, DeviceState::unknown, now_ns);
            }
            break;
        case DeviceState::unknown:
        case DeviceState::wrong_identity:
        case DeviceState::no_command_timeout:
        case DeviceState::sdo_aborted:
        case DeviceState::sdo_timed_out:
        case DeviceState::lost:
            if (!node.due && now_ns >= node.retry_ns) {
                node.due = true;
                // One that fell silent in the midst of its answers is given a new start.
                node.command = node.status.managed == DeviceState::sdo_timed_out ? NmtCommand::reset_communication
                                                                                 : NmtCommand::enter_pre_operational;
            }
            break;
        case DeviceState::boot_up:
        case DeviceState::checking:
        case DeviceState::configuring:
            break;
    }
}

void NetworkManager::choose_next() noexcept {
    // Those that have announced themselves first; they answer at once.
    for (const bool announced : {true, false}) {
        for (std::size_t n = 1; n <= device_count; ++n) {
            const std::size_t i = (last_chosen_ + n) % device_count;
            auto& node = nodes_[i];
            if (i == 0 || !node.due || node.command || (node.status.managed == DeviceState::boot_up) != announced) {
                continue;
            }
            last_chosen_ = i;
            current_ = static_cast<Device>(i);
            node.due = false;
            node.restarted = false;
            node.next_step = 0;
            start_step(*current_);
            return;
        }
    }
}

void NetworkManager::start_step(Device device) noexcept {
    auto& node = nodes_[index_of(device)];
    const auto& step = node.steps[node.next_step];
    const auto id = table_.node_id(device);
    if (step.writes) {
        node.status.managed = DeviceState::configuring;
        sdo_.download(id, step.object, step.value, step.size_bytes);
        return;
    }
    // An absent device stays what it was: unknown or lost.
    if (node.next_step > 0 || node.status.managed == DeviceState::boot_up) {
        node.status.managed = DeviceState::checking;
    }
    sdo_.upload(id, step.object);
}

void NetworkManager::advance(std::int64_t now_ns) noexcept {
    const Device device = *current_;
    auto& node = nodes_[index_of(device)];
    current_.reset();
    if (node.restarted) {
        return;  // the answer belongs to its life before
    }
    const auto& step = node.steps[node.next_step];
    const auto note = [&](SdoAbort abort) {
        node.status.failed_object = step.object;
        node.status.abort = abort;
        node.status.read_raw = sdo_.value();
    };
    switch (sdo_.outcome()) {
        case SdoClient::Outcome::done:
            break;
        case SdoClient::Outcome::timed_out: {
            const bool absent = node.next_step == 0 && node.status.managed != DeviceState::checking;
            note(sdo_.abort_code());
            fail(node, absent ? node.status.managed : DeviceState::sdo_timed_out, now_ns);
            return;
        }
        default:
            note(sdo_.abort_code());
            fail(node, DeviceState::sdo_aborted, now_ns);
            return;
    }
    if (!step.writes && (sdo_.value() < step.lowest || sdo_.value() > step.highest)) {
        note(SdoAbort::none);
        fail(node, step.otherwise, now_ns);
        node.command = NmtCommand::stop;  // whatever it is, it neither sends nor obeys process data until asked again
        return;
    }
    if (++node.next_step < node.steps.size()) {
        current_ = device;
        start_step(device);
        return;
    }
    node.status.managed = DeviceState::pre_operational;
    node.command = NmtCommand::start;
    node.retry_ns = now_ns + retry_interval_ns;
}

std::optional<CanFrame> NetworkManager::frame(std::int64_t now_ns) noexcept {
    if (auto beat = heartbeat(now_ns)) {
        return beat;
    }
    if (!quietened_) {
        quietened_ = true;
        return nmt(NmtCommand::enter_pre_operational, all_nodes, now_ns);
    }
    if (auto command = nmt_command(now_ns)) {
        return command;
    }
    return sdo_.poll(now_ns);
}

std::optional<CanFrame> NetworkManager::heartbeat(std::int64_t now_ns) noexcept {
    if (booted_ && now_ns < next_heartbeat_ns_) {
        return std::nullopt;
    }
    const auto& row = table_.row(heartbeat_of(Device::controller));
    const bool on_time = booted_ && now_ns - next_heartbeat_ns_ < row.interval_ns;
    next_heartbeat_ns_ = (on_time ? next_heartbeat_ns_ : now_ns) + row.interval_ns;
    auto beat = table_.blank(row.message, now_ns);
    beat.data[0] = static_cast<std::uint8_t>(booted_ ? NodeState::operational : NodeState::boot_up);
    booted_ = true;
    return beat;
}

std::optional<CanFrame> NetworkManager::nmt_command(std::int64_t now_ns) noexcept {
    for (std::size_t i = 1; i < device_count; ++i) {
        auto& node = nodes_[i];
        if (!node.command) {
            continue;
        }
        const auto command = *node.command;
        node.command.reset();
        const bool started = command == NmtCommand::start && node.status.managed == DeviceState::pre_operational;
        if (started && table_.config(static_cast<Device>(i)).heartbeat_ms == 0) {
            node.status.managed = DeviceState::operational;  // nothing else will tell
        }
        return nmt(command, table_.node_id(static_cast<Device>(i)), now_ns);
    }
    return std::nullopt;
}

CanFrame NetworkManager::nmt(NmtCommand command, std::uint8_t node_id, std::int64_t now_ns) noexcept {
    auto message = table_.blank(Message::nmt, now_ns);
    message.data[0] = static_cast<std::uint8_t>(command);
    message.data[1] = node_id;
    ++nmt_commands_;
    return message;
}

bool NetworkManager::all_required_operational() const noexcept {
    for (std::size_t i = 1; i < device_count; ++i) {
        if (table_.config(static_cast<Device>(i)).required && !operational(static_cast<Device>(i))) {
            return false;
        }
    }
    return true;
}

}  // namespace steadyboom::drivers
