#include "lancet/runtime/solve/coarse_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

namespace lancet::runtime {

namespace {

using Matrix3 = Eigen::Matrix3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector3 = Eigen::Vector3d;

Matrix3 cross_matrix(const Vector3& r) {
    Matrix3 m;
    m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
    return m;
}

/// An edge between two aggregates, or between an aggregate and the ground.
struct CrossingEdge {
    std::int32_t value;  ///< entry * 9 * width + lane
    std::int32_t row;
    std::int32_t column;
    std::int32_t pair;  ///< of the block's pairs; -1: ground
};

/// Contributions of one block's edges to a pair of aggregates (first owns the rows).
struct AggregatePair {
    std::int32_t first;
    std::int32_t second;
    Matrix6 coupling;         ///< (first, second)
    Matrix6 second_diagonal;  ///< (second, second)
};

constexpr int modes = 6;

using SparseFactorBase = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Upper, Eigen::NaturalOrdering<int>>;

/// Eigen's factorisation without the matrix that `factorize` allocates and, in the natural order, has no use for.
class SparseFactor : public SparseFactorBase {
  public:
    void factorise_in_place(const Eigen::SparseMatrix<double>& upper) { factorize_preordered<false>(upper); }
    bool is_finite() const {
        const auto& values = matrixL().nestedExpression();
        return Eigen::Map<const Eigen::VectorXd>(values.valuePtr(), values.nonZeros()).allFinite();
    }
};

}  // namespace

struct CoarseMatrices {
    std::vector<std::vector<CrossingEdge>> crossing;  ///< [block]
    std::vector<std::vector<AggregatePair>> pairs;    ///< [block]
    std::vector<double> inside;                       ///< [aggregate][kernels::coarse_diagonal_sums]
    std::vector<Matrix6> diagonal;                    ///< [aggregate]
    std::vector<Matrix6> basis;  ///< [aggregate] raw modes to orthonormal ones; zero columns left out

    Eigen::VectorXd scale;
    Eigen::VectorXd right_hand_side;
    Eigen::VectorXd solution;

    // Dense: the inverse in terms of raw modes.
    Eigen::MatrixXd dense;
    Eigen::MatrixXd inverse;

    // Sparse: upper triangle, permuted for little fill.
    Eigen::SparseMatrix<double> sparse;
    Eigen::VectorXi place;  ///< [aggregate] its place in the elimination order
    SparseFactor factor;
    bool is_dense = true;
    bool is_usable = false;

