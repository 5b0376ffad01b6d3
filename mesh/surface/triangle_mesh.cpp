#include "lancet/mesh/surface/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh {

namespace {

/// A side of a triangle.
struct Side {
    std::int32_t low, high;
    std::int32_t triangle;
    bool is_forward;  ///< from the low to the high vertex
};

bool has_repeated_vertex(const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

void require_vertices(const std::string& what, std::size_t vertices, std::span<const Triangle> triangles) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const std::int32_t vertex : triangles[t]) {
            if (vertex >= 0 && static_cast<std::size_t>(vertex) < vertices) continue;
            throw Error(what + ": triangle " + std::to_string(t) + " has vertex " + std::to_string(vertex) +
                        "; there are " + std::to_string(vertices));
        }
    }
}

/// Triangles in two classes, turned and not: a forest in which each knows whether it differs from its parent.
class Orientations {
  public:
    explicit Orientations(std::size_t count) : parent_(count), differs_(count, 0) {
        for (std::size_t t = 0; t < count; ++t) parent_[t] = static_cast<std::int32_t>(t);
    }
    /// Demands that one of both triangles is turned, or none. False where that contradicts what was demanded before.
    bool unite(std::int32_t a, std::int32_t b, bool differ) {
        const auto [root_a, a_differs] = root(a);
        const auto [root_b, b_differs] = root(b);
        if (root_a == root_b) return (a_differs != b_differs) == differ;
        parent_[static_cast<std::size_t>(root_a)] = root_b;
        differs_[static_cast<std::size_t>(root_a)] = (a_differs != b_differs) != differ ? 1 : 0;
        return true;
    }

  private:
    std::pair<std::int32_t, bool> root(std::int32_t triangle) {
        bool differs = false;
        std::int32_t at = triangle;
        while (parent_[static_cast<std::size_t>(at)] != at) {
            differs = differs != (differs_[static_cast<std::size_t>(at)] != 0);
            at = parent_[static_cast<std::size_t>(at)];
        }
        // Everything on the way hangs on the root from now on.
        const std::pair result(at, differs);
        for (std::int32_t on = triangle; parent_[static_cast<std::size_t>(on)] != at && on != at;) {
            const std::int32_t next = parent_[static_cast<std::size_t>(on)];
            const bool own = differs_[static_cast<std::size_t>(on)] != 0;
            parent_[static_cast<std::size_t>(on)] = at;
            differs_[static_cast<std::size_t>(on)] = differs ? 1 : 0;
            differs = differs != own;
            on = next;
        }
        return result;
    }

    std::vector<std::int32_t> parent_;
    std::vector<std::uint8_t> differs_;
};

}  // namespace

SurfaceTopology surface_topology(std::size_t vertices, std::span<const Triangle> triangles) {
    require_vertices("surface", vertices, triangles);
    SurfaceTopology topology;
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (has_repeated_vertex(triangles[t])) {
            ++topology.empty_triangles;
            continue;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t from = triangles[t][k], to = triangles[t][(k + 1) % 3];
            sides.push_back({std::min(from, to), std::max(from, to), static_cast<std::int32_t>(t), from < to});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
    });
    Orientations orientations(triangles.size());
    for (auto run = sides.begin(); run != sides.end();) {
        const auto end = std::find_if(run, sides.end(),
                                      [&](const Side& side) { return side.low != run->low || side.high != run->high; });
        const auto count = end - run;
        const auto forward = std::count_if(run, end, [](const Side& side) { return side.is_forward; });
        topology.unmatched_edges += std::abs(2 * forward - count);
        if (count == 1) ++topology.border_edges;
        if (count > 2) ++topology.overused_edges;
        if (count == 2) {
            const Side &a = *run, &b = *(run + 1);
            if (!orientations.unite(a.triangle, b.triangle, a.is_forward == b.is_forward)) {
                topology.is_orientable = false;
            }
        }
        run = end;
    }
    return topology;
}

double signed_volume(std::span<const Point> vertices, std::span<const Triangle> triangles) {
    if (vertices.empty()) return 0;
    // Cones to a vertex of the surface: far from the origin nothing large cancels.
    const Point apex = vertices.front();
    double volume = 0;
    for (const auto& [a, b, c] : triangles) {
        volume += signed_volume(apex, vertices[static_cast<std::size_t>(a)], vertices[static_cast<std::size_t>(b)],
                                vertices[static_cast<std::size_t>(c)]);
    }
    return volume;
}

double area(std::span<const Point> vertices, std::span<const Triangle> triangles) {
    double sum = 0;
    for (const auto& [a, b, c] : triangles) {
        sum += area(vertices[static_cast<std::size_t>(a)], vertices[static_cast<std::size_t>(b)],
                    vertices[static_cast<std::size_t>(c)]);
    }
    return sum;
}

std::array<Point, 2> bounds(std::span<const Point> points) {
    if (points.empty()) return {};
    std::array<Point, 2> box{points[0], points[0]};
    for (const Point& p : points) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box[0][axis] = std::min(box[0][axis], p[axis]);
            box[1][axis] = std::max(box[1][axis], p[axis]);
        }
    }
    return box;
}

void require_valid(const char* what, std::span<const Point> vertices, std::span<const Triangle> triangles) {
    constexpr auto most = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
    if (vertices.size() > most || triangles.size() > most) {
        throw Error(std::string(what) + ": more vertices or triangles than 32-bit numbers count");
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        for (const double value : vertices[v]) {
            if (!std::isfinite(value)) {
                throw Error(std::string(what) + ": vertex " + std::to_string(v) + " is not finite");
            }
        }
    }
    require_vertices(what, vertices.size(), triangles);
}

}  // namespace lancet::mesh
