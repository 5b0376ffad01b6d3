#include "lancet/mesh/cut/cut_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/cut/facet.hpp"

namespace lancet::mesh {

namespace {

using Vector = Plane::Normal;

Vector exact(const Point& p) {
    return {Exact(p[0]), Exact(p[1]), Exact(p[2])};
}

Vector between(const Point& from, const Point& to) {
    const Vector a = exact(from), b = exact(to);
    return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
}

bool is_zero(const Vector& v) {
    return v[0].sign() == 0 && v[1].sign() == 0 && v[2].sign() == 0;
}

Vector negative(const Vector& v) {
    return {-v[0], -v[1], -v[2]};
}

void require_finite(const char* what, const Point& p) {
    for (const double value : p) {
        if (!std::isfinite(value)) throw Error(std::string(what) + ": a coordinate is not finite");
    }
}

std::array<Point, 2> everywhere() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {Point{-infinity, -infinity, -infinity}, Point{infinity, infinity, infinity}};
}

/// The box of points, enlarged by more than they can be rounded.
std::array<Point, 2> bounds_of(std::span<const Point> points) {
    std::array<Point, 2> bounds{points[0], points[0]};
    for (const Point& p : points) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            bounds[0][axis] = std::min(bounds[0][axis], p[axis]);
            bounds[1][axis] = std::max(bounds[1][axis], p[axis]);
        }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double rounding =
            8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(bounds[0][axis]), std::abs(bounds[1][axis]));
        bounds[0][axis] -= rounding;
        bounds[1][axis] += rounding;
    }
    return bounds;
}

/// The triangle with these corners, in order. Borders stand upright on it: inward = normal x edge.
Facet triangle_facet(const std::array<Point, 3>& corners, const Vector& normal) {
    Facet facet{.plane = Plane(corners[0], normal, corners), .bounds = bounds_of(corners)};
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const std::array<Point, 2> edge{corners[k], corners[(k + 1) % corners.size()]};
        facet.borders.push_back({Plane(edge[0], cross(normal, between(edge[0], edge[1])), edge)});
    }
    return facet;
}

}  // namespace

CutSurface::CutSurface(std::vector<Facet> facets)
    : facets_(std::make_shared<const std::vector<Facet>>(std::move(facets))) {}

std::span<const Facet> CutSurface::facets() const noexcept {
    return *facets_;
}

CutSurface CutSurface::plane(const Point& point, const Point& normal) {
    require_finite("cut plane: point", point);
    require_finite("cut plane: normal", normal);
    if (is_zero(exact(normal))) throw Error("cut plane: the normal is zero");
    return CutSurface({Facet{.plane = Plane(point, exact(normal)), .bounds = everywhere()}});
}

CutSurface CutSurface::half_plane(const Point& point, const Point& normal, const Point& inward) {
    require_finite("cut half-plane: point", point);
    require_finite("cut half-plane: normal", normal);
    require_finite("cut half-plane: inward direction", inward);
    const Vector along = cross(exact(inward), exact(normal));
    if (is_zero(along)) throw Error("cut half-plane: the inward direction is zero or along the normal");
    Facet facet{.plane = Plane(point, exact(normal)), .bounds = everywhere()};
    facet.borders.push_back({Plane(point, cross(exact(normal), along))});
    return CutSurface({std::move(facet)});
}

CutSurface CutSurface::parallelogram(const Point& corner, const Point& first_edge, const Point& second_edge) {
    require_finite("cut parallelogram: corner", corner);
    require_finite("cut parallelogram: edge", first_edge);
    require_finite("cut parallelogram: edge", second_edge);
    const Vector normal = cross(exact(first_edge), exact(second_edge));
    if (is_zero(normal)) throw Error("cut parallelogram: it has no area");
    std::array<Point, 4> corners{corner, corner, corner, corner};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        corners[1][axis] += first_edge[axis];
        corners[2][axis] = corners[1][axis] + second_edge[axis];
        corners[3][axis] += second_edge[axis];
    }
    // The borders take the edges' own directions: the corners are rounded.
    Facet facet{.plane = Plane(corner, normal), .bounds = bounds_of(corners)};
    const Vector from_first = cross(normal, exact(first_edge)), from_second = cross(exact(second_edge), normal);
    facet.borders = {{Plane(corner, from_first)},
                     {Plane(corners[1], negative(from_second))},
                     {Plane(corners[3], negative(from_first))},
                     {Plane(corner, from_second)}};
    return CutSurface({std::move(facet)});
}

CutSurface CutSurface::triangulated(std::span<const Point> vertices, std::span<const Triangle> triangles) {
    for (const Point& vertex : vertices) require_finite("cut triangles: vertex", vertex);
    std::vector<Facet> facets;
    std::vector<std::array<Point, 3>> corners_of;
    std::map<std::pair<Point, Point>, int> uses;
    const auto key = [](const Point& a, const Point& b) { return a < b ? std::pair(a, b) : std::pair(b, a); };
    for (const Triangle& triangle : triangles) {
        std::array<Point, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            if (triangle[k] < 0 || static_cast<std::size_t>(triangle[k]) >= vertices.size()) {
                throw Error("cut triangles: vertex " + std::to_string(triangle[k]) + " does not exist; there are " +
                            std::to_string(vertices.size()));
            }
            corners[k] = vertices[static_cast<std::size_t>(triangle[k])];
        }
        const Vector normal = cross(between(corners[0], corners[1]), between(corners[0], corners[2]));
        if (is_zero(normal)) continue;
        facets.push_back(triangle_facet(corners, normal));
        corners_of.push_back(corners);
        for (std::size_t k = 0; k < 3; ++k) ++uses[key(corners[k], corners[(k + 1) % 3])];
    }
    if (facets.empty()) throw Error("cut triangles: no triangle has an area");
    for (std::size_t f = 0; f < facets.size(); ++f) {
        for (std::size_t k = 0; k < 3; ++k) {
            facets[f].borders[k].is_outer = uses[key(corners_of[f][k], corners_of[f][(k + 1) % 3])] == 1;
        }
    }
    return CutSurface(std::move(facets));
}

CutSurface CutSurface::swept(std::span<const std::array<Point, 2>> places) {
    if (places.size() < 2) {
        throw Error("swept cut: " + std::to_string(places.size()) + " places of the blade; expected at least 2");
    }
    std::vector<Point> vertices;
    std::vector<Triangle> triangles;
    for (const auto& [heel, tip] : places) {
        const auto first = static_cast<std::int32_t>(vertices.size());
        vertices.push_back(heel);
        vertices.push_back(tip);
        if (first == 0) continue;
        triangles.push_back({first - 2, first - 1, first + 1});
        triangles.push_back({first - 2, first + 1, first});
    }
    return triangulated(vertices, triangles);
}

CutSurface CutSurface::level_set(std::function<double(const Point&)> function) {
    if (!function) throw Error("cut level set: no function");
    return CutSurface({Facet{.plane = Plane(std::move(function)), .bounds = everywhere()}});
}

}  // namespace lancet::mesh
