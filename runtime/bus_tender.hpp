#pragma once

#include <chrono>
#include <thread>

#include "drivers/socketcan_bus.hpp"
#include "runtime/realtime_thread.hpp"

namespace steadyboom::runtime {

/// Opens a bus's socket anew after its interface was gone, on a thread of its own: ten times a second it looks.
class BusTender {
  public:
    explicit BusTender(drivers::SocketCanBus& bus)
        : thread_("bus", [&bus](const std::stop_token& stop) {
              while (!stop.stop_requested()) {
                  bus.tend();
                  std::this_thread::sleep_for(std::chrono::milliseconds(100));
              }
          }) {}

  private:
    HelperThread thread_;
};

}  // namespace steadyboom::runtime
