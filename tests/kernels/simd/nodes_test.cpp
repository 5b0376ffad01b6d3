#include <cmath>

#include "tests/kernels/simd/simd_test.hpp"

namespace lancet::kernels::test {

namespace {

constexpr int nodes = 40;

template <class Real>
std::vector<Real> nodal_vector() {
    std::vector<Real> v(4 * nodes);
    for (int i = 0; i < 4 * nodes; ++i) v[i] = Real(std::sin(1.0 + i));
    return v;
}

/// The places of a different node in every lane, in no order.
std::vector<std::int32_t> distinct(int width) {
    std::vector<std::int32_t> index(width);
    for (int lane = 0; lane < width; ++lane) index[lane] = 4 * ((lane * 7 + 3) % nodes);
    return index;
}

template <class Real>
std::vector<Real> lane_values(int width) {
    std::vector<Real> v(3 * width);
    for (int i = 0; i < 3 * width; ++i) v[i] = Real(std::cos(2.0 + i));
    return v;
}

}  // namespace

class NodesTest : public SimdTest {};

TEST_P(NodesTest, LoadTransposesIntoLanes) {
    for_each_scalar([]<class Real>(const SimdProbe<Real>& probe) {
        const auto nodal = nodal_vector<Real>();
        const auto index = distinct(probe.width);
        std::vector<Real> lanes(3 * probe.width), row(3 * probe.width);
        probe.load_nodes(nodal.data(), index.data(), lanes.data());
        probe.load_consecutive(nodal.data() + 4 * 5, row.data());
        for (int c = 0; c < 3; ++c) {
            for (int lane = 0; lane < probe.width; ++lane) {
                EXPECT_EQ(lanes[c * probe.width + lane], nodal[index[lane] + c]) << "lane " << lane;
                EXPECT_EQ(row[c * probe.width + lane], nodal[4 * (5 + lane) + c]) << "lane " << lane;
            }
        }
    });
}

TEST_P(NodesTest, StoreWritesItsNodesAndNoOther) {
    for_each_scalar([]<class Real>(const SimdProbe<Real>& probe) {
        const auto before = nodal_vector<Real>();
        const auto index = distinct(probe.width);
        const auto lanes = lane_values<Real>(probe.width);
        auto scattered = before;
        auto row = before;
        auto scattered_right = before;
        auto row_right = before;
        for (int lane = 0; lane < probe.width; ++lane) {
            for (int c = 0; c < 4; ++c) {
                const Real value = c < 3 ? lanes[c * probe.width + lane] : Real(0);
                scattered_right[index[lane] + c] = value;
                row_right[4 * (5 + lane) + c] = value;
            }
        }
        probe.store_nodes(scattered.data(), index.data(), lanes.data());
        probe.store_consecutive(row.data() + 4 * 5, lanes.data());
        EXPECT_EQ(scattered, scattered_right);
        EXPECT_EQ(row, row_right);
    });
}

TEST_P(NodesTest, LanesMayAddToTheSameNode) {
    for_each_scalar([]<class Real>(const SimdProbe<Real>& probe) {
        for (const int period : {1, 2, 3, nodes}) {  // all lanes share one node ... none does
            std::vector<std::int32_t> index(probe.width);
            for (int lane = 0; lane < probe.width; ++lane) index[lane] = 4 * (4 + lane % period);
            const auto lanes = lane_values<Real>(probe.width);
            auto nodal = nodal_vector<Real>();
            auto right = nodal;
            for (int lane = 0; lane < probe.width; ++lane) {
                for (int c = 0; c < 3; ++c) right[index[lane] + c] += lanes[c * probe.width + lane];
            }
            probe.add_to_nodes(nodal.data(), index.data(), lanes.data());
            EXPECT_EQ(nodal, right) << "period " << period;
        }
    });
}

// Positions 1e6 from the origin, a millionth apart: formed in float, nothing would be left of the difference.
TEST_P(NodesTest, DifferencesAreFormedInDouble) {
    for_each_scalar([]<class Real>(const SimdProbe<Real>& probe) {
        std::vector<double> nodal(4 * nodes);
        for (int i = 0; i < 4 * nodes; ++i) nodal[i] = 1e6 + 1e-6 * std::sin(1.0 + i);
        const auto index = distinct(probe.width);
        std::vector<std::int32_t> origin(probe.width);
        for (int lane = 0; lane < probe.width; ++lane) origin[lane] = 4 * ((lane * 5 + 1) % nodes);
        std::vector<Real> lanes(3 * probe.width);
        probe.load_differences(nodal.data(), index.data(), origin.data(), lanes.data());
        for (int c = 0; c < 3; ++c) {
            for (int lane = 0; lane < probe.width; ++lane) {
                const double right = nodal[index[lane] + c] - nodal[origin[lane] + c];
                EXPECT_EQ(lanes[c * probe.width + lane], static_cast<Real>(right)) << "lane " << lane;
            }
        }
    });
}

// Rows have no spare number: of the last one nothing behind it may be read, or written.
TEST_P(NodesTest, RowsAreReadAndWrittenToTheirEnds) {
    for_each_scalar([]<class Real>(const SimdProbe<Real>& probe) {
        std::vector<double> rows(3 * nodes);
        for (int i = 0; i < 3 * nodes; ++i) rows[i] = 1e6 + 1e-6 * std::sin(1.0 + i);
        auto index = distinct(probe.width);
        std::vector<std::int32_t> origin(probe.width);
        for (int lane = 0; lane < probe.width; ++lane) {
            index[lane] = index[lane] / 4 * 3;
            origin[lane] = 3 * ((lane * 5 + 1) % nodes);
        }
        index.back() = 3 * (nodes - 1);
        std::vector<Real> lanes(3 * probe.width);
        probe.row_differences(rows.data(), index.data(), origin.data(), lanes.data());
        auto written = rows, right = rows;
        probe.store_rows(written.data(), index.data(), lanes.data());
        for (int c = 0; c < 3; ++c) {
            for (int lane = 0; lane < probe.width; ++lane) {
                const double difference = rows[index[lane] + c] - rows[origin[lane] + c];
                EXPECT_EQ(lanes[c * probe.width + lane], static_cast<Real>(difference)) << "lane " << lane;
                right[index[lane] + c] = static_cast<double>(lanes[c * probe.width + lane]);
            }
        }
        EXPECT_EQ(written, right);
    });
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, NodesTest, ::testing::ValuesIn(compiled_instruction_sets()), set_name);

}  // namespace lancet::kernels::test
