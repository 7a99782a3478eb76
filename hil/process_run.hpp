#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "hil/run_result.hpp"

namespace steadyboom::hil {

/// The product's way in real time: steadyboom-plant and steadyboom-controller as processes of their own on a SocketCAN
/// interface; the bench arms and engages over the operator's socket, reads both rings and logs the bus.
///
/// Both programs are looked for beside the running one. `progress` gets a line now and then. Their configuration files
/// go into `folder`, which must exist, and stay there.
///
/// Throws std::runtime_error when a process cannot start or ends early, the controller cannot be armed before the brake
/// event, or records were lost; both processes are ended then. A run that leaves command after the brake event is a
/// result (stayed_engaged false).
[[nodiscard]] RunResult run_on_interface(const RunOptions& options, const std::string& interface,
                                         const std::filesystem::path& folder,
                                         const std::function<void(const std::string&)>& progress);

}  // namespace steadyboom::hil
