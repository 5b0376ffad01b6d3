#include "lancet/runtime/integrate/newmark_acceleration.hpp"

#include "lancet/runtime/solve/block_loop.hpp"

namespace lancet::runtime {

template <class Real, class Accumulate>
NewmarkAcceleration<Real, Accumulate>::NewmarkAcceleration(const Settings& settings,
                                                           const kernels::NodeNumbering& numbering,
                                                           const Inertia& inertia, StepEquations& equations,
                                                           StepSystem<Real, Accumulate>& system)
    : numbering_(&numbering),
      inertia_(&inertia),
      equations_(&equations),
      system_(&system),
      beta_(settings.newmark_beta),
      old_position_(inertia.row_sums.size() * 4) {}

template <class Real, class Accumulate>
void NewmarkAcceleration<Real, Accumulate>::find(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads,
                                                 const ConstraintFilter& filter) {
    // With v~ = v the right-hand side of a step linearised at x is g (f - D v).
    equations_->velocity() = motion.velocity;
    system_->linearise(scheduler, motion.position.data(), loads, true);
    system_->set_right_hand_side(scheduler, motion, loads, filter, {.at_state = false, .falls_free = false});
    const double g = equations_->momentum_length();
    const std::span<const Accumulate> impulse = system_->right_hand_side();
    const std::span<double> forces = equations_->position();
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        for (std::int32_t node = numbering_->block_begin[block]; node < numbering_->block_begin[block + 1]; ++node) {
            const auto at = static_cast<std::size_t>(node);
            for (std::size_t i = 4 * at; i < 4 * at + 3; ++i) {
                const double force = static_cast<double>(impulse[i]) / g;
                forces[i] = force;
                const double mass = inertia_->row_sums[at];
                motion.acceleration[i] = mass > 0 ? force / mass : 0.0;
            }
        }
    });
    if (!inertia_->consistent.empty()) {
        inertia_->consistent.solve(inertia_->row_sums, *numbering_, filter,
                                   {.residual = forces,
                                    .direction = equations_->velocity(),
                                    .product = old_position_,
                                    .solution = motion.acceleration});
    }
    is_known_ = true;
}

template <class Real, class Accumulate>
void NewmarkAcceleration<Real, Accumulate>::begin(Scheduler& scheduler, const BodyMotion& motion) {
    old_position_ = motion.position;
    equations_->position() = motion.position;  // all of them, for fixed nodes are in no block
    equations_->velocity() = motion.velocity;
    const double h = equations_->step_length(), c = equations_->position_length();
    const double early = equations_->early_length(), curved = h * h * (0.5 - beta_);
    const std::span<double> position = equations_->position(), velocity = equations_->velocity();
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            const double v = motion.velocity[i], a = motion.acceleration[i];
            velocity[i] = v + early * a;
            position[i] = motion.position[i] + h * v + curved * a - c * velocity[i];
        }
    });
}

template <class Real, class Accumulate>
void NewmarkAcceleration<Real, Accumulate>::end(Scheduler& scheduler, BodyMotion& motion) {
    const double g = equations_->momentum_length();
    const std::span<const double> start = equations_->velocity();
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            motion.acceleration[i] = (motion.velocity[i] - start[i]) / g;
        }
    });
}

template <class Real, class Accumulate>
void NewmarkAcceleration<Real, Accumulate>::restore(std::span<const double>& numbers) {
    is_known_ = numbers[0] != 0;
    numbers = numbers.subspan(1);
}

template class NewmarkAcceleration<float, float>;
template class NewmarkAcceleration<float, double>;
template class NewmarkAcceleration<double, double>;

}  // namespace lancet::runtime
