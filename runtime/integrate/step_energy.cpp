#include "lancet/runtime/integrate/step_energy.hpp"

#include <cmath>
#include <limits>

#include "lancet/runtime/integrate/nodal_sum.hpp"
#include "lancet/runtime/solve/block_loop.hpp"

namespace lancet::runtime {

template <class Real>
StepEnergy<Real>::StepEnergy(ElasticElements<Real>& elements, const Inertia& inertia)
    : elements_(&elements), inertia_(&inertia), partial_(static_cast<std::size_t>(elements.numbering().blocks())) {}

template <class Real>
template <class Function>
double StepEnergy<Real>::sum_over_nodes(Scheduler& scheduler, const Function& value) {
    return runtime::sum_over_nodes(scheduler, elements_->numbering(), std::span<double>(partial_), value);
}

template <class Real>
double StepEnergy<Real>::kinetic(Scheduler& scheduler, std::span<const double> velocity) {
    return sum_over_nodes(scheduler, [&](std::size_t node, std::size_t at) {
        double sum = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto component = [&](std::size_t j) { return velocity[4 * j + axis]; };
            sum += 0.5 * velocity[at + axis] * inertia_->momentum(node, component);
        }
        return sum;
    });
}

template <class Real>
double StepEnergy<Real>::elastic(Scheduler& scheduler, const double* position) {
    return elements_->evaluate(scheduler, position,
                               {.rotation = !is_linear(), .force = false, .energy = true, .keep_gradients = false});
}

template <class Real>
double StepEnergy<Real>::incremental_potential(Scheduler& scheduler, const StepEquations& step, const BodyLoads& loads,
                                               std::span<const double> position, std::span<const double> velocity) {
    const double g = step.momentum_length(), c = step.position_length();
    const std::span<const double> start = step.velocity(), held_impulse = step.impulse();
    const double elastic_energy = elastic(scheduler, position.data());
    return g / c * elastic_energy + sum_over_nodes(scheduler, [&](std::size_t node, std::size_t at) {
               double sum = 0;
               for (std::size_t axis = 0; axis < 3; ++axis) {
                   const double v = velocity[at + axis], change = v - start[at + axis];
                   const double load = inertia_->row_sums[node] * loads.gravity[axis] + loads.nodal[at + axis];
                   const double impulse = g * load + (held_impulse.empty() ? 0.0 : held_impulse[at + axis]);
                   const double momentum =
                       inertia_->momentum(node, [&](std::size_t j) { return velocity[4 * j + axis]; });
                   const double gained = inertia_->momentum(
                       node, [&](std::size_t j) { return velocity[4 * j + axis] - start[4 * j + axis]; });
                   sum += 0.5 * (change * gained + g * loads.rayleigh_mass * v * momentum) - impulse * v;
               }
               return sum;
           });
}

template <class Real>
double StepEnergy<Real>::growth(Scheduler& scheduler, const StepEquations& step, const BodyLoads& loads,
                                const BodyMotion& motion, std::span<const double> before_hold, Inner& energy) {
    const double h = step.momentum_length();
    const std::span<const double> start = step.position(), start_velocity = step.velocity();
    const bool has_holds = !before_hold.empty();
    Inner after;
    after.elastic = has_holds ? elements_->evaluate(
                                    scheduler, motion.position.data(),
                                    {.rotation = !is_linear(), .force = true, .energy = true, .keep_gradients = false})
                              : elastic(scheduler, motion.position.data());
    after.kinetic = kinetic(scheduler, motion.velocity);
    if (has_holds) {
        for_each_awake_block(scheduler, elements_->numbering(), [&](int block) { elements_->merge_force(block); });
    }
    const double work = sum_over_nodes(scheduler, [&](std::size_t node, std::size_t at) {
        double sum = 0;
        bool is_held = false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double moved = motion.position[at + axis] - start[at + axis];
            const double load = inertia_->row_sums[node] * loads.gravity[axis] + loads.nodal[at + axis];
            sum += load * moved;
            is_held = is_held || (has_holds && before_hold[at + axis] != start_velocity[at + axis]);
        }
        if (!has_holds) return sum;
        // The hold adds whatever the node's motion needs beyond inertia, loads and elastic force.
        for (std::size_t axis = 0; axis < 3 && is_held; ++axis) {
            const double load = inertia_->row_sums[node] * loads.gravity[axis] + loads.nodal[at + axis];
            const double gained = inertia_->momentum(
                node, [&](std::size_t j) { return motion.velocity[4 * j + axis] - before_hold[4 * j + axis]; });
            const double reaction = gained / h - load - static_cast<double>(elements_->force()[at + axis]);
            sum += reaction * (motion.position[at + axis] - start[at + axis]);
        }
        return sum;
    });
    // Rounding of the energies: a sum of positive terms in Real.
    const double rounding =
        64 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * (energy.sum() + after.sum());
    const double excess = after.sum() - energy.sum() - work - rounding;
    energy = after;
    return std::isfinite(energy.sum()) ? excess : HUGE_VAL;
}

template class StepEnergy<float>;
template class StepEnergy<double>;

}  // namespace lancet::runtime
