#include "runtime/realtime_section.hpp"

namespace steadyboom::runtime {

namespace {
thread_local int depth = 0;
}

bool in_realtime_section() noexcept {
    return depth > 0;
}

RealtimeSection::RealtimeSection() noexcept {
    ++depth;
}

RealtimeSection::~RealtimeSection() {
    --depth;
}

}  // namespace steadyboom::runtime
