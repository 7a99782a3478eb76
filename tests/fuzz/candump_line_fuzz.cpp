// Lines of a log that someone else wrote.

#include <algorithm>

#include "drivers/candump_log.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace steadyboom {
namespace {

using namespace drivers;
using tests::require;

void run(std::string_view line) {
    const auto entry = read_candump_line(line);
    if (entry.kind == CandumpKind::malformed) {
        require(!entry.problem.empty(), "a malformed line has a reason");
        return;
    }
    require(entry.frame.length <= longest_frame_bytes, "a frame has at most eight bytes");
    if (entry.kind == CandumpKind::frame) {
        const auto written = candump_line(entry.frame, entry.interface);
        const auto again = read_candump_line(written.view());
        require(again.kind == CandumpKind::frame, "what was read can be written and read again");
        require(again.frame.id == entry.frame.id && again.frame.length == entry.frame.length &&
                    again.frame.data == entry.frame.data && again.frame.stamp_ns == entry.frame.stamp_ns &&
                    again.frame.extended == entry.frame.extended && again.frame.remote == entry.frame.remote &&
                    again.frame.error == entry.frame.error,
                "and is the same");
    }
}

}  // namespace
}  // namespace steadyboom

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    steadyboom::run({reinterpret_cast<const char*>(data), size});
    return 0;
}
