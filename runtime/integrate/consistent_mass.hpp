#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/runtime/solve/constraints.hpp"

namespace lancet::runtime {

/// What a consistent mass has beside its row sums: (M v)_i = m_i v_i + sum_j m_ij (v_j - v_i), with m_i the row sum and
/// m_ij = int rho phi_i phi_j over the elements that hold both nodes. In double, gathered row by row: for the inertia
/// of a step; the matrix of the linear system has it in its operator. An empty one stands for a lumped mass.
class ConsistentMass {
  public:
    ConsistentMass() = default;
    /// - batches: with their pair masses; tetrahedra: of the mesh, in the user's numbering
    template <class Real>
    ConsistentMass(const kernels::ElementBatches<Real>& batches, std::span<const kernels::Tetrahedron> tetrahedra,
                   const kernels::NodeNumbering& numbering);

    bool empty() const noexcept { return begin_.empty(); }

    /// Replaces the row of a free node; its old one is not used any more, nor is its memory until compress.
    void set_row(std::int32_t node, std::span<const std::pair<std::int32_t, double>> row);
    /// Frees what is not used, once that is half of all.
    void compress();

    /// sum_j m_ij (value(j) - value(node)) for a free node, where value(j) is a component of the nodal vector at node
    /// j.
    template <class Value>
    double off_diagonal(std::size_t node, const Value& value) const {
        const double own = value(node);
        double sum = 0;
        for (std::int32_t k = begin_[node]; k < end_[node]; ++k) {
            sum += mass_[k] * (value(static_cast<std::size_t>(column_[k])) - own);
        }
        return sum;
    }

    /// The xyz_ nodal vectors of a solution with M.
    struct System {
        std::span<double> residual;   ///< the right-hand side on entry
        std::span<double> direction;  ///< overwritten
        std::span<double> product;    ///< overwritten
        std::span<double> solution;   ///< overwritten
    };
    /// Solves S M S a = S b, where S is the filter, by conjugate gradients preconditioned with the row sums. Those
    /// bound the spectrum of linear tetrahedra to [1/5, 1] (Wathen 1987), so some forty iterations reach rounding.
    /// - row_sums: [node], kilograms; nodes without mass get no acceleration
    void solve(std::span<const double> row_sums, const kernels::NodeNumbering& numbering,
               const ConstraintFilter& filter, const System& system) const;

    std::size_t bytes() const noexcept;

  private:
    std::vector<std::int32_t> begin_;   ///< first entry of each free node
    std::vector<std::int32_t> end_;     ///< and their end
    std::vector<std::int32_t> column_;  ///< node of each entry, internal numbering
    std::vector<double> mass_;          ///< m_ij of each entry, kilograms
    std::size_t unused_ = 0;            ///< entries of rows that have been replaced
};

}  // namespace lancet::runtime
