// Nodes of a body that sleep while the others go on.
#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/schedule/graph_topology.hpp"

namespace lancet::test {
namespace {

using runtime::DeformableBody;
using runtime::Scene;
using runtime::Scheduler;
using runtime::Settings;

constexpr std::array cells{8, 2, 2};
constexpr std::int32_t of_one = 9 * 3 * 3;  ///< nodes of a bar

/// One clamped bar, or two in one mesh that nothing connects. The second is far away along the bars, so that most
/// blocks are of one bar alone, or beside the first, where all are of both.
enum class Second { none, behind, beside };

Scene bars(Second second) {
    ReferenceSolid solid = jittered_bar(cells, 0.1, 0.1, 301);
    fix_first_section(solid, cells);
    if (second != Second::none) {
        const ReferenceSolid other = solid;
        for (const Point& node : other.nodes) {
            solid.nodes.push_back(second == Second::behind ? Point{node[0] + 3, node[1], node[2]}
                                                           : Point{node[0], node[1], node[2] + 0.25});
        }
        for (const Tetrahedron& t : other.tetrahedra) {
            solid.tetrahedra.push_back({t[0] + of_one, t[1] + of_one, t[2] + of_one, t[3] + of_one});
        }
        solid.regions.insert(solid.regions.end(), other.regions.begin(), other.regions.end());
        for (const std::int32_t node : other.fixed) solid.fixed.push_back(node + of_one);
    }
    Scene scene = scene_of(solid);
    scene.gravity = {0, -9.81, 0};
    return scene;
}

/// [node] 1 for those of the second bar.
std::vector<std::uint8_t> second_asleep() {
    std::vector<std::uint8_t> asleep(2 * of_one, 0);
    std::fill(asleep.begin() + of_one, asleep.end(), std::uint8_t{1});
    return asleep;
}

Eigen::VectorXd first_of(const Eigen::VectorXd& nodal) {
    return nodal.head(3 * of_one);
}
Eigen::VectorXd second_of(const Eigen::VectorXd& nodal) {
    return nodal.tail(3 * of_one);
}

/// What acts on the first bar.
void act(DeformableBody& body, int step) {
    if (step == 2) {
        const Point at = body.position(8);
        // In an explicit step, which is short, it would come with a bang.
        const double lifted = runtime::is_explicit(body.settings().integrator) ? 0 : 0.005;
        body.hold(8, {at[0], at[1] + lifted, at[2]});
    }
    if (step == 9) body.release(8);
    if (step == 4) body.set_load(17, {0.3, 2, -0.5});
}

struct Variant {
    std::string name;
    std::function<void(Settings&)> change;
};

std::vector<Variant> variants() {
    using runtime::Integrator;
    std::vector<Variant> all;
    for (const auto kind : all_operators) {
        for (const auto preconditioner : all_preconditioners) {
            all.push_back({identifier(to_string(kind)) + "_" + identifier(to_string(preconditioner)), [=](Settings& s) {
                               s.matrix = kind;
                               s.preconditioner = preconditioner;
                           }});
        }
    }
    for (const auto scatter : all_scatters) {
        all.push_back({identifier(to_string(scatter)), [=](Settings& s) { s.scatter = scatter; }});
    }
    for (const auto model : all_models) {
        all.push_back({identifier(to_string(model)), [=](Settings& s) { set_model(s, model); }});
    }
    all.push_back(
        {"sparse_coarse_space", [](Settings& s) { s.numbering = {.nodes_per_block = 24, .nodes_per_aggregate = 4}; }});
    all.push_back({"rotation_bound", [](Settings& s) { s.rotation_bound = 1e-9; }});
    all.push_back({"newton", [](Settings& s) { s.newton_iterations = 4; }});
    all.push_back({"at_state", [](Settings& s) { s.linearisation = runtime::Linearisation::state; }});
    all.push_back({"consistent_mass", [](Settings& s) { s.mass = runtime::MassKind::consistent; }});
    all.push_back({"room", [](Settings& s) { s.numbering.spare_nodes = 64; }});
    const auto add = [&](Integrator integrator, double time_step) {
        all.push_back({identifier(to_string(integrator)), [=](Settings& s) {
                           s.integrator = integrator;
                           s.time_step = time_step;
                           s.energy_safeguard = false;
                       }});
    };
    add(Integrator::implicit_midpoint, 0.02);
    add(Integrator::newmark, 0.02);
    add(Integrator::symplectic_euler, 1e-4);
    add(Integrator::central_differences, 1e-4);
    all.push_back({"newmark_consistent_mass", [](Settings& s) {
                       s.integrator = Integrator::newmark;
                       s.mass = runtime::MassKind::consistent;
                       s.energy_safeguard = false;
                   }});
    return all;
}

class Sleep : public ::testing::TestWithParam<std::tuple<Variant, Second>> {
  protected:
    Settings settings = [] {
        Settings s = accurate_settings();
        s.time_step = 0.02;
        std::get<0>(GetParam()).change(s);
        return s;
    }();
    std::unique_ptr<Scheduler> scheduler = serial();
    std::unique_ptr<DeformableBody> alone = make_body(bars(Second::none), settings, *scheduler);
    std::unique_ptr<DeformableBody> both = make_body(bars(std::get<1>(GetParam())), settings, *scheduler);
};
INSTANTIATE_TEST_SUITE_P(Variants, Sleep,
                         ::testing::Combine(::testing::ValuesIn(variants()),
                                            ::testing::Values(Second::behind, Second::beside)),
                         [](const auto& instance) {
                             return std::get<0>(instance.param).name +
                                    (std::get<1>(instance.param) == Second::behind ? "_behind" : "_beside");
                         });

TEST_P(Sleep, LeavesSleepersWhereTheyAreAndTheRestAsIfItWereAlone) {
    // Both hang, and the second falls asleep as it swings.
    for (int step = 0; step < 5; ++step) {
        for (DeformableBody* body : {alone.get(), both.get()}) body->step(*scheduler);
    }
    both->set_asleep(second_asleep());
    EXPECT_FALSE(both->is_asleep(0));
    EXPECT_TRUE(both->is_asleep(of_one));
    both->set_load(of_one + 8, {0, 1, 0});
    // Newmark's accelerations are found anew, of all nodes, where another one is held.
    if (settings.integrator != runtime::Integrator::newmark) both->hold(of_one + 17, {0, 0, 0});
    const Eigen::VectorXd asleep = second_of(positions_of(*both));
    const Eigen::VectorXd start = positions_of(*alone);
    EXPECT_EQ(second_of(velocities_of(*both)).cwiseAbs().maxCoeff(), 0);
    // Explicit steps are short.
    const int steps = runtime::is_explicit(settings.integrator) ? 200 : 20;
    for (int step = 0; step < steps; ++step) {
        for (DeformableBody* body : {alone.get(), both.get()}) {
            act(*body, step);
            body->step(*scheduler);
        }
    }
    EXPECT_EQ(second_of(positions_of(*both)), asleep);
    EXPECT_EQ(second_of(velocities_of(*both)).cwiseAbs().maxCoeff(), 0);
    const double moved = (positions_of(*alone) - start).cwiseAbs().maxCoeff();
    ASSERT_GT(moved, 1e-3);
    EXPECT_LE((first_of(positions_of(*both)) - positions_of(*alone)).cwiseAbs().maxCoeff(), 1e-8 * moved);

    EXPECT_EQ(both->totals().coarse_failures, 0);

    // Awake again, both go on.
    both->set_asleep(std::vector<std::uint8_t>(2 * of_one, 0));
    EXPECT_FALSE(both->is_asleep(of_one));
    if (settings.integrator != runtime::Integrator::newmark) both->release(of_one + 17);
    for (int step = steps; step < steps + 5; ++step) {
        for (DeformableBody* body : {alone.get(), both.get()}) body->step(*scheduler);
    }
    EXPECT_GT((second_of(positions_of(*both)) - asleep).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LE((first_of(positions_of(*both)) - positions_of(*alone)).cwiseAbs().maxCoeff(), 1e-8 * moved);
}

TEST_P(Sleep, IsSaved) {
    for (int step = 0; step < 3; ++step) both->step(*scheduler);
    both->set_asleep(second_asleep());
    for (int step = 0; step < 3; ++step) both->step(*scheduler);
    const runtime::BodyState state = both->save();
    for (int step = 0; step < 10; ++step) {
        act(*both, step);
        both->step(*scheduler);
    }
    const Eigen::VectorXd position = positions_of(*both), velocity = velocities_of(*both);
    // Restored by one that has been awake, and by itself after it woke.
    const auto other = make_body(bars(std::get<1>(GetParam())), settings, *scheduler);
    for (DeformableBody* body : {other.get(), both.get()}) {
        body->set_asleep(std::vector<std::uint8_t>(2 * of_one, 0));
        for (int step = 0; step < 3; ++step) body->step(*scheduler);
        body->restore(*scheduler, state);
        EXPECT_TRUE(body->is_asleep(of_one));
        for (int step = 0; step < 10; ++step) {
            act(*body, step);
            body->step(*scheduler);
        }
        EXPECT_EQ(positions_of(*body), position);
        EXPECT_EQ(velocities_of(*body), velocity);
    }
}

/// Counts what loops run.
class CountingScheduler final : public Scheduler {
  public:
    runtime::SchedulerKind kind() const noexcept override { return inner_->kind(); }
    int threads() const noexcept override { return 1; }
    void for_each_block(int blocks, runtime::FunctionReference<void(int)> body) override {
        count += blocks;
        inner_->for_each_block(blocks, body);
    }
    std::unique_ptr<runtime::GraphExecution> prepare(const runtime::GraphTopology& topology) override {
        return inner_->prepare(topology);
    }

    std::int64_t count = 0;

  private:
    std::unique_ptr<Scheduler> inner_ = serial();
};

TEST(SleepOfABar, LeavesItsBlocksOut) {
    Settings settings = accurate_settings();
    settings.conjugate_gradients = {.iterations = 10};
    settings.coarse_change = 1e9;
    CountingScheduler scheduler;
    const auto both = make_body(bars(Second::behind), settings, scheduler);
    const auto in_a_step = [&] {
        both->step(scheduler);
        const std::int64_t before = scheduler.count;
        both->step(scheduler);
        return static_cast<double>(scheduler.count - before);
    };
    const double awake = in_a_step();
    EXPECT_EQ(both->totals().sleeping_blocks, 0);
    both->set_asleep(second_asleep());
    const double asleep = in_a_step();
    // Half of the blocks is of the second bar, but for one that may be of both.
    const std::int64_t left_out = both->totals().sleeping_blocks / 2;
    EXPECT_EQ(both->totals().sleeping_blocks % 2, 0);
    EXPECT_GE(left_out, both->blocks() / 2 - 1);
    EXPECT_NEAR(asleep / awake, 1 - static_cast<double>(left_out) / both->blocks(), 1e-9);

    // Everything asleep costs nothing at all.
    both->set_asleep(std::vector<std::uint8_t>(2 * of_one, 1));
    EXPECT_EQ(in_a_step(), 0);
}

TEST(SleepOfABar, IsTheSameOnEveryScheduler) {
    for (const Second second : {Second::behind, Second::beside}) {
        Settings settings;
        settings.numbering = {.nodes_per_block = 24, .nodes_per_aggregate = 12};
        Eigen::VectorXd position, velocity;
        for (const auto& scheduler : all_schedulers()) {
            const auto both = make_body(bars(second), settings, *scheduler);
            for (int step = 0; step < 20; ++step) {
                if (step == 5) both->set_asleep(second_asleep());
                if (step == 15) both->set_asleep(std::vector<std::uint8_t>(2 * of_one, 0));
                act(*both, step);
                both->step(*scheduler);
            }
            if (position.size() == 0) {
                position = positions_of(*both);
                velocity = velocities_of(*both);
            }
            EXPECT_EQ(positions_of(*both), position) << to_string(scheduler->kind()) << " " << scheduler->threads();
            EXPECT_EQ(velocities_of(*both), velocity) << to_string(scheduler->kind()) << " " << scheduler->threads();
        }
    }
}

TEST(SleepOfABar, CountsInEnergiesAndForces) {
    const auto scheduler = serial();
    const Settings settings = accurate_settings();
    const auto both = make_body(bars(Second::behind), settings, *scheduler);
    const auto like = make_body(bars(Second::behind), settings, *scheduler);
    for (int step = 0; step < 5; ++step) both->step(*scheduler);
    both->set_asleep(second_asleep());
    for (int step = 0; step < 5; ++step) both->step(*scheduler);
    like->set_positions(as_points(positions_of(*both)));
    like->set_velocities(as_points(velocities_of(*both)));
    const runtime::Energies energies = both->energies(*scheduler), expected = like->energies(*scheduler);
    EXPECT_NEAR(energies.kinetic, expected.kinetic, 1e-12 * expected.kinetic);
    EXPECT_NEAR(energies.elastic, expected.elastic, 1e-12 * expected.elastic);
    EXPECT_NEAR(energies.gravity, expected.gravity, 1e-12 * std::abs(expected.gravity));
    const Eigen::VectorXd force = elastic_forces_of(*like, *scheduler);
    EXPECT_LE((elastic_forces_of(*both, *scheduler) - force).norm(), 1e-9 * force.norm());
    EXPECT_GT(second_of(force).norm(), 0.1 * force.norm());
    // Who asks changes nothing.
    const auto unasked = make_body(bars(Second::behind), settings, *scheduler);
    for (int step = 0; step < 5; ++step) unasked->step(*scheduler);
    unasked->set_asleep(second_asleep());
    for (int step = 0; step < 15; ++step) unasked->step(*scheduler);
    for (int step = 0; step < 10; ++step) {
        both->energies(*scheduler);
        both->step(*scheduler);
    }
    EXPECT_LE((positions_of(*both) - positions_of(*unasked)).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_TRUE(second_of(positions_of(*both)) == second_of(positions_of(*unasked)));
}

TEST(SleepOfABar, KeepsItOnTheFloor) {
    // Both fall on the floor; the second sleeps there while the first is lifted and falls again.
    Scene scene = bars(Second::behind);
    scene.fixed_nodes.clear();
    scene.rayleigh_mass = 5;
    scene.floor = runtime::Floor{.point = {0, -0.03, 0}, .normal = {0, 1, 0}};
    const auto scheduler = serial();
    const auto both = make_body(scene, accurate_settings(), *scheduler);
    for (int step = 0; step < 60; ++step) both->step(*scheduler);
    both->set_asleep(second_asleep());
    const Eigen::VectorXd asleep = second_of(positions_of(*both));
    const Point end = both->position(8);
    both->hold(8, {end[0], end[1] + 0.2, end[2]});
    for (int step = 0; step < 10; ++step) both->step(*scheduler);
    EXPECT_GT(both->position(8)[1], end[1] + 0.1);
    both->release(8);
    for (int step = 0; step < 30; ++step) both->step(*scheduler);
    EXPECT_EQ(second_of(positions_of(*both)), asleep);
    // Awake, it rests as before: its contacts are there.
    both->set_asleep(std::vector<std::uint8_t>(2 * of_one, 0));
    for (int step = 0; step < 10; ++step) both->step(*scheduler);
    EXPECT_LE((second_of(positions_of(*both)) - asleep).cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_EQ(both->totals().lost, 0);
}

TEST(SleepOfABar, EndsWhereTheMotionIsSet) {
    const auto scheduler = serial();
    const auto both = make_body(bars(Second::behind), accurate_settings(), *scheduler);
    for (const bool moves : {true, false}) {
        both->set_asleep(second_asleep());
        ASSERT_TRUE(both->is_asleep(of_one));
        if (moves) {
            both->set_positions(as_points(positions_of(*both)));
        } else {
            both->set_velocities(as_points(velocities_of(*both)));
        }
        EXPECT_FALSE(both->is_asleep(of_one));
    }
}

TEST(SleepOfABar, IsOfWholeElements) {
    const auto scheduler = serial();
    const auto both = make_body(bars(Second::behind), accurate_settings(), *scheduler);
    std::vector<std::uint8_t> some = second_asleep();
    some[of_one + 40] = 0;
    EXPECT_THROW(both->set_asleep(some), Error);
    EXPECT_FALSE(both->is_asleep(of_one)) << "nothing has changed";
    EXPECT_THROW(both->set_asleep(std::span(some).first(3)), Error);
    EXPECT_THROW(both->is_asleep(2 * of_one), Error);
}

}  // namespace
}  // namespace lancet::test
