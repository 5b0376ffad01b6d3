#include "lancet/kernels/layout/vertex_rings.hpp"

#include <algorithm>
#include <numeric>

namespace lancet::kernels {

namespace {

/// A triangle as one of its vertices sees it: from one neighbour to the next.
struct Link {
    std::int32_t from, to;
};

/// The links of all vertices, one vertex after the other.
class VertexLinks {
  public:
    VertexLinks(std::size_t vertices, std::span<const Triangle> triangles) : first_(vertices + 1, 0) {
        for (const Triangle& triangle : triangles) {
            if (is_empty(triangle)) continue;
            for (const std::int32_t vertex : triangle) ++first_[static_cast<std::size_t>(vertex) + 1];
        }
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        links_.resize(first_.back());
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for (const Triangle& triangle : triangles) {
            if (is_empty(triangle)) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                links_[next[static_cast<std::size_t>(triangle[k])]++] = {triangle[(k + 1) % 3], triangle[(k + 2) % 3]};
            }
        }
    }

    std::span<Link> of(std::size_t vertex) {
        return std::span(links_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
    }

  private:
    static bool is_empty(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

    std::vector<std::size_t> first_;
    std::vector<Link> links_;
};

/// Appends the neighbours of a vertex in the order of its links, which are sorted for that.
class RingWriter {
  public:
    void append(std::int32_t vertex, std::span<Link> links, std::vector<std::int32_t>& ring) {
        std::ranges::sort(links, {}, [](const Link& link) { return std::pair(link.from, link.to); });
        ends_.clear();
        for (const Link& link : links) ends_.push_back(link.to);
        std::ranges::sort(ends_);
        is_used_.assign(links.size(), 0);
        // Chains with a beginning first; what is left then are closed ones.
        for (const bool is_closed : {false, true}) {
            for (std::size_t first = 0; first < links.size(); ++first) {
                if (is_used_[first] != 0) continue;
                if (!is_closed && std::ranges::binary_search(ends_, links[first].from)) continue;
                if (!ring.empty()) ring.push_back(vertex);
                ring.push_back(links[first].from);
                for (std::size_t link = first; link < links.size(); link = follower(links, link)) {
                    is_used_[link] = 1;
                    ring.push_back(links[link].to);
                }
            }
        }
    }

  private:
    /// One that has not been used and starts where a link ends; links.size(): none.
    std::size_t follower(std::span<const Link> links, std::size_t link) const {
        const std::int32_t end = links[link].to;
        auto at = static_cast<std::size_t>(std::ranges::lower_bound(links, end, {}, &Link::from) - links.begin());
        for (; at < links.size() && links[at].from == end; ++at) {
            if (is_used_[at] == 0) return at;
        }
        return links.size();
    }

    std::vector<std::int32_t> ends_;
    std::vector<std::uint8_t> is_used_;
};

/// The rings of a block of vertices, one after the other.
struct BlockRings {
    std::vector<std::size_t> begin{0};
    std::vector<std::int32_t> numbers;

    std::span<const std::int32_t> of(std::size_t vertex) const {
        return std::span(numbers).subspan(begin[vertex], begin[vertex + 1] - begin[vertex]);
    }
};

}  // namespace

std::size_t VertexRings::bytes() const noexcept {
    return (slot_begin.size() + vertices.size() + neighbours.size()) * sizeof(std::int32_t);
}

VertexRings vertex_rings(std::size_t vertices, std::span<const Triangle> triangles) {
    constexpr std::size_t lanes = VertexRings::lanes, per_block = lanes * VertexRings::batches_per_block;
    VertexRings rings;
    VertexLinks links(vertices, triangles);
    RingWriter writer;
    std::vector<std::int32_t> ring;
    std::vector<std::size_t> order;
    for (std::size_t first = 0; first < vertices; first += per_block) {
        const std::size_t count = std::min(per_block, vertices - first);
        BlockRings block;
        for (std::size_t k = 0; k < count; ++k) {
            ring.clear();
            writer.append(static_cast<std::int32_t>(first + k), links.of(first + k), ring);
            block.numbers.insert(block.numbers.end(), ring.begin(), ring.end());
            block.begin.push_back(block.numbers.size());
        }
        order.resize(count);
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t k) { return block.of(k).size(); });
        for (std::size_t batch = 0; batch < count; batch += lanes) {
            const auto in_lane = [&](std::size_t lane) { return order[std::min(batch + lane, count - 1)]; };
            const std::size_t slots = block.of(in_lane(lanes - 1)).size();
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                rings.vertices.push_back(3 * static_cast<std::int32_t>(first + in_lane(lane)));
            }
            for (std::size_t slot = 0; slot < slots; ++slot) {
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    const auto of_lane = block.of(in_lane(lane));
                    const auto vertex = static_cast<std::int32_t>(first + in_lane(lane));
                    rings.neighbours.push_back(3 * (slot < of_lane.size() ? of_lane[slot] : vertex));
                }
            }
            rings.slot_begin.push_back(static_cast<std::int32_t>(rings.neighbours.size() / lanes));
        }
    }
    return rings;
}

}  // namespace lancet::kernels
