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

    /// The blocks of a coarse matrix, and the modes of the aggregates (RigidModes::basis).
    struct Blocks {
        const std::vector<RigidMatrix>& diagonal;
        const std::vector<std::vector<AggregatePair>>& pairs;
        const std::vector<RigidMatrix>& basis;
    };

    /// Lays out the matrix of so many aggregates of which these are neighbours.
    void lay_out(int aggregates, std::span<const std::vector<AggregatePair>> pairs);
    /// True where the layout has room for the block of two aggregates.
    bool holds(int a, int b) const;
    int unknowns() const noexcept { return static_cast<int>(scale_.size()); }

    /// False if the matrix is not positive definite, or not finite: is_usable() from then on.
    bool factorise(const Blocks& blocks);
    bool is_usable() const noexcept { return is_usable_; }

    /// Solves for the forces and torques on all aggregates, [aggregate][6].
    void solve(const std::vector<RigidMatrix>& basis, std::span<const double> forces);
    /// How an aggregate moves by that.
    RigidVector motion(const std::vector<RigidMatrix>& basis, int aggregate) const;

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

    void lay_out_sparse(int aggregates, std::span<const std::vector<AggregatePair>> pairs);
    void find_scale(const Blocks& blocks);
    /// A block between two aggregates in scaled orthonormal modes.
    RigidMatrix scaled(const Blocks& blocks, int a, int b, const RigidMatrix& raw) const;
    bool factorise_dense(const Blocks& blocks);
    bool factorise_sparse(const Blocks& blocks);
    void add_to_sparse(int a, int b, const RigidMatrix& block);
    /// The first unknown of an aggregate.
    int first_of(int aggregate) const { return rigid_motions * (is_dense_ ? aggregate : place_[aggregate]); }

    Eigen::VectorXd scale_;  ///< [aggregate][6]
    Eigen::VectorXd right_hand_side_, solution_;
    Eigen::MatrixXd dense_, inverse_;
    SparseMatrix sparse_;    ///< upper triangle, permuted for little fill
    Eigen::VectorXi place_;  ///< [aggregate] its place in the elimination order of the sparse matrix
    SparseFactor factor_;
    bool is_dense_ = true;
    bool is_usable_ = false;
};

}  // namespace lancet::runtime
