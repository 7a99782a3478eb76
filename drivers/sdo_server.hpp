#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/can_frame.hpp"
#include "drivers/sdo_abort.hpp"
#include "drivers/sdo_format.hpp"

namespace steadyboom::drivers {

enum class ObjectAccess : std::uint8_t { read_only, write_only, read_write };

/// One entry of an object dictionary and its value as it lies on the bus: little-endian, zero-extended.
struct ObjectEntry {
    ObjectAddress object;
    std::uint8_t size_bytes = 4;  ///< 1 to 4
    ObjectAccess access = ObjectAccess::read_only;
    std::uint32_t value_raw = 0;
    std::uint32_t lowest_raw = 0;  ///< what may be written, compared as unsigned
    std::uint32_t highest_raw = 0xFFFF'FFFFU;
};

/// Counters since construction.
struct SdoServerStatus {
    std::uint64_t reads = 0;
    std::uint64_t writes = 0;
    std::uint64_t aborts = 0;  ///< requests that were refused
};

/// A node's side of SDO (CiA 301): answers one expedited request with one response. Segmented and block transfers are
/// refused with SdoAbort::command_unknown. Whoever needs a value looks into the dictionary; a write changes it there.
class SdoServer {
  public:
    /// The dictionary outlives the server. Throws std::invalid_argument naming the entry that has a size other than 1
    /// to 4, a value or limit larger than its size holds, limits the wrong way round, or a twin.
    SdoServer(std::uint8_t node, std::span<ObjectEntry> dictionary);

    /// The response, or nothing if the frame is no request to this node or is the client's abort.
    [[nodiscard]] std::optional<CanFrame> answer(const CanFrame& frame, std::int64_t now_ns) noexcept;

    [[nodiscard]] const SdoServerStatus& status() const noexcept { return status_; }

  private:
    struct Found {
        ObjectEntry* entry;
        SdoAbort abort;
    };

    [[nodiscard]] Found find(ObjectAddress object) noexcept;
    [[nodiscard]] SdoAbort write(ObjectEntry& entry, const CanFrame& frame) noexcept;

    std::uint8_t node_;
    std::span<ObjectEntry> dictionary_;
    SdoServerStatus status_;
};

}  // namespace steadyboom::drivers
