#include "lancet/runtime/integrate/energy_safeguard.hpp"

#include <cmath>

#include "lancet/runtime/integrate/nodal_sum.hpp"
#include "lancet/runtime/integrate/step_timer.hpp"
#include "lancet/runtime/solve/block_loop.hpp"

namespace lancet::runtime {

template <class Real, class Accumulate>
EnergySafeguard<Real, Accumulate>::EnergySafeguard(const Parts& parts, int iterations)
    : parts_(parts), iterations_(iterations), partial_(static_cast<std::size_t>(parts.numbering.blocks())) {}

template <class Real, class Accumulate>
void EnergySafeguard<Real, Accumulate>::begin(Scheduler& scheduler, const BodyMotion& motion,
                                              std::span<const double> before_hold, StepTotals& totals) {
    if (is_known_) return;
    StepTimer timer;
    inner_ = {.kinetic = parts_.energy.kinetic(
                  scheduler, before_hold.empty() ? std::span<const double>(motion.velocity) : before_hold),
              .elastic = parts_.energy.elastic(scheduler, motion.position.data())};
    is_known_ = true;
    timer.add_to(totals.seconds_forces);
}

template <class Real, class Accumulate>
bool EnergySafeguard<Real, Accumulate>::gains(Scheduler& scheduler, const StepSubject& subject, const Inner& before) {
    inner_ = before;
    return parts_.energy.growth(scheduler, parts_.equations, subject.loads, subject.motion, subject.before_hold,
                                inner_) > 0;
}

template <class Real, class Accumulate>
void EnergySafeguard<Real, Accumulate>::move(Scheduler& scheduler, BodyMotion& motion) {
    parts_.equations.move(scheduler, motion.position, parts_.equations.position_length(), motion.velocity);
}

template <class Real, class Accumulate>
void EnergySafeguard<Real, Accumulate>::check(Scheduler& scheduler, const StepSubject& subject, StepReport& report,
                                              StepTotals& totals) {
    StepTimer timer;
    const Inner before = inner_;
    const bool gained = gains(scheduler, subject, before);
    timer.add_to(totals.seconds_forces);
    if (!gained) return;

    report.repeated = true;
    BodyMotion& motion = subject.motion;
    // The iterations may end before they have brought the energy down. A slower motion from the same start has less of
    // it, and in the limit of none what the body had at the start.
    if (minimise(scheduler, subject, before, report, totals) &&
        is_finite(scheduler, parts_.numbering, partial_, motion.position, motion.velocity)) {
        StepTimer braking;
        brake(scheduler, subject, before);
        braking.add_to(totals.seconds_forces);
    }
    move(scheduler, motion);
    parts_.system.forget_matrix();
}

template <class Real, class Accumulate>
bool EnergySafeguard<Real, Accumulate>::minimise(Scheduler& scheduler, const StepSubject& subject, const Inner& before,
                                                 StepReport& report, StepTotals& totals) {
    const auto& [motion, loads, filter, before_hold] = subject;
    StepTimer timer;
    LineSearch<Real, Accumulate>& search = parts_.line_search;
    double potential = search.potential(scheduler, motion, motion.velocity, loads);
    const double potential_at_start = search.potential(scheduler, motion, parts_.equations.velocity(), loads);
    if (!(potential < potential_at_start)) {
        motion.velocity = parts_.equations.velocity();
        potential = potential_at_start;
    }
    bool gained = true;
    for (int iteration = 0; iteration < iterations_ && gained; ++iteration) {
        move(scheduler, motion);
        parts_.system.linearise(scheduler, motion.position.data(), loads, true);
        parts_.system.set_right_hand_side(scheduler, motion, loads, filter, {.at_state = false, .falls_free = true});
        timer.add_to(totals.seconds_forces);
        parts_.system.solve(scheduler, motion, filter, report);
        ++report.newton_iterations;
        timer.add_to(totals.seconds_solve);
        if (!search.descend(scheduler, motion, parts_.system.change(), loads, potential, 0)) break;
        move(scheduler, motion);
        gained = gains(scheduler, subject, before);
        timer.add_to(totals.seconds_forces);
    }
    timer.add_to(totals.seconds_forces);
    return gained;
}

template <class Real, class Accumulate>
void EnergySafeguard<Real, Accumulate>::brake(Scheduler& scheduler, const StepSubject& subject, const Inner& before) {
    const auto& [motion, loads, filter, before_hold] = subject;
    bool gained = true;
    const auto slow_down_to = [&](double share, const std::array<double, 4>& limit) {
        slow_down(scheduler, subject.motion, subject.filter, share, limit);
        move(scheduler, subject.motion);
        gained = gains(scheduler, subject, before);
    };
    // What nothing holds is slowed down to the velocity that its momentum asks for.
    const std::array<double, 4> free = free_velocity(scheduler, loads, filter);
    constexpr int attempts = 24;  // 0.75^24 is 1e-3
    for (int attempt = 0; attempt <= attempts && gained; ++attempt) slow_down_to(attempt < attempts ? 0.75 : 0.0, free);
    // Beyond the numbers of the scalar there is nothing to be kept.
    if (gained && !std::isfinite(inner_.sum())) slow_down_to(0, {});
}

template <class Real, class Accumulate>
std::array<double, 4> EnergySafeguard<Real, Accumulate>::free_velocity(Scheduler& scheduler, const BodyLoads& loads,
                                                                       const ConstraintFilter& filter) {
    std::array<double, 4> mean{};
    if (!parts_.system.is_free(filter)) return mean;
    const double g = parts_.equations.momentum_length();
    const std::span<const double> mass = parts_.inertia.row_sums, start = parts_.equations.velocity();
    const double total = sum_over_nodes(scheduler, parts_.numbering, partial_,
                                        [&](std::size_t node, std::size_t) { return mass[node]; });
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double momentum =
            sum_over_nodes(scheduler, parts_.numbering, partial_, [&](std::size_t node, std::size_t at) {
                return mass[node] * (start[at + axis] + g * loads.gravity[axis]) + g * loads.nodal[at + axis];
            });
        mean[axis] = momentum / (total * (1 + g * loads.rayleigh_mass));
    }
    return mean;
}

