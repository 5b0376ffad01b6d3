#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lancet/kernels/isa/kernel_set.hpp"
#include "lancet/kernels/layout/element_batches.hpp"
#include "lancet/runtime/schedule/scheduler.hpp"
#include "lancet/runtime/solve/deformation_watch.hpp"

namespace lancet::runtime {

/// How the rotation of an element is found, and which model it is for.
struct RotationSettings {
    kernels::RotationMethod method = kernels::RotationMethod::robust;
    int steps = 1;  ///< Newton steps of the warm-started methods
};

/// What an element's energy is a function of.
using ElementModel = kernels::MaterialModel;
using kernels::TangentKind;

/// The law of the elements and which derivative of it serves as stiffness. The rotated tangent is the cheapest; the
/// exact one makes Newton's method converge in second order, and shows a loss of stability.
struct ElasticLaw {
    ElementModel model = ElementModel::corotational;
    TangentKind tangent = TangentKind::rotated;

    /// True where rotated gradients say all that operators need: the linear model and the rotated tangent.
    constexpr bool is_rotated() const noexcept {
        return model == ElementModel::linear || tangent == TangentKind::rotated;
    }
};

/// The elements of a body with their state: rotations, rotated gradients, elastic force. `Real` is the scalar of all
/// of them; positions are double.
///
/// Linear and corotational elements with the rotated tangent keep rotated gradients, from which operators make what
/// they need: the fast path. Every other law keeps the edge blocks of each element.
template <class Real>
class ElasticElements {
  public:
    /// What an evaluation computes.
    struct Wanted {
        bool rotation = true;  ///< update the rotations, and the rotated gradients or element blocks
        bool force = true;
        bool energy = false;
        const double* start = nullptr;  ///< see HyperelasticArguments::start
        bool keep_gradients = true;     ///< store the rotated gradients or element blocks; false spares what only
                                        ///< operators need
        double rotation_bound = 0;      ///< rotations stay in blocks whose F has not changed by more since they were
                                        ///< taken up; needs watch_deformation
    };

    ElasticElements(const kernels::KernelSet<Real>& kernels, kernels::ElementBatches<Real> batches,
                    const kernels::NodeNumbering& numbering, kernels::GradientLayout layout,
                    const RotationSettings& rotation, const ElasticLaw& law = {});

    /// Sets every rotation to the identity and the gradients to those at rest: the linear model, and the start of the
    /// corotational one. `positions` are those at rest.
    void reset(Scheduler& scheduler, const double* positions);

    /// Lays out an element that comes, stays in its slot with other nodes or another weight, or, without `element`,
    /// goes; `slot` is -1 for one that comes, and becomes its own. It starts from the rotation of the element in the
    /// slot `like`. `numbering` is that of the elements. Returns false where there is no room, which leaves the
    /// elements unfit for use. When all changes are made, call finish_changes.
    bool change(std::int32_t& slot, const kernels::ChangedElement* element, std::int32_t like);
    /// The slot of each element of the body, -1 for one that is not there.
    std::vector<std::int32_t>& slot_of_element() noexcept { return batches_.slot_of_element; }
    /// Completes changes. Takes the gradients at rest up anew where elements have changed, for the linear model, which
    /// never renews them; `rest_positions` are xyz_.
    void finish_changes(const double* rest_positions);

    /// Evaluates at `positions` (xyz_, internal numbering). The force is complete at the free nodes after
    /// `merge_force` of each block. Returns the elastic energy in joules if wanted, else 0.
    double evaluate(Scheduler& scheduler, const double* positions, const Wanted& wanted);

    /// Makes what rotation_bound needs.
    void watch_deformation();
    /// [block of nodes] 1: rotations of elements there have been taken up since forget_stale_blocks. Empty where the
    /// deformation is not watched.
    std::span<const std::uint8_t> stale_blocks() const noexcept { return stale_blocks_; }
    /// Blocks of elements whose rotations stayed in the last evaluation that could take them up.
    std::ptrdiff_t kept_blocks() const noexcept { return std::ranges::count(has_turned_, std::uint8_t{0}); }
    void forget_stale_blocks() noexcept { std::ranges::fill(stale_blocks_, std::uint8_t{0}); }

    /// What a bit-exact continuation needs of it.
    void save_watch(std::vector<double>& numbers) const;
    void restore_watch(std::span<const double>& numbers);

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

    /// The blocks that may be left out while some nodes are asleep, [internal node], and the others. None that is room:
    /// its rows and elements may be of any node. Throws lancet::Error for an element of which some nodes are asleep and
    /// others are not.
    kernels::SleepingNodes sleeping(std::vector<std::uint8_t> nodes) const;
    /// Takes up that other nodes are asleep than before.
    void forget_force() noexcept { std::ranges::fill(force_, Real(0)); }

    const kernels::ElementBatches<Real>& batches() const noexcept { return batches_; }
    const kernels::KernelSet<Real>& kernels() const noexcept { return *kernels_; }
    const kernels::NodeNumbering& numbering() const noexcept { return *numbering_; }
    kernels::GradientLayout layout() const noexcept { return layout_; }
    const ElasticLaw& law() const noexcept { return law_; }
    const Real* rotated() const noexcept { return rotated_.data(); }
    /// Unit quaternions [batch][w, x, y, z][lane].
    std::span<Real> quaternions() noexcept { return quaternion_; }
    std::span<const Real> quaternions() const noexcept { return quaternion_; }
    std::span<Real> rotated_gradients() noexcept { return rotated_; }
    std::span<const Real> rotated_gradients() const noexcept { return rotated_; }
    std::size_t bytes() const noexcept;

  private:
    kernels::TetrahedronArguments<Real> arguments(const double* positions, const Wanted& wanted);
    /// Gradients as the rotations are, without a step of them.
    kernels::TetrahedronArguments<Real> arguments_at_rest(const double* positions);
    kernels::HyperelasticArguments<Real> hyperelastic_arguments(const double* positions, const Wanted& wanted);
    /// Adds the elements' shares, add(block), to the force buffer, which is cleared first where `is_wanted`.
    /// Blocks of elements whose rotations are to be taken up, into has_turned_.
    void watch(Scheduler& scheduler, const double* positions, double bound);
    template <class Add>
    void scatter(Scheduler& scheduler, bool is_wanted, const Add& add);
    void forget_sleeping(std::span<Real> inverse, int block) const;

    const kernels::KernelSet<Real>* kernels_;
    const kernels::NodeNumbering* numbering_;
    kernels::ElementBatches<Real> batches_;
    kernels::GradientLayout layout_;
    RotationSettings rotation_;
    ElasticLaw law_;
    kernels::AlignedVector<Real> quaternion_;
    kernels::AlignedVector<Real> rotated_;
    kernels::AlignedVector<Real> force_;
    std::vector<double> energy_;
    std::vector<int> changed_blocks_;
    std::optional<DeformationWatch> watch_;
    std::vector<std::uint8_t> stale_blocks_, has_turned_;  ///< [block of nodes], [block of elements]
};

}  // namespace lancet::runtime
