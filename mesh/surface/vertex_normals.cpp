#include "lancet/mesh/surface/vertex_normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/surface/corner_normals.hpp"

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

/// A vector in units of its length; zero where it has none.
Point unit(const Point& sum) {
    const double square = sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2];
    // Angles are below 2 pi times their number; where they are tiny, or opposite, their squares may be lost.
    const double length = square > 1e-250 ? std::sqrt(square) : std::hypot(sum[0], sum[1], sum[2]);
    return length > 0 ? Point{sum[0] / length, sum[1] / length, sum[2] / length} : Point{};
}

void add(Point& sum, const Point& normal) {
    for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += normal[axis];
}

}  // namespace

void vertex_normals(const VertexCorners& corners, std::span<const Point> positions, std::size_t begin, std::size_t end,
                    std::span<Point> normals) {
    if (begin == end) return;
    constexpr std::size_t most = 64;
    std::array<Triangle, most> around;
    std::array<Point, 3 * most> of_corners;
    std::span<const std::int32_t> rest = corners.of(begin, end);
    std::size_t vertex = begin, left = corners.of(begin).size();  // corners of the vertex that are still to come
    Point sum{};
    const auto finish_complete_ones = [&] {
        while (left == 0 && vertex < end) {
            normals[vertex++] = unit(sum);
            sum = {};
            if (vertex < end) left = corners.of(vertex).size();
        }
    };
    finish_complete_ones();
    while (!rest.empty()) {
        const std::size_t count = std::min(most, rest.size());
        for (std::size_t k = 0; k < count; ++k) {
            around[k] = corners.triangles()[static_cast<std::size_t>(rest[k] / 3)];
        }
        corner_normals(std::span(around).first(count), positions, of_corners);
        for (std::size_t k = 0; k < count; ++k) {
            add(sum, of_corners[3 * k + static_cast<std::size_t>(rest[k] % 3)]);
            --left;
            finish_complete_ones();
        }
        rest = rest.subspan(count);
    }
}

void add_corner_normals(const VertexCorners& corners, std::span<const Point> corner_normals, std::size_t begin,
                        std::size_t end, std::span<Point> normals) {
    for (std::size_t vertex = begin; vertex < end; ++vertex) {
        Point sum{};
        for (const std::int32_t corner : corners.of(vertex)) add(sum, corner_normals[static_cast<std::size_t>(corner)]);
        normals[vertex] = unit(sum);
    }
}

}  // namespace lancet::mesh
