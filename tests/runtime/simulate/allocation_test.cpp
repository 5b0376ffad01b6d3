// A step without a change of topology allocates nothing. Every malloc of the program is counted, on all threads.
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <new>

#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/simulate/simulation.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LANCET_SANITIZER_HAS_MALLOC 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define LANCET_SANITIZER_HAS_MALLOC 1
#endif
#endif
#if defined(__GLIBC__) && !defined(LANCET_SANITIZER_HAS_MALLOC)
#define LANCET_COUNTS_MALLOC 1
#endif

namespace {

constinit std::atomic<long> allocations{0};  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

}  // namespace

#if defined(LANCET_COUNTS_MALLOC)
// glibc's own functions under their other names; operator new and std::aligned_alloc end up in these.
// NOLINTBEGIN(cppcoreguidelines-no-malloc, cppcoreguidelines-owning-memory, bugprone-reserved-identifier)
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* memory, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void __libc_free(void* memory);

void* malloc(std::size_t bytes) {
    ++allocations;
    return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) {
    ++allocations;
    return __libc_calloc(count, bytes);
}
void* realloc(void* memory, std::size_t bytes) {
    ++allocations;
    return __libc_realloc(memory, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) {
    ++allocations;
    return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
    ++allocations;
    return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t bytes) {
    ++allocations;
    *memory = __libc_memalign(alignment, bytes);
    return *memory == nullptr ? ENOMEM : 0;
}
void free(void* memory) {
    __libc_free(memory);
}
}
// NOLINTEND(cppcoreguidelines-no-malloc, cppcoreguidelines-owning-memory, bugprone-reserved-identifier)
#endif

