#include "lancet/mesh/cut/front_line.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lancet/mesh/cut/element_cells.hpp"

namespace lancet::mesh {

namespace {

constexpr double tolerance = 1e-9;

/// Three of the barycentric coordinates: affine, so lines, planes and insides are what they are in space.
std::array<double, 3> difference(const Barycentric& a, const Barycentric& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

std::array<double, 3> cross(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double length(const std::array<double, 3>& a) {
    return std::sqrt(dot(a, a));
}

/// Whether a place lies in a plane convex polygon, or on its border.
bool holds(const std::vector<Barycentric>& polygon, const Barycentric& place) {
    std::array<double, 3> normal{};
    for (std::size_t k = 2; k < polygon.size(); ++k) {
        const auto part = cross(difference(polygon[k - 1], polygon[0]), difference(polygon[k], polygon[0]));
        for (std::size_t axis = 0; axis < 3; ++axis) normal[axis] += part[axis];
    }
    const double size = length(normal);
    if (size == 0) return false;
    if (std::abs(dot(normal, difference(place, polygon[0]))) > tolerance * size) return false;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const auto edge = difference(polygon[(k + 1) % polygon.size()], polygon[k]);
        if (dot(cross(edge, difference(place, polygon[k])), normal) < -tolerance * size * length(edge)) return false;
    }
    return true;
}

/// The element behind the face opposite a corner.
std::optional<std::int32_t> neighbour(const CutMesh& cut, std::int32_t element, std::size_t corner) {
    const Tetrahedron& nodes = cut.mesh().tetrahedra()[static_cast<std::size_t>(element)];
    for (const std::int32_t other : cut.star(nodes[(corner + 1) % 4])) {
        const Tetrahedron& theirs = cut.mesh().tetrahedra()[static_cast<std::size_t>(other)];
        const auto has = [&](std::size_t k) { return std::ranges::find(theirs, nodes[k]) != theirs.end(); };
        if (other != element && has((corner + 2) % 4) && has((corner + 3) % 4)) return other;
    }
    return std::nullopt;
}

/// A place of a face by the coordinates of the other element that has the face.
Barycentric seen_from(const CutMesh& cut, std::int32_t element, std::int32_t other, const Barycentric& place) {
    const Tetrahedron &nodes = cut.mesh().tetrahedra()[static_cast<std::size_t>(element)],
                      &theirs = cut.mesh().tetrahedra()[static_cast<std::size_t>(other)];
    Barycentric seen{};
    for (std::size_t k = 0; k < 4; ++k) {
        const auto found = std::ranges::find(theirs, nodes[k]);
        if (found != theirs.end()) seen[static_cast<std::size_t>(found - theirs.begin())] = place[k];
    }
    return seen;
}

}  // namespace

FrontLine::FrontLine(const CutMesh& cut, std::int32_t element) {
    const std::vector<ElementCells::Section> sections = cut.cells(element)->sections();
    const auto goes_on = [](const std::vector<ElementCells::Section>& all, const Barycentric& middle,
                            const ElementCells::Section* own) {
        return std::ranges::any_of(
            all, [&](const auto& section) { return &section != own && mesh::holds(section.corners, middle); });
    };
    for (const ElementCells::Section& section : sections) {
        for (std::size_t k = 0; k < section.corners.size(); ++k) {
            const Barycentric &a = section.corners[k], &b = section.corners[(k + 1) % section.corners.size()];
            Barycentric middle{};
            for (std::size_t i = 0; i < 4; ++i) middle[i] = (a[i] + b[i]) / 2;
            const auto face = static_cast<std::size_t>(std::ranges::find(middle, 0.0) - middle.begin());
            if (face == 4) {
                if (!goes_on(sections, middle, &section)) edges_.push_back({a, b});
                continue;
            }
            const std::optional<std::int32_t> other = neighbour(cut, element, face);
            if (!other) continue;
            const ElementCells* cells = cut.cells(*other);
            if (cells == nullptr || !goes_on(cells->sections(), seen_from(cut, element, *other, middle), nullptr)) {
                edges_.push_back({a, b});
            }
        }
    }
}

bool FrontLine::holds(const Barycentric& place) const {
    return std::ranges::any_of(edges_, [&](const std::array<Barycentric, 2>& edge) {
        const auto along = difference(edge[1], edge[0]), to = difference(place, edge[0]);
        const double square = dot(along, along);
        const double t = square > 0 ? std::clamp(dot(along, to) / square, 0.0, 1.0) : 0;
        return length({to[0] - t * along[0], to[1] - t * along[1], to[2] - t * along[2]}) <= tolerance;
    });
}

}  // namespace lancet::mesh
