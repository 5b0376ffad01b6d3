#include "lancet/runtime/cut/blade.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

}  // namespace

std::vector<Point> rest_places(const CuttableBody& body, std::span<const Point> positions,
                               std::span<const Point> places) {
    const mesh::CutMesh& mesh = body.mesh();
    std::vector<Nearest> nearest(places.size());
    for (std::size_t part = 0; part < mesh.parts().size(); ++part) {
        const Corners corners = corners_of(mesh.parts()[part], positions);
        const Box box = box_around(corners);
        for (std::size_t k = 0; k < places.size(); ++k) {
            const double distance = distance_from(box, places[k]);
            if (distance > nearest[k].box_distance) continue;
            const mesh::Barycentric weights = mesh::barycentric(corners, places[k]);
            if (!std::ranges::all_of(weights, [](double weight) { return std::isfinite(weight); })) continue;
            const double lowest = *std::ranges::min_element(weights);
            if (distance == nearest[k].box_distance && lowest <= nearest[k].depth) continue;
            // What another part of the element holds is not this part's.
            const std::int32_t element = mesh.element_of_part()[part];
            if (lowest >= 0 && mesh.material_point(element, weights).part != static_cast<std::int32_t>(part)) continue;
            nearest[k] = {static_cast<std::int32_t>(part), weights, distance, lowest};
        }
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
