// Bodies that are stepped with contact forces: what bounces keeps its momentum, nothing passes through, nothing gains
// energy.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/runtime/collide/contact_meshes.hpp"
#include <gtest/gtest.h>

#include "lancet/runtime/collide/response.hpp"
#include "lancet/runtime/simulate/body.hpp"

namespace lancet::runtime {
namespace {

constexpr double time_step = 1e-3;

/// Rayleigh damping, in seconds, under which a block of 0.1 m comes to rest within a few tenths of a second: a third of
/// the critical damping of its first mode, some 70 rad / s.
constexpr double damped = 0.01;

/// A body with what is needed to touch others.
class Touchable {
  public:
    Touchable(const mesh::Box& box, const Point& gravity, bool is_fixed, Scheduler& scheduler, double damping = 0)
        : collidable_(testing::collidable(mesh::box(box))) {
        scene_.mesh = mesh::box(box);
        scene_.materials = {{0, {.young_modulus = 2e4, .poisson_ratio = 0.3, .density = 1000}}};
        scene_.gravity = gravity;
        scene_.rayleigh_stiffness = damping;
        if (is_fixed) {
            const auto bottom = scene_.mesh.node_set("z_min");
            scene_.fixed_nodes.assign(bottom.begin(), bottom.end());
        }
        Settings settings;
        settings.time_step = time_step;
        settings.scalar = ScalarMode::double_precision;
        settings.conjugate_gradients = {.iterations = 500, .tolerance = 1e-12};
        body_ = make_body(scene_, settings, scheduler);
        for (auto* vectors : {&positions_, &velocities_, &forces_}) vectors->resize(body_->nodes());
        snapshot();
    }

    void set_velocity(const Point& velocity) {
        std::ranges::fill(velocities_, velocity);
        body_->set_velocities(velocities_);
    }
    void snapshot() {
        body_->positions(positions_);
        body_->velocities(velocities_);
        collidable_.update(positions_);
        std::ranges::fill(forces_, Point{});
    }
    void step(Scheduler& scheduler) {
        body_->set_loads(forces_);
        body_->step(scheduler);
    }
    double mass() const {
        double sum = 0;
        for (std::size_t node = 0; node < positions_.size(); ++node) sum += nodal_mass(node);
        return sum;
    }
    Point momentum() const {
        Point sum{};
        for (std::size_t node = 0; node < velocities_.size(); ++node) {
            sum = add_scaled(sum, nodal_mass(node), velocities_[node]);
        }
        return sum;
    }
    double nodal_mass(std::size_t node) const { return body_->nodal_mass(static_cast<std::int32_t>(node)); }

    DeformableBody& body() { return *body_; }
    const CollidableBody& collidable() const { return collidable_; }
    std::span<const Point> positions() const { return positions_; }
    std::span<const Point> velocities() const { return velocities_; }
    std::span<Point> forces() { return forces_; }

  private:
    Scene scene_;
    std::unique_ptr<DeformableBody> body_;
    CollidableBody collidable_;
    std::vector<Point> positions_, velocities_, forces_;
};

/// The forces of each body's vertices in the other.
class Encounter {
  public:
    explicit Encounter(const Penalty& penalty) : penalty_(penalty) {}

    void add_forces(Scheduler& scheduler, Touchable& a, Touchable& b) {
        energy = deepest = 0;
        contacts = unresolved = 0;
        for (const auto& [first, second] : {std::pair{&a, &b}, {&b, &a}}) {
            finder_.find(scheduler, first->collidable(), second->collidable(), contacts_);
            add_penalty_forces(contacts_, penalty_, second->collidable().tetrahedra(), first->velocities(),
                               second->velocities(), first->forces(), second->forces());
            energy += penalty_energy(contacts_, penalty_);
            contacts += contacts_.size();
            unresolved += finder_.unresolved();
            for (const VertexContact& contact : contacts_) deepest = std::max(deepest, contact.depth);
        }
    }

    double energy = 0, deepest = 0;
    std::size_t contacts = 0, unresolved = 0;

