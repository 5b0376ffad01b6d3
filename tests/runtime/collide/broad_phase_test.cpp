// Every kind of broad phase finds exactly the pairs of boxes that touch, whatever the boxes.
#include "lancet/runtime/collide/broad_phase.hpp"

#include <random>
#include <string>
#include <vector>

#include "tests/runtime/schedule/schedulers_under_test.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

using Boxes = std::vector<Box>;

/// Boxes of random places in [-1, 1]^3 * spread + shift, with sides from 10^smallest to 10^largest.
Boxes random_boxes(unsigned seed, int count, double spread, double smallest, double largest, double shift = 0) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(-spread, spread), exponent(smallest, largest);
    Boxes boxes;
    for (int i = 0; i < count; ++i) {
        Box box;
        const double side = std::pow(10.0, exponent(random));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.lower[axis] = place(random) + shift;
            box.upper[axis] = box.lower[axis] + side * (1 + place(random) / (2 * spread));
        }
        boxes.push_back(box);
    }
    return boxes;
}

/// Some hundred of boxes around each of a few places.
Boxes clustered(unsigned seed) {
    Boxes all;
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(-100, 100);
    for (unsigned cluster = 0; cluster < 5; ++cluster) {
        Boxes some = random_boxes(seed + cluster, 100, 0.1, -2.5, -1);
        const Point at{place(random), place(random), place(random)};
        for (Box& box : some) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                box.lower[axis] += at[axis];
                box.upper[axis] += at[axis];
            }
        }
        all.insert(all.end(), some.begin(), some.end());
    }
    return all;
}

/// Unit cubes side by side: every contact is of faces, edges and corners alone.
Boxes grid(int cells, double size, const Point& origin) {
    Boxes boxes;
    for (int x = 0; x < cells; ++x) {
        for (int y = 0; y < cells; ++y) {
            for (int z = 0; z < cells; ++z) {
                Box box;
                const std::array at{x, y, z};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    box.lower[axis] = origin[axis] + size * at[axis];
                    box.upper[axis] = origin[axis] + size * (at[axis] + 1);
                }
                boxes.push_back(box);
            }
        }
    }
    return boxes;
}

Boxes hostile() {
    Boxes boxes = random_boxes(7, 60, 1, -2, 0);
    boxes.push_back({{not_a_number, 0, 0}, {1, 1, 1}});
    boxes.push_back({{0, 0, 0}, {1, not_a_number, 1}});
    boxes.push_back({{not_a_number, not_a_number, not_a_number}, {not_a_number, not_a_number, not_a_number}});
    boxes.push_back({{0.5, 0, 0}, {-0.5, 1, 1}});  // inverted
    boxes.push_back({{1, 1, 1}, {-1, -1, -1}});
    boxes.push_back({{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}});
    boxes.push_back({{0, 0, 0}, {infinity, 1, 1}});
    boxes.push_back({{-1e200, -1, -1}, {1, 1, 1}});
    boxes.push_back({{-1e150, -1e150, -1e150}, {1e150, 1e150, 1e150}});  // valid: touches all that are
    boxes.push_back({{0, 0, 0}, {0, 0, 0}});
    boxes.push_back({{-1e-310, 0, 0}, {-1e-320, 0, 0}});
    boxes.push_back({{1e-310, 0, 0}, {1e-300, 0, 0}});
    boxes.push_back({{-5e-324, 0, 0}, {-5e-324, 0, 0}});
    return boxes;
}

struct Sample {
    std::string name;
    Boxes boxes;
};

std::vector<Sample> samples() {
    std::vector<Sample> all;
    all.push_back({"none", {}});
    all.push_back({"one", random_boxes(1, 1, 1, -1, 0)});
    for (const int count : {2, 3, 4, 5, 8, 9, 17}) {
        all.push_back({"few_" + std::to_string(count), random_boxes(2, count, 1, -1, 0)});
    }
    all.push_back({"random", random_boxes(3, 1000, 1, -1.5, -0.8)});
    all.push_back({"thin", random_boxes(4, 1000, 1, -6, -5)});
    all.push_back({"ratios_of_1e12", random_boxes(5, 600, 1, -11, 1)});
    all.push_back({"clustered", clustered(6)});
    all.push_back({"side_by_side", grid(8, 1, {0, 0, 0})});
    all.push_back({"side_by_side_away", grid(7, 0.125, {1e8, -1e8, 1e8})});
    all.push_back({"random_away", random_boxes(8, 500, 1, -2, -0.5, 1e8)});
    // Units in the last place are 1.5e-8 m here: most of these boxes are points.
    all.push_back({"below_rounding", random_boxes(9, 400, 1e-6, -10, -7, 1e8)});
    all.push_back({"tiny", random_boxes(10, 300, 1e-120, -121, -120)});
    all.push_back({"enormous", random_boxes(11, 300, 1e140, 138, 140)});
    all.push_back({"all_the_same", Boxes(300, Box{{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}})});
    all.push_back({"all_one_point", Boxes(300, Box{{0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}})});
    Boxes points = random_boxes(12, 400, 1, -1, 0);
    for (Box& box : points) box.upper = box.lower;
    points.insert(points.end(), points.begin(), points.begin() + 50);
    all.push_back({"points", points});
    Boxes flat = random_boxes(13, 400, 1, -1, -0.5);
    for (Box& box : flat) box.lower[1] = box.upper[1] = 0.25;
    all.push_back({"in_a_plane", flat});
    Boxes with_large = random_boxes(14, 500, 1, -2, -1.5);
    with_large.push_back({{-1e6, -1e6, -1e6}, {1e6, 1e6, 1e6}});
    all.push_back({"one_large", with_large});
    all.push_back({"hostile", hostile()});
    all.push_back({"none_valid", Boxes(20, Box{{1, 1, 1}, {0, not_a_number, 0}})});
    return all;
}

