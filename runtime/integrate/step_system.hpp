#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "lancet/runtime/integrate/step_equations.hpp"
#include "lancet/runtime/solve/conjugate_gradients.hpp"

namespace lancet::runtime {

/// A change of velocity in metres per second: one of each node, and a fall that all have in common.
template <class Accumulate>
struct VelocityChange {
    std::span<const Accumulate> nodal;  ///< xyz_
    std::array<double, 4> fall;

    /// A number of the xyz_ nodal vector.
    double operator[](std::size_t i) const noexcept { return static_cast<double>(nodal[i]) + fall[i % 4]; }
};

/// The linear systems of an implicit step: its equations linearised at some positions, with the matrix
/// A = M + g D + g c K, its preconditioner, right-hand side and solution. What has not changed since the last one is
/// kept.
template <class Real, class Accumulate>
class StepSystem {
  public:
    /// All but the definition and the settings must outlive it.
    StepSystem(ElasticElements<Real>& elements, const OperatorDefinition& definition, const Settings& settings,
               const Inertia& inertia, const StepEquations& equations);

    /// Forces at `position`, and where they have changed or `renew` asks for it, rotations; returns whether rotations
    /// are new.
    bool evaluate(Scheduler& scheduler, const double* position, bool renew);
    /// The matrix, unless it is as it was; `rotated`: rotations are newer than it.
    void assemble(Scheduler& scheduler, const BodyLoads& loads, bool rotated);
    /// Both.
    void linearise(Scheduler& scheduler, const double* position, const BodyLoads& loads, bool renew);

    /// How the right-hand side is formed.
    struct Linearised {
        bool at_state;    ///< at x_n instead of the prediction
        bool falls_free;  ///< take the known fall of a body that nothing holds out of it
    };
    /// From the forces that were evaluated last, for a change of motion.velocity; returns the square of its norm.
    double set_right_hand_side(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads,
                               const ConstraintFilter& filter, const Linearised& how);
    std::span<const Accumulate> right_hand_side() const noexcept { return right_hand_side_; }

    /// The preconditioner, unless the matrix is as it was.
    void refresh(Scheduler& scheduler, const BodyMotion& motion);
    void solve(Scheduler& scheduler, const BodyMotion& motion, const ConstraintFilter& filter, StepReport& report);
    /// What was solved for, of zero before solve.
    VelocityChange<Accumulate> change() const noexcept { return {change_, fall_}; }

    /// Nothing holds the body but forces.
    bool is_free(const ConstraintFilter& filter) const noexcept;

    /// Applies the matrix at `position` to z (xyz_, zero at fixed nodes).
    void apply_matrix(Scheduler& scheduler, const double* position, const BodyLoads& loads, std::span<const Real> z,
                      std::span<Real> out);
    LargestEigenvalue largest_eigenvalue(Scheduler& scheduler, const double* position, double tolerance);

    /// Takes up elements and masses that have changed. False where there is no room.
    bool take_up(const LayoutChange& change);
    void forget_matrix() noexcept { matrix_is_known_ = false; }
    void forget() noexcept;
    /// Tells that other nodes are asleep than before.
    void change_sleepers();

    const Operator<Real>& matrix() const noexcept { return *matrix_; }
    Preconditioner<Real>& preconditioner() const noexcept { return *preconditioner_; }
    std::size_t bytes() const noexcept;

    void save(std::vector<double>& numbers) const;
    /// Reads back what save wrote, from the front of `numbers`, which it removes.
    void restore(Scheduler& scheduler, std::span<const double>& numbers);

  private:
    bool is_linear() const noexcept { return elements_->law().model == ElementModel::linear; }

    ElasticElements<Real>* elements_;
    const kernels::NodeNumbering* numbering_;
    const Inertia* inertia_;
    const StepEquations* equations_;
    bool takes_average_stress_;
    double rotation_bound_;
    ConjugateGradientSettings conjugate_gradient_settings_;
    std::unique_ptr<Operator<Real>> matrix_;
    std::unique_ptr<Preconditioner<Real>> preconditioner_;
    ConjugateGradients<Real, Accumulate> conjugate_gradients_;
    kernels::AlignedVector<Accumulate> right_hand_side_, change_;
    std::array<double, 4> fall_{};  ///< what gravity alone adds to the velocity of a body that nothing holds
    std::vector<double> partial_;
    bool matrix_is_known_ = false;
};

}  // namespace lancet::runtime
