#include "lancet/runtime/solve/coarse_factor.hpp"

#include <algorithm>
#include <cmath>

namespace lancet::runtime {

namespace {

/// In orthonormal modes; a mode that is left out gets a one on the diagonal and no force.
RigidMatrix transformed(const CoarseFactor::Blocks& blocks, int a, int b, const RigidMatrix& raw) {
    const auto &basis_a = blocks.basis[static_cast<std::size_t>(a)],
               &basis_b = blocks.basis[static_cast<std::size_t>(b)];
    RigidMatrix block = basis_a.transpose() * raw * basis_b;
    if (a == b) {
        for (int k = 0; k < rigid_motions; ++k) {
            if (basis_a.col(k).isZero(0)) block(k, k) = 1;
        }
    }
    return block;
}

/// Calls visit(pair) for all pairs of different aggregates.
template <class Visit>
void for_each_coupling(std::span<const std::vector<AggregatePair>> pairs, const Visit& visit) {
    for (const auto& of_block : pairs) {
        for (const AggregatePair& pair : of_block) {
            if (pair.first != pair.second) visit(pair);
        }
    }
}

}  // namespace

void CoarseFactor::lay_out(int aggregates, std::span<const std::vector<AggregatePair>> pairs) {
    const int unknowns = rigid_motions * aggregates;
    scale_.resize(unknowns);
    right_hand_side_.resize(unknowns);
    solution_.resize(unknowns);
    is_dense_ = unknowns <= dense_limit;
    is_usable_ = false;
    if (!is_dense_) return lay_out_sparse(aggregates, pairs);
    dense_.resize(unknowns, unknowns);
    inverse_.resize(unknowns, unknowns);
}

void CoarseFactor::lay_out_sparse(int aggregates, std::span<const std::vector<AggregatePair>> pairs) {
    // The pattern of the coarse matrix by aggregates, its elimination order, and the permuted upper triangle.
    std::vector<Eigen::Triplet<double>> graph;
    for (int a = 0; a < aggregates; ++a) graph.emplace_back(a, a, 1.0);
    for_each_coupling(pairs, [&](const AggregatePair& pair) {
        graph.emplace_back(pair.first, pair.second, 1.0);
        graph.emplace_back(pair.second, pair.first, 1.0);
    });
    SparseMatrix adjacency(aggregates, aggregates);
    adjacency.setFromTriplets(graph.begin(), graph.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    Eigen::AMDOrdering<int>()(adjacency, order);
    place_.resize(aggregates);
    for (int k = 0; k < aggregates; ++k) place_[order.indices()[k]] = k;
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < adjacency.outerSize(); ++column) {
        for (SparseMatrix::InnerIterator it(adjacency, column); it; ++it) {
            const int row_place = place_[it.row()], column_place = place_[column];
            if (row_place > column_place) continue;
            for (int i = 0; i < rigid_motions; ++i) {
                for (int j = row_place == column_place ? i : 0; j < rigid_motions; ++j) {
                    entries.emplace_back(rigid_motions * row_place + i, rigid_motions * column_place + j, 1.0);
                }
            }
        }
    }
    sparse_.resize(rigid_motions * aggregates, rigid_motions * aggregates);
    sparse_.setFromTriplets(entries.begin(), entries.end());
    sparse_.makeCompressed();
    factor_.analyzePattern(sparse_);
}

bool CoarseFactor::holds(int a, int b) const {
    if (is_dense_) return true;
    const int row = std::min(first_of(a), first_of(b)), column = std::max(first_of(a), first_of(b));
    const int* begin = sparse_.innerIndexPtr() + sparse_.outerIndexPtr()[column];
    const int* end = sparse_.innerIndexPtr() + sparse_.outerIndexPtr()[column + 1];
    return std::binary_search(begin, end, row);
}

void CoarseFactor::find_scale(const Blocks& blocks) {
    for (int a = 0; a < static_cast<int>(blocks.diagonal.size()); ++a) {
        const RigidMatrix block = transformed(blocks, a, a, blocks.diagonal[static_cast<std::size_t>(a)]);
        for (int k = 0; k < rigid_motions; ++k) {
            scale_[rigid_motions * a + k] = block(k, k) > 0 ? 1 / std::sqrt(block(k, k)) : 0;
        }
    }
}

RigidMatrix CoarseFactor::scaled(const Blocks& blocks, int a, int b, const RigidMatrix& raw) const {
    return scale_.segment<rigid_motions>(rigid_motions * a).asDiagonal() * transformed(blocks, a, b, raw) *
           scale_.segment<rigid_motions>(rigid_motions * b).asDiagonal();
}

bool CoarseFactor::factorise(const Blocks& blocks) {
    find_scale(blocks);
    is_usable_ = is_dense_ ? factorise_dense(blocks) : factorise_sparse(blocks);
    return is_usable_;
}

bool CoarseFactor::factorise_dense(const Blocks& blocks) {
    dense_.setZero();
    for (int a = 0; a < static_cast<int>(blocks.diagonal.size()); ++a) {
        dense_.block<rigid_motions, rigid_motions>(first_of(a), first_of(a)) +=
            scaled(blocks, a, a, blocks.diagonal[static_cast<std::size_t>(a)]);
    }
    for_each_coupling(blocks.pairs, [&](const AggregatePair& pair) {
        const RigidMatrix block = scaled(blocks, pair.first, pair.second, pair.coupling);
        const int a = first_of(pair.first), b = first_of(pair.second);
        dense_.block<rigid_motions, rigid_motions>(a, b) += block;
        dense_.block<rigid_motions, rigid_motions>(b, a) += block.transpose();
    });
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(dense_);
    if (factor.info() != Eigen::Success) return false;
    inverse_.setIdentity();
    factor.solveInPlace(inverse_);
    return inverse_.allFinite();  // a pivot that is not a number passes for a positive one
}

void CoarseFactor::add_to_sparse(int a, int b, const RigidMatrix& block) {
    // Columns hold their entries in order of rows: a block's rows lie behind each other.
    const int row = first_of(a), column = first_of(b);
    for (int j = 0; j < rigid_motions; ++j) {
        const int* begin = sparse_.innerIndexPtr() + sparse_.outerIndexPtr()[column + j];
        const int* end = sparse_.innerIndexPtr() + sparse_.outerIndexPtr()[column + j + 1];
        double* value = sparse_.valuePtr() + (std::lower_bound(begin, end, row) - sparse_.innerIndexPtr());
        const int rows = row == column ? j + 1 : rigid_motions;
        for (int i = 0; i < rows; ++i) value[i] += block(i, j);
    }
}

bool CoarseFactor::factorise_sparse(const Blocks& blocks) {
    std::fill_n(sparse_.valuePtr(), sparse_.nonZeros(), 0.0);
    for (int a = 0; a < static_cast<int>(blocks.diagonal.size()); ++a) {
        add_to_sparse(a, a, scaled(blocks, a, a, blocks.diagonal[static_cast<std::size_t>(a)]));
    }
    for_each_coupling(blocks.pairs, [&](const AggregatePair& pair) {
        const RigidMatrix block = scaled(blocks, pair.first, pair.second, pair.coupling);
        if (first_of(pair.first) < first_of(pair.second)) {
            add_to_sparse(pair.first, pair.second, block);
        } else {
            add_to_sparse(pair.second, pair.first, block.transpose());
        }
    });
    factor_.factorise_in_place(sparse_);
    return factor_.info() == Eigen::Success && factor_.is_finite();
}

void CoarseFactor::solve(const std::vector<RigidMatrix>& basis, std::span<const double> forces) {
    for (int a = 0; a < static_cast<int>(basis.size()); ++a) {
        const Eigen::Map<const RigidVector> force(forces.data() + rigid_motions * a);
        right_hand_side_.segment<rigid_motions>(first_of(a)) =
            scale_.segment<rigid_motions>(rigid_motions * a)
                .cwiseProduct(basis[static_cast<std::size_t>(a)].transpose() * force);
    }
    if (is_dense_) {
        solution_.noalias() = inverse_ * right_hand_side_;
        return;
    }
    solution_ = right_hand_side_;
    factor_.matrixL().solveInPlace(solution_);
    factor_.matrixU().solveInPlace(solution_);
}

RigidVector CoarseFactor::motion(const std::vector<RigidMatrix>& basis, int aggregate) const {
    return basis[static_cast<std::size_t>(aggregate)] *
           scale_.segment<rigid_motions>(rigid_motions * aggregate)
               .cwiseProduct(solution_.segment<rigid_motions>(first_of(aggregate)));
}

std::size_t CoarseFactor::bytes() const noexcept {
    std::size_t bytes = static_cast<std::size_t>(dense_.size() + inverse_.size()) * sizeof(double);
    if (!is_dense_) {
        bytes += static_cast<std::size_t>(sparse_.nonZeros() + factor_.matrixL().nestedExpression().nonZeros()) *
                 (sizeof(double) + sizeof(int));
    }
    return bytes;
}

}  // namespace lancet::runtime
