#include "lancet/runtime/simulate/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>
#include <type_traits>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/integrate/nodal_sum.hpp"
#include "lancet/runtime/simulate/held_scene.hpp"
#include "lancet/runtime/simulate/scene_layout.hpp"
#include "lancet/runtime/solve/conjugate_gradients.hpp"

namespace lancet::runtime {

std::string_view to_string(EquilibriumEnd end) noexcept {
    switch (end) {
        case EquilibriumEnd::converged:
            return "converged";
        case EquilibriumEnd::stagnated:
            return "stagnated";
        default:
            return "lost stability";
    }
}

void validate(const EquilibriumSettings& settings) {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw Error("equilibrium settings: " + what);
    };
    require(settings.tolerance > 0 && settings.tolerance < 1, "the tolerance must be in (0, 1)");
    require(settings.newton_iterations >= 1, "at least one Newton iteration is needed");
    require(settings.conjugate_gradient_iterations >= 1, "at least one iteration of conjugate gradients is needed");
    require(settings.load_steps >= 1, "at least one load step is needed");
    require(settings.smallest_load_step > 0 && settings.smallest_load_step <= 1,
            "the smallest load step must be in (0, 1]");
    kernels::require_tangent(settings.model, settings.tangent);
    require(settings.rotation.steps >= 1, "at least one step of the rotation method is needed");
    kernels::require(settings.instruction_set);
}

namespace {

using Nodal = kernels::AlignedVector<double>;

std::string number(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g", value);
    return text.data();
}

/// `Real` is the scalar of forces and energies, `Inner` that of the tangent and its solves.
template <class Real, class Inner>
class Search {
  public:
    Search(HeldScene held, const EquilibriumSettings& settings, Scheduler& scheduler, std::span<const Point> start)
        : held_(std::move(held)),
          settings_(settings),
          scheduler_(&scheduler),
          numbering_(number_scene(held_.scene, settings.ordering, settings.numbering)),
          elements_(make_elements<Real>()),
          matrix_(make_operator(settings.matrix, inner_elements(), definition())),
          preconditioner_(preconditioner_kind(), inner_elements(), *matrix_, definition(), coarse_change),
          conjugate_gradients_(inner_elements().kernels(), numbering_),
          filter_(slides(), numbering_),
          rest_(numbers(), 0.0),
          position_(numbers(), 0.0),
          load_(numbers(), 0.0),
          residual_(numbers(), 0.0),
          trial_(numbers(), 0.0),
          right_hand_side_(numbers()),
          direction_(numbers()),
          partial_(static_cast<std::size_t>(numbering_.blocks())) {
        const std::vector<Point> loads = external_loads(held_.scene);
        const std::vector<double> mass = nodal_masses(held_.scene, element_materials(held_.scene), numbering_);
        const std::span<const Point> rest = held_.scene.mesh.nodes();
        for (std::size_t internal = 0; internal < mass.size(); ++internal) {
            const std::int32_t user = numbering_.user_of_internal[internal];
            // Unused nodes stand where the first node stands: nothing far away enters a sum.
            const auto node = static_cast<std::size_t>(std::max(user, 0));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                rest_[4 * internal + axis] = rest[node][axis];
                position_[4 * internal + axis] = user < 0 ? rest[node][axis] : start[node][axis];
                if (user >= 0) load_[4 * internal + axis] = loads[node][axis] + mass[internal] * scene().gravity[axis];
            }
        }
        for (const std::int32_t node : held_.scene.fixed_nodes) {
            std::copy_n(rest[static_cast<std::size_t>(node)].begin(), 3, &position_[place(node)]);
        }
        elements_.reset(scheduler, rest_.data());
        if (inner_) inner_->reset(scheduler, rest_.data());
    }

