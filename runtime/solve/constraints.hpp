#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lancet/kernels/layout/node_numbering.hpp"

namespace lancet::runtime {

/// A symmetric projection of one node's vector: xx, yy, zz, xy, xz, yz. Zero holds the node; 1 - n n^T lets it slide
/// in the plane with normal n.
struct NodeConstraint {
    std::int32_t node;  ///< internal numbering, a free node
    std::array<double, 6> projection;
};

/// The filter of Ascher and Boxerman (2003) for constraints that come and go while a body runs: conjugate gradients
/// stay in the subspace of the allowed motions. Nodes that are fixed for good are eliminated instead.
class ConstraintFilter {
  public:
    ConstraintFilter() = default;
    /// Sorts the constraints into the blocks of the numbering. One constraint per node.
    ConstraintFilter(std::vector<NodeConstraint> constraints, const kernels::NodeNumbering& numbering);

    bool empty() const noexcept { return constraints_.empty(); }

    /// Projects the constrained nodes of a block of an xyz_ nodal vector.
    template <class Real>
    void apply(Real* nodal, int block) const noexcept {
        if (constraints_.empty()) return;
        for (std::int32_t k = block_begin_[block]; k < block_begin_[block + 1]; ++k) {
            const auto& [node, s] = constraints_[k];
            Real* v = nodal + 4 * static_cast<std::int64_t>(node);
            const auto x = static_cast<double>(v[0]), y = static_cast<double>(v[1]), z = static_cast<double>(v[2]);
            v[0] = static_cast<Real>(s[0] * x + s[3] * y + s[4] * z);
            v[1] = static_cast<Real>(s[3] * x + s[1] * y + s[5] * z);
            v[2] = static_cast<Real>(s[4] * x + s[5] * y + s[2] * z);
        }
    }

  private:
    std::vector<NodeConstraint> constraints_;
    std::vector<std::int32_t> block_begin_;
};

}  // namespace lancet::runtime