    /// True where the matrix has room for the block of two aggregates.
    bool holds(int a, int b) const {
        if (is_dense) return true;
        const int row = modes * std::min(place[a], place[b]), column = modes * std::max(place[a], place[b]);
        const int* begin = sparse.innerIndexPtr() + sparse.outerIndexPtr()[column];
        const int* end = sparse.innerIndexPtr() + sparse.outerIndexPtr()[column + 1];
        return std::binary_search(begin, end, row);
    }
};

template <class Real>
CoarseSpace<Real>::CoarseSpace(const kernels::KernelSet<Real>& kernels, const kernels::NodeNumbering& numbering,
                               const BlockMatrix<Real>& edges)
    : kernels_(&kernels),
      numbering_(&numbering),
      edges_(&edges),
      aggregates_(numbering),
      offset_(static_cast<std::size_t>(numbering.node_count) * 4),
      change_(static_cast<std::size_t>(numbering.blocks())),
      matrices_(std::make_unique<CoarseMatrices>()) {
    matrices_->crossing.resize(static_cast<std::size_t>(numbering.blocks()));
    matrices_->pairs.resize(matrices_->crossing.size());
    for (int block = 0; block < numbering.blocks(); ++block) take_up_edges(block);
    take_up_aggregates();
}

template <class Real>
void CoarseSpace<Real>::change(std::span<const int> blocks) {
    CoarseMatrices& m = *matrices_;
    const auto count = static_cast<std::size_t>(numbering_->blocks());
    // Where the aggregates of a block are others, so are the pairs of all blocks that border on it.
    std::vector<std::vector<int>> borders(count);
    for (std::size_t block = 0; block < count; ++block) {
        for (const AggregatePair& pair : m.pairs[block]) {
            borders[block].push_back(aggregates_.block_of(pair.first));
            borders[block].push_back(aggregates_.block_of(pair.second));
        }
    }
    std::vector<bool> is_old(count);
    for (const int block : blocks) is_old[block] = true;
    for (const int severed : aggregates_.change(edges_->pattern(), blocks)) {
        for (std::size_t block = 0; block < count; ++block) {
            is_old[block] = is_old[block] || std::ranges::find(borders[block], severed) != borders[block].end();
        }
    }
    for (std::size_t block = 0; block < count; ++block) {
        if (is_old[block]) take_up_edges(static_cast<int>(block));
    }
    is_fresh_ = false;
    // The pattern of a sparse matrix holds as long as it has all pairs.
    bool holds_all = counted() == aggregates_.count();
    for (std::size_t block = 0; block < count && holds_all; ++block) {
        if (!is_old[block]) continue;
        for (const AggregatePair& pair : m.pairs[block]) holds_all = holds_all && m.holds(pair.first, pair.second);
    }
    if (!holds_all) {
        take_up_aggregates();
        return;
    }
    // Numbers without nodes have no modes.
    for (Matrix6& basis : m.basis) basis.setZero();
    for (Matrix6& diagonal : m.diagonal) diagonal.setZero();
}

template <class Real>
void CoarseSpace<Real>::take_up_edges(int block) {
    CoarseMatrices& m = *matrices_;
    const kernels::RowPattern& pattern = edges_->pattern();
    std::vector<AggregatePair>& pairs = m.pairs[block];
    m.crossing[block].clear();
    pairs.clear();
    // A block borders on few aggregates, and an edge mostly on those of the one before.
    std::size_t last = 0;
    const auto pair_of = [&](std::int32_t a, std::int32_t b) {
        const auto is_pair = [&](const AggregatePair& pair) { return pair.first == a && pair.second == b; };
        if (last < pairs.size() && is_pair(pairs[last])) return static_cast<std::int32_t>(last);
        const auto found = std::find_if(pairs.begin(), pairs.end(), is_pair);
        last = static_cast<std::size_t>(found - pairs.begin());
        if (found == pairs.end()) pairs.push_back({a, b, Matrix6::Zero(), Matrix6::Zero()});
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
                const std::int32_t a = aggregates_.of_node()[row], b = aggregates_.of_node()[column];
                // The room also has edges within aggregates of other blocks.
                if (a == b && (row == column || is_own(row))) continue;
                m.crossing[block].push_back(
                    {entry * 9 * pattern.width + lane, row, column, b >= 0 ? pair_of(a, b) : -1});
            }
        }
    }
}

template <class Real>
void CoarseSpace<Real>::take_up_aggregates() {
    CoarseMatrices& m = *matrices_;
    const int aggregates = aggregates_.count(), unknowns = modes * aggregates;
    restricted_.assign(static_cast<std::size_t>(unknowns), 0.0);
    correction_.assign(restricted_.size(), Real(0));
    m.diagonal.assign(static_cast<std::size_t>(aggregates), Matrix6::Zero());
    m.inside.resize(static_cast<std::size_t>(aggregates) * kernels::coarse_diagonal_sums);
    m.basis = m.diagonal;
    m.scale.resize(unknowns);
    m.right_hand_side.resize(unknowns);
    m.solution.resize(unknowns);
    m.is_dense = unknowns <= dense_limit;
    m.is_usable = false;
    if (m.is_dense) {
        m.dense.resize(unknowns, unknowns);
        m.inverse.resize(unknowns, unknowns);
        return;
    }
    // The pattern of the coarse matrix by aggregates, its elimination order, and the permuted upper triangle.
    std::vector<Eigen::Triplet<double>> graph;
    for (int a = 0; a < aggregates; ++a) graph.emplace_back(a, a, 1.0);
    for (const auto& pairs : m.pairs) {
        for (const AggregatePair& pair : pairs) {
            if (pair.first == pair.second) continue;
            graph.emplace_back(pair.first, pair.second, 1.0);
            graph.emplace_back(pair.second, pair.first, 1.0);
        }
    }
    Eigen::SparseMatrix<double> adjacency(aggregates, aggregates);
    adjacency.setFromTriplets(graph.begin(), graph.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    Eigen::AMDOrdering<int>()(adjacency, order);
    m.place.resize(aggregates);
    for (int k = 0; k < aggregates; ++k) m.place[order.indices()[k]] = k;
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < adjacency.outerSize(); ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(adjacency, column); it; ++it) {
            const int row_place = m.place[it.row()], column_place = m.place[column];
            if (row_place > column_place) continue;
            for (int i = 0; i < modes; ++i) {
                for (int j = row_place == column_place ? i : 0; j < modes; ++j) {
                    entries.emplace_back(modes * row_place + i, modes * column_place + j, 1.0);
                }
            }
        }
    }
    m.sparse.resize(unknowns, unknowns);
    m.sparse.setFromTriplets(entries.begin(), entries.end());
    m.sparse.makeCompressed();
    m.factor.analyzePattern(m.sparse);
}

