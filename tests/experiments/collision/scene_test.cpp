// The scenes are what they say: so large, closed, not inverted, and in contact at their end.
#include "lancet/experiments/collision/scene.hpp"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::experiments::collision {
namespace {

TEST(CollisionScenes, AreAboutAsLargeAsAskedForAndClosed) {
    for (const std::string_view name : scene_names()) {
        for (const int primitives : {1000, 10000, 100000}) {
            const Scene scene = make_scene(name, primitives);
            // Whole numbers of cells, cubed.
            EXPECT_NEAR(std::log2(double(scene.primitives()) / primitives), 0, 0.8) << name;
            std::map<std::array<std::int32_t, 2>, int> sides;
            for (const mesh::Triangle& triangle : scene.body.surface) {
                for (std::size_t i = 0; i < 3; ++i) {
                    const std::int32_t a = triangle[i], b = triangle[(i + 1) % 3];
                    ASSERT_LT(static_cast<std::size_t>(a), scene.body.nodes);
                    sides[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
                }
            }
            for (const auto& [edge, sum] : sides) ASSERT_EQ(sum, 0) << name << ": an edge with one side";
        }
    }
}

TEST(CollisionScenes, KeepTheVolumeOfEveryElementPositive) {
    for (const std::string_view name : {"bodies", "folded"}) {
        const Scene scene = make_scene(name, 3000);
        std::vector<Point> positions(scene.body.nodes);
        for (const double time : {0.0, 0.5, 0.95}) {
            scene.body.place(time, positions);
            for (const mesh::Tetrahedron& t : scene.body.tetrahedra) {
                EXPECT_GT(mesh::signed_volume(positions[t[0]], positions[t[1]], positions[t[2]], positions[t[3]]), 0);
            }
        }
    }
}

TEST(CollisionScenes, OfOtherNamesAreRefused) {
    EXPECT_THROW(static_cast<void>(make_scene("cloth", 100)), Error);
}

}  // namespace
}  // namespace lancet::experiments::collision
