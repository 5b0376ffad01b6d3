#include "lancet/runtime/integrate/step_system.hpp"

#include <algorithm>

#include "lancet/runtime/solve/block_loop.hpp"
#include "lancet/runtime/solve/critical_step.hpp"

namespace lancet::runtime {

template <class Real, class Accumulate>
StepSystem<Real, Accumulate>::StepSystem(ElasticElements<Real>& elements, const OperatorDefinition& definition,
                                         const Settings& settings, const Inertia& inertia,
                                         const StepEquations& equations)
    : elements_(&elements),
      numbering_(&elements.numbering()),
      inertia_(&inertia),
      equations_(&equations),
      takes_average_stress_(settings.integrator == Integrator::energy_momentum),
      rotation_bound_(settings.rotation_bound),
      conjugate_gradient_settings_(settings.conjugate_gradients),
      matrix_(make_operator(settings.matrix, elements, definition)),
      preconditioner_(std::make_unique<Preconditioner<Real>>(settings.preconditioner, elements, *matrix_, definition,
                                                             settings.coarse_change)),
      conjugate_gradients_(elements.kernels(), elements.numbering()),
      right_hand_side_(inertia.row_sums.size() * 4),
      change_(inertia.row_sums.size() * 4),
      partial_(static_cast<std::size_t>(elements.numbering().blocks())) {
    if (settings.rotation_bound > 0 && !is_linear()) elements.watch_deformation();
}

template <class Real, class Accumulate>
bool StepSystem<Real, Accumulate>::evaluate(Scheduler& scheduler, const double* position, bool renew) {
    const bool rotate = !is_linear() && (renew || !matrix_is_known_);
    elements_->evaluate(scheduler, position,
                        {.rotation = rotate,
                         .force = true,
                         .energy = false,
                         .start = takes_average_stress_ ? equations_->position().data() : nullptr,
                         .rotation_bound = matrix_is_known_ ? rotation_bound_ : 0});
    return rotate;
}

template <class Real, class Accumulate>
void StepSystem<Real, Accumulate>::assemble(Scheduler& scheduler, const BodyLoads& loads, bool rotated) {
    const double g = equations_->momentum_length();
    const typename Operator<Real>::Factors factors{
        .mass = 1 + g * loads.rayleigh_mass,
        .stiffness = g * equations_->position_length() + g * loads.rayleigh_stiffness};
    const bool same_factors =
        factors.mass == matrix_->factors().mass && factors.stiffness == matrix_->factors().stiffness;
    if (!rotated && matrix_is_known_ && same_factors) return;
    matrix_->assemble(scheduler, factors, rotated && matrix_is_known_ && same_factors);
    elements_->forget_stale_blocks();
    matrix_is_known_ = false;  // until the preconditioner has it too
}

template <class Real, class Accumulate>
void StepSystem<Real, Accumulate>::linearise(Scheduler& scheduler, const double* position, const BodyLoads& loads,
                                             bool renew) {
    assemble(scheduler, loads, evaluate(scheduler, position, renew));
}

template <class Real, class Accumulate>
bool StepSystem<Real, Accumulate>::is_free(const ConstraintFilter& filter) const noexcept {
    return numbering_->free_count == numbering_->node_count && filter.empty();
}

template <class Real, class Accumulate>
double StepSystem<Real, Accumulate>::set_right_hand_side(Scheduler& scheduler, const BodyMotion& motion,
                                                         const BodyLoads& loads, const ConstraintFilter& filter,
                                                         const Linearised& how) {
    const double g = equations_->momentum_length();
    const bool needs_product = how.at_state || loads.rayleigh_stiffness > 0;
    if (needs_product) {
        const std::span<Real> velocity = conjugate_gradients_.scratch();
        for (std::size_t i = 0; i < velocity.size(); ++i) velocity[i] = static_cast<Real>(motion.velocity[i]);
        matrix_->product(scheduler, velocity.data());
    }
    // Linearised at the state: g D v + g c K v = A v - M v. At the prediction: g beta K v is a part of A v.
    const double stiffness_share =
        how.at_state
            ? 1
            : g * loads.rayleigh_stiffness / (g * equations_->position_length() + g * loads.rayleigh_stiffness);
    const double product_mass = how.at_state ? 1 : 1 + g * loads.rayleigh_mass;
    const double drag = how.at_state ? 0 : g * loads.rayleigh_mass;
    // A body that nothing holds falls as a whole: that part of dv is known, A dv = g M gravity for dv = g gravity / (1
    // + g alpha), and solving for the rest alone keeps a fall free of strain, however few the iterations. Newmark's
    // velocity v~ differs from v_n by a share of the fall, too.
    const double damped = 1 + g * loads.rayleigh_mass, early = equations_->early_length();
    std::array<double, 3> load = loads.gravity;
    fall_.fill(0);
    for (std::size_t axis = 0; axis < 3 && how.falls_free && is_free(filter); ++axis) {
        load[axis] = early == 0 ? 0 : -early / g * damped * loads.gravity[axis];
        fall_[axis] = g * loads.gravity[axis] / damped + early * loads.gravity[axis];
    }
    const std::span<const double> start = equations_->velocity(), impulse = equations_->impulse();
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        elements_->merge_force(block);
        if (needs_product) matrix_->merge(block);
        const Real* force = elements_->force();
        const Real* product = matrix_->buffer();
        for (std::int32_t node = numbering_->block_begin[block]; node < numbering_->block_begin[block + 1]; ++node) {
            const auto at = static_cast<std::size_t>(node);
            const double mass = inertia_->row_sums[at];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::size_t i = 4 * at + axis;
                const double change = inertia_->momentum(
                    at, [&](std::size_t j) { return motion.velocity[4 * j + axis] - start[4 * j + axis]; });
                const double momentum =
                    inertia_->momentum(at, [&](std::size_t j) { return motion.velocity[4 * j + axis]; });
                double b =
                    g * (static_cast<double>(force[i]) + mass * load[axis] + loads.nodal[i]) - change - drag * momentum;
                if (!impulse.empty()) b += impulse[i];
                if (needs_product) {
                    b -= stiffness_share * (static_cast<double>(product[i]) - product_mass * momentum);
                }
                right_hand_side_[i] = static_cast<Accumulate>(b);
            }
        }
        filter.apply(right_hand_side_.data(), block);
        double square = 0;
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            square += static_cast<double>(right_hand_side_[i]) * static_cast<double>(right_hand_side_[i]);
            change_[i] = 0;
        }
        partial_[static_cast<std::size_t>(block)] = square;
    });
    return sum_over_awake_blocks(*numbering_, partial_);
}

