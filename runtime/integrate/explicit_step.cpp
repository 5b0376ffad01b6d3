#include "lancet/runtime/integrate/explicit_step.hpp"

#include <algorithm>
#include <cmath>

#include "lancet/runtime/integrate/nodal_sum.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/solve/block_loop.hpp"
#include "lancet/runtime/solve/critical_step.hpp"
#include "lancet/runtime/solve/matrix_free.hpp"

namespace lancet::runtime {

template <class Real>
ExplicitStep<Real>::ExplicitStep(ElasticElements<Real>& elements, std::vector<double> nodal_mass,
                                 const Settings& settings)
    : elements_(&elements),
      numbering_(&elements.numbering()),
      settings_(settings),
      mass_(std::move(nodal_mass)),
      partial_(static_cast<std::size_t>(elements.numbering().blocks())) {}

template <class Real>
double ExplicitStep<Real>::damping_divisor(const BodyLoads& loads) const noexcept {
    const double share = settings_.integrator == Integrator::symplectic_euler ? 1.0 : 0.5;
    return 1 + share * settings_.time_step * loads.rayleigh_mass;
}

template <class Real>
void ExplicitStep<Real>::accelerate(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads,
                                    const ConstraintFilter& filter, double divisor) {
    elements_->evaluate(scheduler, motion.position.data(),
                        {.rotation = !is_linear(), .force = true, .energy = false, .keep_gradients = false});
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        elements_->merge_force(block);
        const Real* force = elements_->force();
        for (std::int32_t node = numbering_->block_begin[block]; node < numbering_->block_begin[block + 1]; ++node) {
            const auto at = static_cast<std::size_t>(node);
            const double mass = mass_[at];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::size_t i = 4 * at + axis;
                motion.acceleration[i] = mass > 0 ? ((static_cast<double>(force[i]) + loads.nodal[i]) / mass +
                                                     loads.gravity[axis] - loads.rayleigh_mass * motion.velocity[i]) /
                                                        divisor
                                                  : 0.0;
            }
        }
        filter.apply(motion.acceleration.data(), block);
    });
}

template <class Real>
bool ExplicitStep<Real>::kick(Scheduler& scheduler, BodyMotion& motion, double length) {
    return std::isfinite(
        sum_over_nodes(scheduler, *numbering_, std::span<double>(partial_), [&](std::size_t, std::size_t at) {
            double size = 0;
            for (std::size_t i = at; i < at + 3; ++i) {
                motion.velocity[i] += length * motion.acceleration[i];
                size += std::abs(motion.velocity[i]);
            }
            return size;
        }));
}

template <class Real>
void ExplicitStep<Real>::drift(Scheduler& scheduler, BodyMotion& motion) {
    const double h = settings_.time_step;
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            motion.position[i] += h * motion.velocity[i];
        }
    });
}

template <class Real>
bool ExplicitStep<Real>::take_step(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads,
                                   const ConstraintFilter& filter, StepTotals& totals) {
    const double h = settings_.time_step;
    const auto timed_accelerate = [&](double divisor) {
        const double begin = steady_seconds();
        accelerate(scheduler, motion, loads, filter, divisor);
        totals.seconds_forces += steady_seconds() - begin;
    };
    if (settings_.integrator == Integrator::symplectic_euler) {
        timed_accelerate(damping_divisor(loads));
        if (!kick(scheduler, motion, h)) return false;
        drift(scheduler, motion);
        return true;
    }
    if (!acceleration_is_known_) timed_accelerate(1);
    if (!kick(scheduler, motion, h / 2)) return false;
    drift(scheduler, motion);
    timed_accelerate(damping_divisor(loads));
    acceleration_is_known_ = true;
    return kick(scheduler, motion, h / 2);
}

template <class Real>
void ExplicitStep<Real>::run(StepStage stage, Scheduler& scheduler, const StepSubject& subject, StepReport& report,
                             StepTotals& totals) {
    if (stage != StepStage::forces) return;
    const double begin = steady_seconds(), forces = totals.seconds_forces;
    if (!take_step(scheduler, subject.motion, subject.loads, subject.filter, totals)) {
        report.lost = true;
        std::fill(subject.motion.velocity.begin(), subject.motion.velocity.end(), 0.0);
        acceleration_is_known_ = false;
        ++totals.lost;
    }
    ++totals.steps;
    totals.seconds_rest += steady_seconds() - begin - (totals.seconds_forces - forces);
}

template <class Real>
Energies ExplicitStep<Real>::energies(Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads,
                                      std::span<const double> rest_position) {
    Energies energies;
    energies.kinetic =
        sum_over_nodes(scheduler, *numbering_, std::span<double>(partial_), [&](std::size_t node, std::size_t at) {
            double square = 0;
            for (std::size_t i = at; i < at + 3; ++i) square += motion.velocity[i] * motion.velocity[i];
            return 0.5 * mass_[node] * square;
        });
    energies.elastic =
        elements_->evaluate(scheduler, motion.position.data(),
                            {.rotation = !is_linear(), .force = false, .energy = true, .keep_gradients = false});
    energies.gravity = gravity_energy(scheduler, *numbering_, std::span<double>(partial_), mass_, loads.gravity,
                                      motion.position, rest_position);
    return energies;
}

template <class Real>
void ExplicitStep<Real>::apply_matrix(Scheduler&, const BodyMotion&, const BodyLoads& loads, std::span<const Real> z,
                                      std::span<Real> out) {
    const double divisor = damping_divisor(loads);
    for (std::size_t i = 0; i < out.size(); ++i) {
        out[i] = static_cast<Real>(divisor * mass_[i / 4] * static_cast<double>(z[i]));
    }
}

template <class Real>
LargestEigenvalue ExplicitStep<Real>::largest_eigenvalue(Scheduler& scheduler, const double* position,
                                                         double tolerance) {
    MatrixFree<Real> stiffness(*elements_, {.tetrahedra = {}, .nodal_mass = mass_});
    elements_->evaluate(scheduler, position, {.rotation = !is_linear(), .force = false, .energy = false});
    stiffness.assemble(scheduler, {.mass = 0, .stiffness = 1}, false);
    return runtime::largest_eigenvalue(scheduler, static_cast<Operator<Real>&>(stiffness), *numbering_, mass_,
                                       tolerance);
}

template <class Real>
bool ExplicitStep<Real>::change(const LayoutChange& change) {
    for (const LayoutChange::NodalMass& changed : change.masses) mass_[changed.node] = changed.mass;
    forget();
    return true;
}

template <class Real>
std::size_t ExplicitStep<Real>::bytes() const noexcept {
    return kernels::heap_bytes(mass_) + kernels::heap_bytes(partial_);
}

template <class Real>
void ExplicitStep<Real>::save(std::vector<double>& numbers) const {
    numbers.push_back(acceleration_is_known_ ? 1.0 : 0.0);
}

template <class Real>
void ExplicitStep<Real>::restore(Scheduler&, std::span<const double>& numbers) {
    acceleration_is_known_ = numbers[0] != 0;
    numbers = numbers.subspan(1);
}

template class ExplicitStep<float>;
template class ExplicitStep<double>;

}  // namespace lancet::runtime
