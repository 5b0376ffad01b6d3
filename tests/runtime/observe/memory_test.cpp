#include "lancet/runtime/observe/memory.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace lancet::runtime {
namespace {

constexpr std::size_t megabyte = 1024 * 1024;

TEST(ResidentMemory, SeesWhatIsTouchedAndKeepsThePeak) {
    const ResidentMemory before = resident_memory();
    EXPECT_GT(before.current, megabyte / 2);
    EXPECT_GE(before.peak, before.current);
    {
        const std::vector<char> touched(200 * megabyte, 1);
        EXPECT_GE(resident_memory().current, before.current + 190 * megabyte);
        EXPECT_EQ(touched.back(), 1);
    }
    const ResidentMemory after = resident_memory();
    EXPECT_GE(after.peak, before.current + 190 * megabyte);
    EXPECT_LE(after.current, after.peak);
}

}  // namespace
}  // namespace lancet::runtime
