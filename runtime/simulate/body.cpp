#include "lancet/runtime/simulate/body.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>

#include "lancet/kernels/error.hpp"
#include "lancet/kernels/layout/spare_nodes.hpp"
#include "lancet/runtime/integrate/explicit_step.hpp"
#include "lancet/runtime/integrate/floor_contact.hpp"
#include "lancet/runtime/integrate/holds.hpp"
#include "lancet/runtime/integrate/implicit_step.hpp"
#include "lancet/runtime/simulate/changed_layout.hpp"
#include "lancet/runtime/simulate/loads.hpp"
#include "lancet/runtime/simulate/scene_layout.hpp"
#include "lancet/runtime/solve/block_loop.hpp"
#include "lancet/runtime/solve/critical_step.hpp"

namespace lancet::runtime {

namespace {

void require_finite(std::span<const Point> values, const char* what) {
    for (std::size_t node = 0; node < values.size(); ++node) {
        for (const double value : values[node]) {
            if (!std::isfinite(value)) {
                throw Error(std::string(what) + " of node " + std::to_string(node) + " is not finite");
            }
        }
    }
}

/// While it lives, passes over a body leave out the blocks that are asleep.
class LeaveSleepersOut {
  public:
    explicit LeaveSleepersOut(kernels::SleepingNodes& sleeping) : sleeping_(&sleeping) {
        sleeping.are_left_out = !sleeping.empty();
    }
    LeaveSleepersOut(const LeaveSleepersOut&) = delete;
    LeaveSleepersOut& operator=(const LeaveSleepersOut&) = delete;
    ~LeaveSleepersOut() { sleeping_->are_left_out = false; }

  private:
    kernels::SleepingNodes* sleeping_;
};

}  // namespace

std::string_view to_string(StepStage stage) noexcept {
    switch (stage) {
        case StepStage::forces:
            return "forces";
        case StepStage::matrix:
            return "matrix";
        case StepStage::solve:
            return "solve";
        default:
            return "update";
    }
}

template <class Real, class Accumulate>
class BodyOf final : public DeformableBody {
  public:
    BodyOf(const Scene& scene, const Settings& settings, Scheduler& scheduler)
        : settings_(settings),
          element_count_(scene.mesh.tetrahedra().size()),
          numbering_(number_scene(scene, settings.ordering, settings.numbering)),
          elements_(make_elements(scene, settings, numbering_)),
          mass_(nodal_masses(scene, element_materials(scene), numbering_, mass_kind(settings))),
          step_(make_step(scene)),
          holds_(scene, numbering_) {
        const std::size_t numbers = 4 * static_cast<std::size_t>(numbering_.node_count);
        motion_.position.assign(numbers, 0.0);
        motion_.velocity.assign(numbers, 0.0);
        loads_.gravity = scene.gravity;
        loads_.nodal.assign(numbers, 0.0);
        loads_.rayleigh_mass = scene.rayleigh_mass;
        loads_.rayleigh_stiffness = scene.rayleigh_stiffness;
        before_hold_.assign(numbers, 0.0);
        if (settings.integrator == Integrator::newmark || is_explicit(settings.integrator)) {
            motion_.acceleration.assign(numbers, 0.0);
        }
        scatter_to_internal(external_loads(scene), loads_.nodal);
        scatter_to_internal(scene.mesh.nodes(), motion_.position);
        // Unused nodes stand where the first node stands: nothing far away enters a sum.
        for (std::size_t node = 0; node < static_cast<std::size_t>(numbering_.node_count); ++node) {
            if (numbering_.user_of_internal[node] >= 0) continue;
            std::copy_n(scene.mesh.nodes().front().begin(), 3, &motion_.position[4 * node]);
        }
        rest_position_ = motion_.position;
        elements_.reset(scheduler, motion_.position.data());
        if (scene.floor) {
            floor_ = FloorContact(*scene.floor, numbering_, motion_.position,
                                  static_cast<double>(std::numeric_limits<Real>::epsilon()));
            floor_.require_above(numbering_, motion_.position);
            before_floor_ = motion_;
        }
        if (is_explicit(settings.integrator) && !settings.force_time_step) require_stable_step(scheduler);
    }

