#include "lancet/mesh/cut/part_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "lancet/mesh/cut/element_cells.hpp"
#include "lancet/mesh/cut/front_line.hpp"

namespace lancet::mesh {

namespace {

class Builder {
  public:
    Builder(const CutMesh& cut, const FrontBlend& blend)
        : cut_(cut), blend_(blend), point_of_copy_(cut.node_of_copy().size(), -1) {}

    PartGeometry build() {
        for (std::size_t part = 0; part < cut_.parts().size(); ++part) {
            const std::int32_t element = cut_.element_of_part()[part];
            if (cut_.cells(element) == nullptr) add_whole(static_cast<std::int32_t>(part));
        }
        for (const std::int32_t element : cut_.touched_elements()) add_cells(element);
        return std::move(geometry_);
    }

  private:
    /// Where a copy is: parts that share it share the point.
    std::int32_t point_at(std::int32_t part, std::size_t corner) {
        std::int32_t& point =
            point_of_copy_[static_cast<std::size_t>(cut_.parts()[static_cast<std::size_t>(part)][corner])];
        if (point < 0) {
            point = static_cast<std::int32_t>(geometry_.points.size());
            MaterialPoint at{.part = part};
            at.weights[corner] = 1;
            geometry_.points.push_back(at);
        }
        return point;
    }

    std::int32_t add_point(const MaterialPoint& point, int side) {
        const auto number = static_cast<std::int32_t>(geometry_.points.size());
        geometry_.points.push_back(point);
        if (blend_.opening(point.part) != nullptr) {
            geometry_.opened.push_back({number, blend_.hold(cut_, point, side)});
        }
        return number;
    }

    /// The side of a blended front on which a cell lies.
    static int side_of(const Cell& cell, const PlanePool& pool, const PartOpening& opening) {
        double sum = 0;
        for (const Cell::Face& face : cell.faces) {
            for (const int point : face.points) sum += opening.guide_at(pool.coordinates(point));
        }
        return sum < 0 ? -1 : 1;
    }

    /// The side of one of its points: on the plane of the cut, that of the cell; 0 where the cut ends.
    static int side_of(const Barycentric& place, int side_of_cell, const PartOpening& opening, const FrontLine& front) {
        double largest = 0;
        for (const double value : opening.guide) largest = std::max(largest, std::abs(value));
        const double value = opening.guide_at(place);
        if (std::abs(value) > 1e-9 * largest) return value < 0 ? -1 : 1;
        return front.holds(place) ? 0 : side_of_cell;
    }

    void add_triangle(const Triangle& triangle, std::int32_t part, bool is_wall) {
        geometry_.triangles.push_back(triangle);
        geometry_.part_of_triangle.push_back(part);
        geometry_.is_wall.push_back(is_wall ? 1 : 0);
    }

    void add_whole(std::int32_t part) {
        Tetrahedron corners{};
        for (std::size_t k = 0; k < 4; ++k) corners[k] = point_at(part, k);
        geometry_.tetrahedra.push_back(corners);
        geometry_.part_of_tetrahedron.push_back(part);
        for (std::size_t k = 0; k < 4; ++k) {
            const CutMesh::FaceState state = cut_.face_state(part, static_cast<int>(k));
            if (state == CutMesh::FaceState::joined) continue;
            const auto& [a, b, c] = opposite_faces[k];
            add_triangle({corners[a], corners[b], corners[c]}, part, state == CutMesh::FaceState::opened);
        }
    }

    void add_cells(std::int32_t element) {
        const ElementCells& cells = *cut_.cells(element);
        const PlanePool& pool = cells.pool();
        const std::vector<std::int32_t> parts = cut_.parts_of_element(element);
        std::map<std::tuple<std::int32_t, int, int>, std::int32_t> numbers;  // by part, point and side
        const bool is_open =
            std::ranges::any_of(parts, [&](std::int32_t part) { return blend_.opening(part) != nullptr; });
        const std::optional<FrontLine> front = is_open ? std::optional(FrontLine(cut_, element)) : std::nullopt;
        for (std::size_t c = 0; c < cells.cells(); ++c) {
            const Cell& cell = cells.cell(c);
            const std::int32_t part = parts[static_cast<std::size_t>(cells.part_of_cell(c))];
            const PartOpening* opening = blend_.opening(part);
            const int side_of_cell = opening == nullptr ? 1 : side_of(cell, pool, *opening);
            const auto number = [&](int point) {
                const Barycentric& weights = pool.coordinates(point);
                const int side = opening == nullptr ? 1 : side_of(weights, side_of_cell, *opening, *front);
                const auto [place, is_new] = numbers.try_emplace({part, point, side}, 0);
                if (!is_new) return place->second;
                const auto corner = static_cast<std::size_t>(std::ranges::find(weights, 1.0) - weights.begin());
                const bool is_copy = corner < 4 && (opening == nullptr || opening->corners[corner].openness == 0 ||
                                                    opening->corners[corner].near_side == side);
                return place->second = is_copy ? point_at(part, corner) : add_point({part, weights}, side);
            };
            const int apex = cell.faces.front().points.front();
            for (const Cell::Face& face : cell.faces) {
                const int plane = face.half.plane;
                const bool is_cut = cells.is_cut(plane);
                const auto state = plane < 4 ? cut_.face_state(part, plane) : CutMesh::FaceState::joined;
                const bool is_outside = is_cut || state != CutMesh::FaceState::joined;
                const bool holds_apex = std::ranges::find(face.points, apex) != face.points.end();
                for (std::size_t k = 2; k < face.points.size(); ++k) {
                    const Triangle triangle{number(face.points[0]), number(face.points[k - 1]), number(face.points[k])};
                    if (is_outside) {
                        add_triangle(triangle, part, is_cut || state == CutMesh::FaceState::opened);
                    }
                    if (holds_apex) continue;
                    geometry_.tetrahedra.push_back({triangle[0], triangle[2], triangle[1], number(apex)});
                    geometry_.part_of_tetrahedron.push_back(part);
                }
            }
        }
    }

    const CutMesh& cut_;
    const FrontBlend& blend_;
    PartGeometry geometry_;
    std::vector<std::int32_t> point_of_copy_;
};

}  // namespace

PartGeometry part_geometry(const CutMesh& cut, const FrontBlend& blend) {
    return Builder(cut, blend).build();
}

std::vector<Point> place(const PartGeometry& geometry, const CutMesh& cut, std::span<const Point> positions) {
    std::vector<Point> places;
    places.reserve(geometry.points.size());
    for (const MaterialPoint& point : geometry.points) {
        Point at{};
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const Point& x =
                positions[static_cast<std::size_t>(cut.parts()[static_cast<std::size_t>(point.part)][corner])];
            for (std::size_t axis = 0; axis < 3; ++axis) at[axis] += point.weights[corner] * x[axis];
        }
        places.push_back(at);
    }
    for (const PartGeometry::OpenedPoint& opened : geometry.opened) {
        places[static_cast<std::size_t>(opened.point)] = opened.hold.place(positions);
    }
    return places;
}

}  // namespace lancet::mesh
