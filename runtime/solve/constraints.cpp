#include "lancet/runtime/solve/constraints.hpp"

#include <algorithm>
#include <string>

#include "lancet/kernels/error.hpp"

namespace lancet::runtime {

ConstraintFilter::ConstraintFilter(std::vector<NodeConstraint> constraints, const kernels::NodeNumbering& numbering)
    : constraints_(std::move(constraints)), block_begin_(1, 0) {
    std::sort(constraints_.begin(), constraints_.end(),
              [](const NodeConstraint& a, const NodeConstraint& b) { return a.node < b.node; });
    for (std::size_t k = 0; k < constraints_.size(); ++k) {
        if (!numbering.is_free(constraints_[k].node) || constraints_[k].node < 0) {
            throw Error("constraint on node " + std::to_string(constraints_[k].node) + ": expected a free node");
        }
        if (k > 0 && constraints_[k].node == constraints_[k - 1].node) {
            throw Error("two constraints on internal node " + std::to_string(constraints_[k].node) +
                        ": expected one per node");
        }
    }
    for (int block = 0; block < numbering.blocks(); ++block) {
        const auto end = std::lower_bound(constraints_.begin(), constraints_.end(), numbering.block_begin[block + 1],
                                          [](const NodeConstraint& c, std::int32_t node) { return c.node < node; });
        block_begin_.push_back(static_cast<std::int32_t>(end - constraints_.begin()));
    }
}

}  // namespace lancet::runtime
