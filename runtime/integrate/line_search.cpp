#include "lancet/runtime/integrate/line_search.hpp"

namespace lancet::runtime {

template <class Real, class Accumulate>
LineSearch<Real, Accumulate>::LineSearch(StepEnergy<Real>& energy, const StepEquations& equations)
    : energy_(&energy), equations_(&equations), trial_velocity_(equations.velocity().size()) {}

template <class Real, class Accumulate>
double LineSearch<Real, Accumulate>::potential(Scheduler& scheduler, BodyMotion& motion,
                                               std::span<const double> velocity, const BodyLoads& loads) {
    equations_->move(scheduler, motion.position, equations_->position_length(), velocity);
    return energy_->incremental_potential(scheduler, *equations_, loads, motion.position, velocity);
}

template <class Real, class Accumulate>
bool LineSearch<Real, Accumulate>::descend(Scheduler& scheduler, BodyMotion& motion,
                                           const VelocityChange<Accumulate>& change, const BodyLoads& loads,
                                           double& potential, double rounding) {
    double length = 1;
    for (int halving = 0; halving < 12; ++halving, length /= 2) {
        for (std::size_t i = 0; i < trial_velocity_.size(); ++i) {
            trial_velocity_[i] = motion.velocity[i] + length * change[i];
        }
        const double trial = this->potential(scheduler, motion, trial_velocity_, loads);
        if (!(trial < potential + rounding)) continue;
        potential = trial;
        motion.velocity = trial_velocity_;
        return true;
    }
    return false;
}

template class LineSearch<float, float>;
template class LineSearch<float, double>;
template class LineSearch<double, double>;

}  // namespace lancet::runtime
