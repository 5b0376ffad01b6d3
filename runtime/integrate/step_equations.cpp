#include "lancet/runtime/integrate/step_equations.hpp"

#include "lancet/runtime/solve/block_loop.hpp"

namespace lancet::runtime {

StepEquations::StepEquations(const Settings& settings, const kernels::NodeNumbering& numbering, const Inertia& inertia)
    : numbering_(&numbering),
      inertia_(&inertia),
      step_length_(settings.time_step),
      position_length_(step_length_),
      momentum_length_(step_length_),
      early_length_(0),
      position_(inertia.row_sums.size() * 4),
      velocity_(inertia.row_sums.size() * 4),
      impulse_(inertia.consistent.empty() ? 0 : inertia.row_sums.size() * 4) {
    switch (settings.integrator) {
        case Integrator::newmark:
            position_length_ = settings.newmark_beta / settings.newmark_gamma * step_length_;
            momentum_length_ = settings.newmark_gamma * step_length_;
            early_length_ = (1 - settings.newmark_gamma) * step_length_;
            break;
        case Integrator::implicit_midpoint:
        case Integrator::energy_momentum:
            position_length_ = momentum_length_ = step_length_ / 2;
            break;
        default:
            break;
    }
}

void StepEquations::set_impulse(Scheduler& scheduler, std::span<const double> velocity,
                                std::span<const double> before_hold) {
    has_impulse_ = !inertia_->consistent.empty() && !before_hold.empty();
    if (!has_impulse_) return;
    const double share = momentum_length_ / step_length_;
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        for (std::int32_t node = numbering_->block_begin[block]; node < numbering_->block_begin[block + 1]; ++node) {
            const auto at = static_cast<std::size_t>(node);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto jump = [&](std::size_t j) { return velocity[4 * j + axis] - before_hold[4 * j + axis]; };
                impulse_[4 * at + axis] = -share * inertia_->momentum(at, jump);
            }
        }
    });
}

void StepEquations::move(Scheduler& scheduler, std::span<double> position, double length,
                         std::span<const double> velocity) const {
    for_each_awake_block(scheduler, *numbering_, [&](int block) {
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            position[i] = position_[i] + length * velocity[i];
        }
    });
}

std::size_t StepEquations::bytes() const noexcept {
    return kernels::heap_bytes(position_) + kernels::heap_bytes(velocity_) + kernels::heap_bytes(impulse_);
}

}  // namespace lancet::runtime