  private:
    Penalty penalty_;
    VertexContactFinder finder_;
    std::vector<VertexContact> contacts_;
};

Point force_on(Touchable& body) {
    Point sum{};
    for (const Point& force : body.forces()) sum = add(sum, force);
    return sum;
}

/// The stiffness at which the step is half of the longest at which a spring on the lightest node is stable: dt = 2
/// sqrt(m / k).
double stable_stiffness(const Touchable& body) {
    double lightest = body.nodal_mass(0);
    for (std::size_t node = 0; node < body.positions().size(); ++node) {
        lightest = std::min(lightest, body.nodal_mass(node));
    }
    return lightest / (time_step * time_step);
}

TEST(ContactSimulation, BlocksBounceWithoutPassingAndKeepTheirMomentum) {
    const auto serial = make_scheduler(SchedulerKind::serial, 1);
    const double side = 0.1, speed = 0.3;
    Touchable lower({.cells = {5, 5, 5}, .size = {side, side, side}}, {}, false, *serial);
    Touchable upper({.cells = {4, 4, 4}, .size = {0.08, 0.08, 0.08}, .origin = {0.013, 0.008, side + 0.002}}, {}, false,
                    *serial);
    upper.set_velocity({0, 0, -speed});
    upper.snapshot();
    const double stiffness = std::min(stable_stiffness(lower), stable_stiffness(upper));
    Encounter encounter({stiffness, 0});
    const Point momentum = upper.momentum();
    const double start = upper.body().energies(*serial).total();
    // What can go into springs is the energy of the relative motion.
    const double reduced = lower.mass() * upper.mass() / (lower.mass() + upper.mass());
    const double available = reduced * speed * speed / 2;
    double deepest = 0;
    std::size_t most = 0;
    for (int step = 0; step < 300; ++step) {
        lower.snapshot();
        upper.snapshot();
        encounter.add_forces(*serial, lower, upper);
        deepest = std::max(deepest, encounter.deepest);
        most = std::max(most, encounter.contacts);
        EXPECT_EQ(encounter.unresolved, 0U) << step;
        const double energy =
            encounter.energy + lower.body().energies(*serial).total() + upper.body().energies(*serial).total();
        // The springs are integrated by symplectic Euler, whose energy swings by dt F . v / 2 about one that is kept;
        // implicit Euler takes energy from all.
        EXPECT_LT(energy, start + time_step / 2 * length(force_on(upper)) * speed + 1e-9 * start) << step;
        // Solves end at 1e-12 of their right-hand side, 300 times.
        const Point now = add(lower.momentum(), upper.momentum());
        EXPECT_LT(length(subtract(now, momentum)), 1e-9 * length(momentum)) << step;
        lower.step(*serial);
        upper.step(*serial);
    }
    EXPECT_GT(most, 25U);
    EXPECT_EQ(encounter.contacts, 0U) << "apart again";
    EXPECT_GT(upper.momentum()[2] / upper.mass(), lower.momentum()[2] / lower.mass());
    // Never so deep that one spring alone would hold all; a twentieth of a block is a quarter of an element.
    EXPECT_LT(deepest, std::sqrt(2 * available / stiffness));
    EXPECT_LT(deepest, 0.05 * side);
    EXPECT_GT(deepest, 0);
}

TEST(ContactSimulation, ABlockDroppedOnAnotherComesToRestOnIt) {
    const auto serial = make_scheduler(SchedulerKind::serial, 1);
    const double side = 0.1, drop = 0.01;
    const Point gravity{0, 0, -9.81};
    Touchable lower({.cells = {5, 5, 5}, .size = {side, side, side}}, gravity, true, *serial, damped);
    Touchable upper({.cells = {3, 3, 3}, .size = {0.06, 0.06, 0.06}, .origin = {0.02, 0.02, side + drop}}, gravity,
                    false, *serial, damped);
    const double stiffness = std::min(stable_stiffness(lower), stable_stiffness(upper));
    Encounter encounter({stiffness, 0.2 * stiffness * time_step});
    double deepest = 0;
    for (int step = 0; step < 1500; ++step) {
        lower.snapshot();
        upper.snapshot();
        encounter.add_forces(*serial, lower, upper);
        deepest = std::max(deepest, encounter.deepest);
        lower.step(*serial);
        upper.step(*serial);
    }
    // Half of an element at most.
    EXPECT_LT(deepest, side / 10);
    // At rest the contacts carry the weight: the force on the upper block is m g.
    const double weight = upper.mass() * 9.81;
    EXPECT_NEAR(force_on(upper)[2], weight, 0.01 * weight);
    EXPECT_LT(length(upper.momentum()), upper.mass() * 1e-3);
    EXPECT_LT(encounter.deepest, deepest);
}

TEST(ContactSimulation, ASpherePressedIntoABlockIsPushedBackWithWhatTheBlockBears) {
    const auto serial = make_scheduler(SchedulerKind::serial, 1);
    Touchable block({.cells = {6, 6, 6}, .size = {0.1, 0.1, 0.1}}, {}, true, *serial, damped);
    const Penalty penalty{stable_stiffness(block), 0};
    ToolMotion motion;
    motion.set(SphereTool{0.03}, {{0.048, 0.052, 0.1 + 0.03 - 0.006}});
    ToolContactFinder finder;
    std::vector<ToolContact> contacts;
    Wrench wrench;
    double start = 0, energy = 0;
    std::vector<Point> elastic(block.body().nodes());
    for (int step = 0; step < 1500; ++step) {
        block.snapshot();
        const auto surface = block.collidable().surface();
        finder.find(block.collidable().surface_boxes(), block.positions(), surface, motion, contacts);
        wrench = add_penalty_forces(contacts, penalty, surface, {}, {}, block.forces());
        energy = penalty_energy(contacts, penalty) + block.body().energies(*serial).total();
        if (step == 0) start = energy;
        EXPECT_LT(energy, 1.01 * start) << step;
        block.step(*serial);
    }
    // It has come to rest: the elastic forces of the free nodes bear the sphere.
    block.body().elastic_forces(*serial, elastic);
    Point borne{};
    for (const Point& force : elastic) borne = add(borne, force);
    EXPECT_GT(wrench.force[2], 0.1);
    EXPECT_LT(length(subtract(borne, wrench.force)), 1e-3 * length(wrench.force));
    Point expected{};
    for (const ToolContact& contact : contacts) {
        expected = add_scaled(expected, penalty.stiffness * contact.share * contact.depth, contact.normal);
    }
    EXPECT_LT(length(subtract(expected, wrench.force)), 1e-12 * length(expected));
    EXPECT_LT(energy, start);
}

}  // namespace
}  // namespace lancet::runtime
