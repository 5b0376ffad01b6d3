#include "lancet/runtime/cut/blade.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/collide/box.hpp"
#include "lancet/runtime/collide/vector3.hpp"

namespace lancet::runtime {

namespace {

using Corners = std::array<Point, 4>;

Corners corners_of(const mesh::Tetrahedron& nodes, std::span<const Point> positions) {
    Corners corners{};
    for (std::size_t k = 0; k < 4; ++k) corners[k] = positions[static_cast<std::size_t>(nodes[k])];
    return corners;
}

/// Square of the distance from a box.
double distance_from(const Box& box, const Point& place) {
    double square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double outside = std::max({box.lower[axis] - place[axis], place[axis] - box.upper[axis], 0.0});
        square += outside * outside;
    }
    return square;
}

/// The part that is nearest to a place, as far as parts have been looked at.
struct Nearest {
    std::int32_t part = -1;
    mesh::Barycentric weights{};
    double box_distance = std::numeric_limits<double>::infinity();
    double depth = -std::numeric_limits<double>::infinity();
};

void require_finite(const Point& place) {
    for (const double value : place) {
        if (!std::isfinite(value)) throw Error("blade: a coordinate is not finite");
    }
}

/// The parts whose boxes have a place in common with a box, ascending.
std::vector<std::int32_t> parts_near(const mesh::CutMesh& mesh, std::span<const Point> positions, const Box& box) {
    // By node, the sides of the box beyond which it lies: a part is away where all its nodes lie beyond one of them.
    std::vector<std::uint8_t> beyond;
    beyond.reserve(positions.size());
    for (const Point& place : positions) {
        unsigned sides = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            sides |= (place[axis] < box.lower[axis] ? 1U : 0U) << (2 * axis);
            sides |= (place[axis] > box.upper[axis] ? 2U : 0U) << (2 * axis);
        }
        beyond.push_back(static_cast<std::uint8_t>(sides));
    }
    std::vector<std::int32_t> near;
    for (std::size_t part = 0; part < mesh.parts().size(); ++part) {
        const auto& [a, b, c, d] = mesh.parts()[part];
        const bool is_near = (beyond[static_cast<std::size_t>(a)] & beyond[static_cast<std::size_t>(b)] &
                              beyond[static_cast<std::size_t>(c)] & beyond[static_cast<std::size_t>(d)]) == 0;
        if (is_near) near.push_back(static_cast<std::int32_t>(part));
    }
    return near;
}

/// Square of the distance from the nearest node, which some part's box is no farther away than.
double distance_from_nodes(std::span<const Point> positions, const Point& place) {
    double least = std::numeric_limits<double>::infinity();
    for (const Point& node : positions) {
        const double x = node[0] - place[0], y = node[1] - place[1], z = node[2] - place[2];
        const double square = x * x + y * y + z * z;
        least = square < least ? square : least;
    }
    return least * (1 + 0x1p-40);
}

/// The box around all that is as near to the places as what has been found.
Box box_within_reach(std::span<const Point> places, std::span<const Nearest> nearest) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (std::size_t k = 0; k < places.size(); ++k) {
        const double reach = std::sqrt(nearest[k].box_distance) * (1 + 0x1p-40);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double rounding = 0x1p-50 * std::abs(places[k][axis]);
            box.lower[axis] = std::min(box.lower[axis], places[k][axis] - reach - rounding);
            box.upper[axis] = std::max(box.upper[axis], places[k][axis] + reach + rounding);
        }
    }
    return box;
}

/// Looks for the nearest of some parts, in their order.
void find_nearest(const mesh::CutMesh& mesh, std::span<const Point> positions, std::span<const std::int32_t> parts,
                  std::span<const Point> places, std::span<Nearest> nearest) {
    for (const std::int32_t part : parts) {
        const Corners corners = corners_of(mesh.parts()[static_cast<std::size_t>(part)], positions);
        const Box box = box_around(corners);
        for (std::size_t k = 0; k < places.size(); ++k) {
            const double distance = distance_from(box, places[k]);
            if (distance > nearest[k].box_distance) continue;
            const mesh::Barycentric weights = mesh::barycentric(corners, places[k]);
            if (!std::ranges::all_of(weights, [](double weight) { return std::isfinite(weight); })) continue;
            const double lowest = *std::ranges::min_element(weights);
            if (distance == nearest[k].box_distance && lowest <= nearest[k].depth) continue;
            // What another part of the element holds is not this part's.
            const std::int32_t element = mesh.element_of_part()[static_cast<std::size_t>(part)];
            if (lowest >= 0 && mesh.material_point(element, weights).part != part) continue;
            nearest[k] = {part, weights, distance, lowest};
        }
    }
}

}  // namespace

