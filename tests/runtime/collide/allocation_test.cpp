// What is asked again and again allocates nothing once it has seen the same before.
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "tests/runtime/collide/contact_meshes.hpp"
#include <gtest/gtest.h>

#include "lancet/runtime/collide/response.hpp"

namespace {

constinit std::atomic<long> allocations{0};  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

}  // namespace

// Everything in these folders is in standard containers, whose memory is from here.
// Never inline: beside a new that is not inline either, the compiler takes the free for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t bytes) {
    ++allocations;
    if (void* memory = std::malloc(bytes > 0 ? bytes : 1)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace lancet::runtime {
namespace {

/// Calls visit(step) for a cycle of steps twice; expects no allocation in the second.
template <class Visit>
void expect_none_when_repeated(const std::string& what, const Visit& visit) {
    constexpr int steps = 6;
    for (int step = 0; step < steps; ++step) visit(step);
    const long before = allocations;
    for (int step = 0; step < steps; ++step) visit(step);
    EXPECT_EQ(allocations - before, 0) << what;
}

std::vector<Point> moved(const mesh::TetMesh& mesh, int step) {
    std::vector<Point> positions(mesh.nodes().begin(), mesh.nodes().end());
    for (Point& p : positions) {
        p[2] -= 0.01 * step;
        p[0] += 0.02 * std::sin(5 * p[1] + step);
    }
    return positions;
}

TEST(CollisionAllocation, IsCounted) {
    const long before = allocations;
    const std::vector<int> some(100, 1);
    EXPECT_EQ(allocations - before, 1);
}

TEST(CollisionAllocation, IsNoneInSteadyState) {
    const mesh::TetMesh below = mesh::box({.cells = {6, 6, 6}});
    const mesh::TetMesh above = mesh::box({.cells = {5, 5, 5}, .size = {0.7, 0.7, 0.7}, .origin = {0.1, 0.11, 0.97}});
    std::vector<std::vector<Point>> positions;
    for (int step = 0; step < 6; ++step) positions.push_back(moved(above, step));
    for (const SchedulerKind scheduler_kind : {SchedulerKind::serial, SchedulerKind::threads}) {
        const auto scheduler = make_scheduler(scheduler_kind, 2);
        for (const BroadPhaseKind kind : broad_phase_kinds()) {
            const std::string name = std::string(to_string(kind)) + ", " + std::string(to_string(scheduler_kind));
            CollidableBody lower = testing::collidable(below, kind), upper = testing::collidable(above, kind);
            std::vector<BoxPair> pairs;
            std::vector<std::int32_t> found;
            expect_none_when_repeated(name + ": boxes", [&](int step) {
                upper.update(positions[static_cast<std::size_t>(step)]);
                upper.tetrahedron_boxes().pairs(*scheduler, lower.node_boxes(), pairs);
                upper.tetrahedron_boxes().self_pairs(*scheduler, pairs);
                upper.surface_boxes().query({{0, 0, 0}, {1, 1, 1}}, found);
            });
            VertexContactFinder finder;
            std::vector<VertexContact> contacts;
            std::vector<Point> on_upper(upper.positions().size()), on_lower(lower.positions().size());
            std::vector<ContactHold> upper_holds, lower_holds;
            std::size_t most = 0;
            expect_none_when_repeated(name + ": bodies", [&](int step) {
                upper.update(positions[static_cast<std::size_t>(step)]);
                finder.find(*scheduler, upper, lower, contacts);
                add_penalty_forces(contacts, {}, lower.tetrahedra(), {}, {}, on_upper, on_lower);
                vertex_holds(contacts, lower.tetrahedra(), upper.positions(), lower.positions(), upper_holds,
                             lower_holds);
                most = std::max(most, contacts.size());
            });
            EXPECT_GT(most, 10U) << name;
            const ToolShape tool = ChainTool{{{0, 0, 0}, {0.2, 0, 0.1}, {0.3, 0.1, 0.4}}, 0.05};
            ToolMotion motion;
            ToolContactFinder tool_finder;
            std::vector<ToolContact> tool_contacts;
            most = 0;
            expect_none_when_repeated(name + ": tool", [&](int step) {
                motion.set(tool, {{0.3, 0.4, 1.1 - 0.02 * step}}, {{0.3, 0.4, 1.08 - 0.02 * step}});
                tool_finder.find(lower.surface_boxes(), lower.positions(), lower.surface(), motion, tool_contacts);
                add_penalty_forces(tool_contacts, {}, lower.surface(), {}, {}, on_lower);
                tool_holds(tool_contacts, lower.surface(), lower.positions(), lower_holds);
                most = std::max(most, tool_contacts.size());
            });
            EXPECT_GT(most, 0U) << name;
        }
    }
}

}  // namespace
}  // namespace lancet::runtime