    StepReport run(StepStage stage, Scheduler& scheduler) override {
        const LeaveSleepersOut leave_out(numbering_.sleeping);
        if (stage == StepStage::forces) {
            report_ = {};
            if (floor_.exists()) {
                let_go_of_floor(scheduler);
                before_floor_ = motion_;
            }
            prepare_holds();
        }
        run_stage(stage, scheduler, report_);
        if (stage == StepStage::update) {
            if (floor_.exists()) repeat_above_floor(scheduler);
            totals_.sleeping_blocks += std::ranges::count(numbering_.sleeping.blocks, std::uint8_t{1});
            time_ += settings_.time_step;
        }
        return report_;
    }

    double critical_time_step(Scheduler& scheduler) override { return critical_time_step(scheduler, 1e-6); }

    std::size_t nodes() const noexcept override { return numbering_.internal_of_user.size(); }
    std::size_t elements() const noexcept override { return element_count_; }
    double time() const noexcept override { return time_; }
    void set_time(double time) override {
        if (!std::isfinite(time)) throw Error("the time of a body is not finite");
        time_ = time;
    }
    void positions(std::span<Point> out) const override { gather_to_user(motion_.position, out); }
    void positions(std::span<const std::int32_t> nodes, std::span<Point> out) const override {
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            const auto internal = numbering_.internal_of_user[static_cast<std::size_t>(nodes[k])];
            const double* const from = &motion_.position[4 * static_cast<std::size_t>(internal)];
            out[k] = {from[0], from[1], from[2]};
        }
    }
    Point position(std::int32_t node) const override {
        const std::size_t at = 4 * static_cast<std::size_t>(internal_node(node));
        return {motion_.position[at], motion_.position[at + 1], motion_.position[at + 2]};
    }
    void velocities(std::span<Point> out) const override { gather_to_user(motion_.velocity, out); }

    void set_positions(std::span<const Point> positions) override {
        require_count(positions.size(), "positions");
        require_finite(positions, "position");
        take_sleepers({});
        for (std::size_t node = 0; node < positions.size(); ++node) {
            const std::int32_t internal = numbering_.internal_of_user[node];
            if (!numbering_.is_free(internal)) continue;
            std::copy_n(positions[node].begin(), 3, &motion_.position[4 * static_cast<std::size_t>(internal)]);
        }
        step_->forget();
    }

    void set_velocities(std::span<const Point> velocities) override {
        require_count(velocities.size(), "velocities");
        require_finite(velocities, "velocity");
        take_sleepers({});
        for (std::size_t node = 0; node < velocities.size(); ++node) {
            const std::int32_t internal = numbering_.internal_of_user[node];
            if (!numbering_.is_free(internal)) continue;
            std::copy_n(velocities[node].begin(), 3, &motion_.velocity[4 * static_cast<std::size_t>(internal)]);
        }
        step_->forget_velocity();
    }

    void set_loads(std::span<const Point> loads) override {
        require_count(loads.size(), "loads");
        require_finite(loads, "load");
        scatter_to_internal(loads, loads_.nodal);
    }

    void set_load(std::int32_t node, const Point& load) override {
        require_finite(std::span(&load, 1), "load");
        std::copy_n(load.begin(), 3, &loads_.nodal[4 * static_cast<std::size_t>(internal_node(node))]);
    }

    void hold(std::int32_t node, const Point& target) override { add_hold(node, target, {0, 0, 0}); }

    void hold(std::int32_t node, const Point& target, const Point& direction) override {
        const double length = std::hypot(direction[0], direction[1], direction[2]);
        if (!(std::abs(length - 1) < 1e-6)) {
            throw Error("hold: the direction has length " + std::to_string(length) + "; expected 1");
        }
        add_hold(node, target, direction);
    }

    void release(std::int32_t node) override {
        holds_.release(internal_node(node));
        step_->forget_acceleration();
    }

    void release_all() override {
        holds_.release_all();
        step_->forget_acceleration();
    }

