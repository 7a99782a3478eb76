#include "hil/benchmark/peers/lcm_publisher.hpp"

#include <algorithm>

#include <lcm/lcm-cpp.hpp>

namespace steadyboom::hil::benchmark {

namespace {

constexpr const char* url = "udpm://239.255.76.67:7668?ttl=0";
constexpr const char* channel = "BENCHMARK";

}  // namespace

struct LcmPublisher::Lcm {
    lcm::LCM instance{url};
};

LcmPublisher::LcmPublisher() : lcm_(std::make_unique<Lcm>()) {}

LcmPublisher::~LcmPublisher() = default;

bool LcmPublisher::publish(std::span<const std::byte> message) {
    return lcm_->instance.good() &&
           lcm_->instance.publish(channel, message.data(), static_cast<unsigned>(message.size())) == 0;
}

bool LcmPublisher::delivers(std::span<const std::byte> message) {
    struct Receipt {
        std::span<const std::byte> sent;
        bool unchanged = false;
        void receive(const lcm::ReceiveBuffer* buffer, const std::string&) {
            const auto* data = static_cast<const std::byte*>(buffer->data);
            unchanged = std::equal(sent.begin(), sent.end(), data, data + buffer->data_size);
        }
    };
    Receipt receipt{message};
    lcm::LCM subscriber(url);
    LcmPublisher publisher;
    if (!subscriber.good()) {
        return false;
    }
    subscriber.subscribe(channel, &Receipt::receive, &receipt);
    constexpr int patience_ms = 1000;
    return publisher.publish(message) && subscriber.handleTimeout(patience_ms) > 0 && receipt.unchanged;
}

}  // namespace steadyboom::hil::benchmark
