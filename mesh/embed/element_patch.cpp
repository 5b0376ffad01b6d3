#include "lancet/mesh/embed/element_patch.hpp"

#include <algorithm>
#include <map>

#include "lancet/mesh/cut/element_cells.hpp"
#include "lancet/mesh/embed/inside_region.hpp"

namespace lancet::mesh {

namespace {

class Builder {
  public:
    Builder(const CutMesh& cut, std::int32_t element, const SurfaceFacets& facets)
        : cut_(cut), facets_(facets), parts_(cut.parts_of_element(element)) {
        if (const ElementCells* cells = cut.cells(element)) cells_ = *cells;
        pool_ = cells_.pool();
        const Tetrahedron& nodes = cut.mesh().tetrahedra()[static_cast<std::size_t>(element)];
        for (std::size_t k = 0; k < 4; ++k) at_rest_[k] = cut.mesh().nodes()[static_cast<std::size_t>(nodes[k])];
    }

    void add_triangle(std::int32_t triangle) {
        CutSurface surface = facets_.facet(triangle);
        const Facet& facet = surface.facets().front();
        if (!may_touch(facet, at_rest_)) return;
        PooledTriangle pooled{.triangle = triangle, .edges = facets_.edges_of(triangle)};
        pooled.plane = pool_.add_plane(facet.plane, at_rest_);
        for (std::size_t k = 0; k < 3; ++k) pooled.borders[k] = pool_.add_plane(facet.borders[k].plane, at_rest_);
        kept_.push_back(std::move(surface));
        triangles_.push_back(pooled);
        for (std::size_t c = 0; c < cells_.cells(); ++c) add_piece(pooled, c);
    }

    void add_sections(const std::function<bool(const Point&)>& is_inside) {
        struct Side {
            std::size_t cell, face;
        };
        std::map<int, std::array<std::vector<Side>, 2>> sides;
        for (std::size_t c = 0; c < cells_.cells(); ++c) {
            const Cell& cell = cells_.cell(c);
            for (std::size_t f = 0; f < cell.faces.size(); ++f) {
                const HalfSpace& half = cell.faces[f].half;
                if (cells_.is_cut(half.plane)) sides[half.plane][half.side > 0 ? 1 : 0].push_back({c, f});
            }
        }
        for (const auto& [plane, both] : sides) {
            for (const Side& above : both[1]) {
                for (const Side& below : both[0]) {
                    const std::int32_t part = part_of(above.cell), other = part_of(below.cell);
                    if (copies(part) == copies(other)) continue;  // nothing opens
                    Polygon section = polygon(cells_.cell(above.cell), above.face);
                    for (const HalfSpace& edge : polygon(cells_.cell(below.cell), below.face).edges) {
                        section = clip(pool_, section, edge);
                        if (section.points.empty()) break;
                    }
                    if (!section.points.empty()) add_wall(section, part, other, is_inside);
                }
            }
        }
    }

    void add_opened_faces(const std::function<bool(const Point&)>& is_inside) {
        for (std::size_t c = 0; c < cells_.cells(); ++c) {
            const Cell& cell = cells_.cell(c);
            for (std::size_t f = 0; f < cell.faces.size(); ++f) {
                const int plane = cell.faces[f].half.plane;
                if (plane >= 4 || cut_.face_state(part_of(c), plane) != CutMesh::FaceState::opened) continue;
                add_wall(polygon(cell, f), part_of(c), -1, is_inside);
            }
        }
    }

    ElementPatch take() { return std::move(patch_); }

  private:
    std::int32_t part_of(std::size_t cell) const { return parts_[static_cast<std::size_t>(cells_.part_of_cell(cell))]; }
    const Tetrahedron& copies(std::int32_t part) const { return cut_.parts()[static_cast<std::size_t>(part)]; }

    /// The corner at a point of the pool, once for each part.
    std::int32_t corner(std::int32_t part, int point, std::int32_t vertex, std::int32_t edge) {
        const auto [place, is_new] = numbers_.try_emplace({part, point}, 0);
        if (is_new) {
            place->second = static_cast<std::int32_t>(patch_.corners.size());
            patch_.corners.push_back({part, pool_.coordinates(point), vertex, edge});
        }
        return place->second;
    }