    EquilibriumReport run() {
        double step = 1.0 / settings_.load_steps;
        report_.held_components = held_.components;
        while (true) {
            const double target = report_.load_factor + step > 1 - 1e-9 ? 1 : report_.load_factor + step;
            const Nodal before = position_;
            const Outcome outcome = equilibrate(report_.load_factor, target);
            if (outcome == Outcome::drowned) {  // smaller loads would only drown sooner
                report_.end = EquilibriumEnd::stagnated;
                report_.explanation = "stagnated at a residual of " + number(report_.residual) + " of the loads, at " +
                                      number(target) + " of the load: rounding of forces in float, up to about " +
                                      number(rounding_ / reference_) +
                                      " of them, hides the rest; mixed or double goes further";
                return report_;
            }
            const bool is_found = outcome == Outcome::converged || outcome == Outcome::rounding;
            if (is_found) {
                report_.load_factor = target;
                ++report_.load_steps;
                step *= 2;
                if (target < 1) continue;
                report_.end = outcome == Outcome::converged ? EquilibriumEnd::converged : EquilibriumEnd::stagnated;
                report_.explanation = outcome == Outcome::converged
                                          ? "the residual is " + number(report_.residual) + " of the loads"
                                          : "the residual stays at " + number(report_.residual) +
                                                " of the loads: what the arithmetic allows";
                return report_;
            }
            position_ = before;
            step /= 2;
            if (step >= settings_.smallest_load_step) continue;
            const bool lost = outcome == Outcome::indefinite;
            report_.end = lost ? EquilibriumEnd::lost_stability : EquilibriumEnd::stagnated;
            report_.explanation =
                (lost ? "the tangent is indefinite beyond " : "Newton's method finds no equilibrium beyond ") +
                number(report_.load_factor) + " of the load, at " + number(target);
            equilibrate(report_.load_factor, report_.load_factor);  // residual and energy of what is returned
            return report_;
        }
    }

    void positions(std::span<Point> out) const {
        for (std::size_t node = 0; node < out.size(); ++node) {
            std::copy_n(&position_[place(static_cast<std::int32_t>(node))], 3, out[node].begin());
        }
    }

  private:
    enum class Outcome {
        converged,
        rounding,    ///< the arithmetic allows no smaller residual
        drowned,     ///< nor does it here, where the residual is still large
        failed,      ///< too many iterations, or no descent
        indefinite,  ///< the tangent is not positive definite
    };
    static constexpr bool is_single = sizeof(Real) == 4;
    static constexpr double coarse_change = 0.05;

    const Scene& scene() const { return held_.scene; }
    std::size_t numbers() const { return 4 * static_cast<std::size_t>(numbering_.node_count); }
    std::size_t place(std::int32_t node) const {
        return 4 * static_cast<std::size_t>(numbering_.internal_of_user[static_cast<std::size_t>(node)]);
    }

    template <class Scalar>
    ElasticElements<Scalar> make_elements() const {
        const kernels::KernelSet<Scalar>& kernels = kernels::kernel_set<Scalar>(settings_.instruction_set);
        return ElasticElements<Scalar>(kernels,
                                       element_batches<Scalar>(scene(), numbering_, settings_.scatter, kernels.width),
                                       numbering_, gradient_layout(settings_.matrix, law()), settings_.rotation, law());
    }

    ElasticElements<Inner>& inner_elements() {
        if constexpr (std::is_same_v<Real, Inner>) {
            return elements_;
        } else {
            if (!inner_) inner_.emplace(make_elements<Inner>());
            return *inner_;
        }
    }

    OperatorDefinition definition() const {
        return {.tetrahedra = scene().mesh.tetrahedra(),
                .nodal_mass = std::vector<double>(static_cast<std::size_t>(numbering_.node_count), 0.0),
                .mass = MassKind::lumped,
                .scatter = settings_.scatter};
    }

    /// The projections of nodes that are held in some components.
    std::vector<NodeConstraint> slides() const {
        std::map<std::int32_t, std::array<double, 6>> projections;
        for (const PrescribedDisplacement& p : held_.prescribed) {
            const std::int32_t node = numbering_.internal_of_user[static_cast<std::size_t>(p.node)];
            if (!numbering_.is_free(node)) continue;
            projections.try_emplace(node, std::array<double, 6>{1, 1, 1, 0, 0, 0})
                .first->second[static_cast<std::size_t>(p.axis)] = 0;
        }
        std::vector<NodeConstraint> constraints;
        constraints.reserve(projections.size());
        for (const auto& [node, projection] : projections) constraints.push_back({node, projection});
        return constraints;
    }

