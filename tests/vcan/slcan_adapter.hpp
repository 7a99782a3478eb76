#pragma once

#include <fcntl.h>
#include <linux/tty.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace steadyboom::test_support {

/// A serial-line CAN adapter (Lawicel's protocol) played on a pseudo-terminal. What the kernel makes of it is a CAN
/// interface like that of a real adapter, with bit rate, states and error counters: what a vcan has not.
///
/// The kernel writes it lines: "S6" 500 kbit/s, "O" open, "C" close, "t1232AABB" a frame. Lines that it writes to the
/// kernel: "t1232AABB" a frame came in; "sa", "sw", "sp", "sb" and its counts of errors, receiving and sending,
/// "sp130096": the controller is active, warning, passive, bus-off; "e1a" nobody acknowledges; "e1o" frames were lost.
class SlcanAdapter {
  public:
    SlcanAdapter() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
        // A kernel that has it built in knows no module; whether it has it shows below.
        (void)std::system("modprobe slcan 2>/dev/null");
        if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) {
            throw std::runtime_error("no pseudo-terminal");
        }
        slave_ = open(ptsname(master_), O_RDWR | O_NOCTTY | O_CLOEXEC);
        termios raw{};
        tcgetattr(slave_, &raw);
        cfmakeraw(&raw);
        tcsetattr(slave_, TCSANOW, &raw);
        const int discipline = N_SLCAN;
        ifreq request{};
        if (ioctl(slave_, TIOCSETD, &discipline) != 0 || ioctl(slave_, SIOCGIFNAME, &request) != 0) {
            throw std::runtime_error("this kernel has no slcan");
        }
        interface_ = request.ifr_name;
        reader_ = std::thread([this] { read_lines(); });
    }

    ~SlcanAdapter() { unplug(); }

    SlcanAdapter(const SlcanAdapter&) = delete;
    SlcanAdapter& operator=(const SlcanAdapter&) = delete;

    [[nodiscard]] const std::string& interface() const { return interface_; }

    /// The kernel then takes the interface away.
    void unplug() {
        if (!unplugged_.exchange(true)) {
            reader_.join();
            close(slave_);
            close(master_);
        }
    }

    void say(const std::string& line) {
        const std::string text = line + "\r";
        if (write(master_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
            throw std::runtime_error("the pseudo-terminal takes nothing");
        }
    }

    /// Takes no further line from the kernel, as an adapter does whose frames nobody acknowledges.
    void stop_reading() { reading_ = false; }

    /// What the kernel wrote so far.
    [[nodiscard]] std::vector<std::string> lines() {
        const std::lock_guard lock(mutex_);
        return lines_;
    }

    [[nodiscard]] int count(const std::string& line) {
        int found = 0;
        for (const std::string& each : lines()) {
            found += each == line ? 1 : 0;
        }
        return found;
    }

  private:
    void read_lines() {
        std::string line;
        while (!unplugged_) {
            pollfd ready{.fd = master_, .events = POLLIN, .revents = 0};
            char byte = 0;
            if (!reading_ || poll(&ready, 1, 20) != 1) {
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            } else if (read(master_, &byte, 1) == 1) {
                if (byte == '\r') {
                    const std::lock_guard lock(mutex_);
                    lines_.push_back(std::exchange(line, {}));
                } else {
                    line += byte;
                }
            }
        }
    }

    int master_ = -1;
    int slave_ = -1;
    std::string interface_;
    std::atomic<bool> unplugged_{false};
    std::atomic<bool> reading_{true};
    std::mutex mutex_;
    std::vector<std::string> lines_;
    std::thread reader_;
};

}  // namespace steadyboom::test_support
