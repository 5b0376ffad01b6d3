#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lancet/mesh/tet_mesh.hpp"

namespace lancet::mesh {

/// The lower and the upper corner of a box along the axes.
using Bounds = std::array<Point, 2>;

/// Boxes in the cells of a uniform grid: about one cell for each box, cells no smaller than boxes are on average. It is
/// built in time linear in the boxes, and asked without memory being taken.
class BoxGrid {
  public:
    BoxGrid() = default;
    /// Boxes must be finite; they are copied.
    explicit BoxGrid(std::span<const Bounds> boxes);

    /// The box around all.
    const Bounds& bounds() const noexcept { return bounds_; }
    /// The length of a cell's longest edge.
    double cell_size() const noexcept { return *std::max_element(cell_.begin(), cell_.end()); }

    /// use(number) once for every box that has a place in common with this one, which may be infinite.
    template <class Use>
    void for_each_overlap(const Bounds& box, const Use& use) const {
        if (boxes_.empty()) return;
        const std::array<int, 3> low = cell_of(box[0]), high = cell_of(box[1]);
        for (int k = low[2]; k <= high[2]; ++k) {
            for (int j = low[1]; j <= high[1]; ++j) {
                for (int i = low[0]; i <= high[0]; ++i) {
                    const std::size_t cell = number({i, j, k});
                    for (std::size_t e = first_[cell]; e < first_[cell + 1]; ++e) {
                        const std::int32_t candidate = entries_[e];
                        const Bounds& other = boxes_[static_cast<std::size_t>(candidate)];
                        if (!overlap(box, other)) continue;
                        // Of the cells that both share, only the first reports it.
                        const std::array<int, 3> begin = cell_of(other[0]);
                        const bool is_first = std::max(begin[0], low[0]) == i && std::max(begin[1], low[1]) == j &&
                                              std::max(begin[2], low[2]) == k;
                        if (is_first) use(candidate);
                    }
                }
            }
        }
    }

  private:
    static bool overlap(const Bounds& a, const Bounds& b) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (a[0][axis] > b[1][axis] || b[0][axis] > a[1][axis]) return false;
        }
        return true;
    }
    std::array<int, 3> cell_of(const Point& place) const;
    std::size_t number(const std::array<int, 3>& cell) const {
        return (static_cast<std::size_t>(cell[2]) * static_cast<std::size_t>(cells_[1]) +
                static_cast<std::size_t>(cell[1])) *
                   static_cast<std::size_t>(cells_[0]) +
               static_cast<std::size_t>(cell[0]);
    }

    std::vector<Bounds> boxes_;
    Bounds bounds_{};
    std::array<int, 3> cells_{1, 1, 1};
    std::array<double, 3> cell_{};
    std::vector<std::size_t> first_;
    std::vector<std::int32_t> entries_;
};

}  // namespace lancet::mesh