    ElasticLaw law() const { return {.model = settings_.model, .tangent = settings_.tangent}; }
    /// Rigid motions that only sliding nodes prevent would make the coarse matrix singular.
    PreconditionerKind preconditioner_kind() const {
        if (settings_.preconditioner != PreconditionerKind::coarse) return settings_.preconditioner;
        return held_.fixed_nodes_hold ? PreconditionerKind::coarse : PreconditionerKind::block_jacobi;
    }
    bool is_linear() const { return settings_.model == ElementModel::linear; }

    /// Sum over the free nodes of value(i) for the places i of their numbers.
    template <class Value>
    double sum(const Value& value) {
        return sum_over_nodes(*scheduler_, numbering_, std::span<double>(partial_),
                              [&](std::size_t, std::size_t at) { return value(at) + value(at + 1) + value(at + 2); });
    }

    /// Moves what is prescribed to where it is at a load factor.
    void prescribe(double factor) {
        for (const PrescribedDisplacement& p : held_.prescribed) {
            const std::size_t i = place(p.node) + static_cast<std::size_t>(p.axis);
            position_[i] = rest_[i] + factor * p.displacement(0);
        }
    }

    double work(const Nodal& position, double factor) {
        return factor * sum([&](std::size_t i) { return load_[i] * (position[i] - rest_[i]); });
    }

    /// Residual at the position; returns its norm.
    double evaluate(double factor) {
        report_.elastic_energy = elements_.evaluate(*scheduler_, position_.data(),
                                                    {.rotation = !is_linear(), .force = true, .energy = true});
        scheduler_->for_each_block(numbering_.blocks(), [&](int block) {
            elements_.merge_force(block);
            const std::size_t begin = 4 * static_cast<std::size_t>(numbering_.block_begin[block]);
            const std::size_t end = 4 * static_cast<std::size_t>(numbering_.block_begin[block + 1]);
            for (std::size_t i = begin; i < end; ++i) {
                residual_[i] = static_cast<double>(elements_.force()[i]) + factor * load_[i];
            }
            filter_.apply(residual_.data(), block);
        });
        report_.potential_energy = report_.elastic_energy - work(position_, factor);
        return std::sqrt(sum([&](std::size_t i) { return residual_[i] * residual_[i]; }));
    }

    /// Solves tangent * direction = residual as far as `tolerance`. False where the tangent shows itself indefinite.
    bool solve(double tolerance) {
        if constexpr (!std::is_same_v<Real, Inner>) {
            inner_->evaluate(*scheduler_, position_.data(), {.rotation = !is_linear(), .force = false});
        }
        matrix_->assemble(*scheduler_, {.mass = 0, .stiffness = 1});
        preconditioner_.refresh(*scheduler_, position_.data());
        // Scaled to length one, so that float has room for it.
        const double size = std::sqrt(sum([&](std::size_t i) { return residual_[i] * residual_[i]; }));
        for (std::size_t i = 0; i < residual_.size(); ++i) {
            right_hand_side_[i] = static_cast<Inner>(residual_[i] / size);
            direction_[i] = 0;
        }
        const ConjugateGradientResult result =
            conjugate_gradients_.solve(*scheduler_, *matrix_, preconditioner_, filter_,
                                       std::span<const Inner>(right_hand_side_), std::span<Inner>(direction_),
                                       {.iterations = settings_.conjugate_gradient_iterations, .tolerance = tolerance});
        report_.conjugate_gradient_iterations += result.iterations;
        direction_size_ = size;
        return !result.broke_down || (result.iterations > 0 && std::is_same_v<Inner, float>);
    }

    double direction(std::size_t i) const { return direction_size_ * static_cast<double>(direction_[i]); }

