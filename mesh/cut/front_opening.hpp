#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/cut/element_cells.hpp"
#include "lancet/mesh/cut/front_blend.hpp"

namespace lancet::mesh {

/// The copies at the fronts of cuts that open, how far, and what the elements around them come to; see lanes.hpp.
class FrontOpening {
  public:
    /// A piece of an element in one of the states that are blended.
    struct Piece {
        Tetrahedron copies;
        PartMoments moments;
        double weight;  ///< the length of its interval of thresholds
    };

    explicit FrontOpening(const CutMesh& cut);

    /// The copies that open; the k-th one's far side is copy node_of_copy().size() + k.
    const std::vector<std::int32_t>& opened_from() const noexcept { return opened_from_; }
    /// The pieces of all elements around opening copies.
    std::map<std::int32_t, std::vector<Piece>> pieces() const;
    /// What of each part around opening copies is open, in the order of the parts.
    std::map<std::int32_t, PartOpening> openings() const;

  private:
    /// A plane of a cut by the values of its function at the corners of an element.
    struct Guide {
        std::int32_t element = -1;
        std::array<double, 4> values{};
    };
    /// A copy in which two sides of a cut meet.
    struct Front {
        Guide guide{};         ///< the cut that comes nearest
        double cut = 0;        ///< int phi over what is cut of the sections around it, square metres; 0: stays closed
        double left = 0;       ///< over what is not
        std::int32_t far = 0;  ///< the copy of the far side
        double openness() const { return cut > 0 ? cut / (cut + left) : 0; }
    };
    /// A part of an element around a front, or what a guide's plane leaves of it on one side.
    struct Side {
        std::int32_t part;
        PartMoments moments;
        int side;  ///< of the element's guide; 0 where there is no volume to tell
    };
    struct Region {
        Guide guide{};
        std::vector<Side> sides{};
    };

    void find_fronts();
    void divide_region(std::int32_t element);
    void close_undivided();
    Guide guide_of(std::int32_t element) const;
    Guide carried(const Guide& guide, std::int32_t element) const;
    std::array<double, 4> section_moments(std::int32_t element, std::span<const Barycentric> polygon) const;
    PartOpening opening_of(std::int32_t part, const Region& region) const;
    std::vector<Piece> pieces_of(std::int32_t element, const Region& region) const;

    const CutMesh& cut_;
    std::map<std::int32_t, Front> fronts_;      ///< by copy
    std::map<std::int32_t, Guide> own_guides_;  ///< of elements through which a cut runs, near fronts
    std::map<std::int32_t, int> own_planes_;    ///< their planes in the pools of the elements
    std::map<std::int32_t, Region> regions_;    ///< by element
    std::vector<std::int32_t> opened_from_;
};

}  // namespace lancet::mesh
