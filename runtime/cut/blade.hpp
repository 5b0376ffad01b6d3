#pragma once

#include <optional>
#include <vector>

#include "lancet/runtime/cut/cuttable_body.hpp"

namespace lancet::runtime {

/// A straight blade that cuts what it is drawn through, while the body moves under it.
///
/// A stroke is swept through the material: it starts where the blade's edge was in the material before, not where that
/// place is in space, so that strokes leave no uncut gap between them however the body has moved since. The edge is
/// taken to the rest configuration at `segments` + 1 of its points, and is straight between them there. A point
/// outside of the body goes along with the element that is nearest.
///
/// A hand is asked far more often than it gets anywhere: strokes are gathered until a point of the edge has moved by
/// `shortest_stroke` through the material, and then cut as one. So a slow cut does not crush an element into thousands
/// of facets that separate nothing; what is less when the blade is lifted is not cut.
class Blade {
  public:
    /// Throws lancet::Error for less than one segment, and a shortest stroke that is negative or not finite.
    explicit Blade(int segments = 8, double shortest_stroke = 0);

    /// Puts the edge somewhere, without cutting. Throws lancet::Error for places that are not finite.
    void place(const CuttableBody& body, const Point& heel, const Point& tip);
    /// Moves the edge to a place, and tells what it sweeps through the material on the way: a surface at rest. Nothing
    /// on the first call, and where the edge has not moved by the shortest stroke since the last.
    std::optional<mesh::CutSurface> sweep(const CuttableBody& body, const Point& heel, const Point& tip);
    /// Draws the edge on to a place, from where it was last, and cuts what lies between; the first call only places it.
    CutUpdate draw(CuttableBody& body, Scheduler& scheduler, const Point& heel, const Point& tip);
    /// Takes the blade away: the next draw starts anew.
    void lift() noexcept { edge_.clear(); }
    bool is_lifted() const noexcept { return edge_.empty(); }

  private:
    int segments_;
    double shortest_stroke_;   ///< m
    std::vector<Point> edge_;  ///< at rest
};

/// Where the material that is now at some places is at rest; outside of the body, as if the nearest element went on.
std::vector<Point> rest_places(const CuttableBody& body, std::span<const Point> positions,
                               std::span<const Point> places);

}  // namespace lancet::runtime
