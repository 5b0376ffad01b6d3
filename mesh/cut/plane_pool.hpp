#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lancet/mesh/cut/facet.hpp"
#include "lancet/mesh/cut/part_moments.hpp"

namespace lancet::mesh {

/// Planes and points of one tetrahedron in barycentric coordinates. A plane is what an affine function takes for
/// values at the four corners; a point is where three planes meet. On which side of a plane a point lies is decided
/// exactly: with bounded rounding errors first, in integers where these do not suffice. The values at the corners of a
/// face, and so all decisions about what lies in it, are the same in both elements that share it.
///
/// Facets of a surface meet along edges and in vertices, where more than three planes go through one point. No rounding
/// error is small enough to tell that; it is known from the vertices that planes have in common.
class PlanePool {
  public:
    /// Planes 0 to 3 are the faces opposite the corners: the functions that are one at a corner and zero at the others.
    PlanePool();

    /// The plane of `source`, whose values are taken at `corners`; `source` must outlive the pool. Returns its number.
    int add_plane(const Plane& source, const std::array<Point, 4>& corners);
    /// The plane of a function that has exactly these values at the corners. Returns its number.
    int add_values(const std::array<double, 4>& values);
    /// The trace of a plane of another pool on the face with the corners `face` there: its values at these three become
    /// those at corners 0, 1, 2, and that at corner 3 is zero. Returns its number, or that of a trace which is there
    /// already: both elements of a face have those of the cuts that run through it, and what lies on them is then known
    /// without arithmetic.
    int add_trace(const PlanePool& other, int plane, const std::array<int, 3>& face);
    /// The point in which three planes meet, which must exist and lie in the tetrahedron. Returns its number.
    /// `find_or_add_point` looks whether it is there already, among all points.
    int find_or_add_point(const std::array<int, 3>& planes);
    int add_point(const std::array<int, 3>& planes);
    /// Takes back the last points: as many are left.
    void keep_points(int count) { points_.resize(static_cast<std::size_t>(count)); }

    int planes() const noexcept { return static_cast<int>(planes_.size()); }
    int points() const noexcept { return static_cast<int>(points_.size()); }
    /// -1, 0 or +1: the side of the plane on which the point lies.
    int side(int plane, int point) const;
    /// -1, 0 or +1: the sign of the plane's value at a corner.
    int side_of_corner(int plane, int corner) const;
    /// The values of a plane's function at the corners, rounded.
    std::array<double, 4> values(int plane) const;
    /// The plane's function at a place, relative to its largest value at a corner; rounded.
    double value(int plane, const Barycentric& place) const;
    /// To nearly full relative precision, and exactly zero where they are.
    const Barycentric& coordinates(int point) const { return points_[static_cast<std::size_t>(point)].coordinates; }

    /// The volume of the tetrahedron with these points as corners over that of the pool's, to a relative 2^-30 however
    /// thin it is.
    double volume_fraction(const std::array<int, 4>& points) const;

  private:
    /// Four numbers of a plane or a point in higher precision, once they were asked for.
    template <class Number>
    using Kept = std::shared_ptr<const std::array<Number, 4>>;
    struct StoredPlane {
        const Plane* source = nullptr;  ///< nothing where the values are exact
        int frame = -1;                 ///< the corners at which its values were taken
        std::array<bool, 4> is_kept{};  ///< false: the value at the corner is zero whatever the source says
        bool is_precise = true;         ///< all values are
        double error = 0;  ///< the largest of a value in proportion to it; infinite where products may leave the range
        std::array<int, 3> vertices{-1, -1, -1};  ///< that lie in it, as far as they are known
        std::array<Bounded, 4> values{};
        mutable Kept<Extended> extended{};
        mutable Kept<Exact> exact{};
    };
    struct StoredPoint {
        std::array<int, 3> planes{};
        bool is_precise = true;            ///< all weights are
        std::array<Bounded, 4> weights{};  ///< homogeneous coordinates, their sum positive
        Barycentric coordinates{};
        mutable Kept<Extended> extended{};  ///< weights
        mutable Kept<Exact> exact{};        ///< weights
    };
    /// A vertex of a surface, and the corners of the tetrahedron beside which it has that place.
    struct Vertex {
        Point place{};
        int frame = -1;
    };
    const StoredPlane& plane(int number) const { return planes_[static_cast<std::size_t>(number)]; }
    int number_of_frame(const std::array<Point, 4>& corners);
    void take_vertices(StoredPlane& plane);
    static void set_error(StoredPlane& plane);
    bool find_weights(StoredPoint& point) const;
    const std::array<Extended, 4>& extended_values(int plane) const;
    const std::array<Exact, 4>& exact_values(int plane) const;
    const std::array<Extended, 4>& extended_weights(const StoredPoint& point) const;
    const std::array<Exact, 4>& exact_weights(const StoredPoint& point) const;
    double extended_volume_fraction(const std::array<int, 4>& points) const;
    double exact_volume_fraction(const std::array<int, 4>& points) const;
    bool meet_in_vertices(const StoredPlane& plane, const StoredPoint& point) const;
    int find_side(int plane, int point) const;

    std::vector<StoredPlane> planes_;
    std::vector<StoredPoint> points_;
    std::vector<std::array<Point, 4>> frames_;
    std::vector<Vertex> vertices_;
};

}  // namespace lancet::mesh
