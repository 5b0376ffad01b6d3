#include "lancet/runtime/cut/blade.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

namespace {

using Corners = std::array<Point, 4>;

Corners corners_of(const mesh::Tetrahedron& nodes, std::span<const Point> positions) {
    Corners corners{};
    for (std::size_t k = 0; k < 4; ++k) corners[k] = positions[static_cast<std::size_t>(nodes[k])];
    return corners;
}

/// Square of the distance from the box around the corners.
double distance_from_box(const Corners& corners, const Point& place) {
    double square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis], corners[3][axis]});
        const double outside = std::max({low - place[axis], place[axis] - high, 0.0});
        square += outside * outside;
    }
    return square;
}

void require_finite(const Point& place) {
    for (const double value : place) {
        if (!std::isfinite(value)) throw Error("blade: a coordinate is not finite");
    }
}

}  // namespace

Point rest_place(const CuttableBody& body, std::span<const Point> positions, const Point& place) {
    const mesh::CutMesh& mesh = body.mesh();
    std::int32_t nearest = -1;
    mesh::Barycentric at{};
    double box_distance = std::numeric_limits<double>::infinity(), depth = -box_distance;
    for (std::size_t part = 0; part < mesh.parts().size(); ++part) {
        const Corners corners = corners_of(mesh.parts()[part], positions);
        const double distance = distance_from_box(corners, place);
        if (distance > box_distance) continue;
        const mesh::Barycentric weights = mesh::barycentric(corners, place);
        if (!std::ranges::all_of(weights, [](double weight) { return std::isfinite(weight); })) continue;
        const double lowest = *std::ranges::min_element(weights);
        if (distance == box_distance && lowest <= depth) continue;
        // What another part of the element holds is not this part's.
        const std::int32_t element = mesh.element_of_part()[part];
        if (lowest >= 0 && mesh.material_point(element, weights).part != static_cast<std::int32_t>(part)) continue;
        nearest = static_cast<std::int32_t>(part);
        at = weights;
        box_distance = distance;
        depth = lowest;
    }
    if (nearest < 0) return place;
    const mesh::Tetrahedron& nodes =
        mesh.mesh().tetrahedra()[static_cast<std::size_t>(mesh.element_of_part()[static_cast<std::size_t>(nearest)])];
    Point rest{};
    for (std::size_t k = 0; k < 4; ++k) {
        const Point& node = mesh.mesh().nodes()[static_cast<std::size_t>(nodes[k])];
        for (std::size_t axis = 0; axis < 3; ++axis) rest[axis] += at[k] * node[axis];
    }
    return rest;
}

Blade::Blade(int segments) : segments_(segments) {
    if (segments < 1) throw Error("blade: " + std::to_string(segments) + " segments; expected at least 1");
}

void Blade::place(const CuttableBody& body, const Point& heel, const Point& tip) {
    require_finite(heel);
    require_finite(tip);
    std::vector<Point> positions(body.body().nodes()), edge;
    body.body().positions(positions);
    for (int k = 0; k <= segments_; ++k) {
        const double t = static_cast<double>(k) / segments_;
        Point along{};
        for (std::size_t axis = 0; axis < 3; ++axis) along[axis] = (1 - t) * heel[axis] + t * tip[axis];
        edge.push_back(rest_place(body, positions, along));
    }
    edge_ = std::move(edge);
}

std::optional<mesh::CutSurface> Blade::sweep(const CuttableBody& body, const Point& heel, const Point& tip) {
    const std::vector<Point> before = edge_;
    place(body, heel, tip);
    if (before.empty() || before == edge_) return std::nullopt;
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
