#include <algorithm>

#include "lancet/mesh/cut/face_joints.hpp"
#include "lancet/mesh/embed/element_patch.hpp"
#include "lancet/mesh/embed/patch_builder.hpp"

namespace lancet::mesh {

namespace {

/// A face between two elements: its corners in both, in one order, and the corner opposite to it behind.
struct FaceCorners {
    std::array<int, 4> first{}, second{};
};

FaceCorners face_corners(const Tetrahedron& a, const Tetrahedron& b) {
    FaceCorners corners;
    std::size_t count = 0;
    for (int k = 0; k < 4; ++k) {
        const auto other = std::ranges::find(b, a[static_cast<std::size_t>(k)]) - b.begin();
        const std::size_t at = other < 4 ? count++ : 3;
        corners.first[at] = k;
        corners.second[at] = static_cast<int>(other);
    }
    corners.second[3] = 6 - corners.second[0] - corners.second[1] - corners.second[2];
    return corners;
}

}  // namespace

ElementPatch face_patch(const CutMesh& cut, std::int32_t element, std::int32_t neighbour, SurfaceFacets& facets,
                        std::span<const std::int32_t> triangles, const Inside& is_inside) {
    const Tetrahedron& nodes = cut.mesh().tetrahedra()[static_cast<std::size_t>(element)];
    const FaceCorners corners = face_corners(nodes, cut.mesh().tetrahedra()[static_cast<std::size_t>(neighbour)]);
    const std::vector<std::int32_t> parts = cut.parts_of_element(element), others = cut.parts_of_element(neighbour);
    // Where the copies are the same nothing can open.
    const auto may_open = [&](std::int32_t part, std::int32_t other) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (cut.parts()[static_cast<std::size_t>(part)][static_cast<std::size_t>(corners.first[k])] !=
                cut.parts()[static_cast<std::size_t>(other)][static_cast<std::size_t>(corners.second[k])]) {
                return true;
            }
        }
        return false;
    };
    if (std::ranges::none_of(
            parts, [&](auto p) { return std::ranges::any_of(others, [&](auto q) { return may_open(p, q); }); })) {
        return {};
    }

    std::array<Point, 4> at_rest{};
    for (std::size_t k = 0; k < 4; ++k) {
        at_rest[k] = cut.mesh().nodes()[static_cast<std::size_t>(nodes[static_cast<std::size_t>(corners.first[k])])];
    }
    PatchBuilder builder(PlanePool{}, at_rest);
    const FaceSide side{.cells = cut.cells(element),
                        .face = corners.first[3],
                        .corners = {corners.first[0], corners.first[1], corners.first[2]}};
    const FaceSide behind{.cells = cut.cells(neighbour),
                          .face = corners.second[3],
                          .corners = {corners.second[0], corners.second[1], corners.second[2]}};
    const std::vector<FacePiece> pieces = face_pieces(builder.pool(), side),
                                 pieces_behind = face_pieces(builder.pool(), behind);
    struct Opened {
        Polygon polygon;
        std::int32_t part, other;
    };
    std::vector<Opened> opened;
    for (const FacePiece& a : pieces) {
        for (const FacePiece& b : pieces_behind) {
            const std::int32_t part = parts[static_cast<std::size_t>(a.part)],
                               other = others[static_cast<std::size_t>(b.part)];
            if (!may_open(part, other)) continue;
            Polygon common = a.polygon;
            for (const HalfSpace& edge : b.polygon.edges) {
                common = clip(builder.pool(), common, edge);
                if (common.points.empty()) break;
            }
            if (!common.points.empty()) opened.push_back({std::move(common), part, other});
        }
    }
    if (opened.empty()) return {};
    for (const std::int32_t triangle : triangles) builder.add_triangle(facets, triangle);
    for (const Opened& wall : opened) {
        builder.add_wall(wall.polygon, {wall.part, corners.first}, {wall.other, corners.second}, is_inside);
    }
    return std::move(builder.patch());
}

}  // namespace lancet::mesh
