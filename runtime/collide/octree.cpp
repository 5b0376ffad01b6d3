#include <array>
#include <numeric>

#include "lancet/kernels/layout/aligned_vector.hpp"
#include "lancet/runtime/collide/broad_phase_kinds.hpp"

namespace lancet::runtime {
namespace {

/// A box lies in the deepest cell around its middle whose loose cell, twice as long, contains it; cells with few boxes
/// are not divided. Cells lie in depth-first order, each with the number of the cell after its subtree.
///
/// A refit keeps the tree as long as every box lies in the loose cell that it was put in.
class Octree final : public BroadPhase {
  public:
    BroadPhaseKind kind() const noexcept override { return BroadPhaseKind::octree; }

  private:
    static constexpr std::int32_t boxes_per_leaf = 8;
    static constexpr int deepest = 20;
    static constexpr std::int32_t outside = -1;

    struct Node {
        Box loose;
        std::int32_t after;  ///< the node after this subtree
        std::int32_t begin;  ///< of the node's own boxes in order_
        std::int32_t end;
    };

    void build_index() override {
        order_.clear();
        Box all = empty_box;
        for (std::size_t i = 0; i < boxes().size(); ++i) {
            if (boxes()[i] == empty_box) continue;
            order_.push_back(static_cast<std::int32_t>(i));
            all = unite(all, boxes()[i]);
        }
        sorted_.resize(order_.size());
        octant_.resize(order_.size());
        node_of_box_.assign(boxes().size(), outside);
        nodes_.clear();
        if (order_.empty()) return;
        const Point centre = middle(all);
        // A little more than half, against rounding of the centre.
        const double half = longest_side(all) * 0.5000001;
        add_node(centre, half, unite(loose_cell(centre, half), all), 0, static_cast<std::int32_t>(order_.size()), 0);
    }

    /// `loose`: of the node; contains the boxes order_[begin, end).
    void add_node(const Point& centre, double half, const Box& loose, std::int32_t begin, std::int32_t end, int depth) {
        const std::size_t node = nodes_.size();
        nodes_.push_back({loose, 0, begin, end});
        // Cells whose faces rounding cannot tell apart are not divided.
        const double size = std::max({std::abs(centre[0]), std::abs(centre[1]), std::abs(centre[2])});
        if (end - begin > boxes_per_leaf && depth < deepest && half > 1e-12 * size) {
            std::array<std::int32_t, 10> first = divide(centre, half, begin, end);
            nodes_[node].end = first[1];
            for (std::size_t octant = 0; octant < 8; ++octant) {
                if (first[octant + 1] == first[octant + 2]) continue;
                const Point at = centre_of(centre, half, octant);
                add_node(at, half / 2, loose_cell(at, half / 2), first[octant + 1], first[octant + 2], depth + 1);
            }
        }
        nodes_[node].after = static_cast<std::int32_t>(nodes_.size());
        for (std::int32_t k = nodes_[node].begin; k < nodes_[node].end; ++k) {
            node_of_box_[order_[k]] = static_cast<std::int32_t>(node);
        }
    }

    /// Sorts order_[begin, end) into what stays (first) and the eight octants; returns where each begins, and the end.
    std::array<std::int32_t, 10> divide(const Point& centre, double half, std::int32_t begin, std::int32_t end) {
        std::array<std::int32_t, 10> first{};
        for (std::int32_t k = begin; k < end; ++k) {
            const Box& box = boxes()[order_[k]];
            const Point at = middle(box);
            std::size_t octant = 0;
            for (std::size_t axis = 0; axis < 3; ++axis) octant |= std::size_t{at[axis] > centre[axis]} << axis;
            const bool fits = contains(loose_cell(centre_of(centre, half, octant), half / 2), box);
            octant_[k] = static_cast<std::uint8_t>(fits ? octant + 1 : 0);
            ++first[octant_[k] + 1U];
        }
        first[0] = begin;
        std::partial_sum(first.begin(), first.end(), first.begin());
        std::array<std::int32_t, 10> next = first;
        for (std::int32_t k = begin; k < end; ++k) sorted_[next[octant_[k]]++] = order_[k];
        std::copy(sorted_.begin() + begin, sorted_.begin() + end, order_.begin() + begin);
        return first;
    }

    static Point centre_of(const Point& centre, double half, std::size_t octant) noexcept {
        Point at;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            at[axis] = centre[axis] + ((octant >> axis & 1U) != 0 ? half / 2 : -half / 2);
        }
        return at;
    }
    static Box loose_cell(const Point& centre, double half) noexcept {
        Box cell;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            cell.lower[axis] = centre[axis] - 2 * half;
            cell.upper[axis] = centre[axis] + 2 * half;
        }
        return cell;
    }

    bool refit_index() override {
        for (std::size_t i = 0; i < boxes().size(); ++i) {
            const std::int32_t node = node_of_box_[i];
            const bool is_empty = boxes()[i] == empty_box;
            if (node == outside ? is_empty : !is_empty && contains(nodes_[node].loose, boxes()[i])) continue;
            build_index();
            return true;
        }
        return false;
    }

    void collect(const Box& box, std::int32_t first, std::vector<std::int32_t>& found) const override {
        const auto count = static_cast<std::int32_t>(nodes_.size());
        for (std::int32_t i = 0; i < count;) {
            const Node& node = nodes_[i];
            if (!touch(node.loose, box)) {
                i = node.after;
                continue;
            }
            for (std::int32_t k = node.begin; k < node.end; ++k) {
                if (order_[k] >= first && touch(boxes()[order_[k]], box)) found.push_back(order_[k]);
            }
            ++i;
        }
    }

    std::size_t index_bytes() const noexcept override {
        using kernels::heap_bytes;
        return heap_bytes(nodes_) + heap_bytes(order_) + heap_bytes(sorted_) + heap_bytes(octant_) +
               heap_bytes(node_of_box_);
    }

    std::vector<Node> nodes_;
    std::vector<std::int32_t> order_;  ///< numbers of the boxes, node by node
    std::vector<std::int32_t> sorted_;
    std::vector<std::uint8_t> octant_;
    std::vector<std::int32_t> node_of_box_;
};

}  // namespace

std::unique_ptr<BroadPhase> make_octree() {
    return std::make_unique<Octree>();
}

}  // namespace lancet::runtime
