#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "drivers/device_table.hpp"
#include "drivers/emcy.hpp"
#include "drivers/sdo_client.hpp"

namespace steadyboom::drivers {

/// Where the manager is with a device.
enum class DeviceState : std::uint8_t {
    unknown,             ///< not heard yet; asked for its device type now and then
    boot_up,             ///< has announced itself, waits for its turn
    checking,            ///< is being asked who it is, and a valve for its command timeout
    configuring,         ///< is being told when to send
    pre_operational,     ///< all is well with it; NMT start is under way
    operational,         ///< sends process data. Devices without CANopen are always here
    stopped,             ///< says that somebody stopped it
    wrong_identity,      ///< 1000h or 1018h are not what the configuration expects; never started
    no_command_timeout,  ///< a valve that would not centre itself in time; never started
    sdo_aborted,         ///< refused a question or a setting; never started
    sdo_timed_out,       ///< fell silent during the questions
    lost,                ///< its heartbeat is missing
};

/// "operational", "wrong identity", ...
[[nodiscard]] std::string_view name_of(DeviceState state) noexcept;

/// One device as the manager knows it.
struct NodeStatus {
    DeviceState managed = DeviceState::unknown;
    NodeState state = NodeState::unknown;  ///< as its last heartbeat said
    bool alive = false;                    ///< heard within its consumer time, or it has no heartbeat
    std::int64_t heartbeat_age_ns = 0;     ///< since the last heartbeat; 0 before the first
    std::uint32_t boot_ups = 0;
    std::uint64_t emergencies = 0;
    Emergency emergency;          ///< the newest one; code 0 once the device says that it is over
    ObjectAddress failed_object;  ///< what the last failure was about
    SdoAbort abort = SdoAbort::none;
    std::uint32_t read_raw = 0;  ///< what it answered there
};

/// NMT manager (CiA 301, 302): brings every device from its boot-up, or from whatever it was doing, to operational. For
/// each: ask 1000h and, where the configuration names them, 1018h:01 and :02 and the valve's command timeout; where it
/// may be configured, write transmission type and event timer of its TPDOs and its heartbeat time; then start it. What
/// goes wrong is tried again after a second. A device that is not who it should be, or a valve without command timeout,
/// is stopped until then; one that fell silent in the midst of its answers is reset. A device whose heartbeat stays
/// away for its consumer time is lost; heard again, it begins anew, for it could be another one.
///
/// A state machine that waits for nothing: one frame a tick at most, no allocation after construction.
class NetworkManager {
  public:
    explicit NetworkManager(const DeviceTable& table);

    // What came in this tick; frames are of the table's length.
    void take_heartbeat(Device device, NodeState state, std::int64_t now_ns) noexcept;
    void take_emergency(Device device, const CanFrame& frame) noexcept;
    void take_sdo_answer(const CanFrame& frame) noexcept;
    /// A device sent process data, as only an operational one does.
    void take_process_data(Device device) noexcept;

    /// Once a tick, after all that came in.
    void update(std::int64_t now_ns) noexcept;

    /// The tick's one management frame, if any: the controller's heartbeat, or else an NMT command, or else SDO.
    [[nodiscard]] std::optional<CanFrame> frame(std::int64_t now_ns) noexcept;

    [[nodiscard]] const NodeStatus& status(Device device) const noexcept { return nodes_[index_of(device)].status; }
    [[nodiscard]] bool operational(Device device) const noexcept {
        return status(device).managed == DeviceState::operational;
    }
    /// Every device that the configuration requires is operational.
    [[nodiscard]] bool all_required_operational() const noexcept;
    [[nodiscard]] std::uint64_t nmt_commands() const noexcept { return nmt_commands_; }

  private:
    /// One question or setting, and what of the answer is right.
    struct Step {
        ObjectAddress object;
        bool writes = false;
        std::uint32_t value = 0;  ///< to write
        std::uint8_t size_bytes = 0;
        std::uint32_t lowest = 0;  ///< of the answer
        std::uint32_t highest = 0xFFFF'FFFFU;
        DeviceState otherwise = DeviceState::wrong_identity;
    };
    struct Node {
        NodeStatus status;
        std::vector<Step> steps;
        std::size_t next_step = 0;
        bool due = true;                    ///< its steps may begin
        bool restarted = false;             ///< booted while its steps ran: they begin anew
        std::int64_t retry_ns = 0;          ///< when, unless something happens earlier; of states that wait
        std::int64_t heard_ns = 0;          ///< last heartbeat
        std::optional<NmtCommand> command;  ///< waits to be sent
    };

    [[nodiscard]] std::vector<Step> steps_of(Device device) const;
    void begin_anew(Node& node, DeviceState state) noexcept;
    void fail(Node& node, DeviceState state, std::int64_t now_ns) noexcept;
    void watch(Device device, std::int64_t now_ns) noexcept;
    void choose_next() noexcept;
    void advance(std::int64_t now_ns) noexcept;
    void start_step(Device device) noexcept;
    [[nodiscard]] std::optional<CanFrame> heartbeat(std::int64_t now_ns) noexcept;
    [[nodiscard]] std::optional<CanFrame> nmt_command(std::int64_t now_ns) noexcept;
    [[nodiscard]] CanFrame nmt(NmtCommand command, std::uint8_t node_id, std::int64_t now_ns) noexcept;

    const DeviceTable& table_;
    std::array<Node, device_count> nodes_;
    SdoClient sdo_;
    std::optional<Device> current_;  ///< whose steps are under way
    std::size_t last_chosen_ = 0;
    bool booted_ = false;
    bool quietened_ = false;  ///< all nodes were asked to be pre-operational
    std::int64_t next_heartbeat_ns_ = 0;
    std::uint64_t nmt_commands_ = 0;
};

}  // namespace steadyboom::drivers
