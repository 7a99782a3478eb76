#pragma once

#include <cstddef>
#include <memory>
#include <span>

namespace steadyboom::hil::benchmark {

/// LCM's udpm provider kept to this machine (ttl=0), sending the bytes of a record as they are: what any LCM message of
/// that size costs at least, its encoding left out.
class LcmPublisher {
  public:
    LcmPublisher();
    ~LcmPublisher();
    LcmPublisher(const LcmPublisher&) = delete;
    LcmPublisher& operator=(const LcmPublisher&) = delete;

    /// False when the message could not be sent.
    bool publish(std::span<const std::byte> message);

    /// Sends `message` to a subscriber of its own and says whether it came back unchanged; false also where multicast
    /// does not work.
    [[nodiscard]] static bool delivers(std::span<const std::byte> message);

  private:
    struct Lcm;
    std::unique_ptr<Lcm> lcm_;
};

}  // namespace steadyboom::hil::benchmark
