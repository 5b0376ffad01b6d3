#include "lancet/runtime/solve/coarse_matrix.hpp"

#include <algorithm>

namespace lancet::runtime {

using Eigen::Matrix3d;
using Eigen::Vector3d;

template <class Real>
CoarseMatrix<Real>::CoarseMatrix(const kernels::KernelSet<Real>& kernels, const BlockMatrix<Real>& edges,
                                 const kernels::NodeNumbering& numbering, const Aggregates& aggregates)
    : kernels_(&kernels),
      edges_(&edges),
      numbering_(&numbering),
      aggregates_(&aggregates),
      crossing_(static_cast<std::size_t>(numbering.blocks())),
      pairs_(crossing_.size()) {
    for (int block = 0; block < numbering.blocks(); ++block) take_up_edges(block);
}

template <class Real>
void CoarseMatrix<Real>::resize(int aggregates) {
    diagonal_.assign(static_cast<std::size_t>(aggregates), RigidMatrix::Zero());
    inside_.resize(static_cast<std::size_t>(aggregates) * kernels::coarse_diagonal_sums);
}

template <class Real>
void CoarseMatrix<Real>::clear() {
    for (RigidMatrix& diagonal : diagonal_) diagonal.setZero();
}

template <class Real>
std::vector<int> CoarseMatrix<Real>::borders(int block) const {
    std::vector<int> blocks;
    for (const AggregatePair& pair : pairs_[static_cast<std::size_t>(block)]) {
        blocks.push_back(aggregates_->block_of(pair.first));
        blocks.push_back(aggregates_->block_of(pair.second));
    }
    return blocks;
}

template <class Real>
void CoarseMatrix<Real>::take_up_edges(int block) {
    const kernels::RowPattern& pattern = edges_->pattern();
    std::vector<AggregatePair>& pairs = pairs_[static_cast<std::size_t>(block)];
    std::vector<CrossingEdge>& crossing = crossing_[static_cast<std::size_t>(block)];
    crossing.clear();
    pairs.clear();
    // A block borders on few aggregates, and an edge mostly on those of the one before.
    std::size_t last = 0;
    const auto pair_of = [&](std::int32_t a, std::int32_t b) {
        const auto is_pair = [&](const AggregatePair& pair) { return pair.first == a && pair.second == b; };
        if (last < pairs.size() && is_pair(pairs[last])) return static_cast<std::int32_t>(last);
        const auto found = std::find_if(pairs.begin(), pairs.end(), is_pair);
        last = static_cast<std::size_t>(found - pairs.begin());
        if (found == pairs.end()) pairs.push_back({a, b, 0, RigidMatrix::Zero(), RigidMatrix::Zero()});
        return static_cast<std::int32_t>(last);
    };
    const auto is_own = [&](std::int32_t row) {
        return numbering_->block_begin[block] <= row && row < numbering_->block_begin[block + 1];
    };
    for (std::int32_t chunk = pattern.block_chunk_begin[block]; chunk < pattern.block_chunk_begin[block + 1]; ++chunk) {
        for (std::int32_t entry = pattern.chunk_entry_begin[chunk]; entry < pattern.chunk_entry_begin[chunk + 1];
             ++entry) {
            for (int lane = 0; lane < pattern.width; ++lane) {
                const std::int32_t row = pattern.row[chunk * pattern.width + lane] / 4;
                const std::int32_t column = pattern.column[entry * pattern.width + lane] / 4;
                const std::int32_t a = aggregates_->of_node()[row], b = aggregates_->of_node()[column];
                // The room also has edges within aggregates of other blocks.
                if (a == b && (row == column || is_own(row))) continue;
                const std::int32_t pair = b >= 0 ? pair_of(a, b) : -1;
                crossing.push_back({entry * 9 * pattern.width + lane, row, column, pair});
                if (pair >= 0 && pattern.has_elements(entry, lane)) ++pairs[static_cast<std::size_t>(pair)].edges;
            }
        }
    }
}

template <class Real>
std::vector<Aggregates::Link> CoarseMatrix<Real>::links() const {
    std::vector<Aggregates::Link> links;
    for (const auto& pairs : pairs_) {
        for (const AggregatePair& pair : pairs) links.push_back({pair.first, pair.second, pair.edges});
    }
    return links;
}

template <class Real>
void CoarseMatrix<Real>::add_inside(const Real* offset, const Real* scaled_mass, int block) {
    const kernels::RowPattern& pattern = edges_->pattern();
    const auto inside_of = [&](std::int32_t a) {
        return inside_.data() + static_cast<std::ptrdiff_t>(a) * kernels::coarse_diagonal_sums;
    };
    // Masses, sum m T^T T with T = [1, -[r]x], and the edges within an aggregate.
    aggregates_->for_each_of_block(
        block, [&](std::int32_t a) { std::fill_n(inside_of(a), kernels::coarse_diagonal_sums, 0.0); });
    kernels_->coarse.diagonal({.block_chunk_begin = pattern.block_chunk_begin.data(),
                               .chunk_entry_begin = pattern.chunk_entry_begin.data(),
                               .row = pattern.row.data(),
                               .column = pattern.column.data(),
                               .values = edges_->values(),
                               .aggregate = aggregates_->of_node().data(),
                               .offset = offset,
                               .sums = inside_.data()},
                              block);
    aggregates_->for_each_of_block(block, [&](std::int32_t a) {
        double mass = 0;
        Vector3d moment = Vector3d::Zero();
        Matrix3d second_moment = Matrix3d::Zero();
        aggregates_->for_each_node(a, [&](std::int32_t node) {
            const auto nodal = static_cast<double>(scaled_mass[node]);
            const Vector3d r = nodal_vector(offset, node);
            mass += nodal;
            moment += nodal * r;
            second_moment += nodal * r * r.transpose();
        });
        const double* inside = inside_of(a);
        RigidMatrix& diagonal = diagonal_[static_cast<std::size_t>(a)];
        diagonal.setZero();
        diagonal.topLeftCorner<3, 3>().diagonal().setConstant(mass);
        diagonal.topRightCorner<3, 3>() =
            Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(inside) - cross_matrix(moment);
        Matrix3d rotation;
        rotation << inside[9], inside[12], inside[13], inside[12], inside[10], inside[14], inside[13], inside[14],
            inside[11];
        diagonal.bottomRightCorner<3, 3>() = rotation + second_moment.trace() * Matrix3d::Identity() - second_moment;
    });
}

template <class Real>
void CoarseMatrix<Real>::add_crossing(const Real* offset, int block) {
    const int width = edges_->pattern().width;
    const Real* values = edges_->values();
    const auto matrix = [&](std::int64_t first) {
        Matrix3d k;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) k(i, j) = static_cast<double>(values[first + (3 * i + j) * width]);
        }
        return k;
    };
    std::vector<AggregatePair>& pairs = pairs_[static_cast<std::size_t>(block)];
    for (AggregatePair& pair : pairs) {
        pair.coupling.setZero();
        pair.second_diagonal.setZero();
    }
    for (const CrossingEdge& edge : crossing_[static_cast<std::size_t>(block)]) {
        const Matrix3d k = matrix(edge.value), ci = cross_matrix(nodal_vector(offset, edge.row));
        const Matrix3d kci = k * ci;
        RigidMatrix& first = diagonal_[static_cast<std::size_t>(aggregates_->of_node()[edge.row])];
        first.topLeftCorner<3, 3>() -= k;
        first.topRightCorner<3, 3>() += kci;
        first.bottomRightCorner<3, 3>() += ci * kci;
        if (edge.pair < 0) continue;
        AggregatePair& pair = pairs[static_cast<std::size_t>(edge.pair)];
        const Matrix3d cj = cross_matrix(nodal_vector(offset, edge.column));
        const Matrix3d kcj = k * cj, ktcj = k.transpose() * cj;
        pair.coupling.topLeftCorner<3, 3>() += k;
        pair.coupling.topRightCorner<3, 3>() -= kcj;
        pair.coupling.bottomLeftCorner<3, 3>() += ci * k;
        pair.coupling.bottomRightCorner<3, 3>() -= ci * kcj;
        pair.second_diagonal.topLeftCorner<3, 3>() -= k.transpose();
        pair.second_diagonal.topRightCorner<3, 3>() += ktcj;
        pair.second_diagonal.bottomRightCorner<3, 3>() += cj * ktcj;
    }
}

