#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/cut/lanes.hpp"

namespace lancet::mesh {

/// How far the copies of a part are open, around a blended front.
struct PartOpening {
    struct Corner {
        double openness = 0;    ///< 0: closed, and the other numbers say nothing
        int near_side = 1;      ///< the side of the guide, 1 or -1, on which the copy itself is
        std::int32_t far = -1;  ///< the copy of the other side
    };
    Barycentric guide{};  ///< the values at the element's corners of the function whose zeros are the cut's plane
    std::array<Corner, 4> corners{};

    bool is_open() const {
        for (const Corner& corner : corners) {
            if (corner.openness > 0) return true;
        }
        return false;
    }
    /// The function of the guide at a place.
    double guide_at(const Barycentric& place) const {
        return guide[0] * place[0] + guide[1] * place[1] + guide[2] * place[2] + guide[3] * place[3];
    }
};

/// The copies on which a point of the material hangs, and with which weights; the weights add up to one.
struct CopyWeights {
    std::array<std::int32_t, 8> copies{};
    std::array<double, 8> weights{};
    int count = 0;

    void add(std::int32_t copy, double weight) {
        if (weight == 0) return;
        copies[static_cast<std::size_t>(count)] = copy;
        weights[static_cast<std::size_t>(count)] = weight;
        ++count;
    }
    /// sum_i weights[i] x(copies[i]). `positions` are of all copies, and of those that open.
    Point place(std::span<const Point> positions) const;
};

/// Where points of the material are around blended fronts: at the mean, over the thresholds of lanes.hpp, of where the
/// lanes put them. At corner k of a part, of a copy c that is o_k open, what lies on the far side of the cut's plane
/// hangs on (1 - o_k) x(c) + o_k x(c'), and what lies on the near side on x(c). So a point moves continuously as the
/// front passes by, and a force on it does the same work in all lanes together.
class FrontBlend {
  public:
    /// Sharp fronts: every point hangs on the copies of its part.
    FrontBlend() = default;
    FrontBlend(const CutMesh& cut, Fronts fronts);

    /// The opening of a part; nothing where all its copies are closed.
    const PartOpening* opening(std::int32_t part) const;

    /// What holds a point of the same mesh; where it lies on the plane of the cut, as on the positive side.
    CopyWeights hold(const CutMesh& cut, const MaterialPoint& point) const;
    /// The same for a point that belongs to a side, 1 or -1; 0 is the mean of both sides.
    CopyWeights hold(const CutMesh& cut, const MaterialPoint& point, int side) const;

  private:
    std::map<std::int32_t, PartOpening> openings_;
};

}  // namespace lancet::mesh
