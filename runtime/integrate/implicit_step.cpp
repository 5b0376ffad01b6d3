#include "lancet/runtime/integrate/implicit_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lancet/runtime/integrate/nodal_sum.hpp"
#include "lancet/runtime/integrate/step_timer.hpp"
#include "lancet/runtime/solve/block_loop.hpp"

namespace lancet::runtime {

namespace {

template <class Real>
Inertia inertia_of(const ElasticElements<Real>& elements, const OperatorDefinition& definition) {
    return {.row_sums = definition.nodal_mass,
            .consistent = definition.mass == MassKind::consistent
                              ? ConsistentMass(elements.batches(), definition.tetrahedra, elements.numbering())
                              : ConsistentMass()};
}

}  // namespace

template <class Real, class Accumulate>
ImplicitStep<Real, Accumulate>::ImplicitStep(ElasticElements<Real>& elements, const OperatorDefinition& definition,
                                             const Settings& settings)
    : elements_(&elements),
      numbering_(&elements.numbering()),
      settings_(settings),
      inertia_(inertia_of(elements, definition)),
      equations_(settings, elements.numbering(), inertia_),
      energy_(elements, inertia_),
      system_(elements, definition, settings, inertia_, equations_),
      line_search_(energy_, equations_),
      safeguard_({.numbering = elements.numbering(),
                  .inertia = inertia_,
                  .equations = equations_,
                  .energy = energy_,
                  .system = system_,
                  .line_search = line_search_},
                 settings.safeguard_iterations),
      partial_(static_cast<std::size_t>(elements.numbering().blocks())) {
    if (settings.integrator == Integrator::newmark) {
        newmark_.emplace(settings, elements.numbering(), inertia_, equations_, system_);
    }
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::add_change(Scheduler& scheduler, BodyMotion& motion) {
    const VelocityChange<Accumulate> change = system_.change();
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            motion.velocity[i] += change[i];
        }
    });
}

template <class Real, class Accumulate>
double ImplicitStep<Real, Accumulate>::load_norm(Scheduler& scheduler, const BodyLoads& loads) {
    const double square = sum_over_nodes(scheduler, *numbering_, partial_, [&](std::size_t node, std::size_t at) {
        double sum = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double force = inertia_.row_sums[node] * loads.gravity[axis] + loads.nodal[at + axis];
            sum += force * force;
        }
        return sum;
    });
    return equations_.momentum_length() * std::sqrt(square);
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::set_up_system(Scheduler& scheduler, const StepSubject& subject,
                                                   StepTotals& totals) {
    StepTimer timer;
    const auto& [motion, loads, filter, before_hold] = subject;
    system_.assemble(scheduler, loads, is_rotated_);
    timer.add_to(totals.seconds_forces);
    // Before the preconditioner, which is gathered where the forces are.
    const double residual =
        system_.set_right_hand_side(scheduler, motion, loads, filter, {.at_state = is_at_state(), .falls_free = true});
    newton_ = {.reference = 0, .potential = 0, .is_finite = std::isfinite(residual)};
    if (iterations() > 1) newton_.reference = std::max(std::sqrt(residual), load_norm(scheduler, loads));
    timer.add_to(totals.seconds_rest);
    system_.refresh(scheduler, motion);
    timer.add_to(totals.seconds_solve);
}

