#include "lancet/kernels/layout/row_pattern.hpp"

#include <algorithm>
#include <numeric>

namespace lancet::kernels {

namespace {

/// Entry (row, column) of the matrix and one element that contributes to it.
struct Contribution {
    std::int32_t column;
    std::int32_t row_corner;  ///< 4 * slot + corner
    std::int32_t column_corner;
};

/// One block of a row: its contributions are [begin, end) of the row.
struct Block {
    std::int32_t column;
    std::int32_t begin;
    std::int32_t end;
};

/// The contributions to each free row, compressed by rows.
struct RowContributions {
    std::vector<std::int64_t> begin;
    std::vector<Contribution> list;

    std::span<const Contribution> row(std::int32_t node) const {
        return std::span(list).subspan(static_cast<std::size_t>(begin[node]),
                                       static_cast<std::size_t>(begin[node + 1] - begin[node]));
    }
};

/// Calls visit(row, contribution) for each pair of corners that the content asks for.
template <class Visit>
void visit_contributions(RowContent content, std::span<const Tetrahedron> tetrahedra,
                         std::span<const std::int32_t> slot_of_element, const NodeNumbering& numbering, Visit visit) {
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        for (std::int32_t i = 0; i < 4; ++i) {
            const std::int32_t row = numbering.internal_of_user[tetrahedra[e][static_cast<std::size_t>(i)]];
            if (!numbering.is_free(row)) continue;
            for (std::int32_t j = 0; j < 4; ++j) {
                const std::int32_t column = numbering.internal_of_user[tetrahedra[e][static_cast<std::size_t>(j)]];
                if (content == RowContent::upper_edges && column <= row) continue;
                visit(row, Contribution{column, 4 * slot_of_element[e] + i, 4 * slot_of_element[e] + j});
            }
        }
    }
}

RowContributions collect(RowContent content, std::span<const Tetrahedron> tetrahedra,
                         std::span<const std::int32_t> slot_of_element, const NodeNumbering& numbering) {
    RowContributions rows;
    rows.begin.assign(static_cast<std::size_t>(numbering.free_count) + 1, 0);
    visit_contributions(content, tetrahedra, slot_of_element, numbering,
                        [&](std::int32_t row, const Contribution&) { ++rows.begin[row + 1]; });
    std::partial_sum(rows.begin.begin(), rows.begin.end(), rows.begin.begin());
    rows.list.resize(static_cast<std::size_t>(rows.begin.back()));
    std::vector<std::int64_t> next(rows.begin.begin(), rows.begin.end() - 1);
    visit_contributions(content, tetrahedra, slot_of_element, numbering,
                        [&](std::int32_t row, const Contribution& c) { rows.list[next[row]++] = c; });
    for (std::int32_t row = 0; row < numbering.free_count; ++row) {
        std::sort(rows.list.begin() + rows.begin[row], rows.list.begin() + rows.begin[row + 1],
                  [](const Contribution& a, const Contribution& b) {
                      return a.column != b.column ? a.column < b.column : a.row_corner < b.row_corner;
                  });
    }
    return rows;
}

/// The blocks of a row: the diagonal first, then those of most elements, so that the lanes of an entry have similar
/// numbers of incidences.
std::vector<Block> blocks_of_row(std::int32_t row, std::span<const Contribution> contributions) {
    std::vector<Block> blocks;
    for (std::size_t k = 0; k < contributions.size(); ++k) {
        const auto place = static_cast<std::int32_t>(k);
        if (blocks.empty() || blocks.back().column != contributions[k].column) {
            blocks.push_back({contributions[k].column, place, place});
        }
        blocks.back().end = place + 1;
    }
    std::stable_sort(blocks.begin(), blocks.end(), [&](const Block& a, const Block& b) {
        if ((a.column == row) != (b.column == row)) return a.column == row;
        return a.end - a.begin > b.end - b.begin;
    });
    return blocks;
}

/// Reorders rows that are sorted by length so that the lanes of a chunk come from distant places of each run of rows
/// of equal length.
void spread_lanes(std::vector<std::int32_t>& rows, const std::vector<std::int32_t>& length, std::size_t lanes) {
    std::vector<std::int32_t> run;
    for (std::size_t begin = 0; begin < rows.size();) {
        std::size_t end = begin;
        while (end < rows.size() && length[rows[end]] == length[rows[begin]]) ++end;
        const std::size_t whole = (end - begin) / lanes;
        run.assign(rows.begin() + static_cast<std::ptrdiff_t>(begin), rows.begin() + static_cast<std::ptrdiff_t>(end));
        for (std::size_t chunk = 0; chunk < whole; ++chunk) {
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                rows[begin + chunk * lanes + lane] = run[lane * whole + chunk];
            }
        }
        begin = end;
    }
}

/// The chunks of the room, without a row: some for each of its nodes, and some for edges of others that get more
/// elements than their places in the pattern hold.
void add_room(RowPattern& pattern, const NodeNumbering& numbering, std::int32_t nothing) {
    constexpr int rows_per_node = 5, entries = 4, incidences = 6;
    const int chunks =
        (rows_per_node * (numbering.free_count - numbering.spare_begin) + pattern.width - 1) / pattern.width;
    const std::int32_t unused = pattern.scatter.unused(numbering.first_blocks());
    const auto append = [&](AlignedVector<std::int32_t>& numbers, std::int32_t number, int chunk_numbers) {
        numbers.insert(numbers.end(), static_cast<std::size_t>(chunks * chunk_numbers * pattern.width), number);
    };
    pattern.room_begin = {pattern.block_chunk_begin.back()};
    append(pattern.row, 4 * numbering.spare_begin, 1);
    append(pattern.row_target, 4 * unused, 1);
    append(pattern.column, 4 * numbering.spare_begin, entries);
    append(pattern.column_target, 4 * unused, entries);
    append(pattern.incidence, 4 * nothing, 2 * entries * incidences);
    for (int entry = 0; entry < chunks * entries; ++entry) {
        pattern.incidence_begin.push_back(pattern.incidence_begin.back() + incidences);
        if ((entry + 1) % entries == 0) {
            pattern.chunk_entry_begin.push_back(static_cast<std::int32_t>(pattern.incidence_begin.size()) - 1);
        }
    }
}

}  // namespace

