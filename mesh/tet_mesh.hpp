#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace lancet::mesh {

/// A place in space, in metres unless a mesh says otherwise.
using Point = std::array<double, 3>;
/// Node numbers of a linear tetrahedron.
using Tetrahedron = std::array<std::int32_t, 4>;
/// Node numbers of a triangle.
using Triangle = std::array<std::int32_t, 3>;

/// The corners of the face opposite each corner of a tetrahedron of positive volume, counter-clockwise as seen from
/// outside.
inline constexpr std::array<Triangle, 4> opposite_faces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// Signed volume det(b - a, c - a, d - a) / 6: positive where d lies on the side of the triangle a, b, c that its
/// right-handed normal points to.
double signed_volume(const Point& a, const Point& b, const Point& c, const Point& d);
/// Barycentric coordinates of a place with respect to the corners of a tetrahedron, also outside of it. Not finite
/// where it is flat.
std::array<double, 4> barycentric(const std::array<Point, 4>& corners, const Point& place);
/// The area of a triangle.
double area(const Point& a, const Point& b, const Point& c);

/// A valid mesh of linear tetrahedra; it does not change after construction.
///
/// Valid means: finite coordinates; node numbers in range and distinct within an element; every volume positive and
/// not flat (see inspect.hpp for the criterion); no two elements with the same nodes; every node used by an element;
/// one region per element; node sets in range.
class TetMesh {
  public:
    /// What a mesh is made of, not yet checked.
    struct Definition {
        std::vector<Point> nodes{};
        std::vector<Tetrahedron> tetrahedra{};
        /// One number per tetrahedron, by which materials are chosen; empty: all in region 0.
        std::vector<std::int32_t> regions{};
        /// Named sets of nodes. The order and repetition of entries mean nothing.
        std::map<std::string, std::vector<std::int32_t>> node_sets{};
        /// Names of regions, where they have one.
        std::map<int, std::string> region_names{};
    };

    /// The mesh without nodes and elements.
    TetMesh() = default;

    /// Checks the definition; sorts node sets and removes repeated entries.
    /// @throws lancet::Error with everything found (see inspect.hpp) in one line.
    explicit TetMesh(Definition definition);

    std::span<const Point> nodes() const { return definition_.nodes; }
    std::span<const Tetrahedron> tetrahedra() const { return definition_.tetrahedra; }
    /// One region number per tetrahedron (never empty, unless the mesh is).
    std::span<const std::int32_t> regions() const { return definition_.regions; }
    /// Sorted node numbers by name.
    const std::map<std::string, std::vector<std::int32_t>>& node_sets() const { return definition_.node_sets; }
    const std::map<int, std::string>& region_names() const { return definition_.region_names; }
    /// Everything the mesh was made of, to make another one from.
    const Definition& definition() const { return definition_; }

    /// The nodes of a set. @throws lancet::Error that lists the sets there are.
    std::span<const std::int32_t> node_set(const std::string& name) const;

    /// Volume of one tetrahedron; positive.
    double volume(std::int32_t tetrahedron) const;
    /// Sum of all volumes.
    double volume() const;

    /// The smallest axis-aligned box around the nodes: lower and upper corner. Both zero for an empty mesh.
    std::array<Point, 2> bounds() const;

  private:
    Definition definition_;
};

}  // namespace lancet::mesh
