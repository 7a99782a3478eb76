#include "hil/bus_monitor.hpp"

#include <algorithm>

#include "drivers/pdo_codec.hpp"

namespace steadyboom::hil {

namespace {

using drivers::Message;
using drivers::MessageKind;
using drivers::MessageRow;

constexpr double s_per_ns = 1.0e-9;

double per_second(std::uint64_t count, std::int64_t duration_ns) noexcept {
    return duration_ns > 0 ? static_cast<double>(count) / (s_per_ns * static_cast<double>(duration_ns)) : 0.0;
}

}  // namespace

double MessageTraffic::mean_rate_Hz() const noexcept {
    return frames > 1 ? per_second(frames - 1, newest.stamp_ns - first_ns) : 0.0;
}

BusMonitor::BusMonitor(drivers::DeviceTable table) : table_(std::move(table)) {
    for (const auto& row : table_.messages()) {
        if (!row.present) {
            continue;
        }
        fields_[index_of(row.message)] = fields_of(table_, row.message);
        if (row.protection == drivers::Protection::e2e) {
            messages_[index_of(row.message)].receiver.emplace(row.data_id);
        }
    }
}

void BusMonitor::note_time(std::int64_t stamp_ns) noexcept {
    if (!any_) {
        first_ns_ = stamp_ns;
        any_ = true;
    }
    last_ns_ = std::max(last_ns_, stamp_ns);
}

void BusMonitor::take_fd_frame(std::int64_t stamp_ns) noexcept {
    note_time(stamp_ns);
    ++fd_frames_;
}

void BusMonitor::take(const drivers::CanFrame& frame) {
    note_time(frame.stamp_ns);
    if (frame.error) {
        ++error_frames_;
        last_error_frame_ = frame;
        return;
    }
    ++frames_;
    bits_ += drivers::nominal_frame_bits(frame.remote ? 0 : frame.length, frame.extended);
    if (frame.remote) {
        ++remote_frames_;
        return;
    }
    const auto message = table_.message_with(frame.id, frame.extended);
    if (message == Message::none) {
        ++unknown_id_frames_;
        const std::pair key{frame.extended, frame.id};
        if (unknown_ids_.size() < most_unknown_ids || unknown_ids_.contains(key)) {
            ++unknown_ids_[key];
        }
        return;
    }
    const auto& row = table_.row(message);
    auto& traffic = messages_[index_of(message)];
    if (frame.length != row.length_bytes) {
        ++traffic.wrong_length_frames;
        return;
    }
    if (traffic.frames++ == 0) {
        traffic.first_ns = frame.stamp_ns;
    }
    traffic.newest = frame;
    if (traffic.receiver) {
        traffic.receiver->check(frame);
    }
    if (row.kind == MessageKind::pdo) {
        check_values(row, frame, traffic);
    } else {
        note_service(row, frame);
    }
}

void BusMonitor::check_values(const MessageRow& row, const drivers::CanFrame& frame, MessageTraffic& traffic) noexcept {
    for (const auto& signal : table_.signals()) {
        if (!signal.present || signal.message != row.message) {
            continue;
        }
        traffic.out_of_range_values += decode_value(signal, frame).has_value() ? 0U : 1U;
        if (signal.status != drivers::Signal::none) {
            const auto status = read_raw(table_.row(signal.status), frame);
            traffic.faulty_values += status == static_cast<std::int64_t>(drivers::SampleStatus::ok) ? 0U : 1U;
        }
    }
}

void BusMonitor::note_service(const MessageRow& row, const drivers::CanFrame& frame) noexcept {
    auto& device = devices_[index_of(row.device)];
    switch (row.kind) {
        case MessageKind::sync:
            for (auto& traffic : messages_) {
                if (traffic.receiver) {
                    traffic.receiver->close_tick();
                }
            }
            break;
        case MessageKind::heartbeat:
            device.state = static_cast<drivers::NodeState>(frame.data[0]);
            device.boot_ups += device.state == drivers::NodeState::boot_up ? 1U : 0U;
            break;
        case MessageKind::emergency:
            if (const auto emergency = drivers::decode_emergency(frame)) {
                ++device.emergencies;
                device.last_emergency = *emergency;
                device.last_emergency_ns = frame.stamp_ns;
            }
            break;
        default:
            break;
    }
}

std::int64_t BusMonitor::raw(const MessageField& field, const drivers::CanFrame& frame) const noexcept {
    if (field.signal != drivers::Signal::none) {
        const auto raw = read_raw(table_.row(field.signal), frame);
        const bool part = field.size_bits < drivers::size_bits(table_.config()[field.signal].type);
        return part ? (raw >> field.shift_bits) & ((std::int64_t{1} << field.size_bits) - 1) : raw;
    }
    // What is no signal of the table is unsigned, and all but the twin's values little-endian.
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < frame.data.size(); ++i) {
        bits |= static_cast<std::uint64_t>(frame.data[i]) << (8U * i);
    }
    return static_cast<std::int64_t>((bits >> field.start_bit) & ((std::uint64_t{1} << field.size_bits) - 1U));
}

void BusMonitor::close_window(std::int64_t now_ns) noexcept {
    if (window_begun_ && now_ns > window_begin_ns_) {
        const auto duration_ns = now_ns - window_begin_ns_;
        recent_rate_Hz_ = per_second(frames_ - frames_before_window_, duration_ns);
        recent_load_share_ = per_second(bits_ - bits_before_window_, duration_ns) / table_.config().bit_rate_bit_s;
        for (auto& traffic : messages_) {
            traffic.recent_rate_Hz = per_second(traffic.frames - traffic.frames_before_window_, duration_ns);
        }
    }
    window_begun_ = true;
    window_begin_ns_ = now_ns;
    frames_before_window_ = frames_;
    bits_before_window_ = bits_;
    for (auto& traffic : messages_) {
        traffic.frames_before_window_ = traffic.frames;
    }
}

double BusMonitor::mean_load_share() const noexcept {
    return per_second(bits_, last_ns_ - first_ns_) / table_.config().bit_rate_bit_s;
}

double BusMonitor::mean_rate_Hz() const noexcept {
    return per_second(frames_, last_ns_ - first_ns_);
}

}  // namespace steadyboom::hil
