#include "lancet/runtime/integrate/implicit_step.hpp"

#include <algorithm>
#include <cmath>

#include "lancet/runtime/integrate/nodal_sum.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/schedule/ordered_sum.hpp"
#include "lancet/runtime/solve/critical_step.hpp"

namespace lancet::runtime {

/// Adds the time since the last mark to one of the totals.
template <class Real, class Accumulate>
class ImplicitStep<Real, Accumulate>::Timer {
  public:
    void add_to(double& total) {
        const double now = steady_seconds();
        total += now - mark_;
        mark_ = now;
    }

  private:
    double mark_ = steady_seconds();
};

template <class Real, class Accumulate>
ImplicitStep<Real, Accumulate>::ImplicitStep(ElasticElements<Real>& elements, const OperatorDefinition& definition,
                                             const Settings& settings)
    : elements_(&elements),
      numbering_(&elements.numbering()),
      settings_(settings),
      inertia_{.row_sums = definition.nodal_mass,
               .consistent = definition.mass == MassKind::consistent
                                 ? ConsistentMass(elements.batches(), definition.tetrahedra, elements.numbering())
                                 : ConsistentMass()},
      energy_(elements, inertia_),
      matrix_(make_operator(settings.matrix, elements, definition)),
      preconditioner_(std::make_unique<Preconditioner<Real>>(settings.preconditioner, elements, *matrix_, definition,
                                                             settings.coarse_change)),
      conjugate_gradients_(elements.kernels(), elements.numbering()),
      old_position_(is_newmark() ? inertia_.row_sums.size() * 4 : 0),
      start_position_(inertia_.row_sums.size() * 4),
      start_velocity_(inertia_.row_sums.size() * 4),
      trial_velocity_(inertia_.row_sums.size() * 4),
      held_impulse_(inertia_.consistent.empty() ? 0 : inertia_.row_sums.size() * 4),
      right_hand_side_(inertia_.row_sums.size() * 4),
      change_(inertia_.row_sums.size() * 4),
      partial_(static_cast<std::size_t>(elements.numbering().blocks())) {
    if (settings.rotation_bound > 0 && !is_linear()) elements.watch_deformation();
}

template <class Real, class Accumulate>
double ImplicitStep<Real, Accumulate>::position_length() const noexcept {
    const double h = settings_.time_step;
    if (is_newmark()) return settings_.newmark_beta / settings_.newmark_gamma * h;
    return is_midpoint() ? h / 2 : h;
}

template <class Real, class Accumulate>
double ImplicitStep<Real, Accumulate>::momentum_length() const noexcept {
    const double h = settings_.time_step;
    if (is_newmark()) return settings_.newmark_gamma * h;
    return is_midpoint() ? h / 2 : h;
}

template <class Real, class Accumulate>
template <class Function>
double ImplicitStep<Real, Accumulate>::sum_over_nodes(Scheduler& scheduler, const Function& value) {
    return runtime::sum_over_nodes(scheduler, *numbering_, std::span<double>(partial_), value);
}

template <class Real, class Accumulate>
bool ImplicitStep<Real, Accumulate>::is_finite(Scheduler& scheduler, const BodyMotion& motion) {
    return std::isfinite(sum_over_nodes(scheduler, [&](std::size_t, std::size_t at) {
        double sum = 0;
        for (std::size_t i = at; i < at + 3; ++i) sum += std::abs(motion.position[i]) + std::abs(motion.velocity[i]);
        return sum;
    }));
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::move(Scheduler& scheduler, BodyMotion& motion, double factor,
                                          std::span<const double> velocity) {
    scheduler.for_each_block(numbering_->blocks(), [&](int block) {
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            motion.position[i] = start_position_[i] + factor * velocity[i];
        }
    });
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::add_change(Scheduler& scheduler, BodyMotion& motion) {
    scheduler.for_each_block(numbering_->blocks(), [&](int block) {
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            motion.velocity[i] += static_cast<double>(change_[i]) + fall_[i % 4];
        }
    });
}

template <class Real, class Accumulate>
bool ImplicitStep<Real, Accumulate>::evaluate(Scheduler& scheduler, const double* position, bool renew) {
    const bool rotate = !is_linear() && (renew || !matrix_is_known_);
    elements_->evaluate(scheduler, position,
                        {.rotation = rotate,
                         .force = true,
                         .energy = false,
                         .start = takes_average_stress() ? start_position_.data() : nullptr,
                         .rotation_bound = matrix_is_known_ ? settings_.rotation_bound : 0});
    return rotate;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::assemble(Scheduler& scheduler, const BodyLoads& loads, bool rotated) {
    const double g = momentum_length();
    const typename Operator<Real>::Factors factors{.mass = 1 + g * loads.rayleigh_mass,
                                                   .stiffness = g * position_length() + g * loads.rayleigh_stiffness};
    const bool same_factors =
        factors.mass == matrix_->factors().mass && factors.stiffness == matrix_->factors().stiffness;
    if (!rotated && matrix_is_known_ && same_factors) return;
    matrix_->assemble(scheduler, factors, rotated && matrix_is_known_ && same_factors);
    elements_->forget_stale_blocks();
    matrix_is_known_ = false;  // until the preconditioner has it too
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::linearise(Scheduler& scheduler, const double* position, const BodyLoads& loads,
                                               bool renew) {
    assemble(scheduler, loads, evaluate(scheduler, position, renew));
}

template <class Real, class Accumulate>
typename ImplicitStep<Real, Accumulate>::Residual ImplicitStep<Real, Accumulate>::right_hand_side(
    Scheduler& scheduler, const BodyMotion& motion, const BodyLoads& loads, const ConstraintFilter& filter,
    const Linearised& how) {
    const double g = momentum_length();
    const bool needs_product = how.at_state || loads.rayleigh_stiffness > 0;
    if (needs_product) {
        const std::span<Real> velocity = conjugate_gradients_.scratch();
        for (std::size_t i = 0; i < velocity.size(); ++i) velocity[i] = static_cast<Real>(motion.velocity[i]);
        matrix_->product(scheduler, velocity.data());
    }
    // Linearised at the state: g D v + g c K v = A v - M v. At the prediction: g beta K v is a part of A v.
    const double stiffness_share =
        how.at_state ? 1 : g * loads.rayleigh_stiffness / (g * position_length() + g * loads.rayleigh_stiffness);
    const double product_mass = how.at_state ? 1 : 1 + g * loads.rayleigh_mass;
    const double drag = how.at_state ? 0 : g * loads.rayleigh_mass;
    // A body that nothing holds falls as a whole: that part of dv is known, A dv = g M gravity for dv = g gravity / (1
    // + g alpha), and solving for the rest alone keeps a fall free of strain, however few the iterations. Newmark's
    // velocity v~ differs from v_n by a share of the fall, too.
    const bool is_held = numbering_->free_count < numbering_->node_count || !filter.empty();
    const double damped = 1 + g * loads.rayleigh_mass;
    const double early = is_newmark() ? (1 - settings_.newmark_gamma) * settings_.time_step : 0;
    std::array<double, 3> load = loads.gravity;
    fall_.fill(0);
    for (std::size_t axis = 0; axis < 3 && !is_held && how.falls_free; ++axis) {
        load[axis] = early == 0 ? 0 : -early / g * damped * loads.gravity[axis];
        fall_[axis] = g * loads.gravity[axis] / damped + early * loads.gravity[axis];
    }
    std::vector<double>& squares = partial_;
    scheduler.for_each_block(numbering_->blocks(), [&](int block) {
        elements_->merge_force(block);
        if (needs_product) matrix_->merge(block);
        const Real* force = elements_->force();
        const Real* product = matrix_->buffer();
        for (std::int32_t node = numbering_->block_begin[block]; node < numbering_->block_begin[block + 1]; ++node) {
            const auto at = static_cast<std::size_t>(node);
            const double mass = inertia_.row_sums[at];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::size_t i = 4 * at + axis;
                const double change = inertia_.momentum(
                    at, [&](std::size_t j) { return motion.velocity[4 * j + axis] - start_velocity_[4 * j + axis]; });
                const double momentum =
                    inertia_.momentum(at, [&](std::size_t j) { return motion.velocity[4 * j + axis]; });
                double b =
                    g * (static_cast<double>(force[i]) + mass * load[axis] + loads.nodal[i]) - change - drag * momentum;
                if (has_held_impulse_) b += held_impulse_[i];
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
        squares[static_cast<std::size_t>(block)] = square;
    });
    Residual residual;
    residual.squared_norm = sum_in_order(std::span<const double>(squares));
    return residual;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::refresh(Scheduler& scheduler, const BodyMotion& motion) {
    if (matrix_is_known_) return;
    preconditioner_->refresh(scheduler, motion.position.data());
    matrix_is_known_ = true;
}

template <class Real, class Accumulate>
ConjugateGradientResult ImplicitStep<Real, Accumulate>::solve(Scheduler& scheduler, const BodyMotion& motion,
                                                              const ConstraintFilter& filter, StepReport& report) {
    refresh(scheduler, motion);
    const ConjugateGradientResult result = conjugate_gradients_.solve(
        scheduler, *matrix_, *preconditioner_, filter, std::span<const Accumulate>(right_hand_side_),
        std::span<Accumulate>(change_), settings_.conjugate_gradients);
    report.conjugate_gradient_iterations += result.iterations;
    report.conjugate_gradient_residual = result.residual;
    return result;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::set_up_system(Scheduler& scheduler, const StepSubject& subject,
                                                   StepTotals& totals) {
    Timer timer;
    const auto& [motion, loads, filter, before_hold] = subject;
    assemble(scheduler, loads, is_rotated_);
    timer.add_to(totals.seconds_forces);
    // Before the preconditioner, which is gathered where the forces are.
    const Residual residual =
        right_hand_side(scheduler, motion, loads, filter, {.at_state = is_at_state(), .falls_free = true});
    newton_ = {.reference = 0, .potential = 0, .is_finite = std::isfinite(residual.squared_norm)};
    if (iterations() > 1) {
        const double load = sum_over_nodes(scheduler, [&](std::size_t node, std::size_t at) {
            double square = 0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double force = inertia_.row_sums[node] * loads.gravity[axis] + loads.nodal[at + axis];
                square += force * force;
            }
            return square;
        });
        newton_.reference = std::max(std::sqrt(residual.squared_norm), momentum_length() * std::sqrt(load));
    }
    timer.add_to(totals.seconds_rest);
    refresh(scheduler, motion);
    timer.add_to(totals.seconds_solve);
}

template <class Real, class Accumulate>
bool ImplicitStep<Real, Accumulate>::accept(Scheduler& scheduler, const StepSubject& subject, bool is_first,
                                            StepReport& report, StepTotals& totals) {
    Timer timer;
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
    if (is_first) newton_.potential = incremental_potential(scheduler, motion, motion.velocity, loads);
    // Rounding of the scalar, and of the positions: small strains are differences of large coordinates.
    const double rounding =
        std::max(64 * static_cast<double>(std::numeric_limits<Real>::epsilon()), 1e-10) * std::abs(newton_.potential);
    const bool descended = descend(scheduler, motion, loads, newton_.potential, rounding);
    timer.add_to(totals.seconds_forces);
    return descended;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::iterate(Scheduler& scheduler, const StepSubject& subject, StepReport& report,
                                             StepTotals& totals) {
    const auto& [motion, loads, filter, before_hold] = subject;
    const double c = position_length();
    bool goes_on = accept(scheduler, subject, true, report, totals);
    for (int iteration = 1; goes_on && iteration < iterations(); ++iteration) {
        Timer timer;
        move(scheduler, motion, c, motion.velocity);
        timer.add_to(totals.seconds_rest);
        linearise(scheduler, motion.position.data(), loads, true);
        timer.add_to(totals.seconds_forces);
        const Residual residual =
            right_hand_side(scheduler, motion, loads, filter, {.at_state = false, .falls_free = false});
        newton_.is_finite = newton_.is_finite && std::isfinite(residual.squared_norm);
        timer.add_to(totals.seconds_rest);
        if (std::sqrt(residual.squared_norm) <= settings_.newton_tolerance * newton_.reference) break;
        solve(scheduler, motion, filter, report);
        timer.add_to(totals.seconds_solve);
        goes_on = accept(scheduler, subject, false, report, totals);
    }
    Timer timer;
    move(scheduler, motion, c, motion.velocity);
    timer.add_to(totals.seconds_rest);
}

template <class Real, class Accumulate>
typename StepEnergy<Real>::Step ImplicitStep<Real, Accumulate>::step_under(const BodyLoads& loads) const noexcept {
    return {.position = start_position_,
            .velocity = start_velocity_,
            .impulse = has_held_impulse_ ? std::span<const double>(held_impulse_) : std::span<const double>(),
            .position_length = position_length(),
            .momentum_length = momentum_length(),
            .loads = &loads};
}

template <class Real, class Accumulate>
double ImplicitStep<Real, Accumulate>::incremental_potential(Scheduler& scheduler, BodyMotion& motion,
                                                             std::span<const double> velocity, const BodyLoads& loads) {
    move(scheduler, motion, position_length(), velocity);
    return energy_.incremental_potential(scheduler, step_under(loads), motion.position, velocity);
}

template <class Real, class Accumulate>
bool ImplicitStep<Real, Accumulate>::descend(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads,
                                             double& potential, double rounding) {
    double length = 1;
    for (int halving = 0; halving < 12; ++halving, length /= 2) {
        for (std::size_t i = 0; i < trial_velocity_.size(); ++i) {
            trial_velocity_[i] = motion.velocity[i] + length * (static_cast<double>(change_[i]) + fall_[i % 4]);
        }
        const double trial = incremental_potential(scheduler, motion, trial_velocity_, loads);
        if (!(trial < potential + rounding)) continue;
        potential = trial;
        motion.velocity = trial_velocity_;
        return true;
    }
    return false;
}

template <class Real, class Accumulate>
std::array<double, 4> ImplicitStep<Real, Accumulate>::free_velocity(Scheduler& scheduler, const BodyLoads& loads,
                                                                    const ConstraintFilter& filter) {
    std::array<double, 4> mean{};
    if (numbering_->free_count < numbering_->node_count || !filter.empty()) return mean;
    const double g = momentum_length();
    const double mass =
        sum_over_nodes(scheduler, [&](std::size_t node, std::size_t) { return inertia_.row_sums[node]; });
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double momentum = sum_over_nodes(scheduler, [&](std::size_t node, std::size_t at) {
            return inertia_.row_sums[node] * (start_velocity_[at + axis] + g * loads.gravity[axis]) +
                   g * loads.nodal[at + axis];
        });
        mean[axis] = momentum / (mass * (1 + g * loads.rayleigh_mass));
    }
    return mean;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::slow_down(Scheduler& scheduler, BodyMotion& motion, const ConstraintFilter& filter,
                                               double share, const std::array<double, 4>& limit) {
    scheduler.for_each_block(numbering_->blocks(), [&](int block) {
        const std::size_t begin = 4 * static_cast<std::size_t>(numbering_->block_begin[block]);
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = begin; i < end; ++i) {
            motion.velocity[i] = share * motion.velocity[i] + (1 - share) * limit[i % 4] - start_velocity_[i];
        }
        filter.apply(motion.velocity.data(), block);
        for (std::size_t i = begin; i < end; ++i) motion.velocity[i] += start_velocity_[i];
    });
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::safeguard(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads,
                                               const ConstraintFilter& filter, std::span<const double> before_hold,
                                               StepReport& report, StepTotals& totals) {
    Timer timer;
    const typename StepEnergy<Real>::Inner before = inner_energy_;
    const auto gains = [&] {
        inner_energy_ = before;
        return energy_.growth(scheduler, step_under(loads), motion, before_hold, inner_energy_) > 0;
    };
    bool gained = gains();
    timer.add_to(totals.seconds_forces);
    if (!gained) return;

    report.repeated = true;
    const double h = settings_.time_step;
    double potential = incremental_potential(scheduler, motion, motion.velocity, loads);
    const double potential_at_start = incremental_potential(scheduler, motion, start_velocity_, loads);
    if (!(potential < potential_at_start)) {
        motion.velocity = start_velocity_;
        potential = potential_at_start;
    }
    for (int iteration = 0; iteration < settings_.safeguard_iterations && gained; ++iteration) {
        move(scheduler, motion, h, motion.velocity);
        linearise(scheduler, motion.position.data(), loads, true);
        right_hand_side(scheduler, motion, loads, filter, {.at_state = false, .falls_free = true});
        timer.add_to(totals.seconds_forces);
        solve(scheduler, motion, filter, report);
        ++report.newton_iterations;
        timer.add_to(totals.seconds_solve);
        const bool decreased = descend(scheduler, motion, loads, potential, 0);
        if (!decreased) break;
        move(scheduler, motion, h, motion.velocity);
        gained = gains();
        timer.add_to(totals.seconds_forces);
    }
    // The iterations may end before they have brought the energy down. A slower motion from the same start has less of
    // it, and in the limit of none what the body had at the start. What nothing holds is slowed down to the velocity
    // that its momentum asks for.
    constexpr int attempts = 24;  // 0.75^24 is 1e-3
    if (gained && is_finite(scheduler, motion)) {
        const auto slow_down_to = [&](double share, const std::array<double, 4>& limit) {
            slow_down(scheduler, motion, filter, share, limit);
            move(scheduler, motion, h, motion.velocity);
            gained = gains();
        };
        const std::array<double, 4> free = free_velocity(scheduler, loads, filter);
        for (int attempt = 0; attempt <= attempts && gained; ++attempt) {
            slow_down_to(attempt < attempts ? 0.75 : 0.0, free);
        }
        // Beyond the numbers of the scalar there is nothing to be kept.
        if (gained && !std::isfinite(inner_energy_.sum())) slow_down_to(0, {});
        timer.add_to(totals.seconds_forces);
    }
    move(scheduler, motion, h, motion.velocity);
    matrix_is_known_ = false;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::find_acceleration(Scheduler& scheduler, BodyMotion& motion, const BodyLoads& loads,
                                                       const ConstraintFilter& filter) {
    // With v~ = v the right-hand side of a step linearised at x is g (f - D v).
    start_velocity_ = motion.velocity;
    linearise(scheduler, motion.position.data(), loads, true);
    right_hand_side(scheduler, motion, loads, filter, {.at_state = false, .falls_free = false});
    const double g = momentum_length();
    scheduler.for_each_block(numbering_->blocks(), [&](int block) {
        for (std::int32_t node = numbering_->block_begin[block]; node < numbering_->block_begin[block + 1]; ++node) {
            const auto at = static_cast<std::size_t>(node);
            for (std::size_t i = 4 * at; i < 4 * at + 3; ++i) {
                const double force = static_cast<double>(right_hand_side_[i]) / g;
                start_position_[i] = force;
                const double mass = inertia_.row_sums[at];
                motion.acceleration[i] = mass > 0 ? force / mass : 0.0;
            }
        }
    });
    if (!inertia_.consistent.empty()) {
        inertia_.consistent.solve(inertia_.row_sums, *numbering_, filter,
                                  {.residual = start_position_,
                                   .direction = start_velocity_,
                                   .product = trial_velocity_,
                                   .solution = motion.acceleration});
    }
    acceleration_is_known_ = true;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::begin_newmark(Scheduler& scheduler, const BodyMotion& motion) {
    const double h = settings_.time_step, c = position_length();
    const double early = h * (1 - settings_.newmark_gamma), curved = h * h * (0.5 - settings_.newmark_beta);
    scheduler.for_each_block(numbering_->blocks(), [&](int block) {
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            const double v = motion.velocity[i], a = motion.acceleration[i];
            start_velocity_[i] = v + early * a;
            start_position_[i] = motion.position[i] + h * v + curved * a - c * start_velocity_[i];
        }
    });
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::end_newmark(Scheduler& scheduler, BodyMotion& motion) {
    const double g = momentum_length();
    scheduler.for_each_block(numbering_->blocks(), [&](int block) {
        const std::size_t end = 4 * static_cast<std::size_t>(numbering_->block_begin[block + 1]);
        for (std::size_t i = 4 * static_cast<std::size_t>(numbering_->block_begin[block]); i < end; ++i) {
            motion.acceleration[i] = (motion.velocity[i] - start_velocity_[i]) / g;
        }
    });
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::find_held_impulse(Scheduler& scheduler, const BodyMotion& motion,
                                                       std::span<const double> before_hold) {
    has_held_impulse_ = !inertia_.consistent.empty() && !before_hold.empty();
    if (!has_held_impulse_) return;
    const double share = momentum_length() / settings_.time_step;
    scheduler.for_each_block(numbering_->blocks(), [&](int block) {
        for (std::int32_t node = numbering_->block_begin[block]; node < numbering_->block_begin[block + 1]; ++node) {
            const auto at = static_cast<std::size_t>(node);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto jump = [&](std::size_t j) {
                    return motion.velocity[4 * j + axis] - before_hold[4 * j + axis];
                };
                held_impulse_[4 * at + axis] = -share * inertia_.momentum(at, jump);
            }
        }
    });
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::stop(BodyMotion& motion) noexcept {
    std::copy_n((is_newmark() ? old_position_ : start_position_).begin(), motion.position.size(),
                motion.position.begin());
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
            Timer timer;
            solve(scheduler, subject.motion, subject.filter, report);
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
    Timer timer;
    if (settings_.energy_safeguard && !energy_is_known_) {
        inner_energy_ = {.kinetic = energy_.kinetic(
                             scheduler, before_hold.empty() ? std::span<const double>(motion.velocity) : before_hold),
                         .elastic = energy_.elastic(scheduler, motion.position.data())};
        energy_is_known_ = true;
        timer.add_to(totals.seconds_forces);
    }
    find_held_impulse(scheduler, motion, before_hold);
    if (is_newmark()) old_position_ = motion.position;
    if (is_newmark() && !acceleration_is_known_) {
        find_acceleration(scheduler, motion, loads, filter);
        timer.add_to(totals.seconds_forces);
    }
    start_position_ = motion.position;
    start_velocity_ = motion.velocity;
    if (is_newmark()) begin_newmark(scheduler, motion);
    if (!is_at_state()) move(scheduler, motion, position_length(), motion.velocity);
    timer.add_to(totals.seconds_rest);
    is_rotated_ = evaluate(scheduler, motion.position.data(), steps_since_renewal_ == 0);
    if (is_rotated_) totals.kept_rotations += elements_->kept_blocks();
    timer.add_to(totals.seconds_forces);
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::end(Scheduler& scheduler, const StepSubject& subject, StepReport& report,
                                         StepTotals& totals) {
    const auto& [motion, loads, filter, before_hold] = subject;
    iterate(scheduler, subject, report, totals);
    if (settings_.energy_safeguard) {
        safeguard(scheduler, motion, loads, filter, before_hold, report, totals);
    }
    if (is_midpoint()) {
        Timer rest;
        move(scheduler, motion, settings_.time_step, motion.velocity);
        for (std::size_t i = 0; i < start_velocity_.size(); ++i) {
            motion.velocity[i] = 2 * motion.velocity[i] - start_velocity_[i];
        }
        rest.add_to(totals.seconds_rest);
    }
    if (is_newmark()) {
        Timer rest;
        end_newmark(scheduler, motion);
        rest.add_to(totals.seconds_rest);
    }
    // Where the safeguard has found no growth, energies and with them the state are finite. Without it a step whose
    // equations are not has gone on as if there were no forces.
    const bool is_guarded = settings_.energy_safeguard;
    if (((!is_guarded || report.repeated) && !is_finite(scheduler, motion)) || !(is_guarded || newton_.is_finite)) {
        stop(motion);
        report.lost = true;
    }
    steps_since_renewal_ = (steps_since_renewal_ + 1) % settings_.rotation_interval;

    ++totals.steps;
    totals.newton_iterations += report.newton_iterations;
    totals.conjugate_gradient_iterations += report.conjugate_gradient_iterations;
    totals.repeats += report.repeated ? 1 : 0;
    totals.lost += report.lost ? 1 : 0;
    totals.coarse_refreshes = preconditioner_->coarse_refreshes();
    totals.coarse_failures = preconditioner_->coarse_failures();
}

template <class Real, class Accumulate>
Energies ImplicitStep<Real, Accumulate>::energies(Scheduler& scheduler, const BodyMotion& motion,
                                                  const BodyLoads& loads, std::span<const double> rest_position) {
    Energies energies;
    energies.kinetic = energy_.kinetic(scheduler, motion.velocity);
    energies.elastic = energy_.elastic(scheduler, motion.position.data());
    energies.gravity = gravity_energy(scheduler, *numbering_, std::span<double>(partial_), inertia_.row_sums,
                                      loads.gravity, motion.position, rest_position);
    return energies;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::apply_matrix(Scheduler& scheduler, const BodyMotion& motion,
                                                  const BodyLoads& loads, std::span<const Real> z,
                                                  std::span<Real> out) {
    linearise(scheduler, motion.position.data(), loads, true);
    matrix_->product(scheduler, z.data());
    scheduler.for_each_block(numbering_->blocks(), [&](int block) { matrix_->merge(block); });
    std::copy_n(matrix_->buffer(), out.size(), out.begin());
}

template <class Real, class Accumulate>
LargestEigenvalue ImplicitStep<Real, Accumulate>::largest_eigenvalue(Scheduler& scheduler, const double* position,
                                                                     double tolerance) {
    elements_->evaluate(scheduler, position, {.rotation = !is_linear(), .force = false, .energy = false});
    matrix_->assemble(scheduler, {.mass = 0, .stiffness = 1});
    matrix_is_known_ = false;
    return runtime::largest_eigenvalue(scheduler, *matrix_, *numbering_, inertia_.row_sums, tolerance);
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
    return matrix_->change(change) && preconditioner_->change(change);
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::forget_velocity() noexcept {
    energy_is_known_ = false;
    acceleration_is_known_ = false;
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::forget() noexcept {
    energy_is_known_ = false;
    matrix_is_known_ = false;
    acceleration_is_known_ = false;
    steps_since_renewal_ = 0;
    preconditioner_->forget_coarse();
}

template <class Real, class Accumulate>
std::size_t ImplicitStep<Real, Accumulate>::bytes() const noexcept {
    using kernels::heap_bytes;
    return heap_bytes(inertia_.row_sums) + inertia_.consistent.bytes() + energy_.bytes() + heap_bytes(old_position_) +
           heap_bytes(held_impulse_) + matrix_->bytes() + preconditioner_->bytes() + conjugate_gradients_.bytes() +
           heap_bytes(start_position_) + heap_bytes(start_velocity_) + heap_bytes(trial_velocity_) +
           heap_bytes(right_hand_side_) + heap_bytes(change_) + heap_bytes(partial_);
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::save(std::vector<double>& numbers) const {
    numbers.insert(numbers.end(),
                   {inner_energy_.kinetic, inner_energy_.elastic, energy_is_known_ ? 1.0 : 0.0,
                    matrix_is_known_ ? 1.0 : 0.0, static_cast<double>(steps_since_renewal_), matrix_->factors().mass,
                    matrix_->factors().stiffness, acceleration_is_known_ ? 1.0 : 0.0});
    preconditioner_->save(numbers);
}

template <class Real, class Accumulate>
void ImplicitStep<Real, Accumulate>::restore(Scheduler& scheduler, std::span<const double>& numbers) {
    inner_energy_ = {.kinetic = numbers[0], .elastic = numbers[1]};
    energy_is_known_ = numbers[2] != 0;
    matrix_is_known_ = numbers[3] != 0;
    steps_since_renewal_ = static_cast<int>(numbers[4]);
    if (matrix_is_known_) matrix_->assemble(scheduler, {.mass = numbers[5], .stiffness = numbers[6]});
    acceleration_is_known_ = numbers[7] != 0;
    numbers = numbers.subspan(8);
    preconditioner_->restore(numbers);
}

template class ImplicitStep<float, float>;
template class ImplicitStep<float, double>;
template class ImplicitStep<double, double>;

}  // namespace lancet::runtime
