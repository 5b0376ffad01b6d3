#include "lancet/runtime/schedule/function_reference.hpp"

#include <memory>
#include <utility>

#include <gtest/gtest.h>

namespace lancet::runtime {
namespace {

int twice(int value) {
    return 2 * value;
}

struct Counter {
    int calls = 0;
    void operator()(int amount) { calls += amount; }
};

int call(FunctionReference<int(int)> function, int value) {
    return function(value);
}

TEST(FunctionReference, CallsLambdasFunctionsAndFunctionPointers) {
    const int offset = 5;
    EXPECT_EQ(call([&](int value) { return value + offset; }, 1), 6);
    EXPECT_EQ(call(twice, 4), 8);
    EXPECT_EQ(call(&twice, 5), 10);
}

TEST(FunctionReference, RefersToTheObjectInsteadOfCopyingIt) {
    Counter counter;
    const FunctionReference<void(int)> reference(counter);
    const auto copy = reference;
    reference(2);
    copy(3);
    EXPECT_EQ(counter.calls, 5);
}

TEST(FunctionReference, PassesReferencesAndMoveOnlyArguments) {
    int target = 0;
    const auto assign = [](int& place, std::unique_ptr<int> value) { place = *value; };
    const FunctionReference<void(int&, std::unique_ptr<int>)> reference(assign);
    reference(target, std::make_unique<int>(7));
    EXPECT_EQ(target, 7);
}

TEST(FunctionReference, IsTwoPointersAndTakesOnlyWhatFits) {
    static_assert(sizeof(FunctionReference<void(int)>) == 2 * sizeof(void*));
    static_assert(std::is_trivially_copyable_v<FunctionReference<void(int)>>);
    static_assert(!std::is_constructible_v<FunctionReference<void(int)>, decltype([] {})>);
    static_assert(!std::is_constructible_v<FunctionReference<int()>, decltype([] { return nullptr; })>);
}

}  // namespace
}  // namespace lancet::runtime