template <class Real, class Accumulate>
void StepSystem<Real, Accumulate>::refresh(Scheduler& scheduler, const BodyMotion& motion) {
    if (matrix_is_known_) return;
    preconditioner_->refresh(scheduler, motion.position.data());
    matrix_is_known_ = true;
}

template <class Real, class Accumulate>
void StepSystem<Real, Accumulate>::solve(Scheduler& scheduler, const BodyMotion& motion, const ConstraintFilter& filter,
                                         StepReport& report) {
    refresh(scheduler, motion);
    const ConjugateGradientResult result = conjugate_gradients_.solve(
        scheduler, *matrix_, *preconditioner_, filter, std::span<const Accumulate>(right_hand_side_),
        std::span<Accumulate>(change_), conjugate_gradient_settings_);
    report.conjugate_gradient_iterations += result.iterations;
    report.conjugate_gradient_residual = result.residual;
}

template <class Real, class Accumulate>
void StepSystem<Real, Accumulate>::apply_matrix(Scheduler& scheduler, const double* position, const BodyLoads& loads,
                                                std::span<const Real> z, std::span<Real> out) {
    linearise(scheduler, position, loads, true);
    matrix_->product(scheduler, z.data());
    for_each_awake_block(scheduler, *numbering_, [&](int block) { matrix_->merge(block); });
    std::copy_n(matrix_->buffer(), out.size(), out.begin());
}

template <class Real, class Accumulate>
LargestEigenvalue StepSystem<Real, Accumulate>::largest_eigenvalue(Scheduler& scheduler, const double* position,
                                                                   double tolerance) {
    elements_->evaluate(scheduler, position, {.rotation = !is_linear(), .force = false, .energy = false});
    matrix_->assemble(scheduler, {.mass = 0, .stiffness = 1});
    matrix_is_known_ = false;
    return runtime::largest_eigenvalue(scheduler, *matrix_, *numbering_, inertia_->row_sums, tolerance);
}

template <class Real, class Accumulate>
bool StepSystem<Real, Accumulate>::take_up(const LayoutChange& change) {
    forget();
    return matrix_->change(change) && preconditioner_->change(change);
}

template <class Real, class Accumulate>
void StepSystem<Real, Accumulate>::forget() noexcept {
    matrix_is_known_ = false;
    preconditioner_->forget_coarse();
}

template <class Real, class Accumulate>
void StepSystem<Real, Accumulate>::change_sleepers() {
    forget();
    // What is left out is not written, and what is computed beside it reads that it does not move.
    std::ranges::fill(change_, Accumulate(0));
    std::ranges::fill(conjugate_gradients_.scratch(), Real(0));
    std::fill_n(matrix_->buffer(), matrix_->buffer_size(), Real(0));
    elements_->forget_force();
}

template <class Real, class Accumulate>
std::size_t StepSystem<Real, Accumulate>::bytes() const noexcept {
    using kernels::heap_bytes;
    return matrix_->bytes() + preconditioner_->bytes() + conjugate_gradients_.bytes() + heap_bytes(right_hand_side_) +
           heap_bytes(change_) + heap_bytes(partial_);
}

template <class Real, class Accumulate>
void StepSystem<Real, Accumulate>::save(std::vector<double>& numbers) const {
    numbers.insert(numbers.end(),
                   {matrix_is_known_ ? 1.0 : 0.0, matrix_->factors().mass, matrix_->factors().stiffness});
    preconditioner_->save(numbers);
}

template <class Real, class Accumulate>
void StepSystem<Real, Accumulate>::restore(Scheduler& scheduler, std::span<const double>& numbers) {
    matrix_is_known_ = numbers[0] != 0;
    if (matrix_is_known_) matrix_->assemble(scheduler, {.mass = numbers[1], .stiffness = numbers[2]});
    numbers = numbers.subspan(3);
    preconditioner_->restore(numbers);
}

template class StepSystem<float, float>;
template class StepSystem<float, double>;
template class StepSystem<double, double>;

}  // namespace lancet::runtime