    /// Goes along the direction to where the potential energy has fallen enough (Armijo 1966); where the energy is too
    /// coarse to tell, to where the residual has. Evaluates there. False if there is no such place.
    bool search_line(double factor, double& norm) {
        const double slope = sum([&](std::size_t i) { return residual_[i] * direction(i); });
        if (!(slope > 0)) return false;
        const double potential = report_.potential_energy;
        const double size = std::abs(report_.elastic_energy) + std::abs(report_.elastic_energy - potential);
        // Strains are rounded to epsilon: an energy of strains of 1 % has lost two digits, and slender bodies strain
        // less.
        const double rounding = (is_single ? 1e-5 : 1e-14) * size;
        const Nodal before = position_;
        double length = 1;
        for (int halving = 0; halving < 30; ++halving, length /= 2) {
            for (std::size_t i = 0; i < before.size(); ++i) {
                trial_[i] = before[i] + (i % 4 == 3 ? 0 : length * direction(i));
            }
            if (slope * length > 16 * rounding) {
                const double elastic = elements_.evaluate(
                    *scheduler_, trial_.data(),
                    {.rotation = !is_linear(), .force = false, .energy = true, .keep_gradients = false});
                const double decrease = potential - (elastic - work(trial_, factor));
                if (!(decrease >= 1e-4 * length * slope - rounding)) continue;
                position_ = trial_;
                norm = evaluate(factor);
                if (std::isfinite(norm)) return true;
            } else {
                position_ = trial_;
                const double reached = evaluate(factor);
                if (reached < norm) {
                    norm = reached;
                    return true;
                }
            }
            position_ = before;
        }
        norm = evaluate(factor);
        return false;
    }

    /// Up to where the norm of what rounding makes of the forces may go. The deformation gradient F = sum_j (x_j -
    /// x_0) b_j^T is rounded to eps sum_j |x_j - x_0| |b_j|: about eps of a regular element, and eps times length over
    /// height of a flat one. That is a strain, and makes a force of V |b_i| (2 mu + 3 |lambda|) times it at corner i,
    /// of any sign: squares are added up. The few operations behind F are in the constant. Bars with stiff, nearly
    /// incompressible or flat elements stop at 0.002 to 3 of this, most at 0.02.
    double rounding_of_forces() {
        constexpr double operations = 4;
        const ElementMaterials materials = element_materials(scene());
        std::vector<double> squares(numbers() / 4, 0.0);
        for (std::size_t e = 0; e < materials.of_element.size(); ++e) {
            const mesh::Tetrahedron& nodes = scene().mesh.tetrahedra()[e];
            std::array<double, 4> slope{};  // |b_i| = area of the face opposite to i / (3 V)
            const double volume = scene().mesh.volume(static_cast<std::int32_t>(e));
            double stretch = 0;
            for (std::size_t i = 0; i < 4; ++i) {
                const auto& [a, b, c] = mesh::opposite_faces[i];
                const auto at = [&](std::size_t k) { return scene().mesh.nodes()[static_cast<std::size_t>(nodes[k])]; };
                slope[i] = mesh::area(at(a), at(b), at(c)) / (3 * volume);
                const double *x = &position_[place(nodes[i])], *x0 = &position_[place(nodes[0])];
                stretch += std::hypot(x[0] - x0[0], x[1] - x0[1], x[2] - x0[2]) * slope[i];
            }
            const auto& material = materials.parameters[static_cast<std::size_t>(materials.of_element[e])];
            const double stress = (2 * material.mu + 3 * std::abs(material.lambda)) * operations *
                                  std::numeric_limits<Real>::epsilon() / 2 * stretch;
            for (std::size_t i = 0; i < 4; ++i) {
                const double force = stress * volume * scene().parts.of(e).fraction * slope[i];
                squares[place(nodes[i]) / 4] += force * force;
            }
        }
        return std::sqrt(sum_over_nodes(*scheduler_, numbering_, std::span<double>(partial_),
                                        [&](std::size_t node, std::size_t) { return squares[node]; }));
    }

    /// Why a load step failed: where forces are rounded to as much as is left of them, this is all there is.
    Outcome failed(double norm, double reference) {
        if (!is_single || !std::isfinite(norm) || reference == 0) return Outcome::failed;
        rounding_ = rounding_of_forces();
        reference_ = reference;
        report_.residual = norm / reference;
        return norm <= 4 * rounding_ ? Outcome::drowned : Outcome::failed;
    }

