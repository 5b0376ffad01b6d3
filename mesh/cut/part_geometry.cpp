#include "lancet/mesh/cut/part_geometry.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "lancet/mesh/cut/element_cells.hpp"

namespace lancet::mesh {

namespace {

class Builder {
  public:
    explicit Builder(const CutMesh& cut) : cut_(cut), point_of_copy_(cut.node_of_copy().size(), -1) {}

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
        std::map<std::pair<std::int32_t, int>, std::int32_t> numbers;
        for (std::size_t c = 0; c < cells.cells(); ++c) {
            const Cell& cell = cells.cell(c);
            const std::int32_t part = parts[static_cast<std::size_t>(cells.part_of_cell(c))];
            const auto number = [&](int point) {
                const auto [place, is_new] = numbers.try_emplace({part, point}, 0);
                if (!is_new) return place->second;
                const Barycentric& weights = pool.coordinates(point);
                const auto corner = std::ranges::find(weights, 1.0) - weights.begin();
                if (corner < 4) return place->second = point_at(part, static_cast<std::size_t>(corner));
                place->second = static_cast<std::int32_t>(geometry_.points.size());
                geometry_.points.push_back({part, weights});
                return place->second;
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
    PartGeometry geometry_;
    std::vector<std::int32_t> point_of_copy_;
};

}  // namespace

PartGeometry part_geometry(const CutMesh& cut) {
    return Builder(cut).build();
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
    return places;
}

}  // namespace lancet::mesh
