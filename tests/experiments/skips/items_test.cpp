#include "lancet/experiments/skips/items.hpp"

#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "lancet/experiments/skips/measure.hpp"

namespace lancet::experiments::skips {
namespace {

const Item& item(const std::vector<Item>& items, const std::string& part) {
    for (const Item& candidate : items) {
        if (candidate.name.find(part) != std::string::npos) return candidate;
    }
    throw std::runtime_error("no item with '" + part + "'");
}

TEST(Items, WhatIsOnlyLeftOutChangesNoBit) {
    const auto items = all_items(true);
    for (const std::string part : {"no cut", "no collider", "no observer", "frames at", "collision at"}) {
        const Gain gain = measure(item(items, part), 3, 1);
        EXPECT_TRUE(gain.same_bits) << part;
        EXPECT_EQ(gain.error_percent, 0) << part;
    }
}

// What is approximated differs, but by less than the step of 40 ms itself is wrong on the Bar: 3.3 % of the length
// against short steps (README).
TEST(Items, WhatIsApproximatedStaysClose) {
    const auto items = all_items(true);
    for (const std::string part : {"fixed nodes", "linear material", "every 5th", "rotations only", "coarse space",
                                   "tolerance", "after a cut"}) {
        const Gain gain = measure(item(items, part), 20, 1);
        EXPECT_FALSE(gain.same_bits) << part;
        EXPECT_LT(gain.error_percent, 3.3) << part;
    }
}

TEST(Items, SleepersStayWhereTheyFellAsleep) {
    const auto items = all_items(true);
    const Item& sleep = item(items, "sleep");
    const auto with = sleep.with(), without = sleep.without();
    const auto at_first = with->positions();
    for (int step = 0; step < 5; ++step) {
        with->advance();
        without->advance();
    }
    const auto later = with->positions(), awake = without->positions();
    ASSERT_EQ(later.size(), awake.size());
    const std::size_t swinging = bar(true).mesh.nodes().size(), sleeping = later.size() - swinging;
    for (std::size_t node = 0; node < sleeping; ++node) {
        ASSERT_EQ(later[node], at_first[node]);
        // 1e-3 m/s at most when it fell asleep, and damped since.
        for (std::size_t axis = 0; axis < 3; ++axis) ASSERT_NEAR(later[node][axis], awake[node][axis], 1e-3);
    }
    bool has_moved = false;
    for (std::size_t node = sleeping; node < later.size(); ++node) {
        has_moved = has_moved || later[node] != at_first[node];
        ASSERT_EQ(later[node], awake[node]);
    }
    EXPECT_TRUE(has_moved);
}

TEST(Items, ABodyThatCannotBeCutKeepsLess) {
    const auto items = all_items(true);
    const Item& cut = item(items, "no cut");
    const auto with = cut.with(), without = cut.without();
    ASSERT_TRUE(with->bytes() && without->bytes());
    EXPECT_GT(*with->bytes(), 0);
    EXPECT_LT(*with->bytes(), *without->bytes());
}

TEST(Items, HaveNamesOfTheirOwn) {
    std::set<std::string> names;
    for (const Item& each : all_items(false)) {
        EXPECT_TRUE(names.insert(each.name).second) << each.name;
        EXPECT_FALSE(each.toggle.empty());
        EXPECT_FALSE(each.scene.empty());
    }
    EXPECT_EQ(names.size(), 15U);
    EXPECT_FALSE(remarks().empty());
}

}  // namespace
}  // namespace lancet::experiments::skips
