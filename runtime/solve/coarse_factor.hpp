#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "lancet/runtime/solve/coarse_matrix.hpp"

namespace lancet::runtime {

/// The coarse matrix in orthonormal modes, scaled by its diagonal and factorised in double: densely up to `dense_limit`
/// unknowns, sparsely above.
class CoarseFactor {
  public:
    static constexpr int dense_limit = 120;

    /// The blocks of a coarse matrix, and the modes of the aggregates (RigidModes::basis). Of what follows other
    /// aggregates neither is read.
    struct Blocks {
        const std::vector<RigidMatrix>& diagonal;
        const std::vector<std::vector<AggregatePair>>& pairs;
        const std::vector<RigidMatrix>& basis;
    };

    /// Lays out the matrix of aggregates of which these are neighbours; unknowns are the motions of those that lead
    /// (Aggregates::leader). Keeps the layout that is there where it is of the same leaders and holds all pairs.
    void lay_out(std::span<const std::int32_t> leader, std::span<const std::vector<AggregatePair>> pairs);
    int unknowns() const noexcept { return static_cast<int>(scale_.size()); }

    /// False if the matrix is not positive definite, or not finite: is_usable() from then on.
    bool factorise(const Blocks& blocks);
    bool is_usable() const noexcept { return is_usable_; }

    /// The aggregates that lead, ascending.
    std::span<const std::int32_t> leaders() const noexcept { return leaders_; }
    /// Solves for the forces and torques on them and what follows them, [aggregate][6].
    void solve(const std::vector<RigidMatrix>& basis, std::span<const double> forces);
    /// How the k-th of leaders() moves by that.
    RigidVector motion(const std::vector<RigidMatrix>& basis, std::size_t k) const;

    std::size_t bytes() const noexcept;

  private:
    using SparseMatrix = Eigen::SparseMatrix<double>;
    using SparseFactorBase = Eigen::SimplicialLLT<SparseMatrix, Eigen::Upper, Eigen::NaturalOrdering<int>>;
    /// Eigen's factorisation without the matrix that `factorize` allocates and, in the natural order, has no use for.
    class SparseFactor : public SparseFactorBase {
      public:
        void factorise_in_place(const SparseMatrix& upper) { factorize_preordered<false>(upper); }
        bool is_finite() const {
            const auto& values = matrixL().nestedExpression();
            return Eigen::Map<const Eigen::VectorXd>(values.valuePtr(), values.nonZeros()).allFinite();
        }
    };

    void lay_out_sparse(std::span<const std::vector<AggregatePair>> pairs);
    bool holds(int a, int b) const;
    void find_scale(const Blocks& blocks);
    /// A block between two leaders in scaled orthonormal modes, from that between them or what follows them.
    RigidMatrix scaled(const Blocks& blocks, int a, int b, const RigidMatrix& raw) const;
    /// Calls visit(pair, k, l) for all pairs of which one follows the k-th, one the l-th leader, another one.
    template <class Visit>
    void for_each_coupling(std::span<const std::vector<AggregatePair>> pairs, const Visit& visit) const;
    bool factorise_dense(const Blocks& blocks);
    bool factorise_sparse(const Blocks& blocks);
    void add_to_sparse(int a, int b, const RigidMatrix& block);
    /// The first unknown of the k-th leader in the matrix.
    int first_of(int k) const { return rigid_motions * (is_dense_ ? k : place_[k]); }
    const RigidMatrix& of_leader(const std::vector<RigidMatrix>& matrices, int k) const {
        return matrices[static_cast<std::size_t>(leaders_[static_cast<std::size_t>(k)])];
    }

    std::vector<std::int32_t> leaders_;
    std::vector<std::int32_t> leader_place_;  ///< [aggregate] that of its leader in leaders_, or -1
    Eigen::VectorXd scale_;                   ///< [k][6]
    Eigen::VectorXd right_hand_side_, solution_;
    Eigen::MatrixXd dense_, inverse_;
    SparseMatrix sparse_;    ///< upper triangle, permuted for little fill
    Eigen::VectorXi place_;  ///< [k] its place in the elimination order of the sparse matrix
    SparseFactor factor_;
    bool is_dense_ = true;
    bool is_usable_ = false;
};

}  // namespace lancet::runtime
