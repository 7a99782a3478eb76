#include "drivers/sdo_client.hpp"

namespace steadyboom::drivers {

bool SdoClient::upload(std::uint8_t node, ObjectAddress object) noexcept {
    if (!begin(node, object)) {
        return false;
    }
    writes_ = false;
    value_ = 0;
    size_bytes_ = 0;
    return true;
}

bool SdoClient::download(std::uint8_t node, ObjectAddress object, std::uint32_t value,
                         std::uint8_t size_bytes) noexcept {
    if (size_bytes < 1 || size_bytes > sdo::largest_expedited_bytes || !begin(node, object)) {
        return false;
    }
    writes_ = true;
    value_ = value;
    size_bytes_ = size_bytes;
    return true;
}

bool SdoClient::begin(std::uint8_t node, ObjectAddress object) noexcept {
    if (busy() || node < 1 || node > 127) {
        return false;
    }
    node_ = node;
    object_ = object;
    outcome_ = Outcome::none;
    abort_ = SdoAbort::none;
    step_ = Step::to_send;
    return true;
}

std::optional<CanFrame> SdoClient::poll(std::int64_t now_ns) noexcept {
    if (step_ == Step::waiting && now_ns - sent_ns_ > timeout_ns_) {
        outcome_ = Outcome::timed_out;
        abort_ = SdoAbort::timeout;
        step_ = Step::to_abort;
    }
    const auto id = sdo_request_code + node_;
    if (step_ == Step::to_abort) {
        step_ = Step::idle;
        return sdo::frame(id, sdo::abort_command, object_, static_cast<std::uint32_t>(abort_), now_ns);
    }
    if (step_ != Step::to_send) {
        return std::nullopt;
    }
    step_ = Step::waiting;
    sent_ns_ = now_ns;
    if (writes_) {
        return sdo::frame(id, sdo::expedited(sdo::download_request, size_bytes_), object_,
                          sdo::low_bytes(value_, size_bytes_), now_ns);
    }
    return sdo::frame(id, sdo::upload_request, object_, 0, now_ns);
}

bool SdoClient::receive(const CanFrame& frame) noexcept {
    if (!sdo::is_sdo(frame, sdo_response_code)) {
        return false;
    }
    if (step_ != Step::waiting || frame.id != sdo_response_code + node_ || sdo::object_of(frame) != object_) {
        ++unexpected_answers_;
        return false;
    }
    const std::uint8_t command = frame.data[0];
    if (command == sdo::abort_command) {
        end(Outcome::aborted, static_cast<SdoAbort>(sdo::payload_of(frame)));
    } else if (writes_) {
        if (sdo::specifier_of(command) == sdo::download_response) {
            end(Outcome::done, SdoAbort::none);
        } else {
            refuse();
        }
    } else if (sdo::specifier_of(command) == sdo::upload_response && (command & sdo::expedited_bit) != 0) {
        size_bytes_ = sdo::size_of(command).value_or(sdo::largest_expedited_bytes);
        value_ = sdo::low_bytes(sdo::payload_of(frame), size_bytes_);
        end(Outcome::done, SdoAbort::none);
    } else {
        refuse();
    }
    return true;
}

void SdoClient::refuse() noexcept {
    outcome_ = Outcome::aborted;
    abort_ = SdoAbort::command_unknown;
    step_ = Step::to_abort;
}

void SdoClient::end(Outcome outcome, SdoAbort code) noexcept {
    outcome_ = outcome;
    abort_ = code;
    step_ = Step::idle;
}

}  // namespace steadyboom::drivers
