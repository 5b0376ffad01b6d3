// Saving and restoring a body.
#include <array>
#include <functional>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

#include "lancet/kernels/error.hpp"

namespace lancet::test {
namespace {

struct Variant {
    std::string name;
    std::function<void(runtime::Settings&)> change;
};

std::vector<Variant> variants() {
    using runtime::OperatorKind;
    std::vector<Variant> all{
        {"defaults", [](runtime::Settings&) {}},
        {"interval_5",
         [](runtime::Settings& s) {
             s.rotation_interval = 5;
             s.energy_safeguard = false;
         }},
        {"interval_5_state_matrix_free",
         [](runtime::Settings& s) {
             s.rotation_interval = 5;
             s.energy_safeguard = false;
             s.linearisation = runtime::Linearisation::state;
             s.matrix = OperatorKind::matrix_free;
         }},
        {"interval_5_block_jacobi",
         [](runtime::Settings& s) {
             s.rotation_interval = 5;
             s.energy_safeguard = false;
             s.preconditioner = runtime::PreconditionerKind::block_jacobi;
             s.matrix = OperatorKind::block_rows;
         }},
        {"rotation_bound", [](runtime::Settings& s) { s.rotation_bound = 0.02; }},
        {"linear", [](runtime::Settings& s) { s.model = runtime::ElementModel::linear; }},
        {"quaternion_method", [](runtime::Settings& s) { s.rotation.method = kernels::RotationMethod::quaternion; }},
        {"newton", [](runtime::Settings& s) { s.newton_iterations = 3; }},
        {"seldom_refreshed_coarse_space", [](runtime::Settings& s) { s.coarse_change = 0.5; }},
        {"sparse_coarse_space",
         [](runtime::Settings& s) {
             s.coarse_change = 0.3;
             s.numbering = {.nodes_per_block = 24, .nodes_per_aggregate = 4};
         }},
        {"midpoint",
         [](runtime::Settings& s) {
             s.integrator = runtime::Integrator::implicit_midpoint;
             s.energy_safeguard = false;
         }},
    };
    return all;
}

class SavedState : public ::testing::TestWithParam<std::tuple<Variant, runtime::ScalarMode>> {
  protected:
    ReferenceSolid solid = [] {
        ReferenceSolid bar = jittered_bar({8, 2, 2}, 0.1, 0.1, 101);
        fix_first_section(bar, {8, 2, 2});
        return bar;
    }();
    std::unique_ptr<runtime::Scheduler> scheduler = serial();

    std::unique_ptr<runtime::DeformableBody> body() {
        runtime::Settings settings;
        settings.numbering = {.nodes_per_block = 24, .nodes_per_aggregate = 12};
        settings.scalar = std::get<1>(GetParam());
        std::get<0>(GetParam()).change(settings);
        runtime::Scene scene = scene_of(solid);
        scene.gravity = {0, -9.81, 0};
        return make_body(scene, settings, *scheduler);
    }
    /// The holds and loads of a step.
    void act(runtime::DeformableBody& b, int step) {
        const Point rest = solid.nodes[8];
        if (step == 2) b.hold(8, {rest[0], rest[1] + 0.05, rest[2]});
        if (step == 4) b.hold(17, solid.nodes[17], {0, 0, 1});
        if (step == 12) b.release(8);
        if (step == 3) b.set_loads(as_points(random_vector(solid.unknowns(), 0.5, 102)));
    }
};
INSTANTIATE_TEST_SUITE_P(Variants, SavedState,
                         ::testing::Combine(::testing::ValuesIn(variants()), ::testing::ValuesIn(all_scalars)),
                         [](const auto& instance) {
                             return std::get<0>(instance.param).name + "_" +
                                    std::string(to_string(std::get<1>(instance.param)));
                         });

TEST_P(SavedState, GoesOnBitForBit) {
    for (const int saved_after : {0, 1, 5, 8}) {
        SCOPED_TRACE(saved_after);
        const auto original = body();
        for (int step = 0; step < saved_after; ++step) {
            act(*original, step);
            original->step(*scheduler);
        }
        const runtime::BodyState state = original->save();
        std::vector<Eigen::VectorXd> positions, velocities;
        constexpr int end = 16;
        for (int step = saved_after; step < end; ++step) {
            act(*original, step);
            original->step(*scheduler);
            positions.push_back(positions_of(*original));
            velocities.push_back(velocities_of(*original));
        }
        ASSERT_GT((positions.back() - solid.rest()).cwiseAbs().maxCoeff(), 1e-3);
        const double time = original->time();
        // A body of its own, and the original after it went elsewhere.
        const auto other = body();
        for (runtime::DeformableBody* b : {other.get(), original.get()}) {
            b->restore(*scheduler, state);
            for (int step = saved_after; step < end; ++step) {
                act(*b, step);
                b->step(*scheduler);
                const auto at = static_cast<std::size_t>(step - saved_after);
                ASSERT_EQ(positions_of(*b), positions[at]) << "step " << step;
                ASSERT_EQ(velocities_of(*b), velocities[at]) << "step " << step;
            }
            EXPECT_EQ(b->time(), time);
        }
    }
}

TEST(BodyState, OfAnotherSceneOrOtherSettingsIsRefused) {
    const auto scheduler = serial();
    const ReferenceSolid one = jittered_bar({3, 2, 2}, 0.1, 0.1, 1), other = jittered_bar({4, 2, 2}, 0.1, 0.1, 1);
    const auto body = make_body(scene_of(one), {}, *scheduler);
    EXPECT_THROW(body->restore(*scheduler, make_body(scene_of(other), {}, *scheduler)->save()), Error);
    EXPECT_THROW(body->restore(*scheduler, {}), Error);
    runtime::Settings in_double;
    in_double.scalar = runtime::ScalarMode::double_precision;
    EXPECT_THROW(body->restore(*scheduler, make_body(scene_of(one), in_double, *scheduler)->save()), Error);
    runtime::Settings block_jacobi;
    block_jacobi.preconditioner = runtime::PreconditionerKind::block_jacobi;
    EXPECT_THROW(body->restore(*scheduler, make_body(scene_of(one), block_jacobi, *scheduler)->save()), Error);
    EXPECT_NO_THROW(body->restore(*scheduler, make_body(scene_of(one), {}, *scheduler)->save()));
}

}  // namespace
}  // namespace lancet::test