    NodeMotion motion(std::int32_t node) const override {
        const std::size_t at = 4 * static_cast<std::size_t>(internal_node(node));
        NodeMotion motion;
        std::copy_n(&motion_.position[at], 3, motion.position.begin());
        std::copy_n(&motion_.velocity[at], 3, motion.velocity.begin());
        return motion;
    }

    void set_asleep(std::span<const std::uint8_t> asleep) override {
        require_count(asleep.size(), "flags");
        if (std::ranges::count(asleep, std::uint8_t{0}) == std::ssize(asleep)) return take_sleepers({});
        std::vector<std::uint8_t> nodes(static_cast<std::size_t>(numbering_.node_count), 0);
        for (std::size_t node = 0; node < asleep.size(); ++node) {
            nodes[static_cast<std::size_t>(numbering_.internal_of_user[node])] = asleep[node] != 0 ? 1 : 0;
        }
        take_sleepers(std::move(nodes));
    }
    bool is_asleep(std::int32_t node) const override { return numbering_.sleeping.has(internal_node(node)); }

    bool change(const BodyChange& change) override {
        const bool is_by_rows = settings_.matrix == OperatorKind::block_rows && !is_explicit(settings_.integrator);
        if (!numbering_.has_room() || is_by_rows || settings_.scatter != kernels::ScatterStrategy::private_copies) {
            return false;
        }
        take_sleepers({});
        ChangedLayout<Real> changed(change, numbering_, spare_nodes_, elements_, rest_position_);
        LayoutChange layout;
        if (!changed.number_nodes() || !changed.lay_out_elements(layout)) return false;
        element_count_ =
            static_cast<std::size_t>(static_cast<std::ptrdiff_t>(element_count_) + changed.more_elements());
        const std::span<const std::int32_t> numbers = changed.numbers();
        std::vector<std::int32_t> gone;
        for (std::size_t user = static_cast<std::size_t>(change.first_node); user < nodes(); ++user) {
            const std::int32_t node = numbering_.internal_of_user[user];
            if (std::find(numbers.begin(), numbers.end(), node) == numbers.end()) gone.push_back(node);
        }
        for (const std::int32_t node : gone) {
            layout.masses.push_back({.node = node});
            kernels::SpareNodes::give_back(numbering_, node);  // it is in no aggregate any more
        }
        for (const BodyChange::NodalMass& of_node : change.masses) {
            LayoutChange::NodalMass& mass = layout.masses.emplace_back();
            mass.node = changed.number_of(of_node.node);
            mass.mass = of_node.mass;
            for (const auto& [node, pair] : of_node.row) mass.row.emplace_back(changed.number_of(node), pair);
        }
        if (!step_->change(layout)) return false;
        for (const LayoutChange::NodalMass& of_node : layout.masses) mass_[of_node.node] = of_node.mass;
        holds_.release_all();
        for (const std::int32_t node : gone) forget_node(node);
        take_nodes(change, numbers);
        ++changes_;
        return true;
    }

    Energies energies(Scheduler& scheduler) override {
        return step_->energies(scheduler, motion_, loads_, rest_position_);
    }

