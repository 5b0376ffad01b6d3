#include "lancet/kernels/layout/row_pattern_changes.hpp"

#include <utility>

namespace lancet::kernels {

namespace {

/// The elements of an edge at one place of the pattern.
struct Incidences {
    std::int32_t* first;  ///< corner of the row's node, of each element; that of the column's is `column` behind it
    std::size_t column, stride;
    std::int32_t room, count;
    std::int32_t nothing;

    std::int32_t& row_corner(std::int32_t k) const { return first[static_cast<std::size_t>(k) * stride]; }
    std::int32_t& column_corner(std::int32_t k) const { return first[static_cast<std::size_t>(k) * stride + column]; }
};

Incidences incidences_at(RowPattern& pattern, std::int32_t entry, std::int32_t lane, std::int32_t nothing) {
    const auto width = static_cast<std::size_t>(pattern.width);
    const std::int32_t begin = pattern.incidence_begin[entry];
    Incidences at{.first = pattern.incidence.data() + static_cast<std::size_t>(begin) * 2 * width + lane,
                  .column = width,
                  .stride = 2 * width,
                  .room = pattern.incidence_begin[entry + 1] - begin,
                  .count = 0,
                  .nothing = nothing};
    while (at.count < at.room && at.row_corner(at.count) != nothing) ++at.count;
    return at;
}

}  // namespace

RowPatternChanges::RowPatternChanges(const RowPattern& pattern, const NodeNumbering& numbering)
    : place_of_row_(static_cast<std::size_t>(numbering.free_count), -1),
      next_place_(pattern.row.size(), -1),
      next_row_(pattern.room_begin.front() * pattern.width) {
    for (std::int32_t place = 0; place < next_row_; ++place) place_of_row_[pattern.row[place] / 4] = place;
}

RowPatternChanges::Edge RowPatternChanges::edge_of(const NodeNumbering& numbering, std::int32_t slot,
                                                   const Tetrahedron& nodes, std::int32_t i, std::int32_t j) {
    const auto is_in_room = [&](std::int32_t node) { return node >= numbering.spare_begin && numbering.is_free(node); };
    const std::int32_t a = nodes[static_cast<std::size_t>(i)], b = nodes[static_cast<std::size_t>(j)];
    const bool row_is_first = is_in_room(a) == is_in_room(b) ? a < b : is_in_room(a);
    return row_is_first ? Edge{a, b, 4 * slot + i, 4 * slot + j} : Edge{b, a, 4 * slot + j, 4 * slot + i};
}

bool RowPatternChanges::enter(RowPattern& pattern, const NodeNumbering& numbering, const ElementMove& move) {
    for (std::int32_t i = 0; i < 4; ++i) {
        for (std::int32_t j = i + 1; j < 4; ++j) {
            const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
            if (move.before[a] == move.after[a] && move.before[b] == move.after[b]) continue;
            if (move.before[a] >= 0) {
                const Edge edge = edge_of(numbering, move.slot, move.before, i, j);
                if (numbering.is_free(edge.row) && !remove(pattern, edge)) return false;
            }
            if (move.after[a] >= 0) {
                const Edge edge = edge_of(numbering, move.slot, move.after, i, j);
                if (numbering.is_free(edge.row) && !add(pattern, numbering, edge)) return false;
            }
        }
    }
    return true;
}

bool RowPatternChanges::remove(RowPattern& pattern, const Edge& edge) {
    const std::int32_t nothing = pattern.nothing();
    return find_place(pattern, edge.row, [&](std::int32_t entry, std::int32_t lane) {
        if (pattern.column[entry * pattern.width + lane] != 4 * edge.column) return false;
        const Incidences at = incidences_at(pattern, entry, lane, nothing);
        for (std::int32_t k = 0; k < at.count; ++k) {
            if (at.row_corner(k) != 4 * edge.row_corner) continue;
            at.row_corner(k) = at.row_corner(at.count - 1);
            at.column_corner(k) = at.column_corner(at.count - 1);
            at.row_corner(at.count - 1) = at.column_corner(at.count - 1) = nothing;
            changed_.push_back(entry * pattern.width + lane);
            return true;
        }
        return false;
    });
}

bool RowPatternChanges::add(RowPattern& pattern, const NodeNumbering& numbering, const Edge& edge) {
    const std::int32_t nothing = pattern.nothing();
    const auto enter_at = [&](std::int32_t entry, std::int32_t lane, const Incidences& at) {
        at.row_corner(at.count) = 4 * edge.row_corner;
        at.column_corner(at.count) = 4 * edge.column_corner;
        changed_.push_back(entry * pattern.width + lane);
    };
    std::int32_t empty = -1;
    const bool is_entered = find_place(pattern, edge.row, [&](std::int32_t entry, std::int32_t lane) {
        const std::int32_t place = entry * pattern.width + lane;
        const bool is_this = pattern.column[place] == 4 * edge.column;
        if (!is_this && empty >= 0) return false;
        const Incidences at = incidences_at(pattern, entry, lane, nothing);
        if (at.count == at.room) return false;
        if (is_this) {
            enter_at(entry, lane, at);
            return true;
        }
        if (at.count == 0) empty = place;
        return false;
    });
    if (is_entered) return true;
    if (empty < 0) {
        const std::int32_t row = take_row(pattern, numbering, edge.row);
        if (row < 0) return false;
        empty = pattern.chunk_entry_begin[row / pattern.width] * pattern.width + row % pattern.width;
    }
    const bool is_in_room = empty >= pattern.chunk_entry_begin[pattern.room_begin.front()] * pattern.width;
    const int block = is_in_room ? numbering.first_blocks() : numbering.block_of(edge.row);
    const std::int32_t target = pattern.scatter.changed_target(numbering, block, edge.column);
    if (target < 0) return false;
    pattern.column[empty] = 4 * edge.column;
    pattern.column_target[empty] = 4 * target;
    enter_at(empty / pattern.width, empty % pattern.width,
             incidences_at(pattern, empty / pattern.width, empty % pattern.width, nothing));
    return true;
}

std::int32_t RowPatternChanges::take_row(RowPattern& pattern, const NodeNumbering& numbering, std::int32_t row) {
    if (next_row_ == static_cast<std::int32_t>(pattern.row.size())) return -1;
    const std::int32_t target = pattern.scatter.changed_target(numbering, numbering.first_blocks(), row);
    if (target < 0) return -1;
    const std::int32_t place = next_row_++, chunk = place / pattern.width;
    pattern.block_chunk_begin.back() = chunk + 1;
    pattern.row[place] = 4 * row;
    pattern.row_target[place] = 4 * target;
    for (std::int32_t entry = pattern.chunk_entry_begin[chunk]; entry < pattern.chunk_entry_begin[chunk + 1]; ++entry) {
        pattern.column[entry * pattern.width + place % pattern.width] = 4 * row;
    }
    next_place_[place] = std::exchange(place_of_row_[row], place);
    return place;
}

std::size_t RowPatternChanges::bytes() const noexcept {
    return heap_bytes(place_of_row_) + heap_bytes(next_place_) + heap_bytes(changed_);
}

}  // namespace lancet::kernels