std::vector<BoxPair> pairs_by_definition(const Boxes& own, const Boxes& others) {
    std::vector<BoxPair> pairs;
    for (std::size_t j = 0; j < others.size(); ++j) {
        for (std::size_t i = 0; i < own.size(); ++i) {
            if (touch(valid_or_empty(own[i]), valid_or_empty(others[j]))) {
                pairs.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)});
            }
        }
    }
    return pairs;
}

std::vector<BoxPair> self_pairs_by_definition(const Boxes& own) {
    std::vector<BoxPair> pairs;
    for (std::size_t i = 0; i < own.size(); ++i) {
        for (std::size_t j = i + 1; j < own.size(); ++j) {
            if (touch(valid_or_empty(own[i]), valid_or_empty(own[j]))) {
                pairs.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)});
            }
        }
    }
    return pairs;
}

class BroadPhases : public ::testing::TestWithParam<BroadPhaseKind> {
  protected:
    void expect_exact(BroadPhase& phase, const Boxes& own, const Boxes& others, const std::string& what) {
        std::vector<BoxPair> found{{-1, -1}};
        phase.pairs(*serial_, others, found);
        EXPECT_TRUE(found == pairs_by_definition(own, others)) << what << ": " << found.size() << " pairs";
        phase.self_pairs(*serial_, found);
        EXPECT_TRUE(found == self_pairs_by_definition(own)) << what << ": " << found.size() << " pairs of its own";
        std::vector<std::int32_t> numbers{-1};
        for (std::size_t j = 0; j < std::min<std::size_t>(others.size(), 20); ++j) {
            phase.query(others[j], numbers);
            std::vector<std::int32_t> expected;
            for (const BoxPair& pair : pairs_by_definition(own, {others[j]})) expected.push_back(pair.first);
            EXPECT_EQ(numbers, expected) << what << ", query " << j;
        }
    }

    std::unique_ptr<Scheduler> serial_ = make_scheduler(SchedulerKind::serial, 1);
};
INSTANTIATE_TEST_SUITE_P(Kinds, BroadPhases,
                         ::testing::ValuesIn(broad_phase_kinds().begin(), broad_phase_kinds().end()),
                         [](const auto& instance) {
                             std::string name(to_string(instance.param));
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

TEST_P(BroadPhases, FindExactlyTheBoxesThatTouch) {
    const auto phase = make_broad_phase(GetParam());
    EXPECT_EQ(phase->kind(), GetParam());
    std::vector<BoxPair> none;
    phase->self_pairs(*serial_, none);  // nothing was built
    EXPECT_TRUE(none.empty());
    const auto all = samples();
    for (const Sample& own : all) {
        phase->build(own.boxes);
        EXPECT_EQ(phase->size(), own.boxes.size());
        for (const Sample& others : all) {
            // Each against itself and against what is elsewhere in size and kind.
            if (&own != &others && others.name != "hostile" && others.name != "one_large" && others.name != "thin") {
                continue;
            }
            expect_exact(*phase, own.boxes, others.boxes, own.name + " and " + others.name);
        }
    }
}

TEST_P(BroadPhases, StayExactWhileBoxesMove) {
    const auto phase = make_broad_phase(GetParam());
    std::mt19937_64 random(21);
    for (const double speed : {1e-3, 0.05, 2.0}) {
        Boxes boxes = random_boxes(22, 700, 1, -1.5, -0.8);
        phase->build(boxes);
        std::normal_distribution<double> move(0, speed);
        for (int step = 0; step < 8; ++step) {
            for (Box& box : boxes) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const double by = move(random);
                    box.lower[axis] += by;
                    box.upper[axis] += by;
                }
            }
            phase->refit(boxes);
            expect_exact(*phase, boxes, boxes, "speed " + std::to_string(speed) + ", step " + std::to_string(step));
        }
    }
}

