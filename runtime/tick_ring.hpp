#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <type_traits>

#include "runtime/seqlock.hpp"

namespace steadyboom::runtime {

/// How a ring is made. The record's size and layout version come from its type.
struct TickRingOptions {
    std::uint64_t capacity_records = 4096;  ///< at least 2
    std::int64_t period_ns = 0;             ///< of the writer's schedule, for readers
    std::uint64_t crane_hash = 0;           ///< identifies the crane file the writer runs
    std::uint32_t file_mode = 0640;
};

/// First bytes of the ring. Everything but the last two fields is constant once the file has its name.
struct TickRingHeader {
    static constexpr std::uint64_t magic_value = 0x474E'4952'4B43'4954;  // "TICKRING"
    static constexpr std::uint32_t format_version_value = 1;

    std::uint64_t magic;
    std::uint32_t format_version;  ///< of this header and the slots
    std::uint32_t record_version;  ///< Record::layout_version
    std::uint64_t record_bytes;
    std::uint64_t capacity_records;
    std::int64_t period_ns;
    std::uint64_t crane_hash;
    std::uint64_t epoch;                            ///< differs for every writer started, never 0
    alignas(64) std::atomic<std::uint64_t> pushed;  ///< records pushed so far
    std::atomic<std::uint64_t> closed;              ///< 1 once the writer ended in order
};
static_assert(std::is_standard_layout_v<TickRingHeader> && sizeof(TickRingHeader) == 128);

/// The memory under a ring: a file mapped by several processes, or plain heap memory of one.
class TickRingMemory {
  public:
    struct Shape {
        std::uint32_t record_version;
        std::uint64_t record_bytes;
        std::uint64_t slot_bytes;
    };

    /// A new file, complete before it takes its name `path`; an older ring of that name lives on for those who have it
    /// open. All pages are allocated and mapped. Throws std::runtime_error naming the path and the remedy.
    static TickRingMemory create_file(const std::filesystem::path& path, const Shape& shape,
                                      const TickRingOptions& options);
    static TickRingMemory create_heap(const Shape& shape, const TickRingOptions& options);

    /// An existing file, read-only. Throws std::runtime_error: not there, no ring, another format, another record.
    static TickRingMemory open_file(const std::filesystem::path& path, const Shape& shape);

    TickRingMemory(TickRingMemory&& other) noexcept;
    TickRingMemory& operator=(TickRingMemory&&) = delete;
    ~TickRingMemory();

    [[nodiscard]] TickRingHeader* header() const noexcept { return static_cast<TickRingHeader*>(base_); }
    [[nodiscard]] void* slots() const noexcept { return static_cast<std::byte*>(base_) + sizeof(TickRingHeader); }

    /// False when the file's name is gone or now belongs to another ring. Always true on the heap.
    [[nodiscard]] bool still_named() const noexcept;

  private:
    TickRingMemory(void* base, std::size_t bytes, std::filesystem::path path);
    void* base_ = nullptr;
    std::size_t bytes_ = 0;
    std::filesystem::path path_;  ///< empty on the heap
    std::uint64_t device_ = 0;
    std::uint64_t inode_ = 0;
};

template <class Record>
struct TickRingSlot {
    std::atomic<std::uint64_t> version;  ///< 2n+1 while record n is written, 2n+2 when it is whole
    AtomicWords<Record> words;

    static TickRingMemory::Shape shape() { return {Record::layout_version, sizeof(Record), sizeof(TickRingSlot)}; }
};

template <class Record>
class TickRingReader;

/// Broadcasts records to any number of readers, in this process or others. Never waits for any of them: a slow reader
/// loses records and knows how many. Exactly one thread pushes.
///
/// `Record` is trivially copyable and has `static constexpr std::uint32_t layout_version`.
template <class Record>
class TickRingWriter {
  public:
    /// A ring at `path` for other processes (see TickRingMemory::create_file).
    TickRingWriter(const std::filesystem::path& path, const TickRingOptions& options)
        : memory_(TickRingMemory::create_file(path, TickRingSlot<Record>::shape(), options)) {
        attach();
    }

    /// A ring for readers in this process.
    explicit TickRingWriter(const TickRingOptions& options)
        : memory_(TickRingMemory::create_heap(TickRingSlot<Record>::shape(), options)) {
        attach();
    }

    TickRingWriter(const TickRingWriter&) = delete;
    TickRingWriter& operator=(const TickRingWriter&) = delete;

