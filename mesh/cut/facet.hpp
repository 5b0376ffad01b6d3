#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "lancet/mesh/cut/numbers.hpp"
#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// An affine function of the place, normal . (x - origin), or any other whose values at nodes are taken as they come.
/// Its zeros are a plane.
class Plane {
  public:
    using Normal = std::array<Exact, 3>;

    /// `vertices`, at most three and all different, are places that lie in the plane exactly.
    Plane(const Point& origin, const Normal& normal, std::span<const Point> vertices = {});
    explicit Plane(std::function<double(const Point&)> function) : function_(std::move(function)) {}

    /// These throw lancet::Error where a function's value is not finite.
    Bounded value(const Point& place) const;
    Extended extended(const Point& place) const;
    Exact exact(const Point& place) const;
    /// The sign of the value where it is quickly told; 0 where it is not.
    int quick_sign(const Point& place) const;
    /// Vertices of a surface that are known to lie in the plane.
    std::span<const Point> vertices() const noexcept { return {vertices_.data(), vertex_count_}; }
    /// True where the values are those of a function that was given.
    bool is_function() const noexcept { return static_cast<bool>(function_); }

  private:
    double function_value(const Point& place) const;

    Point origin_{};
    Normal normal_{};
    std::array<Bounded, 3> rounded_normal_{};
    std::array<Extended, 3> extended_normal_{};
    std::array<Point, 3> vertices_{};
    std::size_t vertex_count_ = 0;
    bool is_normal_ = true;  ///< no number of the normal vector is below what doubles hold with all digits
    std::function<double(const Point&)> function_{};
};

/// A flat piece of a cut surface: where the plane's function is zero and no border's negative.
struct Facet {
    Plane plane;
    struct Border {
        Plane plane;
        bool is_outer = true;  ///< false: another facet of the surface goes on behind it
    };
    std::vector<Border> borders{};
    /// A box around the facet, somewhat larger than needed; infinite where the facet is.
    using Box = std::array<Point, 2>;
    Box bounds;
};

/// The smallest box around two.
Facet::Box united(const Facet::Box& a, const Facet::Box& b);
/// True where two boxes have no place in common.
bool are_apart(const Facet::Box& a, const Facet::Box& b);
/// False where the facet neither crosses the tetrahedron nor touches it. True may be wrong.
bool may_touch(const Facet& facet, const std::array<Point, 4>& corners);
/// All that may touch the tetrahedron, in their order.
std::vector<const Facet*> facets_near(std::span<const Facet> facets, const std::array<Point, 4>& corners);

}  // namespace lancet::mesh
