#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lancet/mesh/cut/cut_surface.hpp"
#include "lancet/mesh/surface/triangle_mesh.hpp"

namespace lancet::mesh {

/// A surface as facets that can be intersected with cells of elements, and its edges.
///
/// Nothing of the surface may lie exactly in a plane of a cut or of a face, or a decision had more than two outcomes.
/// So what is intersected is a copy whose vertices are moved by up to 2^-36 of the surface's size, differently and
/// always in the same way; on this copy every decision is exact. Areas and places of what comes out are right to a few
/// 2^-36, and the vertices themselves stay where they are.
class SurfaceFacets {
  public:
    /// @throws lancet::Error for an invalid surface, and for edges of more than two triangles. Triangles with a
    /// repeated vertex are left out.
    explicit SurfaceFacets(TriangleMesh surface);

    const TriangleMesh& surface() const noexcept { return surface_; }
    /// The copy that is intersected.
    const TriangleMesh& moved() const noexcept { return moved_; }
    /// A triangle of the copy as one facet: its border k stands on the edge from corner k to the next. It is made when
    /// it is first asked for.
    const CutSurface& facet(std::int32_t triangle);
    /// The numbers of these edges.
    const std::array<std::int32_t, 3>& edges_of(std::int32_t triangle) const {
        return edges_of_[static_cast<std::size_t>(triangle)];
    }
    std::size_t edges() const noexcept { return triangles_of_.size(); }
    /// The one or two triangles of an edge; -1 for none.
    const std::array<std::int32_t, 2>& triangles_of(std::int32_t edge) const {
        return triangles_of_[static_cast<std::size_t>(edge)];
    }
    /// Closed and consistently oriented: it has an inside.
    bool is_closed() const noexcept { return is_closed_; }

  private:
    TriangleMesh surface_, moved_;
    std::vector<std::optional<CutSurface>> facets_;
    std::vector<std::array<std::int32_t, 3>> edges_of_;
    std::vector<std::array<std::int32_t, 2>> triangles_of_;
    bool is_closed_ = false;
};

}  // namespace lancet::mesh