template <class Real>
CoarseSpace<Real>::~CoarseSpace() = default;
template <class Real>
CoarseSpace<Real>::CoarseSpace(CoarseSpace&&) noexcept = default;

template <class Real>
double CoarseSpace<Real>::change(Scheduler& scheduler, const double* positions) {
    if (!is_fresh_) return std::numeric_limits<double>::infinity();
    if (change_.empty()) return 0;  // no free node
    scheduler.for_each_block(numbering_->blocks(), [&](int block) {
        double largest = 0;
        aggregates_.for_each_of_block(block, [&](std::int32_t a) {
            // sum |d - mean d|^2 for d = x - r' is sum |d|^2 - |sum d|^2 / n, since the offsets r' have mean zero.
            Vector3 origin = Vector3::Zero(), sum = Vector3::Zero();
            double squares = 0, size = 0;
            int count = 0;
            aggregates_.for_each_node(a, [&](std::int32_t node) {
                const std::int64_t at = 4 * static_cast<std::int64_t>(node);
                const Vector3 r(offset_[at], offset_[at + 1], offset_[at + 2]);
                const Vector3 x = Eigen::Map<const Vector3>(positions + at);
                if (count++ == 0) origin = x;
                const Vector3 d = x - origin - r;
                sum += d;
                squares += d.squaredNorm();
                size += r.squaredNorm();
            });
            const double moved = squares - sum.squaredNorm() / std::max(count, 1);
            if (size > 0) largest = std::max(largest, moved / size);
            if (!std::isfinite(moved)) largest = std::numeric_limits<double>::infinity();
        });
        change_[block] = largest;
    });
    return std::sqrt(std::max(0.0, *std::max_element(change_.begin(), change_.end())));
}

template <class Real>
void CoarseSpace<Real>::set_modes(const double* positions, int block) {
    aggregates_.for_each_of_block(block, [&](std::int32_t a) {
        Vector3 centre = Vector3::Zero();
        int count = 0;
        aggregates_.for_each_node(a, [&](std::int32_t node) {
            centre += Eigen::Map<const Vector3>(positions + 4 * static_cast<std::int64_t>(node));
            ++count;
        });
        centre /= std::max(count, 1);
        Matrix3 inertia = Matrix3::Zero();
        aggregates_.for_each_node(a, [&](std::int32_t node) {
            const std::int64_t at = 4 * static_cast<std::int64_t>(node);
            const Vector3 r = Eigen::Map<const Vector3>(positions + at) - centre;
            for (int axis = 0; axis < 3; ++axis) offset_[at + axis] = static_cast<Real>(r[axis]);
            inertia += r.squaredNorm() * Matrix3::Identity() - r * r.transpose();
        });
        // Rotations about principal axes of no extent move nothing: a node alone has none, collinear nodes two.
        Matrix6& basis = matrices_->basis[a];
        basis.setZero();
        if (count == 0) return;
        basis.topLeftCorner<3, 3>().diagonal().setConstant(1 / std::sqrt(std::max(count, 1)));
        Eigen::SelfAdjointEigenSolver<Matrix3> axes;
        axes.computeDirect(inertia);
        // Offsets below the rounding of the positions are no extent at all.
        const double rounding = 64 * std::numeric_limits<double>::epsilon() * centre.cwiseAbs().maxCoeff();
        const double rank_limit = std::max(1e-8 * axes.eigenvalues().maxCoeff(), count * rounding * rounding);
        for (int k = 0; k < 3; ++k) {
            const double moment = axes.eigenvalues()[k];
            if (moment > rank_limit && moment > 0 && std::isfinite(moment)) {
                basis.block<3, 1>(3, 3 + k) = axes.eigenvectors().col(k) / std::sqrt(moment);
            }
        }
    });
}

