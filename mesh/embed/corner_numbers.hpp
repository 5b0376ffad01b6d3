#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"

namespace lancet::mesh {

/// Barycentric coordinates that differ by less are those of one point, and a smaller one is zero: far more than
/// rounding makes of a point that is computed in two elements, and than vertices are moved by (see SurfaceFacets).
inline constexpr double same_weight = 0x1p-24;

/// Numbers points of the material: points are one where they are in the same place whatever the body does, that is,
/// where they have the same weights on the same copies.
class CornerNumbers {
  public:
    explicit CornerNumbers(const CutMesh& cut) : cut_(cut) {}

    /// The number given to this point before, or -1.
    std::int32_t find(const MaterialPoint& point) const;
    /// Gives a point a number, also where another one has the same place.
    void add(const MaterialPoint& point, std::int32_t number);

  private:
    struct Place {
        std::array<std::int32_t, 4> copies{-1, -1, -1, -1};  ///< sorted; -1 where the weight is zero
        std::array<double, 4> weights{};
    };
    struct Entry {
        std::array<double, 4> weights{};
        std::int32_t number;
    };
    Place place_of(const MaterialPoint& point) const;

    const CutMesh& cut_;
    std::map<std::array<std::int32_t, 4>, std::vector<Entry>> entries_;
};

}  // namespace lancet::mesh
