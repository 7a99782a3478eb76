#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace steadyboom::runtime {

/// Plain bytes of a Record as atomic 64-bit words, so that a copy torn by a concurrent writer is no data race. The
/// words are stored with release and loaded with acquire order: a reader that saw any new word also sees the version
/// its writer set before it, without a stand-alone fence. Valid in memory shared between processes.
template <class Record>
class AtomicWords {
    static_assert(std::is_trivially_copyable_v<Record>);
    static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

  public:
    void store(const Record& record) noexcept {
        std::array<std::uint64_t, word_count> plain{};
        std::memcpy(plain.data(), &record, sizeof(Record));
        for (std::size_t i = 0; i < word_count; ++i) {
            words_[i].store(plain[i], std::memory_order_release);
        }
    }

    void load(Record& record) const noexcept {
        std::array<std::uint64_t, word_count> plain;
        for (std::size_t i = 0; i < word_count; ++i) {
            plain[i] = words_[i].load(std::memory_order_acquire);
        }
        std::memcpy(static_cast<void*>(&record), plain.data(), sizeof(Record));
    }

  private:
    static constexpr std::size_t word_count = (sizeof(Record) + 7) / 8;
    std::array<std::atomic<std::uint64_t>, word_count> words_{};
};

/// The newest value of a Record: one writer that never waits, any number of readers that retry while it writes.
template <class Record>
class Seqlock {
  public:
    Seqlock() noexcept { words_.store(Record{}); }
    explicit Seqlock(const Record& record) noexcept { words_.store(record); }

    /// Only ever from one thread.
    void store(const Record& record) noexcept {
        const std::uint64_t version = version_.load(std::memory_order_relaxed);
        version_.store(version + 1, std::memory_order_relaxed);
        words_.store(record);
        version_.store(version + 2, std::memory_order_release);
    }

    [[nodiscard]] Record load() const noexcept {
        Record record;
        for (;;) {
            const std::uint64_t before = version_.load(std::memory_order_acquire);
            words_.load(record);
            if (before % 2 == 0 && version_.load(std::memory_order_relaxed) == before) {
                return record;
            }
        }
    }

  private:
    std::atomic<std::uint64_t> version_{0};
    AtomicWords<Record> words_;
};

}  // namespace steadyboom::runtime
