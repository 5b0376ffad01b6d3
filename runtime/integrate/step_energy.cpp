#include "lancet/runtime/integrate/step_energy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lancet/runtime/integrate/nodal_sum.hpp"

namespace lancet::runtime {

namespace {

/// F is a sum of edges times gradients b, off by some eps of Real, and by some eps of double times |x| |b|. So strains
/// that are nothing but rounding have the energy `of_edges` + |x|^2 `of_places`, with (mu + 3/2 lambda) V |dF|^2 for
/// each element. Parts of elements add up to them.
struct RoundedStrains {
    double of_edges = 0, of_places = 0;
};

template <class Real>
RoundedStrains rounded_strains(const kernels::ElementBatches<Real>& batches) {
    constexpr double edges = 8 * static_cast<double>(std::numeric_limits<Real>::epsilon());
    constexpr double places = 8 * std::numeric_limits<double>::epsilon();
    const auto width = static_cast<std::size_t>(batches.width);
    RoundedStrains sum;
    for (std::size_t batch = 0; batch < static_cast<std::size_t>(batches.batches()); ++batch) {
        const Real* rest = &batches.rest[batch * kernels::ElementBatches<Real>::rest_entries * width];
        for (std::size_t lane = 0; lane < width; ++lane) {
            const auto entry = [&](std::size_t k) { return static_cast<double>(rest[k * width + lane]); };
            const double stiffness = entry(9) * entry(9) * (1 + 1.5 * std::abs(entry(10)));
            double gradients = 0;
            for (std::size_t k = 0; k < 9; ++k) gradients += entry(k) * entry(k);
            sum.of_edges += stiffness * edges * edges;
            sum.of_places += stiffness * gradients * places * places;
        }
    }
    return sum;
}

}  // namespace

template <class Real>
StepEnergy<Real>::StepEnergy(ElasticElements<Real>& elements, const Inertia& inertia)
    : elements_(&elements), inertia_(&inertia), partial_(static_cast<std::size_t>(elements.numbering().blocks())) {
    const RoundedStrains strains = rounded_strains(elements.batches());
    rounded_edges_ = strains.of_edges;
    rounded_places_ = strains.of_places;
}

template <class Real>
double StepEnergy<Real>::rounded_strains_at(std::span<const double> position) const {
    double square = 0;
    for (const std::int32_t node : elements_->numbering().block_begin) {
        const auto at = 4 * static_cast<std::size_t>(node);
        if (at + 2 >= position.size()) continue;
        square = std::max(square, position[at] * position[at] + position[at + 1] * position[at + 1] +
                                      position[at + 2] * position[at + 2]);
    }
    return rounded_edges_ + square * rounded_places_;
}

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
double StepEnergy<Real>::incremental_potential(Scheduler& scheduler, const Step& step, std::span<const double> position,
                                               std::span<const double> velocity) {
    const double g = step.momentum_length, c = step.position_length;
    const BodyLoads& loads = *step.loads;
    const double elastic_energy = elastic(scheduler, position.data());
    return g / c * elastic_energy + sum_over_nodes(scheduler, [&](std::size_t node, std::size_t at) {
               double sum = 0;
               for (std::size_t axis = 0; axis < 3; ++axis) {
                   const double v = velocity[at + axis], change = v - step.velocity[at + axis];
                   const double load = inertia_->row_sums[node] * loads.gravity[axis] + loads.nodal[at + axis];
                   const double impulse = g * load + (step.impulse.empty() ? 0.0 : step.impulse[at + axis]);
                   const double momentum =
                       inertia_->momentum(node, [&](std::size_t j) { return velocity[4 * j + axis]; });
                   const double gained = inertia_->momentum(
                       node, [&](std::size_t j) { return velocity[4 * j + axis] - step.velocity[4 * j + axis]; });
                   sum += 0.5 * (change * gained + g * loads.rayleigh_mass * v * momentum) - impulse * v;
               }
               return sum;
           });
}

template <class Real>
double StepEnergy<Real>::growth(Scheduler& scheduler, const Step& step, const BodyMotion& motion,
                                std::span<const double> before_hold, Inner& energy) {
    const double h = step.momentum_length;
    const BodyLoads& loads = *step.loads;
    const bool has_holds = !before_hold.empty();
    Inner after;
    after.elastic = has_holds ? elements_->evaluate(
                                    scheduler, motion.position.data(),
                                    {.rotation = !is_linear(), .force = true, .energy = true, .keep_gradients = false})
                              : elastic(scheduler, motion.position.data());
    after.kinetic = kinetic(scheduler, motion.velocity);
    if (has_holds) {
        scheduler.for_each_block(elements_->numbering().blocks(), [&](int block) { elements_->merge_force(block); });
    }
    const double work = sum_over_nodes(scheduler, [&](std::size_t node, std::size_t at) {
        double sum = 0;
        bool is_held = false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double moved = motion.position[at + axis] - step.position[at + axis];
            const double load = inertia_->row_sums[node] * loads.gravity[axis] + loads.nodal[at + axis];
            sum += load * moved;
            is_held = is_held || (has_holds && before_hold[at + axis] != step.velocity[at + axis]);
        }
        if (!has_holds) return sum;
        // The hold adds whatever the node's motion needs beyond inertia, loads and elastic force.
        for (std::size_t axis = 0; axis < 3 && is_held; ++axis) {
            const double load = inertia_->row_sums[node] * loads.gravity[axis] + loads.nodal[at + axis];
            const double gained = inertia_->momentum(
                node, [&](std::size_t j) { return motion.velocity[4 * j + axis] - before_hold[4 * j + axis]; });
            const double reaction = gained / h - load - static_cast<double>(elements_->force()[at + axis]);
            sum += reaction * (motion.position[at + axis] - step.position[at + axis]);
        }
        return sum;
    });
    // Rounding of the energies: a sum of positive terms in Real, of strains that are rounded themselves. Without the
    // latter a body that drifts slowly and has no strain would be slowed down for having some.
    const double rounding =
        64 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * (energy.sum() + after.sum()) +
        rounded_strains_at(motion.position);
    const double excess = after.sum() - energy.sum() - work - rounding;
    energy = after;
    return std::isfinite(energy.sum()) ? excess : HUGE_VAL;
}

template <class Real>
double StepEnergy<Real>::noise(std::span<const double> position, const Inner& energy) const {
    return 2 * std::sqrt(rounded_strains_at(position) * std::max(energy.sum(), 0.0));
}

template class StepEnergy<float>;
template class StepEnergy<double>;

}  // namespace lancet::runtime
