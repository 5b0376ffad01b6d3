#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lancet/kernels/isa/kernel_set.hpp"
#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"

namespace lancet::runtime {

/// How the rotation of an element is found, and which model it is for.
struct RotationSettings {
    kernels::RotationMethod method = kernels::RotationMethod::robust;
    int steps = 1;  ///< Newton steps of the warm-started methods
};

/// The elements of a body with their state: rotations, rotated gradients, elastic force. `Real` is the scalar of all
/// of them; positions are double.
template <class Real>
class ElasticElements {
  public:
    /// What an evaluation computes.
    struct Wanted {
        bool rotation = true;  ///< update the rotations and rotated gradients
        bool force = true;
        bool energy = false;
        bool keep_gradients =
            true;  ///< store the rotated gradients; false spares the memory traffic where only energy counts
    };

    ElasticElements(const kernels::KernelSet<Real>& kernels, kernels::ElementBatches<Real> batches,
                    const kernels::NodeNumbering& numbering, kernels::GradientLayout layout,
                    const RotationSettings& rotation);

    /// Sets every rotation to the identity and the gradients to those at rest: the linear model, and the start of the
    /// corotational one. `positions` are those at rest.
    void reset(Scheduler& scheduler, const double* positions);

    /// Evaluates at `positions` (xyz_, internal numbering). The force is complete at the free nodes after
    /// `merge_force` of each block. Returns the elastic energy in joules if wanted, else 0.
    double evaluate(Scheduler& scheduler, const double* positions, const Wanted& wanted);

    /// Completes the elastic force on the nodes of a block.
    void merge_force(int block);
    /// Elastic force, xyz_ in newtons; read it after merge_force.
    const Real* force() const noexcept { return force_.data(); }

    /// The inverses of the diagonal blocks of stiffness_factor K + mass_factor M, laid out as the vector kernels apply
    /// them, [node / width][6][lane]; blocks: false inverts their diagonals alone. `nodal_mass` is M's row sums times
    /// mass_factor; a consistent mass takes its other part from the elements. Overwrites the force.
    struct DiagonalWanted {
        double stiffness_factor;
        double mass_factor;
        const Real* nodal_mass;
        bool has_consistent_mass;
        bool blocks;
    };
    void invert_diagonal(Scheduler& scheduler, const DiagonalWanted& wanted, std::span<Real> inverse);

    const kernels::ElementBatches<Real>& batches() const noexcept { return batches_; }
    const kernels::KernelSet<Real>& kernels() const noexcept { return *kernels_; }
    const kernels::NodeNumbering& numbering() const noexcept { return *numbering_; }
    kernels::GradientLayout layout() const noexcept { return layout_; }
    const Real* rotated() const noexcept { return rotated_.data(); }
    /// Unit quaternions [batch][w, x, y, z][lane].
    std::span<Real> quaternions() noexcept { return quaternion_; }
    std::span<const Real> quaternions() const noexcept { return quaternion_; }
    std::span<Real> rotated_gradients() noexcept { return rotated_; }
    std::span<const Real> rotated_gradients() const noexcept { return rotated_; }
    std::size_t bytes() const noexcept;

  private:
    kernels::TetrahedronArguments<Real> arguments(const double* positions, const Wanted& wanted);
    /// Adds the elements' shares, add(block), to the force buffer, which is cleared first where `is_wanted`.
    template <class Add>
    void scatter(Scheduler& scheduler, bool is_wanted, const Add& add);

    const kernels::KernelSet<Real>* kernels_;
    const kernels::NodeNumbering* numbering_;
    kernels::ElementBatches<Real> batches_;
    kernels::GradientLayout layout_;
    RotationSettings rotation_;
    kernels::AlignedVector<Real> quaternion_;
    kernels::AlignedVector<Real> rotated_;
    kernels::AlignedVector<Real> force_;
    std::vector<double> energy_;
};

}  // namespace lancet::runtime