    Outcome equilibrate(double from, double factor) {
        const bool is_last = factor == 1;
        const double tolerance = is_last ? settings_.tolerance : std::max(settings_.tolerance, is_single ? 1e-2 : 1e-5);
        prescribe(factor);
        double norm = evaluate(factor);
        const double load = factor * std::sqrt(sum([&](std::size_t i) { return load_[i] * load_[i]; }));
        const double reference = std::max(load, from == factor ? 0.0 : norm);
        report_.residuals.clear();
        double previous = norm, forcing = 0.1;
        for (int iteration = 0;; ++iteration) {
            report_.residual = reference > 0 ? norm / reference : norm;
            report_.residuals.push_back(report_.residual);
            if (!std::isfinite(norm)) return Outcome::failed;
            if (norm <= tolerance * reference) return Outcome::converged;
            if (iteration == settings_.newton_iterations) return failed(norm, reference);
            const double enough = 0.1 * tolerance * reference / norm;
            if (iteration > 0) {
                // Eisenstat and Walker 1996: choice 2 and its safeguard.
                const double kept = 0.9 * forcing * forcing, ratio = norm / previous;
                forcing = std::min(0.9 * ratio * ratio, 0.5);
                if (kept > 0.1) forcing = std::max(forcing, kept);
            }
            constexpr double least = sizeof(Inner) == 4 ? 1e-5 : 1e-12;
            const bool is_definite = solve(std::max(least, is_linear() ? enough : std::max(enough, forcing)));
            if (!is_definite) return Outcome::indefinite;
            previous = norm;
            ++report_.newton_iterations;
            const bool descended = search_line(factor, norm);
            // Near the end of the digits neither energy nor residual falls any further.
            const bool is_near = norm < (is_single ? 1e-2 : 1e-6) * reference;
            const bool is_enough = norm <= tolerance * reference;  // the loop says so
            if (is_near && !is_enough && (!descended || norm > 0.9 * previous)) {
                report_.residual = norm / reference;
                return Outcome::rounding;
            }
            if (!descended && !is_enough) return failed(norm, reference);
        }
    }

    HeldScene held_;
    EquilibriumSettings settings_;
    Scheduler* scheduler_;
    kernels::NodeNumbering numbering_;
    ElasticElements<Real> elements_;
    std::optional<ElasticElements<Inner>> inner_;  ///< where Inner is another type than Real
    std::unique_ptr<Operator<Inner>> matrix_;
    Preconditioner<Inner> preconditioner_;
    ConjugateGradients<Inner, Inner> conjugate_gradients_;
    ConstraintFilter filter_;
    Nodal rest_, position_, load_, residual_, trial_;
    kernels::AlignedVector<Inner> right_hand_side_, direction_;
    double direction_size_ = 1;
    double rounding_ = 0, reference_ = 1;  ///< of the forces, and of the residual, where a load step drowned
    std::vector<double> partial_;
    EquilibriumReport report_;
};

}  // namespace

EquilibriumReport find_equilibrium(const Scene& scene, const EquilibriumSettings& settings, Scheduler& scheduler,
                                   std::span<Point> positions) {
    validate(settings);
    if (scene.mesh.tetrahedra().empty()) throw Error("scene: the mesh has no elements");
    if (!settings.force_preconditioner) require_preconditioner(scene, settings.preconditioner);
    if (scene.floor) throw Error("equilibrium: the scene has a floor; expected none, contact is for dynamics");
    if (positions.size() != scene.mesh.nodes().size()) {
        throw Error(std::to_string(positions.size()) + " positions given; the mesh has " +
                    std::to_string(scene.mesh.nodes().size()) + " nodes");
    }
    for (const Point& position : positions) {
        for (const double value : position) {
            if (!std::isfinite(value)) throw Error("equilibrium: a start position is not finite");
        }
    }
    const auto search = [&]<class Real, class Inner>(Real, Inner) {
        Search<Real, Inner> run(hold_scene(scene, settings.hold_floating), settings, scheduler, positions);
        EquilibriumReport report = run.run();
        run.positions(positions);
        return report;
    };
    switch (settings.scalar) {
        case ScalarMode::single_precision:
            return search(float(), float());
        case ScalarMode::mixed:
            return search(double(), float());
        default:
            return search(double(), double());
    }
}

}  // namespace lancet::runtime
