#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/solve/elastic_elements.hpp"
#include "lancet/runtime/solve/layout_change.hpp"
#include "lancet/runtime/solve/mass_kind.hpp"

namespace lancet::runtime {

/// How the step matrix is kept.
enum class OperatorKind {
    matrix_free,  ///< rotated gradients of each element
    edge_blocks,  ///< one 3 x 3 block per edge and nodal masses
    block_rows    ///< every 3 x 3 block of every row
};
std::string_view to_string(OperatorKind kind) noexcept;
OperatorKind operator_kind_from_string(std::string_view name);

/// y = A z for A = mass_factor M + stiffness_factor K, symmetric positive definite, over the free nodes. `z` is read at
/// all nodes. An operator is the sum of nodal masses (the row sums of M) and terms whose rows add up to zero.
///
/// A product is taken in two halves, so that the second joins the vector pass that follows it: `product` fills the
/// buffer, `merge(block)` completes the nodes of a block.
template <class Real>
class Operator {
  public:
    struct Factors {
        double mass = 1;
        double stiffness = 0;
    };
    /// Work of one product: floating-point operations, and bytes that must come from memory or cache.
    struct Work {
        double flops;
        double bytes;
    };

    virtual ~Operator() = default;

    virtual OperatorKind kind() const noexcept = 0;
    /// Takes up the rotated gradients or blocks of the elements.
    /// `only_stale`: where ElasticElements::stale_blocks says so; the rest is as it was assembled last, with the same
    /// factors.
    virtual void assemble(Scheduler& scheduler, const Factors& factors, bool only_stale = false) = 0;
    /// Takes up elements and masses that have changed, after the elements themselves have; assemble comes next. False
    /// where there is no room, which leaves the operator unfit for use.
    virtual bool change(const LayoutChange& change);
    /// Fills buffer() with A z up to merging and returns z . A z.
    double product(Scheduler& scheduler, const Real* z);
    /// Completes the nodes of a block of buffer().
    void merge(int block);
    Real* buffer() noexcept { return y_.data(); }
    /// With the slots of the blocks.
    std::size_t buffer_size() const noexcept { return y_.size(); }

    /// Nodal masses times their factor, [node].
    const Real* scaled_mass() const noexcept { return scaled_mass_.data(); }
    const Factors& factors() const noexcept { return factors_; }
    virtual std::size_t bytes() const noexcept;
    virtual Work work() const noexcept = 0;

  protected:
    Operator(ElasticElements<Real>& elements, std::vector<double> nodal_mass);
    /// Says where products are scattered; the plan must live as long as the operator.
    void set_plan(const kernels::ScatterPlan& plan);
    void set_factors(const Factors& factors);
    virtual void add_product(const kernels::ProductArguments<Real>& product, int block) const = 0;

    ElasticElements<Real>& elements() const noexcept { return *elements_; }
    const kernels::NodeNumbering& numbering() const noexcept { return elements_->numbering(); }
    const kernels::KernelSet<Real>& kernels() const noexcept { return elements_->kernels(); }

  private:
    ElasticElements<Real>* elements_;
    const kernels::ScatterPlan* plan_ = nullptr;
    std::vector<double> nodal_mass_;
    kernels::AlignedVector<Real> scaled_mass_;
    kernels::AlignedVector<Real> y_;
    std::vector<double> quadratic_;
    Factors factors_{};
};

/// What operators are built from.
struct OperatorDefinition {
    std::span<const kernels::Tetrahedron> tetrahedra;  ///< of the mesh, in the user's numbering
    std::vector<double> nodal_mass;                    ///< [node], internal numbering, kilograms
    MassKind mass = MassKind::lumped;
    kernels::ScatterStrategy scatter = kernels::ScatterStrategy::private_copies;
};

/// Builds an operator; `elements` must outlive it. The layout of the elements must suit the kind:
/// see gradient_layout.
template <class Real>
std::unique_ptr<Operator<Real>> make_operator(OperatorKind kind, ElasticElements<Real>& elements,
                                              const OperatorDefinition& definition);

/// What an operator reads of the elements.
constexpr kernels::GradientLayout gradient_layout(OperatorKind kind, const ElasticLaw& law = {}) {
    if (!law.is_rotated()) return kernels::GradientLayout::element_blocks;
    return kind == OperatorKind::matrix_free ? kernels::GradientLayout::batches : kernels::GradientLayout::corners;
}

}  // namespace lancet::runtime
