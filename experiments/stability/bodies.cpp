#include "lancet/experiments/stability/bodies.hpp"

#include <algorithm>
#include <cmath>

#include "lancet/mesh/generate/box.hpp"
#include "lancet/mesh/generate/cylinder.hpp"
#include "lancet/mesh/inspect.hpp"

namespace lancet::experiments::stability {

namespace {

using mesh::Point;
using mesh::TetMesh;

std::array<Point, 4> corners_of(const TetMesh& mesh, std::int32_t element) {
    std::array<Point, 4> corners{};
    for (std::size_t k = 0; k < 4; ++k) {
        corners[k] = mesh.nodes()[static_cast<std::size_t>(mesh.tetrahedra()[static_cast<std::size_t>(element)][k])];
    }
    return corners;
}

double distance(const Point& a, const Point& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

double longest_edge(const std::array<Point, 4>& corners) {
    double longest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < i; ++j) longest = std::max(longest, distance(corners[i], corners[j]));
    }
    return longest;
}

bool is_valid(const TetMesh::Definition& definition) {
    return mesh::inspect(definition).clean();
}

/// Moves every node by up to `share` of the shortest edge of its elements, or less where that makes elements invalid.
TetMesh jittered(const TetMesh& mesh, double share, Random& random) {
    std::vector<double> reach(mesh.nodes().size(), HUGE_VAL);
    for (const mesh::Tetrahedron& corners : mesh.tetrahedra()) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                const auto a = static_cast<std::size_t>(corners[i]), b = static_cast<std::size_t>(corners[j]);
                if (i != j) reach[a] = std::min(reach[a], distance(mesh.nodes()[a], mesh.nodes()[b]));
            }
        }
    }
    std::vector<std::array<double, 3>> moves(mesh.nodes().size());
    for (std::size_t node = 0; node < moves.size(); ++node) {
        const auto direction = random.direction();
        const double length = share * random.uniform() * reach[node];
        for (std::size_t axis = 0; axis < 3; ++axis) moves[node][axis] = length * direction[axis];
    }
    for (double factor = 1; factor > 1e-3; factor /= 2) {
        TetMesh::Definition definition = mesh.definition();
        for (std::size_t node = 0; node < moves.size(); ++node) {
            for (std::size_t axis = 0; axis < 3; ++axis) definition.nodes[node][axis] += factor * moves[node][axis];
        }
        if (is_valid(definition)) return TetMesh(std::move(definition));
    }
    return mesh;
}

TetMesh stretched(const TetMesh& mesh, std::size_t axis, double factor) {
    TetMesh::Definition definition = mesh.definition();
    for (Point& node : definition.nodes) node[axis] *= factor;
    return TetMesh(std::move(definition));
}

/// Scaled about the origin, then moved.
TetMesh placed(const TetMesh& mesh, double scale, const Point& offset) {
    TetMesh::Definition definition = mesh.definition();
    for (Point& node : definition.nodes) {
        for (std::size_t axis = 0; axis < 3; ++axis) node[axis] = scale * node[axis] + offset[axis];
    }
    // Far away rounding may flatten what is thin.
    return is_valid(definition) ? TetMesh(std::move(definition)) : mesh;
}

}  // namespace

double quality(const TetMesh& mesh, std::int32_t element) {
    const double longest = longest_edge(corners_of(mesh, element));
    return 6 * std::sqrt(2.0) * mesh.volume(element) / (longest * longest * longest);
}

double lowest_quality(const TetMesh& mesh) {
    double lowest = HUGE_VAL;
    for (std::size_t e = 0; e < mesh.tetrahedra().size(); ++e) {
        lowest = std::min(lowest, quality(mesh, static_cast<std::int32_t>(e)));
    }
    return lowest;
}

double height_over_edge(const TetMesh& mesh, std::int32_t element) {
    const std::array<Point, 4> corners = corners_of(mesh, element);
    double largest_area = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        largest_area =
            std::max(largest_area, mesh::area(corners[(k + 1) % 4], corners[(k + 2) % 4], corners[(k + 3) % 4]));
    }
    return 3 * mesh.volume(element) / largest_area / longest_edge(corners);
}

