#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "lancet/experiments/common/renderer.hpp"
#include "lancet/experiments/pipeline/world.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::pipeline {
namespace {

TEST(Renderer, ShowsWhatIsThereAndOnlyThat) {
    Renderer renderer(41, 41);
    const std::vector<Point> positions{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {NAN, 0, 0}};
    const std::vector<mesh::Triangle> triangles{{0, 1, 2}, {0, 1, 3}};
    const PictureSurface red{.positions = positions, .triangles = triangles, .colour = {1, 0, 0}};
    const auto pixel = [](const Picture& picture, int x, int y) {
        const auto at = static_cast<std::size_t>(3 * (y * picture.width + x));
        return std::vector<int>{picture.pixels[at], picture.pixels[at + 1], picture.pixels[at + 2]};
    };
    const Picture empty = renderer.draw({}, {}, {});
    const Picture drawn = renderer.draw({}, std::span(&red, 1), {});
    EXPECT_EQ(pixel(drawn, 0, 0), pixel(empty, 0, 0));
    EXPECT_GT(pixel(drawn, 20, 20)[0], 2 * pixel(drawn, 20, 20)[1]);
    // A rod before it hides it; one behind it does not.
    const PictureRod before{.start = {0, 0, 1}, .end = {0, 0.1, 1}, .radius = 0.2, .colour = {0, 0, 1}};
    const PictureRod behind{.start = {0, 0, -1}, .end = {0, 0.1, -1}, .radius = 0.2, .colour = {0, 0, 1}};
    const Picture with_rod = renderer.draw({}, std::span(&red, 1), std::span(&before, 1));
    EXPECT_GT(pixel(with_rod, 20, 20)[2], pixel(with_rod, 20, 20)[0]);
    EXPECT_EQ(pixel(renderer.draw({}, std::span(&red, 1), std::span(&behind, 1)), 20, 20), pixel(drawn, 20, 20));
    EXPECT_THROW((void)renderer.draw({.eye = {0, 0, 0}, .target = {0, 0, 0}}, {}, {}), Error);
    EXPECT_THROW((void)renderer.draw({.up = {0, 0, 1}}, {}, {}), Error);
    const std::vector<mesh::Triangle> wrong{{0, 1, 4}};
    const PictureSurface bad{.positions = positions, .triangles = wrong};
    EXPECT_THROW((void)renderer.draw({}, std::span(&bad, 1), {}), Error);
    EXPECT_THROW(Renderer(0, 10), Error);
}

TEST(World, TheHandPokesGrabsAndCuts) {
    const auto scheduler = runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
    PipelineSettings settings;
    settings.scene = "organ";
    settings.seconds = 8;
    World world = make_world(settings, *scheduler);
    const runtime::ToolPath path = built_in_path(world, settings);
    EXPECT_NO_THROW(runtime::require_valid(path));
    for (const auto action : {runtime::ToolAction::touch, runtime::ToolAction::grab, runtime::ToolAction::cut}) {
        EXPECT_TRUE(std::ranges::any_of(path, [&](const auto& sample) { return sample.action == action; }));
    }
    world.simulation->play(world.tool, path);
    bool has_pulled = false, has_pushed = false;
    for (int step = 0; step < 1600; ++step) {
        world.simulation->step();
        for (const auto& anchor : world.simulation->latest_forces(world.tool)->anchors) {
            (anchor.spring.is_contact() ? has_pushed : has_pulled) = true;
        }
    }
    EXPECT_TRUE(has_pushed);
    EXPECT_TRUE(has_pulled);
    EXPECT_GT(world.simulation->cut_statistics().elements, 0);
    EXPECT_EQ(world.simulation->body(world.body).lost_steps(), 0);
}

}  // namespace
}  // namespace lancet::experiments::pipeline
