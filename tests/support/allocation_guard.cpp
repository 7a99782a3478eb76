// Aborts, with a backtrace, on any allocation or release inside a runtime::RealtimeSection. Linked as an object into
// every test program. Eigen's own EIGEN_RUNTIME_NO_MALLOC switch is not used: it is one flag for all threads, and each
// of its allocations comes through malloc anyway.
#include <execinfo.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "runtime/realtime_section.hpp"

namespace {

// backtrace() allocates on its first use, and so would whatever abort() calls.
thread_local bool reporting = false;

void require_allowed(const char* what) noexcept {
    if (!steadyboom::runtime::in_realtime_section() || reporting) {
        return;
    }
    reporting = true;
    const char* const parts[] = {"allocation guard: ", what, " inside a RealtimeSection\n"};
    for (const char* part : parts) {
        [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, part, std::strlen(part));
    }
    void* frames[64];
    backtrace_symbols_fd(frames, backtrace(frames, 64), STDERR_FILENO);
    std::abort();
}

}  // namespace

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

// The sanitizer owns the allocator and offers hooks.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*, std::size_t),
                                                         void (*free_hook)(const volatile void*));

namespace {

[[maybe_unused]] const int installed =
    __sanitizer_install_malloc_and_free_hooks([](const volatile void*, std::size_t) { require_allowed("malloc"); },
                                              [](const volatile void* memory) {
                                                  if (memory != nullptr) {
                                                      require_allowed("free");
                                                  }
                                              });

}  // namespace

#else

extern "C" {

void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* memory, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void __libc_free(void* memory);

void* malloc(std::size_t bytes) noexcept {
    require_allowed("malloc");
    return __libc_malloc(bytes);
}

void* calloc(std::size_t count, std::size_t bytes) noexcept {
    require_allowed("calloc");
    return __libc_calloc(count, bytes);
}

void* realloc(void* memory, std::size_t bytes) noexcept {
    require_allowed("realloc");
    return __libc_realloc(memory, bytes);
}

void* memalign(std::size_t alignment, std::size_t bytes) noexcept {
    require_allowed("memalign");
    return __libc_memalign(alignment, bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
    require_allowed("aligned_alloc");
    return __libc_memalign(alignment, bytes);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t bytes) noexcept {
    require_allowed("posix_memalign");
    if (alignment % sizeof(void*) != 0 || alignment == 0 || (alignment & (alignment - 1)) != 0) {
        return EINVAL;
    }
    void* const made = __libc_memalign(alignment, bytes);
    if (made == nullptr) {
        return ENOMEM;
    }
    *memory = made;
    return 0;
}

void free(void* memory) noexcept {
    if (memory != nullptr) {
        require_allowed("free");
    }
    __libc_free(memory);
}

}  // extern "C"

#endif
