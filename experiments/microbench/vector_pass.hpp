#pragma once

#include <type_traits>
#include <vector>

#include "lancet/experiments/microbench/solver_parts.hpp"
#include "lancet/kernels/vector/vector_kernels.hpp"

namespace lancet::experiments {

/// The vectors of conjugate gradients, random, and the pass over them that follows a product: update and
/// preconditioner. `parts` must outlive it.
template <class Real, class Accumulate>
class VectorPass {
  public:
    VectorPass(SolverParts<Real>& parts, runtime::PreconditionerKind kind)
        : parts_(&parts),
          preconditioner_(&parts.preconditioner(kind)),
          products_(2 * static_cast<std::size_t>(parts.bar().numbering.blocks())) {
        const auto& random = parts.bar().random;
        copy(random[0], w_);
        copy(random[1], z_);
        copy(random[2], p_);
        copy(random[3], s_);
        copy(random[4], x_);
        copy(random[5], r_);
    }

    /// p = z + beta p, s = w + beta s, x += alpha p, r -= alpha s, z = B r. The sign of alpha changes every time, so
    /// that the vectors stay bounded.
    void run() {
        const kernels::NodeNumbering& numbering = parts_->bar().numbering;
        const kernels::ConjugateGradientArguments<Real, Accumulate> arguments{
            .block_begin = numbering.block_begin.data(),
            .w = w_.data(),
            .z = z_.data(),
            .p = p_.data(),
            .s = s_.data(),
            .x = x_.data(),
            .r = r_.data(),
            .inverse_diagonal = preconditioner_->inverse_diagonal(),
            .alpha = alpha_,
            .beta = Accumulate(0.25),
            .r_dot_z = products_.data(),
            .r_dot_r = products_.data() + numbering.blocks()};
        alpha_ = -alpha_;
        const auto& kernels = vector_kernels();
        runtime::Scheduler& scheduler = parts_->scheduler();
        if (preconditioner_->coarse() == nullptr) {
            scheduler.for_each_block(numbering.blocks(),
                                     [&](int block) { kernels.update_and_precondition(arguments, block); });
            return;
        }
        const auto coarse = preconditioner_->coarse()->arguments();
        scheduler.for_each_block(numbering.blocks(), [&](int block) {
            kernels.update(arguments, block);
            kernels.restrict_residual(coarse, arguments, block);
        });
        preconditioner_->coarse()->solve();
        scheduler.for_each_block(numbering.blocks(),
                                 [&](int block) { kernels.precondition_with_coarse(coarse, arguments, block); });
    }

    const Real* z() const noexcept { return z_.data(); }

    /// Bytes read and written: eight vectors of the solution's scalar (p, s, x, r both ways), w, z both ways, and what
    /// the preconditioner reads, as often as it does.
    double bytes() const {
        const double numbers = 4.0 * parts_->bar().numbering.free_count;
        const double coarse = preconditioner_->coarse() == nullptr ? 0 : 2 * sizeof(Real) + sizeof(Accumulate);
        return numbers * (8 * sizeof(Accumulate) + 3 * sizeof(Real) + 1.5 * sizeof(Real) + coarse);
    }

  private:
    const auto& vector_kernels() const {
        if constexpr (std::is_same_v<Real, Accumulate>) {
            return parts_->kernels().vector;
        } else {
            return parts_->kernels().vector_mixed;
        }
    }

    template <class Number>
    static void copy(const kernels::AlignedVector<double>& from, kernels::AlignedVector<Number>& to) {
        to.reserve(from.size());
        for (const double value : from) to.push_back(static_cast<Number>(value));
    }

    SolverParts<Real>* parts_;
    runtime::Preconditioner<Real>* preconditioner_;
    kernels::AlignedVector<Real> w_, z_;
    kernels::AlignedVector<Accumulate> p_, s_, x_, r_;
    std::vector<double> products_;
    Accumulate alpha_ = Accumulate(0.125);
};

}  // namespace lancet::experiments