std::size_t RowPattern::bytes() const noexcept {
    return heap_bytes(block_chunk_begin) + heap_bytes(chunk_entry_begin) + heap_bytes(row) + heap_bytes(row_target) +
           heap_bytes(column) + heap_bytes(column_target) + heap_bytes(incidence_begin) + heap_bytes(incidence) +
           scatter.bytes();
}

RowPattern make_row_pattern(RowContent content, std::span<const Tetrahedron> tetrahedra,
                            std::span<const std::int32_t> slot_of_element, std::int32_t slots,
                            const NodeNumbering& numbering, ScatterStrategy strategy, int width) {
    RowPattern pattern;
    pattern.width = width;
    pattern.content = content;
    pattern.slots = slots;
    pattern.scatter = ScatterPlan(strategy, numbering);
    const auto lanes = static_cast<std::size_t>(width);
    const bool is_half = content == RowContent::upper_edges;
    const std::int32_t nothing = 4 * slots;

    const RowContributions contributions = collect(content, tetrahedra, slot_of_element, numbering);
    std::vector<std::vector<Block>> rows(static_cast<std::size_t>(numbering.free_count));
    std::vector<std::int32_t> length(rows.size());
    for (std::int32_t row = 0; row < numbering.free_count; ++row) {
        rows[row] = blocks_of_row(row, contributions.row(row));
        length[row] = static_cast<std::int32_t>(rows[row].size());
        pattern.blocks_stored += length[row];
    }

    pattern.block_chunk_begin.push_back(0);
    pattern.chunk_entry_begin.push_back(0);
    pattern.incidence_begin.push_back(0);
    for (int block = 0; block < numbering.blocks(); ++block) {
        std::vector<std::int32_t> order(
            static_cast<std::size_t>(numbering.block_begin[block + 1] - numbering.block_begin[block]));
        std::iota(order.begin(), order.end(), numbering.block_begin[block]);
        std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return length[a] > length[b]; });
        spread_lanes(order, length, lanes);

        for (std::size_t first = 0; first < order.size(); first += lanes) {
            std::size_t entries = 0;
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                const bool is_padding = first + lane >= order.size();
                const std::int32_t row = is_padding ? order[first] : order[first + lane];
                pattern.row.push_back(4 * row);
                // A row's own sum is stored by its block; where every contribution has a slot, it needs none.
                pattern.row_target.push_back(4 * (is_padding && is_half ? pattern.scatter.unused(block) : row));
                if (!is_padding) entries = std::max(entries, rows[row].size());
            }
            for (std::size_t entry = 0; entry < entries; ++entry) {
                std::size_t incidences = 0;
                const auto block_at = [&](std::size_t lane) -> const Block* {
                    if (first + lane >= order.size()) return nullptr;
                    const std::vector<Block>& blocks = rows[order[first + lane]];
                    return entry < blocks.size() ? &blocks[entry] : nullptr;
                };
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    const Block* stored = block_at(lane);
                    const std::int32_t row = pattern.row[pattern.row.size() - lanes + lane];
                    pattern.column.push_back(stored != nullptr ? 4 * stored->column : row);
                    if (is_half) {
                        pattern.column_target.push_back(4 * (stored != nullptr
                                                                 ? pattern.scatter.target(block, stored->column)
                                                                 : pattern.scatter.unused(block)));
                    }
                    if (stored != nullptr) {
                        incidences = std::max(incidences, static_cast<std::size_t>(stored->end - stored->begin));
                    }
                }
                for (std::size_t k = 0; k < incidences; ++k) {
                    for (const bool of_column : {false, true}) {
                        for (std::size_t lane = 0; lane < lanes; ++lane) {
                            const Block* stored = block_at(lane);
                            std::int32_t corner = nothing;
                            if (stored != nullptr && k < static_cast<std::size_t>(stored->end - stored->begin)) {
                                const Contribution& c =
                                    contributions.row(order[first + lane])[static_cast<std::size_t>(stored->begin) + k];
                                corner = of_column ? c.column_corner : c.row_corner;
                            }
                            pattern.incidence.push_back(4 * corner);
                        }
                    }
                }
                pattern.incidence_begin.push_back(pattern.incidence_begin.back() +
                                                  static_cast<std::int32_t>(incidences));
            }
            pattern.chunk_entry_begin.push_back(static_cast<std::int32_t>(pattern.incidence_begin.size()) - 1);
        }
        pattern.block_chunk_begin.push_back(static_cast<std::int32_t>(pattern.chunk_entry_begin.size()) - 1);
    }
    if (numbering.has_room() && is_half) add_room(pattern, numbering, nothing);
    pattern.scatter.finish();
    pattern.row.shrink_to_fit();
    pattern.row_target.shrink_to_fit();
    pattern.column.shrink_to_fit();
    pattern.column_target.shrink_to_fit();
    pattern.incidence_begin.shrink_to_fit();
    pattern.incidence.shrink_to_fit();
    return pattern;
}

}  // namespace lancet::kernels