    /// What a cell has of a triangle.
    void add_piece(const PooledTriangle& triangle, std::size_t c) {
        const auto pieces = split(pool_, cells_.cell(c), triangle.plane);
        if (!pieces) return;
        // The lid of the inner piece is seen from outside of the surface.
        Polygon piece = polygon(pieces->first, pieces->first.faces.size() - 1);
        for (const int border : triangle.borders) {
            piece = clip(pool_, piece, {border, 1});
            if (piece.points.empty()) return;
        }
        const std::size_t count = piece.points.size();
        const auto border = [&](std::size_t k) {
            return std::ranges::find(triangle.borders, piece.edges[k % count].plane) - triangle.borders.begin();
        };
        const Triangle& vertices = facets_.surface().triangles[static_cast<std::size_t>(triangle.triangle)];
        std::vector<std::int32_t> loop;
        for (std::size_t k = 0; k < count; ++k) {
            // Point k lies between edges k - 1 and k; border b runs from corner b to the next.
            const auto before = border(k + count - 1), behind = border(k);
            std::int32_t vertex = -1, edge = -1;
            if (before < 3 && behind < 3) {
                vertex = vertices[static_cast<std::size_t>((before + 1) % 3 == behind ? behind : before)];
            } else if (before < 3 || behind < 3) {
                edge = triangle.edges[static_cast<std::size_t>(std::min(before, behind))];
            }
            loop.push_back(corner(part_of(c), piece.points[k], vertex, edge));
        }
        patch_.polygons.push_back({part_of(c), triangle.triangle, {std::move(loop)}});
    }

    Point at_rest(int point) const {
        Point place{};
        const Barycentric& weights = pool_.coordinates(point);
        for (std::size_t k = 0; k < 4; ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) place[axis] += weights[k] * at_rest_[k][axis];
        }
        return place;
    }

    /// The inside of a polygon as a wall of the part from which it is seen counter-clockwise from outside, and of the
    /// other one, if there is one.
    void add_wall(const Polygon& section, std::int32_t part, std::int32_t other,
                  const std::function<bool(const Point&)>& is_inside) {
        const auto is_border_inside = [&] {
            // All corners are on one side; one that is close to the surface may be misjudged.
            const auto inside = std::ranges::count_if(section.points, [&](int p) { return is_inside(at_rest(p)); });
            return 2 * static_cast<std::size_t>(inside) > section.points.size();
        };
        const auto loops = inside_region(pool_, section, triangles_, is_border_inside);
        if (!loops || loops->empty()) return;
        const auto add = [&](std::int32_t of, bool is_reversed) {
            ElementPatch::Polygon& wall = patch_.polygons.emplace_back();
            wall.part = of;
            for (const Loop& loop : *loops) {
                std::vector<std::int32_t>& numbers = wall.loops.emplace_back();
                for (const RegionCorner& at : loop) numbers.push_back(corner(of, at.point, -1, at.edge));
                if (is_reversed) std::ranges::reverse(numbers);
            }
        };
        add(part, false);
        if (other >= 0) add(other, true);
    }

    const CutMesh& cut_;
    const SurfaceFacets& facets_;
    std::vector<std::int32_t> parts_;
    ElementCells cells_;
    PlanePool pool_;
    std::array<Point, 4> at_rest_{};
    std::vector<CutSurface> kept_;  ///< which the pool refers to
    std::vector<PooledTriangle> triangles_;
    std::map<std::pair<std::int32_t, int>, std::int32_t> numbers_;
    ElementPatch patch_;
};

}  // namespace

ElementPatch element_patch(const CutMesh& cut, std::int32_t element, const SurfaceFacets& facets,
                           std::span<const std::int32_t> triangles,
                           const std::function<bool(const Point&)>& is_inside) {
    Builder builder(cut, element, facets);
    for (const std::int32_t triangle : triangles) builder.add_triangle(triangle);
    if (is_inside) {
        builder.add_sections(is_inside);
        builder.add_opened_faces(is_inside);
    }
    return builder.take();
}

}  // namespace lancet::mesh