    /// Leaves the file, so that the last records can still be read, and marks it closed.
    ~TickRingWriter() { header_->closed.store(1, std::memory_order_release); }

    /// Wait-free; copies sizeof(Record) bytes.
    void push(const Record& record) noexcept {
        TickRingSlot<Record>& slot = slots_[pushed_ % capacity_];
        slot.version.store(2 * pushed_ + 1, std::memory_order_relaxed);
        slot.words.store(record);
        slot.version.store(2 * pushed_ + 2, std::memory_order_release);
        ++pushed_;
        header_->pushed.store(pushed_, std::memory_order_release);
    }

    [[nodiscard]] std::uint64_t pushed() const noexcept { return pushed_; }
    [[nodiscard]] std::uint64_t epoch() const noexcept { return header_->epoch; }

  private:
    friend class TickRingReader<Record>;

    void attach() noexcept {
        header_ = memory_.header();
        slots_ = static_cast<TickRingSlot<Record>*>(memory_.slots());
        capacity_ = header_->capacity_records;
    }

    TickRingMemory memory_;
    TickRingHeader* header_ = nullptr;
    TickRingSlot<Record>* slots_ = nullptr;
    std::uint64_t capacity_ = 0;
    std::uint64_t pushed_ = 0;
};

/// Where a reader that opens a running ring begins.
enum class RingStart {
    oldest,  ///< the oldest record still there
    newest,  ///< the next record pushed
};

/// One reader's place in a ring. Every record pushed since its start is either delivered, in order, or counted lost.
template <class Record>
class TickRingReader {
  public:
    /// Throws std::runtime_error (see TickRingMemory::open_file).
    explicit TickRingReader(const std::filesystem::path& path, RingStart start = RingStart::oldest)
        : memory_(std::make_unique<TickRingMemory>(TickRingMemory::open_file(path, TickRingSlot<Record>::shape()))) {
        attach(*memory_, start);
    }

    /// A reader in the writer's process; it must not outlive the writer.
    explicit TickRingReader(const TickRingWriter<Record>& writer, RingStart start = RingStart::oldest) {
        attach(writer.memory_, start);
    }

    /// The next record; false when there is none yet. Never waits for the writer. Only ever from one thread.
    bool read(Record& into) noexcept {
        for (;;) {
            const std::uint64_t pushed = header_->pushed.load(std::memory_order_acquire);
            if (next_ >= pushed) {
                return false;
            }
            if (pushed - next_ > capacity_) {
                lost_ += pushed - capacity_ - next_;
                next_ = pushed - capacity_;
            }
            const TickRingSlot<Record>& slot = slots_[next_ % capacity_];
            const std::uint64_t whole = 2 * next_ + 2;
            const bool was_whole = slot.version.load(std::memory_order_acquire) == whole;
            if (was_whole) {
                slot.words.load(into);
            }
            ++next_;
            if (was_whole && slot.version.load(std::memory_order_relaxed) == whole) {
                return true;
            }
            ++lost_;
        }
    }

    [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
    [[nodiscard]] std::uint64_t epoch() const noexcept { return header_->epoch; }
    [[nodiscard]] std::int64_t period_ns() const noexcept { return header_->period_ns; }
    [[nodiscard]] std::uint64_t crane_hash() const noexcept { return header_->crane_hash; }

    /// The writer ended in order. What it pushed can still be read.
    [[nodiscard]] bool closed() const noexcept { return header_->closed.load(std::memory_order_acquire) != 0; }

    /// Another writer made a new ring of this name, or the name is gone: read what is left, then open anew.
    [[nodiscard]] bool replaced() const noexcept { return memory_ && !memory_->still_named(); }

  private:
    void attach(const TickRingMemory& memory, RingStart start) noexcept {
        header_ = memory.header();
        slots_ = static_cast<const TickRingSlot<Record>*>(memory.slots());
        capacity_ = header_->capacity_records;
        const std::uint64_t pushed = header_->pushed.load(std::memory_order_acquire);
        next_ = start == RingStart::newest ? pushed : (pushed > capacity_ ? pushed - capacity_ : 0);
    }

    std::unique_ptr<TickRingMemory> memory_;
    const TickRingHeader* header_ = nullptr;
    const TickRingSlot<Record>* slots_ = nullptr;
    std::uint64_t capacity_ = 0;
    std::uint64_t next_ = 0;
    std::uint64_t lost_ = 0;
};

}  // namespace steadyboom::runtime
