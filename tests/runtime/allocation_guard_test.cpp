#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <optional>
#include <thread>
#include <vector>

#include <Eigen/Core>

#include "runtime/realtime_section.hpp"

namespace steadyboom::runtime {
namespace {

// Keeps the compiler from proving an allocation unneeded.
template <class T>
void keep(T* pointer) {
    asm volatile("" : : "g"(pointer) : "memory");
}

TEST(AllocationGuardDeathTest, MallocInsideASectionAborts) {
    EXPECT_DEATH(
        {
            const RealtimeSection section;
            keep(std::malloc(16));
        },
        "allocation guard: .* inside a RealtimeSection");
}

TEST(AllocationGuardDeathTest, NewInsideASectionAborts) {
    EXPECT_DEATH(
        {
            const RealtimeSection section;
            keep(new double(1.0));
        },
        "allocation guard: .* inside a RealtimeSection");
}

TEST(AllocationGuardDeathTest, AlignedNewInsideASectionAborts) {
    EXPECT_DEATH(
        {
            const RealtimeSection section;
            keep(::operator new(64, std::align_val_t(64)));
        },
        "allocation guard: .* inside a RealtimeSection");
}

TEST(AllocationGuardDeathTest, VectorGrowthInsideASectionAborts) {
    std::vector<int> numbers;
    EXPECT_DEATH(
        {
            const RealtimeSection section;
            numbers.push_back(1);
            keep(numbers.data());
        },
        "allocation guard: .* inside a RealtimeSection");
}

TEST(AllocationGuardDeathTest, DynamicEigenMatrixInsideASectionAborts) {
    EXPECT_DEATH(
        {
            const RealtimeSection section;
            const Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(4, 4);
            keep(matrix.data());
        },
        "allocation guard: .* inside a RealtimeSection");
}

TEST(AllocationGuardDeathTest, FreeInsideASectionAborts) {
    void* const memory = std::malloc(16);
    keep(memory);
    EXPECT_DEATH(
        {
            const RealtimeSection section;
            std::free(memory);
        },
        "allocation guard: free inside a RealtimeSection");
    std::free(memory);
}

TEST(AllocationGuardDeathTest, InnerSectionsEndLeavesTheOuterOneGuarded) {
    EXPECT_DEATH(
        {
            const RealtimeSection outer;
            { const RealtimeSection inner; }
            keep(std::malloc(16));
        },
        "allocation guard: .* inside a RealtimeSection");
}

TEST(AllocationGuard, AllocationOutsideSectionsIsFree) {
    { const RealtimeSection section; }
    std::vector<int> numbers;
    numbers.push_back(1);
    keep(numbers.data());
    void* memory = std::realloc(std::malloc(16), 64);
    keep(memory);
    std::free(memory);
    keep(static_cast<double*>(memory = std::calloc(4, 8)));
    std::free(memory);
    ASSERT_EQ(posix_memalign(&memory, 64, 128), 0);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory) % 64, 0U);
    std::free(memory);
    EXPECT_FALSE(in_realtime_section());
}

TEST(AllocationGuard, SectionBelongsToItsThreadAlone) {
    std::optional<bool> inside_elsewhere;
    std::atomic<bool> section_open{false};
    std::thread other([&] {
        while (!section_open.load()) {
            std::this_thread::yield();
        }
        inside_elsewhere = in_realtime_section();
        std::vector<int> numbers(100);
        keep(numbers.data());
        section_open = false;
    });
    {
        const RealtimeSection section;
        EXPECT_TRUE(in_realtime_section());
        section_open = true;
        while (section_open.load()) {
            std::this_thread::yield();
        }
    }
    other.join();
    EXPECT_EQ(inside_elsewhere, false);
}

TEST(AllocationGuard, FixedSizeEigenArithmeticPassesInsideASection) {
    const Eigen::Matrix<double, 7, 7> matrix = Eigen::Matrix<double, 7, 7>::Identity() * 2.0;
    Eigen::Matrix<double, 7, 1> product;
    {
        const RealtimeSection section;
        product = matrix * Eigen::Matrix<double, 7, 1>::Ones();
    }
    EXPECT_EQ(product.sum(), 14.0);
}

}  // namespace
}  // namespace steadyboom::runtime
