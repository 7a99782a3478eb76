#include "runtime/tick_ring.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "runtime/file_descriptor.hpp"

namespace steadyboom::runtime {

namespace {

constexpr std::size_t alignment_bytes = alignof(TickRingHeader);

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw std::runtime_error("tick ring " + path.string() + ": " + what);
}

std::string words(int error) {
    return std::generic_category().message(error);
}

std::size_t bytes_needed(std::uint64_t capacity_records, const TickRingMemory::Shape& shape) {
    return sizeof(TickRingHeader) + static_cast<std::size_t>(capacity_records * shape.slot_bytes);
}

void check(const TickRingOptions& options) {
    constexpr std::uint64_t most = 1U << 20;
    if (options.capacity_records < 2 || options.capacity_records > most) {
        throw std::runtime_error("tick ring: capacity_records is " + std::to_string(options.capacity_records) +
                                 ", allowed are 2 to " + std::to_string(most));
    }
}

// The time makes it differ from ring to ring, the process number between two that start within one clock tick.
std::uint64_t new_epoch() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const auto ns = static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000U + static_cast<std::uint64_t>(now.tv_nsec);
    return (ns << 16U) ^ static_cast<std::uint64_t>(getpid()) ^ 1U;
}

void initialise(void* base, const TickRingMemory::Shape& shape, const TickRingOptions& options) {
    auto* header = new (base) TickRingHeader{};
    header->magic = TickRingHeader::magic_value;
    header->format_version = TickRingHeader::format_version_value;
    header->record_version = shape.record_version;
    header->record_bytes = shape.record_bytes;
    header->capacity_records = options.capacity_records;
    header->period_ns = options.period_ns;
    header->crane_hash = options.crane_hash;
    header->epoch = new_epoch();
}

}  // namespace

TickRingMemory::TickRingMemory(void* base, std::size_t bytes, std::filesystem::path path)
    : base_(base), bytes_(bytes), path_(std::move(path)) {}

TickRingMemory::TickRingMemory(TickRingMemory&& other) noexcept
    : base_(std::exchange(other.base_, nullptr)),
      bytes_(other.bytes_),
      path_(std::move(other.path_)),
      device_(other.device_),
      inode_(other.inode_) {}

TickRingMemory::~TickRingMemory() {
    if (base_ == nullptr) {
        return;
    }
    if (path_.empty()) {
        ::operator delete(base_, std::align_val_t(alignment_bytes));
    } else {
        munmap(base_, bytes_);
    }
}

TickRingMemory TickRingMemory::create_heap(const Shape& shape, const TickRingOptions& options) {
    check(options);
    const std::size_t bytes = bytes_needed(options.capacity_records, shape);
    void* base = ::operator new(bytes, std::align_val_t(alignment_bytes));
    std::memset(base, 0, bytes);
    initialise(base, shape, options);
    return {base, bytes, {}};
}

TickRingMemory TickRingMemory::create_file(const std::filesystem::path& path, const Shape& shape,
                                           const TickRingOptions& options) {
    check(options);
    const std::size_t bytes = bytes_needed(options.capacity_records, shape);
    const std::filesystem::path temporary = path.string() + "." + std::to_string(getpid()) + ".new";
    unlink(temporary.c_str());
    const FileDescriptor file(open(temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
    if (file.get() < 0) {
        fail(path, "cannot create it: " + words(errno) + "; make its folder and let this user write there");
    }
    try {
        // Allocates now: a full disk is an error here and not a SIGBUS in a tick.
        if (const int error = posix_fallocate(file.get(), 0, static_cast<off_t>(bytes)); error != 0) {
            fail(path, "cannot allocate " + std::to_string(bytes) + " bytes: " + words(error) +
                           "; free space there or lower capacity_records");
        }
        void* base = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, file.get(), 0);
        if (base == MAP_FAILED) {
            fail(path, "cannot map it: " + words(errno));
        }
        TickRingMemory memory(base, bytes, path);
        initialise(base, shape, options);
        struct stat facts {};
        if (fstat(file.get(), &facts) != 0 || fchmod(file.get(), options.file_mode) != 0 ||
            rename(temporary.c_str(), path.c_str()) != 0) {
            fail(path, "cannot give it its name: " + words(errno));
        }
        memory.device_ = facts.st_dev;
        memory.inode_ = facts.st_ino;
        return memory;
    } catch (...) {
        unlink(temporary.c_str());
        throw;
    }
}

TickRingMemory TickRingMemory::open_file(const std::filesystem::path& path, const Shape& shape) {
    const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat facts {};
    if (file.get() < 0 || fstat(file.get(), &facts) != 0) {
        fail(path, "cannot open it: " + words(errno) + "; start the program that writes it, or name another path");
    }
    const auto bytes = static_cast<std::size_t>(facts.st_size);
    if (!S_ISREG(facts.st_mode) || bytes < sizeof(TickRingHeader)) {
        fail(path, "is no tick ring");
    }
    void* base = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, file.get(), 0);
    if (base == MAP_FAILED) {
        fail(path, "cannot map it: " + words(errno));
    }
    TickRingMemory memory(base, bytes, path);
    memory.device_ = facts.st_dev;
    memory.inode_ = facts.st_ino;

    const TickRingHeader& header = *memory.header();
    if (header.magic != TickRingHeader::magic_value) {
        fail(path, "is no tick ring");
    }
    if (header.format_version != TickRingHeader::format_version_value) {
        fail(path, "has format " + std::to_string(header.format_version) + ", this program reads format " +
                       std::to_string(TickRingHeader::format_version_value) + "; run both from one release");
    }
    if (header.record_version != shape.record_version || header.record_bytes != shape.record_bytes) {
        fail(path, "holds records of version " + std::to_string(header.record_version) + " with " +
                       std::to_string(header.record_bytes) + " bytes, this program reads version " +
                       std::to_string(shape.record_version) + " with " + std::to_string(shape.record_bytes) +
                       " bytes; run both from one release");
    }
    if (header.capacity_records < 2 || header.capacity_records > bytes / shape.slot_bytes ||
        bytes < bytes_needed(header.capacity_records, shape)) {
        fail(path, "is shorter than its " + std::to_string(header.capacity_records) + " records; it is damaged");
    }
    return memory;
}

bool TickRingMemory::still_named() const noexcept {
    if (path_.empty()) {
        return true;
    }
    struct stat facts {};
    return stat(path_.c_str(), &facts) == 0 && facts.st_dev == device_ && facts.st_ino == inode_;
}

}  // namespace steadyboom::runtime
