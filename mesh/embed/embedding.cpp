#include "lancet/mesh/embed/embedding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/surface/box_grid.hpp"
#include "lancet/mesh/surface/triangle_mesh.hpp"

namespace lancet::mesh {

namespace {

Point minus(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double distance_to_segment(const Point& p, const Point& a, const Point& b) {
    const Point edge = minus(b, a), from = minus(p, a);
    const double along = std::clamp(dot(from, edge) / dot(edge, edge), 0.0, 1.0);
    return std::hypot(from[0] - along * edge[0], from[1] - along * edge[1], from[2] - along * edge[2]);
}

double distance_to_triangle(const Point& p, const Point& a, const Point& b, const Point& c) {
    // Above the triangle the plane is nearest, elsewhere one of the edges.
    const Point u = minus(b, a), v = minus(c, a), w = minus(p, a);
    const Point normal{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    const auto side = [&](const Point& from, const Point& to) {
        const Point edge = minus(to, from), at = minus(p, from);
        return dot(normal, {edge[1] * at[2] - edge[2] * at[1], edge[2] * at[0] - edge[0] * at[2],
                            edge[0] * at[1] - edge[1] * at[0]});
    };
    if (side(a, b) >= 0 && side(b, c) >= 0 && side(c, a) >= 0) {
        return std::abs(dot(normal, w)) / std::sqrt(dot(normal, normal));
    }
    return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

class Binder {
  public:
    explicit Binder(const TetMesh& mesh) : mesh_(mesh) {
        std::vector<Bounds> boxes;
        boxes.reserve(mesh.tetrahedra().size());
        for (std::size_t e = 0; e < mesh.tetrahedra().size(); ++e) boxes.push_back(bounds(corners(e)));
        grid_ = BoxGrid(boxes);
    }

    struct Found {
        std::int32_t element = -1;
        Barycentric weights{};
        double distance = std::numeric_limits<double>::infinity();
    };

    Found bind(const Point& point) const {
        Found found = containing(point);
        if (found.element >= 0) return found;
        // The nearest is found when the searched box reaches as far as it: twice as far each time.
        double reach = grid_.cell_size() + distance_to_bounds(point);
        while (!(found.distance <= reach)) {
            Bounds box{point, point};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                box[0][axis] -= reach;
                box[1][axis] += reach;
            }
            grid_.for_each_overlap(box, [&](std::int32_t element) {
                const double distance = distance_to(static_cast<std::size_t>(element), point);
                if (distance > found.distance || (distance == found.distance && element > found.element)) return;
                found.distance = distance;
                found.element = element;
            });
            reach *= 2;
        }
        if (found.element >= 0) {
            found.weights = barycentric(corners(static_cast<std::size_t>(found.element)), point);
        }
        return found;
    }

  private:
    std::array<Point, 4> corners(std::size_t element) const {
        const Tetrahedron& t = mesh_.tetrahedra()[element];
        const auto x = mesh_.nodes();
        return {x[static_cast<std::size_t>(t[0])], x[static_cast<std::size_t>(t[1])], x[static_cast<std::size_t>(t[2])],
                x[static_cast<std::size_t>(t[3])]};
    }

    /// The element in which the point lies deepest; none where it is outside of all.
    Found containing(const Point& point) const {
        Found found;
        double deepest = 0;
        grid_.for_each_overlap({point, point}, [&](std::int32_t element) {
            const Barycentric weights = barycentric(corners(static_cast<std::size_t>(element)), point);
            const double depth = *std::ranges::min_element(weights);
            const bool is_better =
                depth > deepest || (depth == deepest && (found.element < 0 || element < found.element));
            if (!(depth >= 0) || !is_better) return;
            deepest = depth;
            found = {element, weights, 0};
        });
        return found;
    }

    double distance_to(std::size_t element, const Point& point) const {
        const std::array<Point, 4> x = corners(element);
        double nearest = std::numeric_limits<double>::infinity();
        for (const auto& [a, b, c] : opposite_faces) {
            nearest =
                std::min(nearest, distance_to_triangle(point, x[static_cast<std::size_t>(a)],
                                                       x[static_cast<std::size_t>(b)], x[static_cast<std::size_t>(c)]));
        }
        return nearest;
    }

    double distance_to_bounds(const Point& point) const {
        Point outside{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            outside[axis] =
                std::max({grid_.bounds()[0][axis] - point[axis], point[axis] - grid_.bounds()[1][axis], 0.0});
        }
        return std::hypot(outside[0], outside[1], outside[2]);
    }

    const TetMesh& mesh_;
    BoxGrid grid_;
};

}  // namespace

Embedding embed(const TetMesh& mesh, std::span<const Point> points) {
    if (mesh.tetrahedra().empty()) throw Error("embedding: the mesh has no elements");
    require_valid("embedding", points, {});
    Embedding embedding;
    embedding.elements.reserve(points.size());
    embedding.weights.reserve(points.size());
    embedding.distances.reserve(points.size());
    const Binder binder(mesh);
    for (std::size_t p = 0; p < points.size(); ++p) {
        const Binder::Found found = binder.bind(points[p]);
        if (found.element < 0) {
            throw Error("embedding: point " + std::to_string(p) + " is too far away for its distance to be finite");
        }
        embedding.elements.push_back(found.element);
        embedding.weights.push_back(found.weights);
        embedding.distances.push_back(found.distance);
    }
    return embedding;
}

void place(std::span<const Tetrahedron> nodes, std::span<const Barycentric> weights, std::span<const Point> positions,
           std::span<Point> places) {
    for (std::size_t p = 0; p < places.size(); ++p) places[p] = place(nodes[p], weights[p], positions);
}

}  // namespace lancet::mesh
