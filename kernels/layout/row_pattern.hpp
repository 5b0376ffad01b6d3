#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lancet/kernels/layout/aligned_vector.hpp"
#include "lancet/kernels/layout/node_numbering.hpp"
#include "lancet/kernels/layout/scatter_plan.hpp"

namespace lancet::kernels {

/// Which 3 x 3 blocks of the matrix a pattern holds.
enum class RowContent {
    upper_edges,  ///< one block per edge of the mesh graph, in the row of its first node
    full_rows     ///< every block, the diagonal one first, and those of fixed nodes
};

/// The rows of the free nodes in sliced ELLPACK order: `width` rows of similar length form a chunk, entry k of a chunk
/// holds the k-th block of each of its rows. Each block of the matrix is a sum over the elements that contain both its
/// nodes, its incidences; it is assembled by gathering them, without a conflict and in a fixed order.
struct RowPattern {
    int width = 1;
    RowContent content = RowContent::upper_edges;
    std::vector<std::int32_t> block_chunk_begin;  ///< first chunk of each block, and the end
    std::vector<std::int32_t> chunk_entry_begin;  ///< first entry of each chunk, and the end
    AlignedVector<std::int32_t> row;              ///< [chunk][lane] 4 * node, its place in a nodal vector
    AlignedVector<std::int32_t> row_target;       ///< [chunk][lane] 4 * target of the row's own sum
    AlignedVector<std::int32_t> column;           ///< [entry][lane] 4 * node
    AlignedVector<std::int32_t>
        column_target;  ///< [entry][lane] 4 * target of the transposed product (upper_edges only)
    std::vector<std::int32_t> incidence_begin;  ///< first incidence of each entry, and the end
    AlignedVector<std::int32_t> incidence;      ///< [incidence][2][lane] 4 * (4 * slot + corner) of the row's and the
                                                ///< column's node; 16 * slots stands for 'nothing'
    std::int32_t slots = 0;                     ///< of the element batches
    ScatterPlan scatter;                        ///< upper_edges only
    std::int64_t blocks_stored = 0;             ///< 3 x 3 blocks without padding
    /// With room (see NodeNumbering), upper_edges only, else empty: the first chunk of the last block. Its chunks hold
    /// no row yet, and come into use one by one, up to block_chunk_begin.back(). Their rows may be of any node.
    std::vector<std::int32_t> room_begin{};

    int chunks() const noexcept { return block_chunk_begin.back(); }
    int entries() const noexcept { return chunk_entry_begin.back(); }
    /// The incidence that stands for nothing.
    std::int32_t nothing() const noexcept { return 16 * slots; }
    /// Whether the edge at a lane of an entry is one of elements; padding, and what elements have left behind, is not.
    bool has_elements(std::int32_t entry, int lane) const noexcept {
        const std::int32_t first = incidence_begin[entry];
        return first < incidence_begin[entry + 1] &&
               incidence[static_cast<std::size_t>(2 * first) * width + lane] != nothing();
    }
    std::size_t bytes() const noexcept;
};

/// Builds a pattern. `slot_of_element` and `slots` are those of the element batches whose gradients are gathered.
RowPattern make_row_pattern(RowContent content, std::span<const Tetrahedron> tetrahedra,
                            std::span<const std::int32_t> slot_of_element, std::int32_t slots,
                            const NodeNumbering& numbering, ScatterStrategy strategy, int width);

}  // namespace lancet::kernels
