#include <map>
#include <set>
#include <tuple>

#include "tests/kernels/layout/layouts_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

using kernels::RowContent;
using kernels::RowPattern;
using NodePair = std::pair<std::int32_t, std::int32_t>;

class RowPatterns : public ::testing::TestWithParam<std::tuple<ScatterStrategy, int>> {
  protected:
    ReferenceSolid solid = layout_solid();
    NodeNumbering numbering = numbered(solid, layout_options);
    kernels::ElementBatches<double> batches =
        batches_of<double>(solid, numbering, std::get<0>(GetParam()), std::get<1>(GetParam()));
    std::size_t width = static_cast<std::size_t>(std::get<1>(GetParam()));

    RowPattern pattern(RowContent content) const {
        return kernels::make_row_pattern(content, solid.tetrahedra, batches.slot_of_element, batches.slots(), numbering,
                                         std::get<0>(GetParam()), std::get<1>(GetParam()));
    }

    /// Every block that the content asks for, with the corners (4 * (4 * slot + corner)) that contribute to it.
    std::map<NodePair, std::set<NodePair>> expected(RowContent content) const {
        std::map<NodePair, std::set<NodePair>> blocks;
        for (std::size_t e = 0; e < solid.tetrahedra.size(); ++e) {
            for (std::int32_t i = 0; i < 4; ++i) {
                for (std::int32_t j = 0; j < 4; ++j) {
                    const std::int32_t row = numbering.internal_of_user[solid.tetrahedra[e][i]];
                    const std::int32_t column = numbering.internal_of_user[solid.tetrahedra[e][j]];
                    const bool wanted = content == RowContent::full_rows || row < column;
                    if (!numbering.is_free(row) || !wanted) continue;
                    const std::int32_t slot = batches.slot_of_element[e];
                    blocks[{row, column}].insert({4 * (4 * slot + i), 4 * (4 * slot + j)});
                }
            }
        }
        return blocks;
    }

    static bool is_padding_row(const RowPattern& p, std::int32_t chunk, std::size_t lane) {
        // Padding repeats the first row of its chunk.
        const std::size_t at = static_cast<std::size_t>(chunk * p.width);
        return lane > 0 && p.row[at + lane] == p.row[at];
    }
};
INSTANTIATE_TEST_SUITE_P(StrategiesAndWidths, RowPatterns,
                         ::testing::Combine(::testing::ValuesIn(scatter_strategies), ::testing::Values(1, 4, 8, 16)),
                         layout_name);

TEST_P(RowPatterns, HoldEveryBlockOnceWithAllItsIncidences) {
    for (const RowContent content : {RowContent::upper_edges, RowContent::full_rows}) {
        SCOPED_TRACE(static_cast<int>(content));
        const RowPattern p = pattern(content);
        const std::int32_t nothing = 16 * batches.slots();
        auto left = expected(content);
        EXPECT_EQ(p.blocks_stored, static_cast<std::int64_t>(left.size()));
        std::set<std::int32_t> rows;
        for (int block = 0; block < numbering.blocks(); ++block) {
            for (std::int32_t chunk = p.block_chunk_begin[block]; chunk < p.block_chunk_begin[block + 1]; ++chunk) {
                for (std::size_t lane = 0; lane < width; ++lane) {
                    const std::int32_t row = p.row[static_cast<std::size_t>(chunk) * width + lane] / 4;
                    ASSERT_EQ(numbering.block_of(row), block);
                    const bool repeats = is_padding_row(p, chunk, lane);
                    EXPECT_EQ(repeats, !rows.insert(row).second);
                    for (std::int32_t entry = p.chunk_entry_begin[chunk]; entry < p.chunk_entry_begin[chunk + 1];
                         ++entry) {
                        const std::int32_t column = p.column[static_cast<std::size_t>(entry) * width + lane] / 4;
                        ASSERT_GE(column, 0);
                        ASSERT_LT(column, numbering.node_count);
                        std::set<NodePair> incidences;
                        for (std::int32_t k = p.incidence_begin[entry]; k < p.incidence_begin[entry + 1]; ++k) {
                            const std::size_t at = static_cast<std::size_t>(k) * 2 * width + lane;
                            const NodePair corners{p.incidence[at], p.incidence[at + width]};
                            EXPECT_EQ(corners.first == nothing, corners.second == nothing);
                            if (corners.first == nothing) continue;
                            EXPECT_TRUE(incidences.insert(corners).second);
                        }
                        if (incidences.empty()) continue;  // padding
                        EXPECT_FALSE(repeats);
                        const auto found = left.find({row, column});
                        ASSERT_NE(found, left.end()) << "block " << row << ", " << column << " twice or unasked for";
                        EXPECT_EQ(incidences, found->second);
                        left.erase(found);
                    }
                }
            }
        }
        EXPECT_TRUE(left.empty()) << left.size() << " blocks are missing";
        EXPECT_EQ(rows.size(), static_cast<std::size_t>(numbering.free_count));
    }
}

