#include "lancet/kernels/layout/spare_nodes.hpp"

#include <algorithm>

namespace lancet::kernels {

namespace {

/// A free place of an aggregate, or -1.
std::int32_t place_in(const NodeNumbering& numbering, std::int32_t aggregate) {
    const auto begin = numbering.user_of_internal.begin() + numbering.aggregate_begin[aggregate];
    const auto end = numbering.user_of_internal.begin() + numbering.aggregate_begin[aggregate + 1];
    const auto found = std::find(begin, end, -1);
    return found == end ? -1 : static_cast<std::int32_t>(found - numbering.user_of_internal.begin());
}

}  // namespace

std::int32_t SpareNodes::take_fixed(NodeNumbering& numbering, std::int32_t user) {
    const auto found =
        std::find(numbering.user_of_internal.begin() + next_fixed_, numbering.user_of_internal.end(), -1);
    if (found == numbering.user_of_internal.end()) return -1;
    *found = user;
    return static_cast<std::int32_t>(found - numbering.user_of_internal.begin());
}

std::int32_t SpareNodes::take(NodeNumbering& numbering, std::int32_t user, bool is_fixed,
                              std::span<const std::int32_t> neighbours) {
    if (!numbering.has_room()) return -1;
    if (is_fixed) return take_fixed(numbering, user);
    const std::int32_t first = numbering.block_aggregate_begin[numbering.first_blocks()];
    std::int32_t& end = numbering.block_aggregate_begin.back();
    std::int32_t node = -1;
    for (const std::int32_t neighbour : neighbours) {
        if (neighbour < numbering.spare_begin || !numbering.is_free(neighbour)) continue;
        node = place_in(numbering, first + (neighbour - numbering.spare_begin) / nodes_per_aggregate);
        if (node >= 0) break;
    }
    if (node < 0 && end < numbering.aggregates()) {
        node = numbering.aggregate_begin[end++];
        numbering.block_begin.back() = numbering.aggregate_begin[end];
    }
    for (std::int32_t aggregate = first; node < 0 && aggregate < end; ++aggregate) {
        node = place_in(numbering, aggregate);
    }
    if (node >= 0) numbering.user_of_internal[node] = user;
    return node;
}

}  // namespace lancet::kernels