template <class Real>
void CoarseSpace<Real>::accumulate(const Real* scaled_mass, int block) {
    CoarseMatrices& m = *matrices_;
    const kernels::RowPattern& pattern = edges_->pattern();
    const int width = pattern.width;
    const Real* values = edges_->values();
    const auto offset = [&](std::int32_t node) {
        const std::int64_t at = 4 * static_cast<std::int64_t>(node);
        return Vector3(offset_[at], offset_[at + 1], offset_[at + 2]);
    };
    const auto matrix = [&](std::int64_t first) {
        Matrix3 k;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) k(i, j) = static_cast<double>(values[first + (3 * i + j) * width]);
        }
        return k;
    };
    // Masses, sum m T^T T with T = [1, -[r]x], and the edges within an aggregate.
    aggregates_.for_each_of_block(block, [&](std::int32_t a) {
        std::fill_n(m.inside.begin() + a * kernels::coarse_diagonal_sums, kernels::coarse_diagonal_sums, 0.0);
    });
    kernels_->coarse.diagonal({.block_chunk_begin = pattern.block_chunk_begin.data(),
                               .chunk_entry_begin = pattern.chunk_entry_begin.data(),
                               .row = pattern.row.data(),
                               .column = pattern.column.data(),
                               .values = values,
                               .aggregate = aggregates_.of_node().data(),
                               .offset = offset_.data(),
                               .sums = m.inside.data()},
                              block);
    aggregates_.for_each_of_block(block, [&](std::int32_t a) {
        double mass = 0;
        Vector3 moment = Vector3::Zero();
        Matrix3 second_moment = Matrix3::Zero();
        aggregates_.for_each_node(a, [&](std::int32_t node) {
            const auto nodal = static_cast<double>(scaled_mass[node]);
            const Vector3 r = offset(node);
            mass += nodal;
            moment += nodal * r;
            second_moment += nodal * r * r.transpose();
        });
        Eigen::Map<const Eigen::Matrix<double, kernels::coarse_diagonal_sums, 1>> inside(
            m.inside.data() + a * kernels::coarse_diagonal_sums);
        Matrix6& diagonal = m.diagonal[a];
        diagonal.setZero();
        diagonal.topLeftCorner<3, 3>().diagonal().setConstant(mass);
        diagonal.topRightCorner<3, 3>() =
            Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(inside.data()) - cross_matrix(moment);
        Matrix3 rotation;
        rotation << inside[9], inside[12], inside[13], inside[12], inside[10], inside[14], inside[13], inside[14],
            inside[11];
        diagonal.bottomRightCorner<3, 3>() = rotation + second_moment.trace() * Matrix3::Identity() - second_moment;
    });
    for (AggregatePair& pair : m.pairs[block]) {
        pair.coupling.setZero();
        pair.second_diagonal.setZero();
    }
    for (const CrossingEdge& edge : m.crossing[block]) {
        const Matrix3 k = matrix(edge.value), ci = cross_matrix(offset(edge.row));
        const Matrix3 kci = k * ci;
        Matrix6& first = m.diagonal[aggregates_.of_node()[edge.row]];
        first.topLeftCorner<3, 3>() -= k;
        first.topRightCorner<3, 3>() += kci;
        first.bottomRightCorner<3, 3>() += ci * kci;
        if (edge.pair < 0) continue;
        AggregatePair& pair = m.pairs[block][static_cast<std::size_t>(edge.pair)];
        const Matrix3 cj = cross_matrix(offset(edge.column));
        const Matrix3 kcj = k * cj, ktcj = k.transpose() * cj;
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
bool CoarseSpace<Real>::refresh(Scheduler& scheduler, const double* positions, const Real* scaled_mass) {
    scheduler.for_each_block(numbering_->blocks(), [&](int block) { set_modes(positions, block); });
    scheduler.for_each_block(numbering_->first_blocks(), [&](int block) { accumulate(scaled_mass, block); });
    // The room also has edges of aggregates of other blocks.
    if (numbering_->has_room()) accumulate(scaled_mass, numbering_->first_blocks());
    CoarseMatrices& m = *matrices_;
    for (const auto& pairs : m.pairs) {
        for (const AggregatePair& pair : pairs) {
            m.diagonal[pair.second] += pair.second_diagonal;
            if (pair.first == pair.second) m.diagonal[pair.first] += pair.coupling + pair.coupling.transpose();
        }
    }
    for (Matrix6& diagonal : m.diagonal) {
        diagonal.bottomLeftCorner<3, 3>() = diagonal.topRightCorner<3, 3>().transpose();
        diagonal = (0.5 * (diagonal + diagonal.transpose())).eval();
    }
    is_fresh_ = true;
    return factorise();
}

template <class Real>
bool CoarseSpace<Real>::factorise() {
    CoarseMatrices& m = *matrices_;
    const auto aggregates = static_cast<int>(m.diagonal.size());
    // In orthonormal modes; a mode that is left out gets a one on the diagonal and no force.
    const auto transformed = [&](int a, int b, const Matrix6& raw) {
        Matrix6 block = m.basis[a].transpose() * raw * m.basis[b];
        if (a == b) {
            for (int k = 0; k < modes; ++k) {
                if (m.basis[a].col(k).isZero(0)) block(k, k) = 1;
            }
        }
        return block;
    };
    for (int a = 0; a < aggregates; ++a) {
        const Matrix6 block = transformed(a, a, m.diagonal[a]);
        for (int k = 0; k < modes; ++k) m.scale[modes * a + k] = block(k, k) > 0 ? 1 / std::sqrt(block(k, k)) : 0;
    }
    const auto scaled = [&](int a, int b, const Matrix6& raw) {
        return Matrix6(m.scale.segment<modes>(modes * a).asDiagonal() * transformed(a, b, raw) *
                       m.scale.segment<modes>(modes * b).asDiagonal());
    };
    if (m.is_dense) {
        m.dense.setZero();
        for (int a = 0; a < aggregates; ++a) {
            m.dense.block<modes, modes>(modes * a, modes * a) += scaled(a, a, m.diagonal[a]);
        }
        for (const auto& pairs : m.pairs) {
            for (const AggregatePair& pair : pairs) {
                if (pair.first == pair.second) continue;
                const Matrix6 block = scaled(pair.first, pair.second, pair.coupling);
                m.dense.block<modes, modes>(modes * pair.first, modes * pair.second) += block;
                m.dense.block<modes, modes>(modes * pair.second, modes * pair.first) += block.transpose();
            }
        }
        const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(m.dense);
        m.is_usable = llt.info() == Eigen::Success;
        if (!m.is_usable) return false;
        m.inverse.setIdentity();
        llt.solveInPlace(m.inverse);
        m.is_usable = m.inverse.allFinite();  // a pivot that is not a number passes for a positive one
        return m.is_usable;
    }
    for (int column = 0; column < m.sparse.outerSize(); ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(m.sparse, column); it; ++it) it.valueRef() = 0;
    }
    const auto add = [&](int a, int b, const Matrix6& block) {
        // Columns hold their entries in order of rows: a block's rows lie behind each other.
        const int row = modes * m.place[a], column = modes * m.place[b];
        for (int j = 0; j < modes; ++j) {
            const int* begin = m.sparse.innerIndexPtr() + m.sparse.outerIndexPtr()[column + j];
            const int* end = m.sparse.innerIndexPtr() + m.sparse.outerIndexPtr()[column + j + 1];
            double* value = m.sparse.valuePtr() + (std::lower_bound(begin, end, row) - m.sparse.innerIndexPtr());
            const int rows = row == column ? j + 1 : modes;
            for (int i = 0; i < rows; ++i) value[i] += block(i, j);
        }
    };
    for (int a = 0; a < aggregates; ++a) add(a, a, scaled(a, a, m.diagonal[a]));
    for (const auto& pairs : m.pairs) {
        for (const AggregatePair& pair : pairs) {
            if (pair.first == pair.second) continue;
            const Matrix6 block = scaled(pair.first, pair.second, pair.coupling);
            if (m.place[pair.first] < m.place[pair.second]) {
                add(pair.first, pair.second, block);
            } else {
                add(pair.second, pair.first, block.transpose());
            }
        }
    }
    m.factor.factorise_in_place(m.sparse);
    m.is_usable = m.factor.info() == Eigen::Success && m.factor.is_finite();
    return m.is_usable;
}

