// Forces and products where elements are huge, inside out, flat, collapsed or not a number.
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "tests/kernels/layout/layouts_under_test.hpp"
#include "tests/runtime/solve/bodies_under_test.hpp"
#include <gtest/gtest.h>

namespace lancet::test {
namespace {

using runtime::OperatorKind;

class HostileState : public ArithmeticTest {
  protected:
    ReferenceSolid solid = jittered_bar({5, 3, 2}, 0.1, 0.15, 61);
    std::unique_ptr<runtime::Scheduler> scheduler = serial();

    std::unique_ptr<runtime::DeformableBody> body(OperatorKind kind, kernels::RotationMethod method) {
        runtime::Settings settings = accurate_settings();
        GetParam().set(settings);
        settings.matrix = kind;
        settings.rotation.method = method;
        return make_body(scene_of(solid), settings, *scheduler);
    }

    void expect_finite(const Eigen::VectorXd& x) {
        const Eigen::VectorXd z = random_vector(solid.unknowns(), 1, 62);
        for (const OperatorKind kind : all_operators) {
            for (const auto method :
                 {kernels::RotationMethod::robust, kernels::RotationMethod::polar, kernels::RotationMethod::svd}) {
                SCOPED_TRACE(::testing::Message() << to_string(kind) << ", " << to_string(method));
                const auto b = body(kind, method);
                b->set_positions(as_points(x));
                EXPECT_TRUE(elastic_forces_of(*b, *scheduler).allFinite());
                EXPECT_TRUE(std::isfinite(b->energies(*scheduler).elastic));
                const Eigen::VectorXd product = matrix_times(*b, *scheduler, z);
                EXPECT_TRUE(product.allFinite());
                EXPECT_GT(product.dot(z), 0);
            }
        }
    }
};
INSTANTIATE_TEST_SUITE_P(Arithmetics, HostileState, ::testing::ValuesIn(compiled_arithmetics()), ArithmeticName());

TEST_P(HostileState, GradientsUpToAMillionGiveFiniteForces) {
    const std::array<Eigen::Matrix3d, 3> gradients{
        Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Matrix3d(Eigen::Vector3d(1, -0.5, 0.1).asDiagonal()),
        (Eigen::Matrix3d() << 0.1, 1, 0.2, -0.7, 0.3, 0.5, 0.9, -0.2, 0.4).finished()};
    for (const double size : {1e3, 1e6}) {
        for (const Eigen::Matrix3d& gradient : gradients) {
            expect_finite(moved(solid.rest(), size * gradient, {0, 0, 0}));
        }
    }
}

TEST_P(HostileState, InvertedFlatAndCollapsedElementsGiveFiniteForces) {
    const auto with_axes = [&](double x, double y, double z) {
        return moved(solid.rest(), Eigen::Vector3d(x, y, z).asDiagonal(), {0.1, 0.2, 0.3});
    };
    for (const double tiny : {0.0, 1e-30, 1e-12}) {
        SCOPED_TRACE(tiny);
        expect_finite(with_axes(1, 1, tiny));        // flat
        expect_finite(with_axes(1, tiny, tiny));     // a line
        expect_finite(with_axes(tiny, tiny, tiny));  // a point
        expect_finite(with_axes(1, 1, -tiny));
    }
    expect_finite(with_axes(-1, 1, 1));
    expect_finite(with_axes(-1, -1, -1));
    expect_finite(with_axes(-1, -2, 0.5));
    expect_finite(random_vector(solid.unknowns(), 1, 63));
}

/// The elements alone: a body takes no position that is not finite.
template <class Real>
void expect_no_spreading(const ReferenceSolid& solid, kernels::InstructionSet instruction_set) {
    const auto scheduler = serial();
    const NodeNumbering numbering = numbered(solid, layout_options);
    const kernels::KernelSet<Real>& kernels = kernels::kernel_set<Real>(instruction_set);
    const Eigen::VectorXd x = solid.rest() + random_vector(solid.unknowns(), 0.02, 64);
    constexpr std::int32_t broken = 25;
    std::vector<bool> touched(solid.nodes.size(), false);
    for (const Tetrahedron& t : solid.tetrahedra) {
        if (std::find(t.begin(), t.end(), broken) == t.end()) continue;
        for (const std::int32_t node : t) touched[node] = true;
    }
    for (const OperatorKind kind : all_operators) {
        for (const auto scatter : all_scatters) {
            SCOPED_TRACE(::testing::Message() << to_string(kind) << ", " << to_string(scatter));
            runtime::ElasticElements<Real> elements(kernels, batches_of<Real>(solid, numbering, scatter, kernels.width),
                                                    numbering, gradient_layout(kind), {});
            runtime::OperatorDefinition definition{
                .tetrahedra = solid.tetrahedra,
                .nodal_mass = std::vector<double>(static_cast<std::size_t>(numbering.node_count), 1.0),
                .scatter = scatter};
            const auto matrix = make_operator(kind, elements, definition);
            kernels::AlignedVector<double> position(static_cast<std::size_t>(numbering.node_count) * 4, 0.0);
            kernels::AlignedVector<double> rest(position.size(), 0.0);
            kernels::AlignedVector<Real> z(position.size(), Real(0));
            for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const auto at = 4 * static_cast<std::size_t>(numbering.internal_of_user[node]) + axis;
                    position[at] = x[static_cast<Eigen::Index>(3 * node + axis)];
                    rest[at] = solid.nodes[node][axis];
                    z[at] = static_cast<Real>(position[at]);
                }
            }
            const auto force_and_product = [&] {
                elements.evaluate(*scheduler, position.data(), {});
                matrix->assemble(*scheduler, {.mass = 1, .stiffness = 1e-4});
                matrix->product(*scheduler, z.data());
                std::vector<Real> values;
                for (int block = 0; block < numbering.blocks(); ++block) {
                    elements.merge_force(block);
                    matrix->merge(block);
                }
                for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
                    const auto at = 4 * static_cast<std::size_t>(numbering.internal_of_user[node]);
                    for (const Real* source : {elements.force(), const_cast<const Real*>(matrix->buffer())}) {
                        values.insert(values.end(), source + at, source + at + 3);
                    }
                }
                return values;
            };
            elements.reset(*scheduler, rest.data());
            const std::vector<Real> sane = force_and_product();
            for (const double bad : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
                const auto at = 4 * static_cast<std::size_t>(numbering.internal_of_user[broken]);
                const double kept = std::exchange(position[at], bad);
                elements.reset(*scheduler, rest.data());
                const std::vector<Real> ill = force_and_product();
                position[at] = kept;
                const std::vector<Real> healed = force_and_product();
                for (std::size_t node = 0; node < solid.nodes.size(); ++node) {
                    for (std::size_t k = 6 * node; k < 6 * node + 6; ++k) {
                        if (touched[node]) continue;
                        EXPECT_EQ(ill[k], sane[k]) << "node " << node << " touches no element of node " << broken;
                    }
                }
                EXPECT_FALSE(std::isfinite(ill[6 * broken])) << "what is not a number stays visible";
                // Nothing of it is kept as the start of the next rotation: the same to the rounding of rotations
                // that were started elsewhere, times the stiffness.
                const double tolerance = 64 * static_cast<double>(std::numeric_limits<Real>::epsilon()) *
                                         (solid.materials[1].lambda() + 2 * solid.materials[1].mu()) * 0.1 * 0.1;
                for (std::size_t k = 0; k < sane.size(); ++k) EXPECT_NEAR(healed[k], sane[k], tolerance);
            }
        }
    }
}

TEST_P(HostileState, OneBadNodeDoesNotSpread) {
    if (GetParam().scalar == runtime::ScalarMode::double_precision) {
        expect_no_spreading<double>(solid, GetParam().instruction_set);
    } else {
        expect_no_spreading<float>(solid, GetParam().instruction_set);
    }
}

}  // namespace
}  // namespace lancet::test
