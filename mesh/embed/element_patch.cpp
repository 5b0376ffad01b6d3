#include "lancet/mesh/embed/element_patch.hpp"

#include <algorithm>
#include <map>

#include "lancet/mesh/cut/element_cells.hpp"
#include "lancet/mesh/embed/patch_builder.hpp"

namespace lancet::mesh {

namespace {

std::array<Point, 4> corners_at_rest(const TetMesh& mesh, std::int32_t element) {
    const Tetrahedron& nodes = mesh.tetrahedra()[static_cast<std::size_t>(element)];
    std::array<Point, 4> corners{};
    for (std::size_t k = 0; k < 4; ++k) corners[k] = mesh.nodes()[static_cast<std::size_t>(nodes[k])];
    return corners;
}

class Builder {
  public:
    Builder(const CutMesh& cut, std::int32_t element, SurfaceFacets& facets)
        : cut_(cut),
          facets_(facets),
          parts_(cut.parts_of_element(element)),
          cells_(cut.cells(element) != nullptr ? *cut.cells(element) : ElementCells()),
          builder_(cells_.pool(), corners_at_rest(cut.mesh(), element)),
          pool_(builder_.pool()) {}

    void add_triangle(std::int32_t triangle) {
        const PooledTriangle* pooled = builder_.add_triangle(facets_, triangle);
        if (pooled == nullptr) return;
        for (std::size_t c = 0; c < cells_.cells(); ++c) add_piece(*pooled, c);
    }

    void add_sections(const Inside& is_inside) {
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
                    if (!section.points.empty()) builder_.add_wall(section, {part}, {other}, is_inside);
                }
            }
        }
    }

    ElementPatch take() { return std::move(builder_.patch()); }

  private:
    std::int32_t part_of(std::size_t cell) const { return parts_[static_cast<std::size_t>(cells_.part_of_cell(cell))]; }
    const Tetrahedron& copies(std::int32_t part) const { return cut_.parts()[static_cast<std::size_t>(part)]; }

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
            loop.push_back(
                builder_.corner(part_of(c), piece.points[k], pool_.coordinates(piece.points[k]), vertex, edge));
        }
        builder_.patch().polygons.push_back({part_of(c), triangle.triangle, {std::move(loop)}});
    }

    const CutMesh& cut_;
    SurfaceFacets& facets_;
    std::vector<std::int32_t> parts_;
    ElementCells cells_;
    PatchBuilder builder_;
    PlanePool& pool_;
};

}  // namespace

ElementPatch element_patch(const CutMesh& cut, std::int32_t element, SurfaceFacets& facets,
                           std::span<const std::int32_t> triangles, const Inside& is_inside) {
    Builder builder(cut, element, facets);
    for (const std::int32_t triangle : triangles) builder.add_triangle(triangle);
    if (is_inside) builder.add_sections(is_inside);
    return builder.take();
}

}  // namespace lancet::mesh