template <class Real>
void CoarseSpace<Real>::solve() {
    CoarseMatrices& m = *matrices_;
    if (!m.is_usable) {
        std::fill(correction_.begin(), correction_.end(), Real(0));
        return;
    }
    const auto aggregates = static_cast<int>(m.diagonal.size());
    const auto place = [&](int a) { return modes * (m.is_dense ? a : m.place[a]); };
    for (int a = 0; a < aggregates; ++a) {
        const Eigen::Map<const Eigen::Matrix<double, modes, 1>> force(restricted_.data() + modes * a);
        m.right_hand_side.segment<modes>(place(a)) =
            m.scale.segment<modes>(modes * a).cwiseProduct(m.basis[a].transpose() * force);
    }
    if (m.is_dense) {
        m.solution.noalias() = m.inverse * m.right_hand_side;
    } else {
        m.solution = m.right_hand_side;
        m.factor.matrixL().solveInPlace(m.solution);
        m.factor.matrixU().solveInPlace(m.solution);
    }
    for (int a = 0; a < aggregates; ++a) {
        const Eigen::Matrix<double, modes, 1> motion =
            m.basis[a] * m.scale.segment<modes>(modes * a).cwiseProduct(m.solution.segment<modes>(place(a)));
        for (int k = 0; k < modes; ++k) correction_[modes * a + k] = static_cast<Real>(motion[k]);
    }
    for (int block = 0; block < numbering_->blocks(); ++block) {
        aggregates_.for_each_piece(block, [&](std::int32_t number, const Aggregates::Piece& piece) {
            for (int k = 0; k < modes; ++k) correction_[modes * number + k] -= correction_[modes * piece.aggregate + k];
        });
    }
}