TEST_P(BroadPhases, StayExactWhereBoxesBecomeInvalidAndComeBack) {
    const auto phase = make_broad_phase(GetParam());
    const Boxes good = random_boxes(31, 300, 1, -1.5, -0.5);
    Boxes bad = good;
    for (std::size_t i = 0; i < bad.size(); i += 3) bad[i].lower[i % 2] = not_a_number;
    const Boxes none(good.size(), Box{{1, 1, 1}, {0, 0, 0}});
    const Boxes away = random_boxes(32, 300, 1, -1.5, -0.5, 1e8);
    phase->build(bad);
    for (const Boxes* boxes :
         std::initializer_list<const Boxes*>{&good, &bad, &none, &good, &none, &away, &bad, &away, &good}) {
        phase->refit(*boxes);
        expect_exact(*phase, *boxes, good, "refit");
    }
}

TEST_P(BroadPhases, RefuseARefitOfAnotherNumber) {
    const auto phase = make_broad_phase(GetParam());
    phase->build(random_boxes(1, 10, 1, -1, 0));
    try {
        phase->refit(random_boxes(1, 11, 1, -1, 0));
        FAIL() << "expected an error";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("11 boxes; expected 10"));
    }
}

TEST_P(BroadPhases, AgreeBitForBitOnAllSchedulers) {
    const Boxes own = random_boxes(41, 3000, 1, -1.6, -0.9), others = random_boxes(42, 2000, 1, -1.6, -0.9);
    const auto phase = make_broad_phase(GetParam());
    phase->build(own);
    std::vector<BoxPair> expected, expected_self, found;
    phase->pairs(*serial_, others, expected);
    phase->self_pairs(*serial_, expected_self);
    EXPECT_GT(expected.size(), 1000U);
    for (const testing::SchedulerChoice& choice : testing::schedulers_under_test()) {
        const auto scheduler = choice.make();
        phase->pairs(*scheduler, others, found);
        EXPECT_TRUE(found == expected) << choice.name();
        phase->self_pairs(*scheduler, found);
        EXPECT_TRUE(found == expected_self) << choice.name();
    }
}

/// Rows of boxes that change places: a tree that kept them together would be no better than brute force.
TEST(BroadPhaseTrees, AreBuiltAnewWhenTheyHaveDegraded) {
    for (const BroadPhaseKind kind : {BroadPhaseKind::aabb_tree, BroadPhaseKind::sphere_tree, BroadPhaseKind::octree}) {
        const auto phase = make_broad_phase(kind);
        Boxes boxes = random_boxes(51, 2000, 1, -2, -1.9);
        phase->build(boxes);
        // What only moves, turns by right angles, or grows with everything else stays as good as it was.
        Boxes moved = boxes;
        for (Box& box : moved)
            box = {{box.lower[1], box.lower[2], box.lower[0]}, {box.upper[1], box.upper[2], box.upper[0]}};
        phase->refit(boxes);
        EXPECT_EQ(phase->rebuilds(), 0) << to_string(kind);
        if (kind != BroadPhaseKind::octree) {
            phase->refit(moved);
            EXPECT_EQ(phase->rebuilds(), 0) << to_string(kind);
        }
        std::shuffle(boxes.begin(), boxes.end(), std::mt19937_64(1));
        const auto before = phase->rebuilds();
        phase->refit(boxes);
        EXPECT_EQ(phase->rebuilds(), before + 1) << to_string(kind);
    }
}

TEST(BroadPhaseKind, NamesAreReadBack) {
    for (const BroadPhaseKind kind : broad_phase_kinds()) EXPECT_EQ(broad_phase_from_string(to_string(kind)), kind);
    try {
        static_cast<void>(broad_phase_from_string("bsp"));
        FAIL() << "expected an error";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("'bsp'; expected one of: aabb-tree, sphere-tree, spatial-hash"));
    }
}

TEST(Box, AroundPointsThatAreNotNumbersIsEmpty) {
    const std::vector<Point> points{{0, 0, 0}, {1, not_a_number, 1}}, good{{0, 2, 0}, {1, -1, 1}};
    EXPECT_FALSE(is_valid(box_around(points)));
    EXPECT_EQ(box_around(good, 0.5), (Box{{-0.5, -1.5, -0.5}, {1.5, 2.5, 1.5}}));
    EXPECT_FALSE(is_valid(box_around({})));
}

}  // namespace
}  // namespace lancet::runtime
