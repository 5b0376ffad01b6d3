#pragma once

#include <vector>

#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/collide/collidable_body.hpp"

namespace lancet::runtime::testing {

/// A surface to touch: where it is, and the broad phase over it.
struct Surface {
    std::vector<Point> positions;
    std::vector<mesh::Triangle> triangles;
    std::unique_ptr<BroadPhase> boxes = make_broad_phase(BroadPhaseKind::aabb_tree);

    void update() {
        std::vector<Box> all(triangles.size());
        boxes_around(std::span<const Point>(positions), std::span<const mesh::Triangle>(triangles), 0, all);
        boxes->build(all);
    }
};

inline Surface surface_of(const mesh::TetMesh& mesh) {
    Surface surface{{mesh.nodes().begin(), mesh.nodes().end()}, mesh::boundary(mesh).triangles};
    surface.update();
    return surface;
}

inline CollidableBody collidable(const mesh::TetMesh& mesh, BroadPhaseKind kind = BroadPhaseKind::aabb_tree) {
    CollidableBody body(mesh.nodes().size(), mesh.tetrahedra(), mesh::boundary(mesh).triangles, kind);
    body.update(mesh.nodes());
    return body;
}

}  // namespace lancet::runtime::testing
