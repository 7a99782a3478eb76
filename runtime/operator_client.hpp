#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

#include "runtime/file_descriptor.hpp"
#include "runtime/operator_protocol.hpp"

namespace steadyboom::runtime {

/// The operator's end of the controller's socket.
class OperatorClient {
  public:
    /// Connects, trying again until `patience` is over. Throws std::runtime_error naming the path and the remedy.
    explicit OperatorClient(const std::filesystem::path& path,
                            std::chrono::milliseconds patience = std::chrono::milliseconds(0));

    /// Sends one command and waits for its reply. Throws std::runtime_error when the controller closes the connection,
    /// does not reply within `timeout`, or speaks another protocol.
    OperatorReply request(OperatorCommand command, std::uint64_t token = 0,
                          std::chrono::milliseconds timeout = std::chrono::milliseconds(2000));

    /// Arm, then engage with the token of that arm; the arm's reply when that was not done.
    OperatorReply arm_and_engage();

  private:
    std::filesystem::path path_;
    FileDescriptor socket_;
};

}  // namespace steadyboom::runtime
