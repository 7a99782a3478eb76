#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "runtime/operator_mailbox.hpp"

namespace steadyboom::runtime {

static_assert(std::endian::native == std::endian::little, "operator messages are little-endian as they lie in memory");

inline constexpr std::uint32_t operator_magic = 0x504F'4253;  // "SBOP"
inline constexpr std::uint16_t operator_protocol_version = 2;

/// One packet from operator to controller on a SOCK_SEQPACKET socket. Any other length, magic, version or command
/// closes the connection without a reply.
struct OperatorMessage {
    std::uint32_t magic = operator_magic;
    std::uint16_t version = operator_protocol_version;
    std::uint16_t command = 0;  ///< OperatorCommand
    std::uint64_t token = 0;    ///< for engage; 0 otherwise
};
static_assert(std::is_trivially_copyable_v<OperatorMessage> && sizeof(OperatorMessage) == 16);

/// The one reply to each message.
struct OperatorReply {
    std::uint32_t magic = operator_magic;
    std::uint16_t version = operator_protocol_version;
    std::uint16_t result = 0;       ///< OperatorResult
    std::uint32_t state = 0;        ///< OperatorStatus::state when the reply was made
    std::uint32_t reasons = 0;      ///< of the refusal; for status and when done, OperatorStatus::reasons
    std::uint64_t tick = 0;         ///< newest tick when the reply was made
    std::int64_t tick_age_ns = -1;  ///< how long ago that tick was due; -1: no tick yet
    std::uint64_t token = 0;        ///< to an arm that was done, what engage needs; never 0 then
    std::array<char, 984> text{};   ///< state, reasons and devices in words, zero-terminated

    [[nodiscard]] OperatorResult outcome() const noexcept { return static_cast<OperatorResult>(result); }
    [[nodiscard]] std::string_view words() const noexcept {
        const std::string_view all(text.data(), text.size());
        return all.substr(0, all.find('\0'));
    }
};
static_assert(std::is_trivially_copyable_v<OperatorReply> && sizeof(OperatorReply) == 1024);

[[nodiscard]] std::string_view name_of(OperatorCommand command) noexcept;
[[nodiscard]] std::string_view name_of(OperatorResult result) noexcept;

}  // namespace steadyboom::runtime