template <class Real>
template <class Accumulate>
void CoarseSpace<Real>::restrict_to_pieces(const Accumulate* r, int block) {
    aggregates_.for_each_piece(block, [&](std::int32_t number, const Aggregates::Piece& piece) {
        Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
        for (const std::int32_t node : piece.nodes) {
            const std::int64_t at = 4 * static_cast<std::int64_t>(node);
            const Vector3 f(r[at], r[at + 1], r[at + 2]);
            force += f;
            torque += Vector3(offset_[at], offset_[at + 1], offset_[at + 2]).cross(f);
        }
        double *of_piece = &restricted_[modes * number], *of_aggregate = &restricted_[modes * piece.aggregate];
        for (int axis = 0; axis < 3; ++axis) {
            of_piece[axis] = force[axis];
            of_piece[3 + axis] = torque[axis];
        }
        for (int k = 0; k < modes; ++k) of_aggregate[k] -= of_piece[k];
    });
}

template <class Real>
template <class Accumulate>
double CoarseSpace<Real>::move_pieces(const Accumulate* r, Real* z, int block) const {
    using Motion = Eigen::Matrix<Real, 3, 1>;
    double product = 0;
    aggregates_.for_each_piece(block, [&](std::int32_t number, const Aggregates::Piece& piece) {
        const Eigen::Map<const Motion> translation(&correction_[modes * number]),
            rotation(&correction_[modes * number + 3]);
        for (const std::int32_t node : piece.nodes) {
            const std::int64_t at = 4 * static_cast<std::int64_t>(node);
            const Motion motion = translation + rotation.cross(Eigen::Map<const Motion>(&offset_[at]));
            for (int axis = 0; axis < 3; ++axis) {
                z[at + axis] += motion[axis];
                product += static_cast<double>(r[at + axis]) * static_cast<double>(motion[axis]);
            }
        }
    });
    return product;
}