std::vector<Point> rest_places(const CuttableBody& body, std::span<const Point> positions,
                               std::span<const Point> places) {
    const mesh::CutMesh& mesh = body.mesh();
    const std::span<const Point> copies = positions.first(mesh.node_of_copy().size());
    std::vector<Nearest> nearest(places.size());
    for (std::size_t k = 0; k < places.size(); ++k) nearest[k].box_distance = distance_from_nodes(copies, places[k]);
    find_nearest(mesh, copies, parts_near(mesh, copies, box_within_reach(places, nearest)), places, nearest);
    for (std::size_t k = 0; k < places.size(); ++k) {
        if (nearest[k].part >= 0) continue;
        // What is so near does not hold the place or has collapsed: look at all parts.
        std::vector<std::int32_t> all(mesh.parts().size());
        std::iota(all.begin(), all.end(), 0);
        nearest[k] = Nearest{};
        find_nearest(mesh, copies, all, places.subspan(k, 1), std::span(nearest).subspan(k, 1));
    }
    std::vector<Point> rest(places.begin(), places.end());
    for (std::size_t k = 0; k < places.size(); ++k) {
        if (nearest[k].part < 0) continue;
        const auto element = mesh.element_of_part()[static_cast<std::size_t>(nearest[k].part)];
        const mesh::Tetrahedron& nodes = mesh.mesh().tetrahedra()[static_cast<std::size_t>(element)];
        rest[k] = {};
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const Point& node = mesh.mesh().nodes()[static_cast<std::size_t>(nodes[corner])];
            for (std::size_t axis = 0; axis < 3; ++axis) rest[k][axis] += nearest[k].weights[corner] * node[axis];
        }
    }
    return rest;
}

Blade::Blade(int segments, double shortest_stroke) : segments_(segments), shortest_stroke_(shortest_stroke) {
    if (segments < 1) throw Error("blade: " + std::to_string(segments) + " segments; expected at least 1");
    if (!(shortest_stroke >= 0) || !std::isfinite(shortest_stroke)) {
        throw Error("blade: a shortest stroke of " + std::to_string(shortest_stroke) + " m; expected at least 0");
    }
}

void Blade::place(const CuttableBody& body, const Point& heel, const Point& tip) {
    require_finite(heel);
    require_finite(tip);
    std::vector<Point> positions(body.body().nodes()), edge;
    body.body().positions(positions);
    for (int k = 0; k <= segments_; ++k) {
        const double t = static_cast<double>(k) / segments_;
        Point& along = edge.emplace_back();
        for (std::size_t axis = 0; axis < 3; ++axis) along[axis] = (1 - t) * heel[axis] + t * tip[axis];
    }
    edge_ = rest_places(body, positions, edge);
}

std::optional<mesh::CutSurface> Blade::sweep(const CuttableBody& body, const Point& heel, const Point& tip) {
    const std::vector<Point> before = edge_;
    place(body, heel, tip);
    if (before.empty() || before == edge_) return std::nullopt;
    double farthest = 0;
    for (std::size_t k = 0; k < edge_.size(); ++k) {
        farthest = std::max(farthest, length(subtract(edge_[k], before[k])));
    }
    if (farthest < shortest_stroke_) {
        edge_ = before;
        return std::nullopt;
    }
    std::vector<Point> vertices = before;
    vertices.insert(vertices.end(), edge_.begin(), edge_.end());
    std::vector<mesh::Triangle> triangles;
    for (int k = 0; k < segments_; ++k) {
        const int next = k + 1, moved = k + segments_ + 1;
        triangles.push_back({k, next, moved + 1});
        triangles.push_back({k, moved + 1, moved});
    }
    return mesh::CutSurface::triangulated(vertices, triangles);
}

CutUpdate Blade::draw(CuttableBody& body, Scheduler& scheduler, const Point& heel, const Point& tip) {
    const std::vector<Point> before = edge_;
    const std::optional<mesh::CutSurface> surface = sweep(body, heel, tip);
    if (!surface) return {};
    try {
        return body.cut(scheduler, *surface, Configuration::rest);
    } catch (...) {
        edge_ = before;
        throw;
    }
}

}  // namespace lancet::runtime