TetMesh with_bad_element(const TetMesh& mesh, double wanted, Random& random) {
    for (int attempt = 0; attempt < 64; ++attempt) {
        const std::size_t element = random.below(mesh.tetrahedra().size());
        const std::size_t corner = random.below(4);
        const mesh::Tetrahedron& nodes = mesh.tetrahedra()[element];
        TetMesh::Definition definition = mesh.definition();
        Point& moved = definition.nodes[static_cast<std::size_t>(nodes[corner])];
        const double share = wanted / quality(mesh, static_cast<std::int32_t>(element));
        if (share >= 1) return mesh;
        Point foot{};
        for (std::size_t k = 0; k < 4; ++k) {
            if (k == corner) continue;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                foot[axis] += mesh.nodes()[static_cast<std::size_t>(nodes[k])][axis] / 3;
            }
        }
        for (std::size_t axis = 0; axis < 3; ++axis) moved[axis] = foot[axis] + share * (moved[axis] - foot[axis]);
        if (is_valid(definition)) return TetMesh(std::move(definition));
    }
    return mesh;
}

TetMesh random_mesh(Random& random) {
    TetMesh mesh;
    const std::size_t kind = random.below(3);
    if (kind == 2) {
        mesh = mesh::cylinder({.length = 1,
                               .radius = random.uniform(0.2, 0.6),
                               .cells_along = random.between(1, 3),
                               .cells_across = 1,
                               .axis = 0});
    } else {
        mesh = mesh::box({.cells = {random.between(1, 4), random.between(1, 3), random.between(1, 3)},
                          .size = {1, random.uniform(0.3, 1), random.uniform(0.3, 1)},
                          .split = kind == 0 ? mesh::Split::five : mesh::Split::six});
    }
    switch (random.below(4)) {
        case 0:
            break;
        case 1:
            mesh = jittered(mesh, 0.45, random);
            break;
        case 2:
            mesh = stretched(mesh, random.below(3), random.logarithmic(0.01, 100));
            break;
        default:
            mesh = with_bad_element(jittered(mesh, 0.2, random), random.logarithmic(1e-6, 1e-1), random);
    }
    const bool is_far = random.chance(0.1);
    const auto away = random.direction();
    const double scale = random.chance(0.3) ? random.logarithmic(1e-3, 1) : 1;
    const double reach = is_far ? 100 : 0;
    return is_far || scale < 1 ? placed(mesh, scale, {reach * away[0], reach * away[1], reach * away[2]}) : mesh;
}

runtime::Scene random_scene(TetMesh mesh, Random& random) {
    runtime::Scene scene;
    const double size = size_of(mesh);
    // From stiff to what its own weight crushes: rho g l / E from 1e-4 to 3.
    const double load = random.logarithmic(1e-4, 3);
    const double density = random.uniform(500, 2000);
    scene.materials[0] = {
        .young_modulus = density * 9.81 * size / load, .poisson_ratio = random.uniform(0, 0.45), .density = density};
    const std::size_t support = random.below(3);
    if (support == 0) scene.fixed_nodes = nodes_at_end(mesh, false);
    if (support == 1) scene.fixed_nodes = {static_cast<std::int32_t>(random.below(mesh.nodes().size()))};
    scene.mesh = std::move(mesh);
    return scene;
}

std::vector<std::int32_t> nodes_at_end(const TetMesh& mesh, bool highest) {
    const auto bounds = mesh.bounds();
    const double end = bounds[highest ? 1 : 0][0], reach = 1e-3 * (bounds[1][0] - bounds[0][0]);
    std::vector<std::int32_t> nodes;
    for (std::size_t n = 0; n < mesh.nodes().size(); ++n) {
        if (std::abs(mesh.nodes()[n][0] - end) <= reach) nodes.push_back(static_cast<std::int32_t>(n));
    }
    return nodes;
}

double size_of(const TetMesh& mesh) {
    const auto bounds = mesh.bounds();
    return distance(bounds[0], bounds[1]);
}

}  // namespace lancet::experiments::stability
