#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "lancet/kernels/layout/aligned_vector.hpp"
#include "lancet/runtime/collide/broad_phase.hpp"

namespace lancet::runtime {

/// A balanced binary tree of bounding volumes over boxes. `Volume` is regular and has
///     static Volume around(const Box&);                    // of a box or empty_box
///     static Volume merged(const Volume&, const Volume&);  // contains both
///     bool touches(const Box&) const;                      // may be true for a box that is near by
///
/// Built by halving along the longest side of the box around the middles; O(n log n). Nodes lie in depth-first order,
/// each with the number of the node after its subtree, so that a query needs no stack, and a refit is one pass from the
/// last node to the first.
///
/// A refit keeps the tree until
///     (sum over inner nodes of the area of the box around them) / (sum of the areas of all boxes)
/// has grown by half since it was built (where the boxes are points, over the area of the root's box): about the nodes
/// that a query of the size of a box visits in vain. The measure does not change with motion, size or stretch of all.
template <class Volume>
class BoundingVolumeTree : public BroadPhase {
  private:
    /// Several boxes a leaf: testing four costs less than two more nodes.
    static constexpr std::int32_t boxes_per_leaf = 4;
    static constexpr double largest_growth = 1.5;

    struct Node {
        Volume volume;
        std::int32_t after;  ///< the node after this subtree
        std::int32_t begin;  ///< of the leaf's boxes in order_; begin = end: an inner node
        std::int32_t end;
    };

    void build_index() override {
        const auto count = static_cast<std::int32_t>(boxes().size());
        order_.resize(boxes().size());
        std::iota(order_.begin(), order_.end(), 0);
        middles_.resize(boxes().size());
        std::ranges::transform(boxes(), middles_.begin(), middle);
        ordered_.resize(boxes().size());
        nodes_.clear();
        if (count > 0) add_node(0, count);
        node_boxes_.resize(nodes_.size());
        cost_when_built_ = update();
    }

    bool refit_index() override {
        if (update() <= largest_growth * cost_when_built_) return false;
        build_index();
        return true;
    }

    void add_node(std::int32_t begin, std::int32_t end) {
        const std::size_t node = nodes_.size();
        const bool is_leaf = end - begin <= boxes_per_leaf;
        nodes_.push_back({Volume{}, 0, is_leaf ? begin : 0, is_leaf ? end : 0});
        if (!is_leaf) {
            const std::int32_t half = begin + (end - begin) / 2;
            halve(begin, half, end);
            add_node(begin, half);
            add_node(half, end);
        }
        nodes_[node].after = static_cast<std::int32_t>(nodes_.size());
    }

    void halve(std::int32_t begin, std::int32_t half, std::int32_t end) {
        Box around = empty_box;
        for (std::int32_t i = begin; i < end; ++i) {
            const Point& at = middles_[order_[i]];
            around = unite(around, {at, at});
        }
        std::size_t axis = 0;
        for (const std::size_t other : {1U, 2U}) {
            if (around.upper[other] - around.lower[other] > around.upper[axis] - around.lower[axis]) axis = other;
        }
        std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end,
                         [&](std::int32_t a, std::int32_t b) {
                             const double at_a = middles_[a][axis], at_b = middles_[b][axis];
                             return at_a < at_b || (at_a == at_b && a < b);
                         });
    }

    /// Takes the volumes from the boxes as they are; returns the measure of the tree.
    double update() {
        double inner_area = 0, box_area = 0;
        for (std::size_t i = 0; i < order_.size(); ++i) {
            ordered_[i] = boxes()[order_[i]];
            box_area += half_area(ordered_[i]);
        }
        for (std::size_t i = nodes_.size(); i-- > 0;) {
            Node& node = nodes_[i];
            Box& box = node_boxes_[i];
            if (node.begin < node.end) {
                box = empty_box;
                for (std::int32_t k = node.begin; k < node.end; ++k) box = unite(box, ordered_[k]);
                node.volume = Volume::around(box);
            } else {
                const std::size_t first = i + 1, second = static_cast<std::size_t>(nodes_[first].after);
                box = unite(node_boxes_[first], node_boxes_[second]);
                node.volume = Volume::merged(nodes_[first].volume, nodes_[second].volume);
                inner_area += half_area(box);
            }
        }
        if (box_area == 0 && !nodes_.empty()) box_area = half_area(node_boxes_[0]);
        return box_area > 0 ? inner_area / box_area : 0;
    }

    void collect(const Box& box, std::int32_t first, std::vector<std::int32_t>& found) const override {
        const auto count = static_cast<std::int32_t>(nodes_.size());
        for (std::int32_t i = 0; i < count;) {
            const Node& node = nodes_[i];
            if (!node.volume.touches(box)) {
                i = node.after;
                continue;
            }
            for (std::int32_t k = node.begin; k < node.end; ++k) {
                if (order_[k] >= first && touch(ordered_[k], box)) found.push_back(order_[k]);
            }
            ++i;
        }
    }

    std::size_t index_bytes() const noexcept override {
        using kernels::heap_bytes;
        return heap_bytes(nodes_) + heap_bytes(node_boxes_) + heap_bytes(order_) + heap_bytes(ordered_) +
               heap_bytes(middles_);
    }

    std::vector<Node> nodes_;
    std::vector<Box> node_boxes_;
    std::vector<std::int32_t> order_;  ///< numbers of the boxes, leaf by leaf
    std::vector<Box> ordered_;         ///< the boxes in that order
    std::vector<Point> middles_;
    double cost_when_built_ = 0;
};

}  // namespace lancet::runtime