template <class Real>
void CoarseMatrix<Real>::clear(int block) {
    aggregates_->for_each_of_block(block, [&](std::int32_t a) { diagonal_[static_cast<std::size_t>(a)].setZero(); });
    for (AggregatePair& pair : pairs_[static_cast<std::size_t>(block)]) {
        pair.coupling.setZero();
        pair.second_diagonal.setZero();
    }
}

template <class Real>
void CoarseMatrix<Real>::accumulate(const Real* offset, const Real* scaled_mass, int block) {
    add_inside(offset, scaled_mass, block);
    add_crossing(offset, block);
}

template <class Real>
void CoarseMatrix<Real>::assemble(Scheduler& scheduler, const Real* offset, const Real* scaled_mass) {
    scheduler.for_each_block(numbering_->first_blocks(), [&](int block) {
        if (numbering_->sleeping.leave_out(block)) {
            clear(block);
        } else {
            accumulate(offset, scaled_mass, block);
        }
    });
    // The room also has edges of aggregates of other blocks.
    if (numbering_->has_room()) accumulate(offset, scaled_mass, numbering_->first_blocks());
    // Motions of what follows are about the centre of its leader already.
    const std::span<const std::int32_t> leader = aggregates_->leader();
    const auto diagonal_of = [&](std::int32_t a) -> RigidMatrix& { return diagonal_[static_cast<std::size_t>(a)]; };
    aggregates_->for_each_follower(
        [&](std::int32_t follower, std::int32_t led_by) { diagonal_of(led_by) += diagonal_of(follower); });
    for (const auto& pairs : pairs_) {
        for (const AggregatePair& pair : pairs) {
            const std::int32_t first = leader[pair.first], second = leader[pair.second];
            if (first < 0 || second < 0) continue;
            diagonal_of(second) += pair.second_diagonal;
            if (first == second) diagonal_of(first) += pair.coupling + pair.coupling.transpose();
        }
    }
    for (RigidMatrix& diagonal : diagonal_) {
        diagonal.bottomLeftCorner<3, 3>() = diagonal.topRightCorner<3, 3>().transpose();
        diagonal = (0.5 * (diagonal + diagonal.transpose())).eval();
    }
}

template <class Real>
std::size_t CoarseMatrix<Real>::bytes() const noexcept {
    std::size_t bytes = kernels::heap_bytes(diagonal_) + kernels::heap_bytes(inside_);
    for (const auto& crossing : crossing_) bytes += kernels::heap_bytes(crossing);
    for (const auto& pairs : pairs_) bytes += kernels::heap_bytes(pairs);
    return bytes;
}

template class CoarseMatrix<float>;
template class CoarseMatrix<double>;

}  // namespace lancet::runtime
