#pragma once

namespace steadyboom::runtime {

/// True while the calling thread is inside at least one RealtimeSection.
[[nodiscard]] bool in_realtime_section() noexcept;

/// Marks the code of the calling thread that must not allocate, lock, log or block. It costs one thread-local counter
/// and forbids nothing by itself: every test program carries an allocator (tests/support) that aborts on any allocation
/// or release made inside a section. Sections nest and belong to the thread that opened them.
class RealtimeSection {
  public:
    RealtimeSection() noexcept;
    ~RealtimeSection();
    RealtimeSection(const RealtimeSection&) = delete;
    RealtimeSection& operator=(const RealtimeSection&) = delete;
};

}  // namespace steadyboom::runtime
