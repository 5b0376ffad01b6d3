#include "lancet/experiments/collision/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "lancet/experiments/common/organ_mesh.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::experiments::collision {
namespace {

constexpr std::array<std::string_view, 3> names{"organ", "bodies", "folded"};

/// A triangle surface with points of its own.
struct Surface {
    std::vector<Point> points;
    std::vector<mesh::Triangle> triangles;
};

/// The boundary of a mesh, its nodes numbered anew.
Surface surface_of(const mesh::TetMesh& mesh) {
    Surface surface;
    surface.triangles = mesh::boundary(mesh).triangles;
    std::vector<std::int32_t> number(mesh.nodes().size(), -1);
    for (mesh::Triangle& triangle : surface.triangles) {
        for (std::int32_t& node : triangle) {
            if (number[node] < 0) {
                number[node] = static_cast<std::int32_t>(surface.points.size());
                surface.points.push_back(mesh.nodes()[node]);
            }
            node = number[node];
        }
    }
    return surface;
}

/// Every triangle in four, by the middles of its edges.
Surface refine(const Surface& coarse) {
    Surface fine{coarse.points, {}};
    std::map<std::array<std::int32_t, 2>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
        const auto [found, is_new] = middles.try_emplace({std::min(a, b), std::max(a, b)}, fine.points.size());
        if (is_new) fine.points.push_back(runtime::Segment{coarse.points[a], coarse.points[b]}.at(0.5));
        return found->second;
    };
    for (const auto& [a, b, c] : coarse.triangles) {
        const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        for (const mesh::Triangle& part : {mesh::Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
            fine.triangles.push_back(part);
        }
    }
    return fine;
}

/// The organ's surface of about so many triangles: 12 n m of n rings and m layers, and its ends, four times as many for
/// each refinement.
Surface organ_surface(int triangles) {
    int refinements = 0, coarse = triangles;
    for (; coarse > 8000; coarse /= 4) ++refinements;
    const int rings = std::max(2, static_cast<int>(std::lround(std::sqrt(coarse / 40.0))));
    const int layers = std::max(2, static_cast<int>(std::lround(coarse / (12.0 * rings) - rings)));
    Surface surface = surface_of(organ_mesh(rings, layers));
    for (; refinements > 0; --refinements) surface = refine(surface);
    return surface;
}

Scene organ_scene(int primitives) {
    Surface surface = organ_surface(primitives);
    const auto rest = std::make_shared<const std::vector<Point>>(std::move(surface.points));
    Scene scene{.name = "organ", .title = "A bent probe on the surface of an organ", .body = {.place = {}}};
    scene.body.nodes = rest->size();
    scene.body.surface = std::move(surface.triangles);
    scene.body.place = [rest](double time, std::span<Point> positions) {
        for (std::size_t i = 0; i < rest->size(); ++i) {
            const Point& p = (*rest)[i];
            // A wave of 3 % that runs along it, and a bend.
            const double wave = 1 + 0.03 * std::sin(60 * p[0] - 4 * std::numbers::pi * time);
            positions[i] = {p[0], p[1] * wave, p[2] * wave + time * p[0] * p[0]};
        }
    };
    scene.tool = runtime::ChainTool{{{0, 0, 0}, {0.03, 0, 0.005}, {0.05, 0.01, 0.03}, {0.05, 0.02, 0.1}}, 0.004};
    scene.tool_pose = [](double time) {
        return runtime::Pose{{-0.06 + 0.08 * time, -0.005, 0.036 - 0.006 * std::sin(std::numbers::pi * time)}};
    };
    return scene;
}

/// Nodes that are moved a little apart from where they are, the same way every time: no block is quite regular.
double shake(const Point& p, double time, double size) {
    return size * std::sin(90 * p[0] + 70 * p[1] + 110 * p[2] + 2 * std::numbers::pi * time);
}

MovingBody block(const mesh::Box& box, const Point& way, double shaking) {
    const auto mesh = std::make_shared<const mesh::TetMesh>(mesh::box(box));
    MovingBody body{.nodes = mesh->nodes().size(), .place = {}};
    body.tetrahedra.assign(mesh->tetrahedra().begin(), mesh->tetrahedra().end());
    body.surface = mesh::boundary(*mesh).triangles;
    body.place = [mesh, way, shaking](double time, std::span<Point> positions) {
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const Point& p = mesh->nodes()[i];
            positions[i] = runtime::add_scaled(p, time, way);
            positions[i][2] += shake(p, time, shaking);
        }
    };
    return body;
}

Scene bodies_scene(int primitives) {
    // Five tetrahedra a cell in each of both.
    const int cells = std::max(2, static_cast<int>(std::lround(std::cbrt(primitives / 5.0))));
    const double cell = 0.1 / cells;
    Scene scene{.name = "bodies", .title = "A block that sinks into another", .body = {.place = {}}};
    scene.body = block({.cells = {cells, cells, cells}, .size = {0.1, 0.1, 0.1}}, {0, 0, 0}, 0.1 * cell);
    scene.other = block({.cells = {cells, cells, cells}, .size = {0.09, 0.09, 0.09}, .origin = {0.013, 0.011, 0.1}},
                        {0.002, 0.003, -0.01}, 0.1 * cell);
    return scene;
}

Scene folded_scene(int primitives) {
    // A bar of 8 k x k x k cells: its ends come to lie on each other.
    const int k = std::max(2, static_cast<int>(std::lround(std::cbrt(primitives / 40.0))));
    constexpr double length = 0.4, thickness = 0.05;
    const auto mesh = std::make_shared<const mesh::TetMesh>(
        mesh::box({.cells = {8 * k, k, k}, .size = {length, thickness, thickness}}));
    Scene scene{.name = "folded", .title = "A bar that is folded onto itself", .body = {.place = {}}};
    MovingBody& body = scene.body;
    body.nodes = mesh->nodes().size();
    body.tetrahedra.assign(mesh->tetrahedra().begin(), mesh->tetrahedra().end());
    body.surface = mesh::boundary(*mesh).triangles;
    body.place = [mesh](double time, std::span<Point> positions) {
        // Bent by 0.9 to 1.11 times 180 degrees over a part whose outside keeps its length, 0.18 m: so the centre of
        // the bend comes as near to the inside as 1.6 mm.
        const double angle = std::numbers::pi * (0.9 + 0.21 * time), first = 0.1, last = 0.28;
        const double radius = (last - first) / angle;
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const Point& p = mesh->nodes()[i];
            const double along = std::clamp(p[0] - first, 0.0, last - first) / radius;
            const double beyond = std::max(p[0] - last, 0.0), before = std::min(p[0], first);
            const double to_centre = radius - p[2];
            // Sheared, so that its halves do not lie node on node.
            positions[i] = {before + to_centre * std::sin(along) + beyond * std::cos(along), p[1] + 0.07 * p[0],
                            -to_centre * std::cos(along) + beyond * std::sin(along)};
        }
    };
    return scene;
}

}  // namespace

std::span<const std::string_view> scene_names() {
    return names;
}

Scene make_scene(std::string_view name, int primitives) {
    if (name == "organ") return organ_scene(primitives);
    if (name == "bodies") return bodies_scene(primitives);
    if (name == "folded") return folded_scene(primitives);
    throw Error("there is no scene '" + std::string(name) + "'; expected organ, bodies or folded");
}

}  // namespace lancet::experiments::collision
