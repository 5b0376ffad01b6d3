#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lancet/runtime/solve/constraints.hpp"
#include "lancet/runtime/solve/operator.hpp"
#include "lancet/runtime/solve/preconditioner.hpp"

namespace lancet::runtime {

/// When conjugate gradients stop.
struct ConjugateGradientSettings {
    int iterations = 10;  ///< at most
    /// Relative: the norm of the residual with the preconditioner, sqrt(r . B r / b . B b), and then the largest entry
    /// of the preconditioned residual B r against that of the solution. The norm is one of energy, in which nodes weigh
    /// as much as they are stiff: thin parts of cut elements, of a volume fraction v, may be wrong by tolerance /
    /// sqrt(v) before it sees them; the largest entry sees all alike. 0: all iterations.
    double tolerance = 0;
};

/// How a solve ended.
struct ConjugateGradientResult {
    int iterations = 0;
    double residual = 0;  ///< sqrt(r . B r / b . B b), with b the right-hand side filtered
    bool broke_down =
        false;  ///< the matrix showed itself indefinite or not finite; the iterate before that is returned
};

/// Preconditioned conjugate gradients in the form of Chronopoulos and Gear (1989): the products that an iteration needs
/// are formed while the operator and the vector pass run, so that the threads meet twice an iteration (three times with
/// a coarse space) where the textbook's form meets four times.
///
/// `Real` is the scalar of the operator, `Accumulate` that of solution and residual.
template <class Real, class Accumulate>
class ConjugateGradients {
  public:
    explicit ConjugateGradients(const kernels::KernelSet<Real>& kernels, const kernels::NodeNumbering& numbering);

    /// Solves S A S x = S b, where S is the filter, starting from x, whose values at fixed and held nodes are
    /// prescribed and kept. b and x are xyz_ nodal vectors. `history`, if not empty, receives the residual after each
    /// iteration.
    ConjugateGradientResult solve(Scheduler& scheduler, Operator<Real>& matrix, Preconditioner<Real>& preconditioner,
                                  const ConstraintFilter& filter, std::span<const Accumulate> b,
                                  std::span<Accumulate> x, const ConjugateGradientSettings& settings,
                                  std::span<double> history = {});

    /// A nodal vector of the solver that is free between solves.
    std::span<Real> scratch() noexcept { return z_; }
    std::size_t bytes() const noexcept;

  private:
    struct Products {
        double r_dot_z = 0;
        double r_dot_r = 0;
    };

    Products precondition(Scheduler& scheduler, Preconditioner<Real>& preconditioner, const ConstraintFilter& filter);
    /// Calls before(block) in the first of its passes.
    template <class Before>
    Products precondition_with_coarse(Scheduler& scheduler, CoarseSpace<Real>& coarse, const ConstraintFilter& filter,
                                      const Before& before);
    Products advance(Scheduler& scheduler, Operator<Real>& matrix, Preconditioner<Real>& preconditioner,
                     const ConstraintFilter& filter, double alpha, double beta);
    Products sum_products() const noexcept;
    /// The largest entries of z and of x.
    struct Corrections {
        double correction = 0, solution = 0;
    };
    Corrections corrections(Scheduler& scheduler, std::span<const Accumulate> x);
    /// Goes along z, but only at nodes where it is larger than `limit`, to where the energy is lowest, if those nodes
    /// have next to none of it (of r . z); returns whether they do. z is then to be computed anew.
    ///
    /// Conjugate gradients reduce the energy of the error, and thin parts of a volume fraction v have only v of it: the
    /// polynomial in the matrix that they build is small at the eigenvalues of the rest, and takes half as many
    /// iterations again to be small between them, where those of thin parts lie. Yet nothing hangs on thin parts: with
    /// the rest at rest, what their own blocks of the matrix say is right but for what thin parts say to each other.
    bool correct_thin_nodes(Scheduler& scheduler, Operator<Real>& matrix, const ConstraintFilter& filter,
                            std::span<Accumulate> x, double limit, double r_dot_z);

    const kernels::VectorKernels<Real, Accumulate>* kernels_;
    const kernels::NodeNumbering* numbering_;
    kernels::AlignedVector<Real> z_;
    kernels::AlignedVector<Accumulate> p_, s_, r_;
    std::vector<double> r_dot_z_, r_dot_r_;
    kernels::ConjugateGradientArguments<Real, Accumulate> arguments_{};
};

}  // namespace lancet::runtime