template <class Real, class Accumulate>
bool ImplicitStep<Real, Accumulate>::accept(Scheduler& scheduler, const StepSubject& subject, bool is_first,
                                            StepReport& report, StepTotals& totals) {
    StepTimer timer;
    const auto& [motion, loads, filter, before_hold] = subject;
    ++report.newton_iterations;
    // A line search needs the potential of all forces, which stiffness-proportional damping and the average stress of
    // a step do not have.
    const bool searches = iterations() > 1 && loads.rayleigh_stiffness == 0 && !takes_average_stress();
    if (!searches) {
        add_change(scheduler, motion);
        timer.add_to(totals.seconds_rest);
        return true;
    }
    // Where no step along the direction descends, the iterate is as good as the scalar type allows.
    if (is_first) newton_.potential = line_search_.potential(scheduler, motion, motion.velocity, loads);
    // Rounding of the scalar, and of the positions: small strains are differences of large coordinates.
    const double rounding =
        std::max(64 * static_cast<double>(std::numeric_limits<Real>::epsilon()), 1e-10) * std::abs(newton_.potential);
    const bool descended =
        line_search_.descend(scheduler, motion, system_.change(), loads, newton_.potential, rounding);
    timer.add_to(totals.seconds_forces);
    return descended;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::iterate(Scheduler& scheduler, const StepSubject& subject, StepReport& report,
                                             StepTotals& totals) {
    const auto& [motion, loads, filter, before_hold] = subject;
    const double c = equations_.position_length();
    bool goes_on = accept(scheduler, subject, true, report, totals);
    for (int iteration = 1; goes_on && iteration < iterations(); ++iteration) {
        StepTimer timer;
        equations_.move(scheduler, motion.position, c, motion.velocity);
        timer.add_to(totals.seconds_rest);
        system_.linearise(scheduler, motion.position.data(), loads, true);
        timer.add_to(totals.seconds_forces);
        const double residual =
            system_.set_right_hand_side(scheduler, motion, loads, filter, {.at_state = false, .falls_free = false});
        newton_.is_finite = newton_.is_finite && std::isfinite(residual);
        timer.add_to(totals.seconds_rest);
        if (std::sqrt(residual) <= settings_.newton_tolerance * newton_.reference) break;
        system_.solve(scheduler, motion, filter, report);
        timer.add_to(totals.seconds_solve);
        goes_on = accept(scheduler, subject, false, report, totals);
    }
    StepTimer timer;
    equations_.move(scheduler, motion.position, c, motion.velocity);
    timer.add_to(totals.seconds_rest);
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::extrapolate(Scheduler& scheduler, BodyMotion& motion) {
    equations_.move(scheduler, motion.position, equations_.step_length(), motion.velocity);
    for (std::size_t i = 0; i < motion.velocity.size(); ++i) {
        motion.velocity[i] = 2 * motion.velocity[i] - equations_.velocity()[i];
    }
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::stop(BodyMotion& motion) noexcept {
    motion.position = newmark_ ? newmark_->old_position() : equations_.position();
    std::fill(motion.velocity.begin(), motion.velocity.end(), 0.0);
    std::fill(motion.acceleration.begin(), motion.acceleration.end(), 0.0);
    forget();
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::run(StepStage stage, Scheduler& scheduler, const StepSubject& subject,
                                         StepReport& report, StepTotals& totals) {
    switch (stage) {
        case StepStage::forces:
            return begin(scheduler, subject, totals);
        case StepStage::matrix:
            return set_up_system(scheduler, subject, totals);
        case StepStage::solve: {
            StepTimer timer;
            system_.solve(scheduler, subject.motion, subject.filter, report);
            timer.add_to(totals.seconds_solve);
            return;
        }
        case StepStage::update:
            return end(scheduler, subject, report, totals);
    }
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::begin(Scheduler& scheduler, const StepSubject& subject, StepTotals& totals) {
    const auto& [motion, loads, filter, before_hold] = subject;
    if (settings_.energy_safeguard) safeguard_.begin(scheduler, motion, before_hold, totals);
    StepTimer timer;
    equations_.set_impulse(scheduler, motion.velocity, before_hold);
    if (newmark_) {
        if (!newmark_->is_known()) {
            newmark_->find(scheduler, motion, loads, filter);
            timer.add_to(totals.seconds_forces);
        }
        newmark_->begin(scheduler, motion);
    } else {
        equations_.position() = motion.position;
        equations_.velocity() = motion.velocity;
    }
    if (!is_at_state()) {
        equations_.move(scheduler, motion.position, equations_.position_length(), motion.velocity);
    }
    timer.add_to(totals.seconds_rest);
    is_rotated_ = system_.evaluate(scheduler, motion.position.data(), steps_since_renewal_ == 0);
    if (is_rotated_) totals.kept_rotations += elements_->kept_blocks();
    timer.add_to(totals.seconds_forces);
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::end(Scheduler& scheduler, const StepSubject& subject, StepReport& report,
                                         StepTotals& totals) {
    BodyMotion& motion = subject.motion;
    iterate(scheduler, subject, report, totals);
    if (settings_.energy_safeguard) safeguard_.check(scheduler, subject, report, totals);
    StepTimer rest;
    if (is_midpoint()) extrapolate(scheduler, motion);
    if (newmark_) newmark_->end(scheduler, motion);
    rest.add_to(totals.seconds_rest);
    // Where the safeguard has found no growth, energies and with them the state are finite. Without it a step whose
    // equations are not has gone on as if there were no forces.
    const bool is_guarded = settings_.energy_safeguard;
    if (((!is_guarded || report.repeated) &&
         !is_finite(scheduler, *numbering_, partial_, motion.position, motion.velocity)) ||
        !(is_guarded || newton_.is_finite)) {
        stop(motion);
        report.lost = true;
    }
    steps_since_renewal_ = (steps_since_renewal_ + 1) % settings_.rotation_interval;

    ++totals.steps;
    totals.newton_iterations += report.newton_iterations;
    totals.conjugate_gradient_iterations += report.conjugate_gradient_iterations;
    totals.repeats += report.repeated ? 1 : 0;
    totals.lost += report.lost ? 1 : 0;
    totals.coarse_refreshes = system_.preconditioner().coarse_refreshes();
    totals.coarse_failures = system_.preconditioner().coarse_failures();
}

template <class Real, class Accumulate>
Energies ImplicitStep<Real, Accumulate>::energies(Scheduler& scheduler, const BodyMotion& motion,
                                                  const BodyLoads& loads, std::span<const double> rest_position) {
    Energies energies;
    energies.kinetic = energy_.kinetic(scheduler, motion.velocity);
    energies.elastic = energy_.elastic(scheduler, motion.position.data());
    energies.gravity = gravity_energy(scheduler, *numbering_, partial_, inertia_.row_sums, loads.gravity,
                                      motion.position, rest_position);
    return energies;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::apply_matrix(Scheduler& scheduler, const BodyMotion& motion,
                                                  const BodyLoads& loads, std::span<const Real> z,
                                                  std::span<Real> out) {
    system_.apply_matrix(scheduler, motion.position.data(), loads, z, out);
}

template <class Real, class Accumulate>
LargestEigenvalue ImplicitStep<Real, Accumulate>::largest_eigenvalue(Scheduler& scheduler, const double* position,
                                                                     double tolerance) {
    return system_.largest_eigenvalue(scheduler, position, tolerance);
}

template <class Real, class Accumulate>
bool ImplicitStep<Real, Accumulate>::change(const LayoutChange& change) {
    for (const LayoutChange::NodalMass& changed : change.masses) {
        inertia_.row_sums[changed.node] = changed.mass;
        if (!inertia_.consistent.empty() && numbering_->is_free(changed.node)) {
            inertia_.consistent.set_row(changed.node, changed.row);
        }
    }
    if (!inertia_.consistent.empty()) inertia_.consistent.compress();
    forget();
    return system_.take_up(change);
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::forget_velocity() noexcept {
    safeguard_.forget();
    forget_acceleration();
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::forget_acceleration() noexcept {
    if (newmark_) newmark_->forget();
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::forget() noexcept {
    forget_velocity();
    system_.forget();
    steps_since_renewal_ = 0;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::change_sleepers() {
    safeguard_.forget();
    system_.change_sleepers();
}

template <class Real, class Accumulate>
std::size_t ImplicitStep<Real, Accumulate>::bytes() const noexcept {
    return kernels::heap_bytes(inertia_.row_sums) + inertia_.consistent.bytes() + equations_.bytes() + energy_.bytes() +
           system_.bytes() + line_search_.bytes() + safeguard_.bytes() + (newmark_ ? newmark_->bytes() : 0) +
           kernels::heap_bytes(partial_);
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::save(std::vector<double>& numbers) const {
    numbers.push_back(static_cast<double>(steps_since_renewal_));
    safeguard_.save(numbers);
    if (newmark_) newmark_->save(numbers);
    system_.save(numbers);
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::restore(Scheduler& scheduler, std::span<const double>& numbers) {
    steps_since_renewal_ = static_cast<int>(numbers[0]);
    numbers = numbers.subspan(1);
    safeguard_.restore(numbers);
    if (newmark_) newmark_->restore(numbers);
    system_.restore(scheduler, numbers);
}

template class ImplicitStep<float, float>;
template class ImplicitStep<float, double>;
template class ImplicitStep<double, double>;

}  // namespace lancet::runtime