namespace lancet::test {
namespace {

struct Variant {
    std::string name;
    runtime::SchedulerKind scheduler;
    int threads;
    runtime::OperatorKind matrix;
    runtime::PreconditionerKind preconditioner;
    int nodes_per_aggregate;
    runtime::ScalarMode scalar = runtime::ScalarMode::single_precision;
    kernels::ScatterStrategy scatter = kernels::ScatterStrategy::private_copies;
    runtime::MassKind mass = runtime::MassKind::lumped;
};

std::vector<Variant> variants() {
    using runtime::OperatorKind;
    using runtime::PreconditionerKind;
    std::vector<Variant> all;
    for (const auto& [kind, threads] :
         {std::pair{runtime::SchedulerKind::serial, 1}, {runtime::SchedulerKind::threads, 3}}) {
        const std::string scheduler(to_string(kind));
        all.push_back(
            {scheduler + "_dense_coarse", kind, threads, OperatorKind::edge_blocks, PreconditionerKind::coarse, 24});
        // More than 120 unknowns: the sparse factorisation.
        all.push_back(
            {scheduler + "_sparse_coarse", kind, threads, OperatorKind::edge_blocks, PreconditionerKind::coarse, 4});
        all.push_back({scheduler + "_matrix_free_coarse", kind, threads, OperatorKind::matrix_free,
                       PreconditionerKind::coarse, 24, runtime::ScalarMode::mixed, kernels::ScatterStrategy::coloring,
                       runtime::MassKind::consistent});
        all.push_back({scheduler + "_block_rows", kind, threads, OperatorKind::block_rows,
                       PreconditionerKind::block_jacobi, 24, runtime::ScalarMode::double_precision,
                       kernels::ScatterStrategy::node_gather});
    }
    return all;
}

class StepAllocation : public ::testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(Variants, StepAllocation, ::testing::ValuesIn(variants()),
                         [](const auto& instance) { return instance.param.name; });

TEST(AllocationCount, SeesEveryWayToAllocate) {
#if !defined(LANCET_COUNTS_MALLOC)
    GTEST_SKIP() << "not run: malloc cannot be counted in this build";
#endif
    const auto count = [](const auto& function) {
        const long before = allocations;
        function();
        return allocations - before;
    };
    EXPECT_GE(count([] { const std::vector<int> some(100, 1); }), 1);
    EXPECT_GE(count([] { const kernels::AlignedVector<float> some(100, 1); }), 1);
    EXPECT_GE(count([] { const Eigen::VectorXd some = Eigen::VectorXd::Zero(1000); }), 1);
}

runtime::Settings settings_of(const Variant& variant) {
    runtime::Settings settings;
    settings.matrix = variant.matrix;
    settings.preconditioner = variant.preconditioner;
    settings.scalar = variant.scalar;
    settings.scatter = variant.scatter;
    settings.mass = variant.mass;
    settings.coarse_change = 0;  // refreshed at every step
    settings.numbering = {.nodes_per_block = 24, .nodes_per_aggregate = variant.nodes_per_aggregate};
    return settings;
}

TEST_P(StepAllocation, IsNone) {
#if !defined(LANCET_COUNTS_MALLOC)
    GTEST_SKIP() << "not run: malloc cannot be counted in this build";
#endif
    const Variant& variant = GetParam();
    ReferenceSolid solid = jittered_bar({10, 3, 2}, 0.1, 0.1, 141);
    fix_first_section(solid, {10, 3, 2});
    runtime::Scene scene = scene_of(solid);
    scene.gravity = {0, -9.81, 0};
    scene.rayleigh_stiffness = 0.001;
    const auto scheduler = runtime::make_scheduler(variant.scheduler, variant.threads);
    const auto body = make_body(scene, settings_of(variant), *scheduler);
    if (variant.preconditioner == runtime::PreconditionerKind::coarse) {
        ASSERT_EQ(body->coarse_unknowns() > 120, variant.nodes_per_aggregate == 4);
    }
    std::vector<Point> positions(body->nodes()), violent(body->nodes());
    for (std::size_t node = 0; node < violent.size(); ++node) {
        violent[node] = {node % 2 == 0 ? 5.0 : -5.0, node % 3 == 0 ? 5.0 : -5.0, 0};
    }
    body->hold(10, {1.05, 0.02, 0});
    for (int step = 0; step < 2; ++step) body->step(*scheduler);
    const auto refreshes = body->totals().coarse_refreshes;
    const long before = allocations;
    for (int step = 0; step < 10; ++step) {
        body->hold(10, {1.05, 0.02 + 0.01 * step, 0});
        body->step(*scheduler);
        body->positions(positions);
    }
    EXPECT_EQ(allocations - before, 0) << "in ten steps";
    // The safeguard too.
    body->set_velocities(violent);
    const long before_repeat = allocations;
    for (int step = 0; step < 3; ++step) body->step(*scheduler);
    EXPECT_EQ(allocations - before_repeat, 0) << "with repeated steps";
    EXPECT_GT(body->totals().repeats, 0);
    if (variant.preconditioner == runtime::PreconditionerKind::coarse) {
        EXPECT_GE(body->totals().coarse_refreshes, refreshes + 10);
    }
}

TEST_P(StepAllocation, IsNoneWhileSomeSleep) {
#if !defined(LANCET_COUNTS_MALLOC)
    GTEST_SKIP() << "not run: malloc cannot be counted in this build";
#endif
    const Variant& variant = GetParam();
    ReferenceSolid solid = jittered_bar({10, 3, 2}, 0.1, 0.1, 141);
    const std::size_t half = solid.nodes.size(), elements = solid.tetrahedra.size();
    for (std::size_t node = 0; node < half; ++node) {
        const Point at = solid.nodes[node];
        solid.nodes.push_back({at[0] + 2, at[1], at[2]});
    }
    for (std::size_t element = 0; element < elements; ++element) {
        Tetrahedron nodes = solid.tetrahedra[element];
        for (std::int32_t& node : nodes) node += static_cast<std::int32_t>(half);
        solid.tetrahedra.push_back(nodes);
        solid.regions.push_back(solid.regions[element]);
    }
    runtime::Scene scene = scene_of(solid);
    scene.gravity = {0, -9.81, 0};
    const auto scheduler = runtime::make_scheduler(variant.scheduler, variant.threads);
    const auto body = make_body(scene, settings_of(variant), *scheduler);
    std::vector<std::uint8_t> asleep(body->nodes(), 0);
    std::fill(asleep.begin() + static_cast<std::ptrdiff_t>(half), asleep.end(), std::uint8_t{1});
    body->hold(10, {1.05, 0.02, 0});
    body->step(*scheduler);
    body->set_asleep(asleep);
    for (int step = 0; step < 2; ++step) body->step(*scheduler);
    const long before = allocations;
    for (int step = 0; step < 10; ++step) {
        body->hold(10, {1.05, 0.02 + 0.01 * step, 0});
        body->step(*scheduler);
    }
    EXPECT_EQ(allocations - before, 0) << "in ten steps";
    EXPECT_GT(body->totals().sleeping_blocks, 0);
}

// A world with everything but a cut: two bodies that touch, a tool that pushes, surfaces, collision, force feedback.
TEST(SimulationAllocation, IsNone) {
#if !defined(LANCET_COUNTS_MALLOC)
    GTEST_SKIP() << "not run: malloc cannot be counted in this build";
#endif
    for (const auto& [kind, threads] :
         {std::pair{runtime::SchedulerKind::serial, 1}, {runtime::SchedulerKind::threads, 3}}) {
        const auto scheduler = runtime::make_scheduler(kind, threads);
        runtime::Simulation simulation(*scheduler, {.time_step = 0.01, .frame_rate = 100});
        for (const double height : {0.0, 0.29}) {
            runtime::BodyDefinition body;
            body.scene.mesh = mesh::box({.cells = {6, 3, 3}, .size = {0.6, 0.3, 0.3}, .origin = {0, height, 0}});
            const auto nodes = body.scene.mesh.node_set("x_min");
            body.scene.fixed_nodes.assign(nodes.begin(), nodes.end());
            body.scene.materials[0].young_modulus = 1e6;
            body.settings.time_step = 0.01;
            body.can_be_cut = true;
            simulation.add_body(std::move(body));
        }
        const int tool = simulation.add_tool({.shape = runtime::SphereTool{.radius = 0.05}});
        simulation.keep_surfaces();
        const auto step = [&](int number) {
            simulation.move(tool, {.position = {0.5, 0.62 + 0.001 * (number % 2), 0.15}}, runtime::ToolAction::touch);
            simulation.step();
        };
        for (int number = 0; number < 40; ++number) step(number);
        ASSERT_FALSE(simulation.latest_forces(tool)->anchors.empty());
        const long before = allocations;
        for (int number = 0; number < 20; ++number) step(number);
        EXPECT_EQ(allocations - before, 0) << runtime::to_string(kind);
    }
}

}  // namespace
}  // namespace lancet::test
