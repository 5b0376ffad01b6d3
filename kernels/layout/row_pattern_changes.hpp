#pragma once

#include <cstdint>
#include <vector>

#include "lancet/kernels/layout/row_pattern.hpp"

namespace lancet::kernels {

/// An element that is no longer where it was, or not between the nodes that it was between.
struct ElementMove {
    std::int32_t slot = 0;
    Tetrahedron before{-1, -1, -1, -1};  ///< internal numbers of its nodes; -1: it was not there
    Tetrahedron after{-1, -1, -1, -1};   ///< -1: it is not there any more
};

/// Changes a pattern of edges (RowContent::upper_edges) with room where elements have come, moved or gone, and leaves
/// the rest of it as it is.
///
/// The blocks of a matrix, its products and the coarse matrix are sums over what is stored: an edge may be stored in
/// several places, each with some of its elements. So an element that comes is entered where its edge has a place left,
/// or else at a place of the row without an edge, or else in a row of the room. Edges of nodes in the numbering's room
/// are in rows of those, all others as make_row_pattern stores them, in the row of the lower number.
class RowPatternChanges {
  public:
    RowPatternChanges() = default;
    RowPatternChanges(const RowPattern& pattern, const NodeNumbering& numbering);

    /// Enters a move in the pattern. False where there is no room, which leaves the pattern unfit for use.
    /// pattern.scatter must be told when all moves are made (ScatterPlan::finish_changes).
    bool enter(RowPattern& pattern, const NodeNumbering& numbering, const ElementMove& move);

    /// Calls visit(entry, lane) for all places of the edges of an element.
    template <class Visit>
    void for_each_place(const RowPattern& pattern, const NodeNumbering& numbering, const Tetrahedron& nodes,
                        const Visit& visit) const {
        for (std::int32_t i = 0; i < 4; ++i) {
            for (std::int32_t j = i + 1; j < 4; ++j) {
                const Edge edge = edge_of(numbering, 0, nodes, i, j);
                if (!numbering.is_free(edge.row)) continue;
                find_place(pattern, edge.row, [&](std::int32_t entry, std::int32_t lane) {
                    if (pattern.column[entry * pattern.width + lane] == 4 * edge.column) visit(entry, lane);
                    return false;
                });
            }
        }
    }

    /// entry * width + lane of all places whose elements have changed, in the order of changes, some several times.
    const std::vector<std::int32_t>& changed_places() const noexcept { return changed_; }
    void forget_changed_places() noexcept { changed_.clear(); }
    std::size_t bytes() const noexcept;

  private:
    struct Edge {
        std::int32_t row, column;
        std::int32_t row_corner, column_corner;  ///< 4 * slot + corner
    };
    static Edge edge_of(const NodeNumbering& numbering, std::int32_t slot, const Tetrahedron& nodes, std::int32_t i,
                        std::int32_t j);
    bool add(RowPattern& pattern, const NodeNumbering& numbering, const Edge& edge);
    bool remove(RowPattern& pattern, const Edge& edge);
    std::int32_t take_row(RowPattern& pattern, const NodeNumbering& numbering, std::int32_t row);
    /// Calls visit(entry, lane) for the places of a row until it returns true; returns whether it did.
    template <class Visit>
    bool find_place(const RowPattern& pattern, std::int32_t row, const Visit& visit) const {
        for (std::int32_t place = place_of_row_[row]; place >= 0; place = next_place_[place]) {
            const std::int32_t chunk = place / pattern.width;
            for (std::int32_t entry = pattern.chunk_entry_begin[chunk]; entry < pattern.chunk_entry_begin[chunk + 1];
                 ++entry) {
                if (visit(entry, place % pattern.width)) return true;
            }
        }
        return false;
    }

    std::vector<std::int32_t>
        place_of_row_;                      ///< [node] chunk * width + lane, the last row of the room it has taken; -1
    std::vector<std::int32_t> next_place_;  ///< [chunk * width + lane] the place before that of the same row; -1
    std::int32_t next_row_ = 0;             ///< chunk * width + lane, the first row of the room that is not taken
    std::vector<std::int32_t> changed_;
};

}  // namespace lancet::kernels
