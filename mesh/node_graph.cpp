#include "lancet/mesh/node_graph.hpp"

#include <algorithm>

namespace lancet::mesh {

namespace {

/// Breadth-first search that can be restarted without clearing.
class Search {
  public:
    explicit Search(const NodeGraph& graph) : graph_(graph), mark_(graph.node_count(), 0) {}

    struct Result {
        std::int32_t levels;
        /// The node of lowest degree in the last level, of lowest number among equals.
        std::int32_t farthest;
    };

    /// Visits the component of `start`.
    Result run(std::int32_t start) {
        ++stamp_;
        queue_.assign(1, start);
        mark_[start] = stamp_;
        Result result{0, start};
        for (std::size_t begin = 0; begin < queue_.size(); ++result.levels) {
            const std::size_t end = queue_.size();
            result.farthest = queue_[begin];
            for (std::size_t at = begin; at < end; ++at) {
                const std::int32_t node = queue_[at];
                if (before(node, result.farthest)) result.farthest = node;
                for (const std::int32_t neighbour : graph_.of(node)) {
                    if (mark_[neighbour] == stamp_) continue;
                    mark_[neighbour] = stamp_;
                    queue_.push_back(neighbour);
                }
            }
            begin = end;
        }
        return result;
    }

    bool before(std::int32_t left, std::int32_t right) const {
        const std::size_t left_degree = graph_.degree(left);
        const std::size_t right_degree = graph_.degree(right);
        return left_degree != right_degree ? left_degree < right_degree : left < right;
    }

  private:
    const NodeGraph& graph_;
    std::vector<std::int32_t> mark_;
    std::vector<std::int32_t> queue_;
    std::int32_t stamp_ = 0;
};

/// A node at one end of the component: searches from the far end as long as that makes the search deeper.
std::int32_t peripheral_node(Search& search, std::int32_t start) {
    auto [levels, farthest] = search.run(start);
    // The depth grows in every round, but a long thin component need not be followed to its very end.
    for (int round = 0; round < 8; ++round) {
        const auto [next_levels, next_farthest] = search.run(farthest);
        if (next_levels <= levels) break;
        start = farthest;
        levels = next_levels;
        farthest = next_farthest;
    }
    return farthest;
}

}  // namespace

NodeGraph node_graph(const TetMesh& mesh) {
    const std::size_t node_count = mesh.nodes().size();
    std::vector<std::size_t> begin(node_count + 1, 0);
    for (const Tetrahedron& t : mesh.tetrahedra()) {
        for (const std::int32_t node : t) begin[node + std::size_t{1}] += 3;
    }
    for (std::size_t n = 0; n < node_count; ++n) begin[n + 1] += begin[n];
    std::vector<std::int32_t> all(begin.back());
    std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
    for (const Tetrahedron& t : mesh.tetrahedra()) {
        for (const std::int32_t node : t) {
            for (const std::int32_t other : t) {
                if (other != node) all[next[node]++] = other;
            }
        }
    }
    NodeGraph graph;
    graph.first.assign(1, 0);
    graph.first.reserve(node_count + 1);
    for (std::size_t n = 0; n < node_count; ++n) {
        const auto from = all.begin() + static_cast<std::ptrdiff_t>(begin[n]);
        const auto to = all.begin() + static_cast<std::ptrdiff_t>(begin[n + 1]);
        std::sort(from, to);
        graph.neighbours.insert(graph.neighbours.end(), from, std::unique(from, to));
        graph.first.push_back(graph.neighbours.size());
    }
    return graph;
}

std::vector<std::int32_t> reverse_cuthill_mckee(const NodeGraph& graph) {
    Search search(graph);
    std::vector<char> numbered(graph.node_count(), 0);
    std::vector<std::int32_t> sequence;
    sequence.reserve(graph.node_count());
    for (std::size_t n = 0; n < graph.node_count(); ++n) {
        if (numbered[n] != 0) continue;
        const std::int32_t start = peripheral_node(search, static_cast<std::int32_t>(n));
        numbered[start] = 1;
        std::size_t at = sequence.size();
        sequence.push_back(start);
        for (; at < sequence.size(); ++at) {
            const std::size_t children = sequence.size();
            for (const std::int32_t neighbour : graph.of(sequence[at])) {
                if (numbered[neighbour] != 0) continue;
                numbered[neighbour] = 1;
                sequence.push_back(neighbour);
            }
            std::sort(sequence.begin() + static_cast<std::ptrdiff_t>(children), sequence.end(),
                      [&](std::int32_t left, std::int32_t right) { return search.before(left, right); });
        }
    }
    std::reverse(sequence.begin(), sequence.end());
    return sequence;
}

}  // namespace lancet::mesh