template <class Real, class Accumulate>
void EnergySafeguard<Real, Accumulate>::slow_down(Scheduler& scheduler, BodyMotion& motion,
                                                  const ConstraintFilter& filter, double share,
                                                  const std::array<double, 4>& limit) {
    const kernels::NodeNumbering& numbering = parts_.numbering;
    const std::span<const double> start = parts_.equations.velocity();
    for_each_awake_block(scheduler, numbering, [&](int block) {
        const std::size_t begin = 4 * static_cast<std::size_t>(numbering.block_begin[block]);
        const std::size_t end = 4 * static_cast<std::size_t>(numbering.block_begin[block + 1]);
        for (std::size_t i = begin; i < end; ++i) {
            motion.velocity[i] = share * motion.velocity[i] + (1 - share) * limit[i % 4] - start[i];
        }
        filter.apply(motion.velocity.data(), block);
        for (std::size_t i = begin; i < end; ++i) motion.velocity[i] += start[i];
    });
}

template <class Real, class Accumulate>
void EnergySafeguard<Real, Accumulate>::save(std::vector<double>& numbers) const {
    numbers.insert(numbers.end(), {inner_.kinetic, inner_.elastic, is_known_ ? 1.0 : 0.0});
}

template <class Real, class Accumulate>
void EnergySafeguard<Real, Accumulate>::restore(std::span<const double>& numbers) {
    inner_ = {.kinetic = numbers[0], .elastic = numbers[1]};
    is_known_ = numbers[2] != 0;
    numbers = numbers.subspan(3);
}

template class EnergySafeguard<float, float>;
template class EnergySafeguard<float, double>;
template class EnergySafeguard<double, double>;

}  // namespace lancet::runtime
