#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/kernels/layout/node_numbering.hpp"

namespace lancet::runtime {

/// Tells where a body has deformed since something was last taken up from its deformation, by blocks of elements.
///
/// With d the displacements of the nodes since then, F of an element has changed by sum_k (d_k - d_0) b_k^T, at most
/// |e| sum_k |b_k| for the extents e of the box around all d of the block: a look at its nodes instead of its elements.
class DeformationWatch {
  public:
    DeformationWatch() = default;
    template <class Real>
    DeformationWatch(const kernels::ElementBatches<Real>& batches, const kernels::NodeNumbering& numbering);

    /// Looks at the elements of a block again, which have changed.
    template <class Real>
    void change(const kernels::ElementBatches<Real>& batches, const kernels::NodeNumbering& numbering, int block);

    /// True where F (Frobenius norm) of some element of the block may have changed by more than `bound`, or the block
    /// has not been looked at before: from now on it is measured from these positions (xyz_).
    bool has_changed(int block, const double* positions, double bound);
    /// From now on the block is measured from these positions.
    void take_up(int block, const double* positions);

    /// The blocks of nodes that belong to elements of a block, ascending.
    std::span<const int> touched_blocks(int block) const { return blocks_[static_cast<std::size_t>(block)].touched; }

    void save(std::vector<double>& numbers) const;
    /// Reads back what save wrote, from the front of `numbers`, which it removes.
    void restore(std::span<const double>& numbers);
    std::size_t bytes() const noexcept;

  private:
    struct Block {
        std::vector<std::int32_t> nodes{};  ///< of its elements, each once
        std::vector<double> places{};       ///< [node][axis]
        std::vector<int> touched{};
        double reach = 0;  ///< the largest sum_k |b_k|, per metre
        bool is_known = false;
    };
    std::vector<Block> blocks_;
};

}  // namespace lancet::runtime