    void elastic_forces(Scheduler& scheduler, std::span<Point> out) override {
        require_count(out.size(), "forces");
        elements_.evaluate(scheduler, motion_.position.data(),
                           {.rotation = settings_.model != ElementModel::linear, .force = true});
        for (int block = 0; block < numbering_.blocks(); ++block) elements_.merge_force(block);
        for (std::size_t node = 0; node < out.size(); ++node) {
            const std::int32_t internal = numbering_.internal_of_user[node];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                out[node][axis] = numbering_.is_free(internal)
                                      ? static_cast<double>(elements_.force()[4 * internal + static_cast<int>(axis)])
                                      : 0.0;
            }
        }
        step_->forget_matrix();
    }

    void apply_matrix(Scheduler& scheduler, std::span<const Point> z, std::span<Point> out) override {
        require_count(z.size(), "values");
        require_count(out.size(), "results");
        kernels::AlignedVector<Real> in(motion_.position.size(), Real(0)), result(in.size());
        for (std::size_t node = 0; node < z.size(); ++node) {
            const std::int32_t internal = numbering_.internal_of_user[node];
            if (!numbering_.is_free(internal)) continue;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                in[4 * static_cast<std::size_t>(internal) + axis] = static_cast<Real>(z[node][axis]);
            }
        }
        step_->apply_matrix(scheduler, motion_, loads_, in, result);
        step_->forget_matrix();
        for (std::size_t node = 0; node < out.size(); ++node) {
            const std::int32_t internal = numbering_.internal_of_user[node];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                out[node][axis] = numbering_.is_free(internal)
                                      ? static_cast<double>(result[4 * static_cast<std::size_t>(internal) + axis])
                                      : 0.0;
            }
        }
    }

    double nodal_mass(std::int32_t node) const override { return mass_[internal_node(node)]; }

    BodyState save() const override {
        BodyState state;
        state.numbers_ = {static_cast<double>(element_count_),
                          static_cast<double>(changes_),
                          static_cast<double>(motion_.position.size()),
                          static_cast<double>(elements_.quaternions().size_bytes()),
                          static_cast<double>(elements_.rotated_gradients().size_bytes()),
                          time_};
        for (const auto* vector : {&motion_.position, &motion_.velocity, &motion_.acceleration, &loads_.nodal}) {
            state.numbers_.insert(state.numbers_.end(), vector->begin(), vector->end());
        }
        step_->save(state.numbers_);
        elements_.save_watch(state.numbers_);
        for (const auto span : {elements_.quaternions(), elements_.rotated_gradients()}) {
            const auto bytes = std::as_bytes(span);
            state.solver_.insert(state.solver_.end(), bytes.begin(), bytes.end());
        }
        state.holds_ = holds_.save();
        state.sleeping_ = numbering_.sleeping.nodes;
        return state;
    }

    void restore(Scheduler& scheduler, const BodyState& state) override {
        std::span<const double> numbers = state.numbers_;
        const bool fits = numbers.size() > 6 && numbers[0] == static_cast<double>(element_count_) &&
                          numbers[1] == static_cast<double>(changes_) &&
                          numbers[2] == static_cast<double>(motion_.position.size()) &&
                          numbers[3] == static_cast<double>(elements_.quaternions().size_bytes()) &&
                          numbers[4] == static_cast<double>(elements_.rotated_gradients().size_bytes()) &&
                          state.numbers_.size() == save().numbers_.size();
        if (!fits) throw Error("restore: the state was saved by a body of another scene or other settings");
        take_sleepers(state.sleeping_);
        time_ = numbers[5];
        numbers = numbers.subspan(6);
        for (auto* vector : {&motion_.position, &motion_.velocity, &motion_.acceleration, &loads_.nodal}) {
            std::copy_n(numbers.begin(), vector->size(), vector->begin());
            numbers = numbers.subspan(vector->size());
        }
        const std::byte* bytes = state.solver_.data();
        for (const auto span : {elements_.quaternions(), elements_.rotated_gradients()}) {
            std::memcpy(span.data(), bytes, span.size_bytes());
            bytes += span.size_bytes();
        }
        holds_.restore(state.holds_);
        if (floor_.exists()) floor_.restore(holds_.contacts());
        step_->restore(scheduler, numbers);
        elements_.restore_watch(numbers);
    }

    const Settings& settings() const noexcept override { return settings_; }
    const StepTotals& totals() const noexcept override { return totals_; }
    void reset_totals() noexcept override { totals_ = {}; }

    std::size_t bytes() const noexcept override {
        using kernels::heap_bytes;
        return numbering_.bytes() + elements_.bytes() + step_->bytes() + heap_bytes(motion_.position) +
               heap_bytes(motion_.velocity) + heap_bytes(motion_.acceleration) + heap_bytes(loads_.nodal) +
               heap_bytes(before_hold_) + heap_bytes(mass_) + heap_bytes(rest_position_) + holds_.bytes() +
               floor_.bytes();
    }
    int blocks() const noexcept override { return numbering_.blocks(); }
    int coarse_unknowns() const noexcept override {
        return step_->coarse() == nullptr ? 0 : step_->coarse()->unknowns();
    }
    Work solve_work() const noexcept override {
        if (step_->matrix() == nullptr) return {};
        const auto product = step_->matrix()->work();
        const auto numbers = 4.0 * numbering_.free_count;
        const bool has_blocks = settings_.preconditioner != PreconditionerKind::none;
        const bool has_coarse = settings_.preconditioner == PreconditionerKind::coarse;
        const auto coarse = static_cast<double>(coarse_unknowns());
        // Vectors: p, s, x, r updated by one multiply-add each (8 flops a number), two dot products (4); z, w read, and
        // z written. Blocks: 15 flops and 6 numbers a node. Coarse space: 15 + 12 flops and offsets twice.
        const double vector_flops = numbers * 12 + (has_blocks ? numbers / 4 * 15 : 0) +
                                    (has_coarse ? numbers / 4 * 33 + 2 * coarse * coarse : 0);
        const double vector_bytes = numbers * (8 * sizeof(Accumulate) + 3 * sizeof(Real)) +
                                    (has_blocks ? numbers * 1.5 * sizeof(Real) : 0) +
                                    (has_coarse ? numbers * (2 * sizeof(Real) + sizeof(Accumulate)) : 0);
        return {product.flops + vector_flops, product.bytes + vector_bytes};
    }

  private:
    static ElasticElements<Real> make_elements(const Scene& scene, const Settings& settings,
                                               const kernels::NodeNumbering& numbering) {
        const kernels::KernelSet<Real>& kernels = kernels::kernel_set<Real>(settings.instruction_set);
        const ElasticLaw law{.model = settings.model, .tangent = settings.tangent};
        return ElasticElements<Real>(
            kernels, element_batches<Real>(scene, numbering, settings.scatter, kernels.width, mass_kind(settings)),
            numbering,
            // No operator: nothing reads the gradients but products for the critical step, which are matrix-free.
            is_explicit(settings.integrator) && law.is_rotated() ? kernels::GradientLayout::batches
                                                                 : gradient_layout(settings.matrix, law),
            settings.rotation, law);
    }

    std::unique_ptr<StepMethod<Real>> make_step(const Scene& scene) {
        if (is_explicit(settings_.integrator)) {
            if (scene.rayleigh_stiffness > 0) {
                throw Error(std::string(to_string(settings_.integrator)) +
                            ": damping proportional to the stiffness is for implicit integrators; expected "
                            "rayleigh_stiffness 0");
            }
            return std::make_unique<ExplicitStep<Real>>(elements_, mass_, settings_);
        }
        return std::make_unique<ImplicitStep<Real, Accumulate>>(
            elements_,
            OperatorDefinition{.tetrahedra = scene.mesh.tetrahedra(),
                               .nodal_mass = mass_,
                               .mass = mass_kind(settings_),
                               .scatter = settings_.scatter},
            settings_);
    }

    double critical_time_step(Scheduler& scheduler, double tolerance) {
        if (settings_.mass == MassKind::consistent) {
            throw Error("critical time step: the mass is consistent; explicit integrators need a lumped one");
        }
        const LargestEigenvalue eigenvalue = step_->largest_eigenvalue(scheduler, motion_.position.data(), tolerance);
        return critical_step(eigenvalue.upper_bound, loads_.rayleigh_mass, loads_.rayleigh_stiffness);
    }

    void require_stable_step(Scheduler& scheduler) {
        // A coarse bound is enough for most steps.
        for (const double tolerance : {1e-2, 1e-6}) {
            const double critical = critical_time_step(scheduler, tolerance);
            if (settings_.time_step <= critical) return;
            if (tolerance > 1e-6) continue;
            std::ostringstream text;
            text << to_string(settings_.integrator) << ": the time step of " << settings_.time_step
                 << " s is longer than the critical one of " << critical << " s; force_time_step takes it anyway";
            throw Error(text.str());
        }
    }

    void prepare_holds() {
        holds_.prepare(numbering_, time_ + settings_.time_step);
        if (holds_.empty()) return;
        before_hold_ = motion_.velocity;
        holds_.apply(motion_.position, motion_.velocity, settings_.time_step);
    }

    void run_stage(StepStage stage, Scheduler& scheduler, StepReport& report) {
        const StepSubject subject{
            .motion = motion_,
            .loads = loads_,
            .filter = holds_.filter(),
            .before_hold = holds_.empty() ? std::span<const double>() : std::span<const double>(before_hold_)};
        step_->run(stage, scheduler, subject, report, totals_);
    }

    /// Takes the step again and again, with the nodes that pass the floor held on it, until none does.
    void repeat_above_floor(Scheduler& scheduler) {
        while (floor_.add(numbering_, before_floor_.position, motion_.position)) {
            motion_ = before_floor_;
            --totals_.steps;
            totals_.lost -= report_.lost ? 1 : 0;
            holds_.set_contacts(floor_.contacts(), floor_.normal(), true);
            step_->forget();
            StepReport again;
            prepare_holds();
            for (const StepStage stage : step_stages) run_stage(stage, scheduler, again);
            report_.newton_iterations += again.newton_iterations;
            report_.conjugate_gradient_iterations += again.conjugate_gradient_iterations;
            report_.conjugate_gradient_residual = again.conjugate_gradient_residual;
            report_.repeated = report_.repeated || again.repeated;
            report_.lost = again.lost;
        }
    }

    /// Ends the contacts with the floor that would pull.
    void let_go_of_floor(Scheduler& scheduler) {
        if (!floor_.is_touched(numbering_)) return;
        elements_.evaluate(scheduler, motion_.position.data(),
                           {.rotation = settings_.model != ElementModel::linear, .force = true});
        for_each_awake_block(scheduler, numbering_, [&](int block) {
            elements_.merge_force(block);
            const std::size_t end = 4 * static_cast<std::size_t>(numbering_.block_begin[block + 1]);
            for (std::size_t i = 4 * static_cast<std::size_t>(numbering_.block_begin[block]); i < end; ++i) {
                const std::size_t axis = i % 4;
                before_hold_[i] = axis == 3 ? 0.0
                                            : static_cast<double>(elements_.force()[i]) + loads_.nodal[i] +
                                                  mass_[i / 4] * loads_.gravity[axis];
            }
        });
        if (settings_.model != ElementModel::linear) step_->forget_matrix();
        if (!floor_.let_go(numbering_, motion_.velocity, before_hold_, settings_.time_step)) return;
        holds_.set_contacts(floor_.contacts(), floor_.normal(), true);
        step_->forget_acceleration();
    }

    /// [internal node] 1: asleep; empty: none is.
    void take_sleepers(std::vector<std::uint8_t> nodes) {
        if (nodes == numbering_.sleeping.nodes) return;
        numbering_.sleeping = nodes.empty() ? kernels::SleepingNodes{} : elements_.sleeping(std::move(nodes));
        const auto sleepers = static_cast<std::int32_t>(numbering_.sleeping.nodes.size());
        for (std::int32_t node = 0; node < sleepers; ++node) {
            if (!numbering_.sleeping.has(node)) continue;
            for (auto* vector : {&motion_.velocity, &motion_.acceleration}) {
                if (!vector->empty()) std::fill_n(&(*vector)[4 * static_cast<std::size_t>(node)], 4, 0.0);
            }
        }
        holds_.change_sleepers();
        step_->change_sleepers();
    }

    std::int32_t internal_node(std::int32_t node) const {
        if (node < 0 || static_cast<std::size_t>(node) >= nodes()) {
            throw Error("node " + std::to_string(node) + " does not exist; the body has nodes 0 to " +
                        std::to_string(nodes() - 1));
        }
        return numbering_.internal_of_user[node];
    }

    void require_count(std::size_t count, const char* what) const {
        if (count != nodes()) {
            throw Error(std::to_string(count) + " " + what + " given; the body has " + std::to_string(nodes()) +
                        " nodes");
        }
    }

    void scatter_to_internal(std::span<const Point> values, kernels::AlignedVector<double>& nodal) const {
        for (std::size_t node = 0; node < values.size(); ++node) {
            std::copy_n(values[node].begin(), 3,
                        &nodal[4 * static_cast<std::size_t>(numbering_.internal_of_user[node])]);
        }
    }

    void gather_to_user(const kernels::AlignedVector<double>& nodal, std::span<Point> values) const {
        require_count(values.size(), "places");
        for (std::size_t node = 0; node < values.size(); ++node) {
            const double* const from = &nodal[4 * static_cast<std::size_t>(numbering_.internal_of_user[node])];
            values[node] = {from[0], from[1], from[2]};
        }
    }

    void forget_node(std::int32_t node) {
        std::fill_n(&loads_.nodal[4 * static_cast<std::size_t>(node)], 4, 0.0);
        holds_.forget(node);
        if (floor_.exists()) floor_.forget(node);
    }

    /// Takes the new numbering up, with what the nodes carry.
    void take_nodes(const BodyChange& change, std::span<const std::int32_t> numbers) {
        numbering_.internal_of_user.resize(static_cast<std::size_t>(change.first_node));
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            const BodyChange::Node& node = change.nodes[k];
            const auto at = static_cast<std::size_t>(numbers[k]);
            numbering_.user_of_internal[at] = static_cast<std::int32_t>(numbering_.internal_of_user.size());
            numbering_.internal_of_user.push_back(numbers[k]);
            std::copy_n(node.position.begin(), 3, &motion_.position[4 * at]);
            std::copy_n(node.velocity.begin(), 3, &motion_.velocity[4 * at]);
            if (node.before >= 0) continue;
            if (!motion_.acceleration.empty()) std::fill_n(&motion_.acceleration[4 * at], 4, 0.0);
            std::fill_n(&loads_.nodal[4 * at], 4, 0.0);
        }
        for (const PrescribedDisplacement& prescribed : change.prescribed) {
            const std::int32_t node = numbering_.internal_of_user[prescribed.node];
            holds_.prescribe(
                prescribed, node,
                rest_position_[4 * static_cast<std::size_t>(node) + static_cast<std::size_t>(prescribed.axis)]);
        }
        if (floor_.exists()) holds_.set_contacts(floor_.contacts(), floor_.normal(), true);
    }

    void add_hold(std::int32_t node, const Point& target, const Point& direction) {
        const std::int32_t internal = internal_node(node);
        if (!numbering_.is_free(internal)) {
            throw Error("hold: node " + std::to_string(node) + " is fixed for good");
        }
        require_finite(std::span(&target, 1), "hold: target");
        if (holds_.hold(internal, target, direction)) step_->forget_acceleration();
    }

    Settings settings_;
    std::size_t element_count_;
    kernels::NodeNumbering numbering_;
    ElasticElements<Real> elements_;
    std::vector<double> mass_;  ///< row sums, [internal node], kilograms
    std::unique_ptr<StepMethod<Real>> step_;
    Holds holds_;
    FloorContact floor_;
    BodyMotion before_floor_;
    BodyMotion motion_;
    BodyLoads loads_;
    kernels::AlignedVector<double> before_hold_;
    kernels::AlignedVector<double> rest_position_;
    StepTotals totals_;
    StepReport report_;  ///< of the step that is under way
    double time_ = 0;
    kernels::SpareNodes spare_nodes_{numbering_};
    std::int64_t changes_ = 0;
};

std::unique_ptr<DeformableBody> make_body(const Scene& scene, const Settings& settings, Scheduler& scheduler) {
    validate(settings);
    if (scene.mesh.tetrahedra().empty()) throw Error("scene: the mesh has no elements");
    for (const double value :
         {scene.gravity[0], scene.gravity[1], scene.gravity[2], scene.rayleigh_mass, scene.rayleigh_stiffness}) {
        if (!std::isfinite(value)) throw Error("scene: gravity and damping must be finite");
    }
    if (scene.rayleigh_mass < 0 || scene.rayleigh_stiffness < 0) throw Error("scene: damping must not be negative");
    if (!is_explicit(settings.integrator) && !settings.force_preconditioner) {
        require_preconditioner(scene, settings.preconditioner);
    }
    switch (settings.scalar) {
        case ScalarMode::single_precision:
            return std::make_unique<BodyOf<float, float>>(scene, settings, scheduler);
        case ScalarMode::mixed:
            return std::make_unique<BodyOf<float, double>>(scene, settings, scheduler);
        default:
            return std::make_unique<BodyOf<double, double>>(scene, settings, scheduler);
    }
}

}  // namespace lancet::runtime
