#include "lancet/runtime/solve/coarse_factor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lancet::runtime {

template <class Visit>
void CoarseFactor::for_each_coupling(std::span<const std::vector<AggregatePair>> pairs, const Visit& visit) const {
    for (const auto& of_block : pairs) {
        for (const AggregatePair& pair : of_block) {
            const std::int32_t k = leader_place_[static_cast<std::size_t>(pair.first)],
                               l = leader_place_[static_cast<std::size_t>(pair.second)];
            if (k >= 0 && l >= 0 && k != l) visit(pair, k, l);
        }
    }
}

void CoarseFactor::lay_out(std::span<const std::int32_t> leader, std::span<const std::vector<AggregatePair>> pairs) {
    std::vector<std::int32_t> leaders, place(leader.size(), -1);
    for (std::size_t a = 0; a < leader.size(); ++a) {
        if (leader[a] != static_cast<std::int32_t>(a)) continue;
        place[a] = static_cast<std::int32_t>(leaders.size());
        leaders.push_back(leader[a]);
    }
    leader_place_.resize(leader.size());
    for (std::size_t a = 0; a < leader.size(); ++a) {
        leader_place_[a] = leader[a] < 0 ? -1 : place[static_cast<std::size_t>(leader[a])];
    }
    bool is_held = leaders == leaders_ && scale_.size() > 0;
    leaders_ = std::move(leaders);
    if (is_held) {
        for_each_coupling(pairs, [&](const AggregatePair&, int k, int l) { is_held = is_held && holds(k, l); });
    }
    is_usable_ = false;
    if (is_held) return;

    const int unknowns = rigid_motions * static_cast<int>(leaders_.size());
    scale_.resize(unknowns);
    right_hand_side_.resize(unknowns);
    solution_.resize(unknowns);
    is_dense_ = unknowns <= dense_limit;
    if (!is_dense_) return lay_out_sparse(pairs);
    dense_.resize(unknowns, unknowns);
    inverse_.resize(unknowns, unknowns);
}