template <class Real>
kernels::CoarseArguments<Real> CoarseSpace<Real>::arguments() noexcept {
    return {.block_aggregate_begin = numbering_->block_aggregate_begin.data(),
            .aggregate_begin = numbering_->aggregate_begin.data(),
            .offset = offset_.data(),
            .restricted = restricted_.data(),
            .correction = correction_.data()};
}

template <class Real>
int CoarseSpace<Real>::unknowns() const noexcept {
    return static_cast<int>(restricted_.size());
}

template <class Real>
std::size_t CoarseSpace<Real>::bytes() const noexcept {
    using kernels::heap_bytes;
    const CoarseMatrices& m = *matrices_;
    std::size_t bytes = aggregates_.bytes() + heap_bytes(offset_) + heap_bytes(restricted_) + heap_bytes(correction_) +
                        heap_bytes(m.diagonal) + heap_bytes(m.basis);
    for (const auto& crossing : m.crossing) bytes += heap_bytes(crossing);
    for (const auto& pairs : m.pairs) bytes += heap_bytes(pairs);
    bytes += static_cast<std::size_t>(m.dense.size() + m.inverse.size()) * sizeof(double);
    if (!m.is_dense) {
        bytes += static_cast<std::size_t>(m.sparse.nonZeros() + m.factor.matrixL().nestedExpression().nonZeros()) *
                 (sizeof(double) + sizeof(int));
    }
    return bytes;
}

template <class Real>
void CoarseSpace<Real>::save(std::vector<double>& numbers) const {
    const CoarseMatrices& m = *matrices_;
    numbers.push_back(is_fresh_ ? 1 : 0);
    numbers.insert(numbers.end(), offset_.begin(), offset_.end());
    const auto append = [&](const Matrix6& matrix) {
        numbers.insert(numbers.end(), matrix.data(), matrix.data() + matrix.size());
    };
    for (const Matrix6& matrix : m.diagonal) append(matrix);
    for (const Matrix6& matrix : m.basis) append(matrix);
    for (const auto& pairs : m.pairs) {
        for (const AggregatePair& pair : pairs) append(pair.coupling);
    }
}

template <class Real>
void CoarseSpace<Real>::restore(std::span<const double>& numbers) {
    CoarseMatrices& m = *matrices_;
    std::size_t next = 0;
    is_fresh_ = numbers[next++] != 0;
    for (Real& number : offset_) number = static_cast<Real>(numbers[next++]);
    const auto read = [&](Matrix6& matrix) {
        for (int i = 0; i < matrix.size(); ++i) matrix.data()[i] = numbers[next++];
    };
    for (Matrix6& matrix : m.diagonal) read(matrix);
    for (Matrix6& matrix : m.basis) read(matrix);
    for (auto& pairs : m.pairs) {
        for (AggregatePair& pair : pairs) read(pair.coupling);
    }
    numbers = numbers.subspan(next);
    if (is_fresh_) factorise();
}

template class CoarseSpace<float>;
template class CoarseSpace<double>;
template void CoarseSpace<float>::restrict_to_pieces<float>(const float*, int);
template void CoarseSpace<float>::restrict_to_pieces<double>(const double*, int);
template void CoarseSpace<double>::restrict_to_pieces<double>(const double*, int);
template double CoarseSpace<float>::move_pieces<float>(const float*, float*, int) const;
template double CoarseSpace<float>::move_pieces<double>(const double*, float*, int) const;
template double CoarseSpace<double>::move_pieces<double>(const double*, double*, int) const;

}  // namespace lancet::runtime
