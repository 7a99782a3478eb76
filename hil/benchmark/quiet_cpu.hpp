#pragma once

namespace steadyboom::hil::benchmark {

/// Holds /dev/cpu_dma_latency at 0 while it lives, so that no CPU sleeps deeply between paced calls.
class QuietCpu {
  public:
    QuietCpu() noexcept;
    ~QuietCpu();
    QuietCpu(const QuietCpu&) = delete;
    QuietCpu& operator=(const QuietCpu&) = delete;

    /// False without the rights, or where the kernel has no such file: paced calls then take longer.
    [[nodiscard]] bool held() const noexcept { return file_ >= 0; }

  private:
    int file_;
};

}  // namespace steadyboom::hil::benchmark