TEST_P(RowPatterns, FullRowsStartWithTheDiagonal) {
    const RowPattern p = pattern(RowContent::full_rows);
    for (std::int32_t chunk = 0; chunk < p.chunks(); ++chunk) {
        if (p.chunk_entry_begin[chunk] == p.chunk_entry_begin[chunk + 1]) continue;
        for (std::size_t lane = 0; lane < width; ++lane) {
            EXPECT_EQ(p.column[static_cast<std::size_t>(p.chunk_entry_begin[chunk]) * width + lane],
                      p.row[static_cast<std::size_t>(chunk) * width + lane]);
        }
    }
}

TEST_P(RowPatterns, EdgesReachBothEndsOnce) {
    const RowPattern p = pattern(RowContent::upper_edges);
    const std::int32_t nothing = 16 * batches.slots();
    std::vector<double> expected_sum(static_cast<std::size_t>(numbering.node_count), 0.0);
    std::vector<double> buffer(static_cast<std::size_t>(p.scatter.buffer_size()), 0.0);
    std::vector<std::set<std::int32_t>> written(static_cast<std::size_t>(numbering.blocks()));
    for (int block = 0; block < numbering.blocks(); ++block) {
        for (std::int32_t chunk = p.block_chunk_begin[block]; chunk < p.block_chunk_begin[block + 1]; ++chunk) {
            for (std::size_t lane = 0; lane < width; ++lane) {
                const std::size_t at_row = static_cast<std::size_t>(chunk) * width + lane;
                // Padding of chunks and entries adds numbers that must reach nobody.
                double sum = is_padding_row(p, chunk, lane) ? 1e9 : 0.0;
                for (std::int32_t entry = p.chunk_entry_begin[chunk]; entry < p.chunk_entry_begin[chunk + 1]; ++entry) {
                    const std::size_t at = static_cast<std::size_t>(entry) * width + lane;
                    bool is_edge = false;
                    for (std::int32_t k = p.incidence_begin[entry]; k < p.incidence_begin[entry + 1]; ++k) {
                        is_edge = is_edge || p.incidence[static_cast<std::size_t>(k) * 2 * width + lane] != nothing;
                    }
                    const double value = 1.0 + static_cast<double>((at * 2654435761U) % 1000003U);
                    buffer[p.column_target[at] / 4] += is_edge ? value : 1e9;
                    written[static_cast<std::size_t>(block)].insert(p.column_target[at] / 4);
                    if (!is_edge) continue;
                    sum += value;
                    expected_sum[p.row[at_row] / 4] += value;
                    expected_sum[p.column[at] / 4] += value;
                }
                buffer[p.row_target[at_row] / 4] += sum;
                written[static_cast<std::size_t>(block)].insert(p.row_target[at_row] / 4);
            }
        }
    }
    for (const auto& [node, slot] : p.scatter.merges()) buffer[node] += buffer[slot];
    for (std::int32_t node = 0; node < numbering.free_count; ++node) EXPECT_EQ(buffer[node], expected_sum[node]);
    for (const auto& color : p.scatter.colors()) {
        std::set<std::int32_t> of_color;
        for (const std::int32_t block : color) {
            for (const std::int32_t target : written[static_cast<std::size_t>(block)]) {
                EXPECT_TRUE(of_color.insert(target).second) << "two blocks of a color write to " << target;
            }
        }
    }
}

}  // namespace
}  // namespace lancet::test
