#pragma once

#include <cstdint>
#include <optional>

#include "drivers/can_frame.hpp"
#include "drivers/sdo_abort.hpp"
#include "drivers/sdo_format.hpp"

namespace steadyboom::drivers {

/// Reads and writes objects of 1 to 4 bytes in other nodes (CiA 301 expedited SDO), one transfer at a time:
///
///     client.upload(node, {0x1018, 1});
///     each tick: client.receive(frame) for frames that come; send client.poll(now) if it holds one
///     until !client.busy(); then client.outcome(), client.value()
///
/// Time is the caller's, steady. A node that does not answer within `timeout_ns` of the request's send gets an abort.
/// An answer that wants segments (objects of more than 4 bytes) is aborted too.
class SdoClient {
  public:
    enum class Outcome : std::uint8_t { none, done, aborted, timed_out };

    explicit SdoClient(std::int64_t timeout_ns = 100'000'000) noexcept : timeout_ns_(timeout_ns) {}

    /// Starts reading. False, and nothing changes, if a transfer is under way or the node is not 1 to 127.
    bool upload(std::uint8_t node, ObjectAddress object) noexcept;

    /// Starts writing the low `size_bytes` (1 to 4) of `value`. False as above.
    bool download(std::uint8_t node, ObjectAddress object, std::uint32_t value, std::uint8_t size_bytes) noexcept;

    /// A frame to send now, if any: the request once, an abort after a timeout or a wrong answer.
    [[nodiscard]] std::optional<CanFrame> poll(std::int64_t now_ns) noexcept;

    /// True if the frame was the answer to the transfer under way; all others are left alone, late answers counted.
    bool receive(const CanFrame& frame) noexcept;

    [[nodiscard]] bool busy() const noexcept { return step_ != Step::idle; }
    [[nodiscard]] Outcome outcome() const noexcept { return outcome_; }    ///< of the last transfer; none while busy
    [[nodiscard]] SdoAbort abort_code() const noexcept { return abort_; }  ///< none unless aborted or timed_out
    [[nodiscard]] std::uint32_t value() const noexcept { return value_; }  ///< read, little-endian, zero-extended
    [[nodiscard]] std::uint8_t size_bytes() const noexcept { return size_bytes_; }  ///< read; 4 if the node did not say
    [[nodiscard]] std::uint8_t node() const noexcept { return node_; }
    [[nodiscard]] ObjectAddress object() const noexcept { return object_; }
    [[nodiscard]] std::uint64_t unexpected_answers() const noexcept { return unexpected_answers_; }

  private:
    enum class Step : std::uint8_t { idle, to_send, waiting, to_abort };

    bool begin(std::uint8_t node, ObjectAddress object) noexcept;
    void end(Outcome outcome, SdoAbort code) noexcept;
    void refuse() noexcept;

    std::int64_t timeout_ns_;
    Step step_ = Step::idle;
    Outcome outcome_ = Outcome::none;
    SdoAbort abort_ = SdoAbort::none;
    bool writes_ = false;
    std::uint8_t node_ = 0;
    ObjectAddress object_;
    std::uint32_t value_ = 0;
    std::uint8_t size_bytes_ = 0;
    std::int64_t sent_ns_ = 0;
    std::uint64_t unexpected_answers_ = 0;
};

}  // namespace steadyboom::drivers
