#include "hil/benchmark/quiet_cpu.hpp"

#include <cstdint>

#include <fcntl.h>
#include <unistd.h>

namespace steadyboom::hil::benchmark {

QuietCpu::QuietCpu() noexcept : file_(open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC)) {
    const std::int32_t latency_us = 0;
    if (file_ >= 0 && write(file_, &latency_us, sizeof(latency_us)) != sizeof(latency_us)) {
        close(file_);
        file_ = -1;
    }
}

QuietCpu::~QuietCpu() {
    if (file_ >= 0) {
        close(file_);
    }
}

}  // namespace steadyboom::hil::benchmark
