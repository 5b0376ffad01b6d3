// Counts what is allocated with operator new, ours and that of the standard library, on all threads. The runtimes of
// OpenMP and oneTBB have allocators of their own, which are not counted.
#include <atomic>
#include <cstdlib>
#include <new>
#include <vector>

#include "tests/runtime/schedule/schedulers_under_test.hpp"
#include <gtest/gtest.h>

#include "lancet/runtime/schedule/ordered_sum.hpp"
#include "lancet/runtime/schedule/step_graph.hpp"

namespace {

std::atomic<long>& allocation_count() {
    static std::atomic<long> count{0};
    return count;
}

// NOLINTBEGIN(cppcoreguidelines-no-malloc, cppcoreguidelines-owning-memory): this is where memory comes from

void* counted(std::size_t bytes, std::size_t alignment) {
    ++allocation_count();
    void* const memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

// Never inline: beside a new that is not inline either, the compiler takes the free for a mismatch.
[[gnu::noinline]] void released(void* memory) noexcept {
    std::free(memory);
}

}  // namespace

void* operator new(std::size_t bytes) {
    return counted(bytes, alignof(std::max_align_t));
}
void* operator new[](std::size_t bytes) {
    return counted(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    return counted(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
    return counted(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    released(memory);
}
void operator delete[](void* memory) noexcept {
    released(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    released(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    released(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    released(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
    released(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    released(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
    released(memory);
}
// NOLINTEND(cppcoreguidelines-no-malloc, cppcoreguidelines-owning-memory)

namespace lancet::runtime {
namespace {

class Allocation : public ::testing::TestWithParam<testing::SchedulerChoice> {};
INSTANTIATE_TEST_SUITE_P(Schedulers, Allocation, ::testing::ValuesIn(testing::schedulers_under_test()),
                         testing::SchedulerName());

template <class Function>
long allocations_in(const Function& function) {
    const long before = allocation_count();
    function();
    return allocation_count() - before;
}

TEST(AllocationCount, SeesAnAllocation) {
    EXPECT_GE(allocations_in([] { const std::vector<int> some(100, 1); }), 1);
}

TEST_P(Allocation, LoopsAndSumsAllocateNothing) {
    const auto scheduler = GetParam().make();
    std::vector<double> partials(64);
    std::atomic<long> calls{0};
    const auto run = [&] {
        for (int repetition = 0; repetition < 100; ++repetition) {
            scheduler->for_each_block(64, [&](int) { ++calls; });
            ordered_sum(*scheduler, std::span<double>(partials), [](int block) { return block * 0.5; });
        }
    };
    run();
    EXPECT_EQ(allocations_in(run), 0);
    EXPECT_EQ(calls, 2 * 100 * 64);
}

TEST_P(Allocation, RunningAGraphAgainAllocatesNothing) {
    const auto scheduler = GetParam().make();
    std::atomic<long> calls{0};
    StepGraph graph;
    auto first = graph.task("first", [&] { scheduler->for_each_block(32, [&](int) { ++calls; }); });
    auto left = graph.task("left", [&] { scheduler->for_each_block(32, [&](int) { ++calls; }); });
    auto right = graph.task("right", [&] { ++calls; });
    auto last = graph.task("last", [&] { ++calls; });
    first.precede(left, right);
    left.precede(last);
    right.precede(last);
    graph.run(*scheduler);
    const long allocations = allocations_in([&] {
        for (int repetition = 0; repetition < 100; ++repetition) graph.run(*scheduler);
    });
    // oneTBB takes a little from operator new when a worker comes for the first time; one per run would be ours.
    EXPECT_LE(allocations, GetParam().kind == SchedulerKind::tbb ? 20 : 0);
    EXPECT_EQ(calls, 101 * 66);
}

}  // namespace
}  // namespace lancet::runtime
