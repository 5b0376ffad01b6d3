#include "lancet/mesh/surface/vertex_normals.hpp"

#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::mesh {

VertexCorners::VertexCorners(std::size_t vertices, std::span<const Triangle> triangles)
    : triangles_(triangles.begin(), triangles.end()), first_(vertices + 1, 0), corners_(3 * triangles.size()) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const std::int32_t vertex : triangles[t]) {
            if (vertex < 0 || static_cast<std::size_t>(vertex) >= vertices) {
                throw Error("surface: triangle " + std::to_string(t) + " has vertex " + std::to_string(vertex) +
                            "; there are " + std::to_string(vertices));
            }
            ++first_[static_cast<std::size_t>(vertex) + 1];
        }
    }
    for (std::size_t v = 0; v < vertices; ++v) first_[v + 1] += first_[v];
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t c = 0; c < corners_.size(); ++c) {
        corners_[next[static_cast<std::size_t>(triangles[c / 3][c % 3])]++] = static_cast<std::int32_t>(c);
    }
}

namespace {

/// The direction from a to b; zero where there is none.
Point direction(const Point& a, const Point& b) {
    const Point d{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double length = std::hypot(d[0], d[1], d[2]);
    if (!(length > 0) || !std::isfinite(length)) return {};
    return {d[0] / length, d[1] / length, d[2] / length};
}

Point cross(const Point& u, const Point& v) {
    return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

double dot(const Point& u, const Point& v) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/// Adds the unit normal of the triangle, weighted by its angle at p: n / |n| atan2(|n|, u . v) with the edges u and v
/// from p and n = u x v, of any length.
void add_weighted(const Point& p, const Point& q, const Point& r, Point& sum) {
    Point u{q[0] - p[0], q[1] - p[1], q[2] - p[2]}, v{r[0] - p[0], r[1] - p[1], r[2] - p[2]};
    Point normal = cross(u, v);
    double square = dot(normal, normal);
    // Where a square is not a normal number, edges of unit length; |n|^2 is of the fourth order in them.
    constexpr double smallest = 1e-250, largest = 1e250;
    if (!(square > smallest && square < largest)) {
        u = direction(p, q);
        v = direction(p, r);
        normal = cross(u, v);
        square = dot(normal, normal);
        if (!(square > 0)) return;
    }
    const double sine = std::sqrt(square);
    const double weight = std::atan2(sine, dot(u, v)) / sine;
    for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += weight * normal[axis];
}

}  // namespace

void vertex_normals(const VertexCorners& corners, std::span<const Point> positions, std::size_t begin, std::size_t end,
                    std::span<Point> normals) {
    for (std::size_t vertex = begin; vertex < end; ++vertex) {
        Point sum{};
        for (const std::int32_t corner : corners.of(vertex)) {
            const Triangle& t = corners.triangles()[static_cast<std::size_t>(corner / 3)];
            const auto at = [&](std::int32_t k) -> const Point& {
                return positions[static_cast<std::size_t>(t[static_cast<std::size_t>((corner + k) % 3)])];
            };
            // (corner + k) % 3 runs through the triangle from this corner on, since corner = 3 t + k.
            add_weighted(at(0), at(1), at(2), sum);
        }
        const double length = std::hypot(sum[0], sum[1], sum[2]);
        normals[vertex] = length > 0 ? Point{sum[0] / length, sum[1] / length, sum[2] / length} : Point{};
    }
}

}  // namespace lancet::mesh