void CoarseFactor::lay_out_sparse(std::span<const std::vector<AggregatePair>> pairs) {
    // The pattern of the coarse matrix by leaders, its elimination order, and the permuted upper triangle.
    const auto count = static_cast<int>(leaders_.size());
    std::vector<Eigen::Triplet<double>> graph;
    for (int k = 0; k < count; ++k) graph.emplace_back(k, k, 1.0);
    for_each_coupling(pairs, [&](const AggregatePair&, int k, int l) {
        graph.emplace_back(k, l, 1.0);
        graph.emplace_back(l, k, 1.0);
    });
    SparseMatrix adjacency(count, count);
    adjacency.setFromTriplets(graph.begin(), graph.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    Eigen::AMDOrdering<int>()(adjacency, order);
    place_.resize(count);
    for (int k = 0; k < count; ++k) place_[order.indices()[k]] = k;
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
    sparse_.resize(rigid_motions * count, rigid_motions * count);
    sparse_.setFromTriplets(entries.begin(), entries.end());
    sparse_.makeCompressed();
    factor_.analyzePattern(sparse_);
}

/// True where the layout has room for the block of two leaders.
bool CoarseFactor::holds(int k, int l) const {
    if (is_dense_) return true;
    const int row = std::min(first_of(k), first_of(l)), column = std::max(first_of(k), first_of(l));
    const int* begin = sparse_.innerIndexPtr() + sparse_.outerIndexPtr()[column];
    const int* end = sparse_.innerIndexPtr() + sparse_.outerIndexPtr()[column + 1];
    return std::binary_search(begin, end, row);
}

void CoarseFactor::find_scale(const Blocks& blocks) {
    scale_.setOnes();
    for (int k = 0; k < static_cast<int>(leaders_.size()); ++k) {
        const RigidMatrix block = scaled(blocks, k, k, of_leader(blocks.diagonal, k));
        for (int i = 0; i < rigid_motions; ++i) {
            scale_[rigid_motions * k + i] = block(i, i) > 0 ? 1 / std::sqrt(block(i, i)) : 0;
        }
    }
}

RigidMatrix CoarseFactor::scaled(const Blocks& blocks, int k, int l, const RigidMatrix& raw) const {
    const RigidMatrix &basis_k = of_leader(blocks.basis, k), &basis_l = of_leader(blocks.basis, l);
    RigidMatrix block = basis_k.transpose() * raw * basis_l;
    // A mode that is left out gets a one on the diagonal and no force.
    for (int i = 0; i < rigid_motions && k == l; ++i) {
        if (basis_k.col(i).isZero(0)) block(i, i) = 1;
    }
    return scale_.segment<rigid_motions>(rigid_motions * k).asDiagonal() * block *
           scale_.segment<rigid_motions>(rigid_motions * l).asDiagonal();
}

bool CoarseFactor::factorise(const Blocks& blocks) {
    find_scale(blocks);
    is_usable_ = is_dense_ ? factorise_dense(blocks) : factorise_sparse(blocks);
    return is_usable_;
}

bool CoarseFactor::factorise_dense(const Blocks& blocks) {
    dense_.setZero();
    for (int k = 0; k < static_cast<int>(leaders_.size()); ++k) {
        dense_.block<rigid_motions, rigid_motions>(first_of(k), first_of(k)) +=
            scaled(blocks, k, k, of_leader(blocks.diagonal, k));
    }
    for_each_coupling(blocks.pairs, [&](const AggregatePair& pair, int k, int l) {
        const RigidMatrix block = scaled(blocks, k, l, pair.coupling);
        dense_.block<rigid_motions, rigid_motions>(first_of(k), first_of(l)) += block;
        dense_.block<rigid_motions, rigid_motions>(first_of(l), first_of(k)) += block.transpose();
    });
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(dense_);
    if (factor.info() != Eigen::Success) return false;
    inverse_.setIdentity();
    factor.solveInPlace(inverse_);
    return inverse_.allFinite();  // a pivot that is not a number passes for a positive one
}

void CoarseFactor::add_to_sparse(int k, int l, const RigidMatrix& block) {
    // Columns hold their entries in order of rows: a block's rows lie behind each other.
    const int row = first_of(k), column = first_of(l);
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
    for (int k = 0; k < static_cast<int>(leaders_.size()); ++k) {
        add_to_sparse(k, k, scaled(blocks, k, k, of_leader(blocks.diagonal, k)));
    }
    for_each_coupling(blocks.pairs, [&](const AggregatePair& pair, int k, int l) {
        const RigidMatrix block = scaled(blocks, k, l, pair.coupling);
        if (first_of(k) < first_of(l)) {
            add_to_sparse(k, l, block);
        } else {
            add_to_sparse(l, k, block.transpose());
        }
    });
    factor_.factorise_in_place(sparse_);
    return factor_.info() == Eigen::Success && factor_.is_finite();
}

void CoarseFactor::solve(const std::vector<RigidMatrix>& basis, std::span<const double> forces) {
    for (int k = 0; k < static_cast<int>(leaders_.size()); ++k) {
        const Eigen::Map<const RigidVector> force(forces.data() +
                                                  rigid_motions * leaders_[static_cast<std::size_t>(k)]);
        right_hand_side_.segment<rigid_motions>(first_of(k)) =
            scale_.segment<rigid_motions>(rigid_motions * k).cwiseProduct(of_leader(basis, k).transpose() * force);
    }
    if (is_dense_) {
        solution_.noalias() = inverse_ * right_hand_side_;
        return;
    }
    solution_ = right_hand_side_;
    factor_.matrixL().solveInPlace(solution_);
    factor_.matrixU().solveInPlace(solution_);
}

RigidVector CoarseFactor::motion(const std::vector<RigidMatrix>& basis, std::size_t leader) const {
    const auto k = static_cast<int>(leader);
    return of_leader(basis, k) *
           scale_.segment<rigid_motions>(rigid_motions * k).cwiseProduct(solution_.segment<rigid_motions>(first_of(k)));
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
