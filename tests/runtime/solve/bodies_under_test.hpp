#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/kernels/element/reference_solid.hpp"
#include <gtest/gtest.h>

#include "lancet/runtime/simulate/body.hpp"

namespace lancet::test {

/// The scene of a solid, without gravity.
inline runtime::Scene scene_of(const ReferenceSolid& solid) {
    runtime::Scene scene;
    scene.mesh = mesh::TetMesh({.nodes = solid.nodes, .tetrahedra = solid.tetrahedra, .regions = solid.regions});
    for (std::size_t region = 0; region < solid.materials.size(); ++region) {
        const ReferenceMaterial& m = solid.materials[region];
        scene.materials[static_cast<int>(region)] = {
            .young_modulus = m.young_modulus, .poisson_ratio = m.poisson_ratio, .density = m.density};
    }
    scene.fixed_nodes = solid.fixed;
    scene.gravity = {0, 0, 0};
    return scene;
}

/// Settings of a body whose linear systems are solved to `tolerance` in double.
inline runtime::Settings accurate_settings(double tolerance = 1e-12) {
    runtime::Settings settings;
    settings.scalar = runtime::ScalarMode::double_precision;
    settings.conjugate_gradients = {.iterations = 2000, .tolerance = tolerance};
    // A few blocks and aggregates even on the small bodies of the tests.
    settings.numbering = {.nodes_per_block = 24, .nodes_per_aggregate = 12};
    return settings;
}

/// Sets a model with a tangent that it has: the rotated one where there is one.
inline void set_model(runtime::Settings& settings, runtime::ElementModel model) {
    settings.model = model;
    settings.tangent = model == runtime::ElementModel::st_venant_kirchhoff ? runtime::TangentKind::exact
                                                                           : runtime::TangentKind::rotated;
}

inline std::unique_ptr<runtime::Scheduler> serial() {
    return runtime::make_scheduler(runtime::SchedulerKind::serial, 1);
}

inline Eigen::VectorXd positions_of(const runtime::DeformableBody& body) {
    std::vector<Point> points(body.nodes());
    body.positions(points);
    return as_vector(points);
}

inline Eigen::VectorXd velocities_of(const runtime::DeformableBody& body) {
    std::vector<Point> points(body.nodes());
    body.velocities(points);
    return as_vector(points);
}

inline Eigen::VectorXd elastic_forces_of(runtime::DeformableBody& body, runtime::Scheduler& scheduler) {
    std::vector<Point> points(body.nodes());
    body.elastic_forces(scheduler, points);
    return as_vector(points);
}

inline Eigen::VectorXd matrix_times(runtime::DeformableBody& body, runtime::Scheduler& scheduler,
                                    const Eigen::VectorXd& z) {
    std::vector<Point> result(body.nodes());
    body.apply_matrix(scheduler, as_points(z), result);
    return as_vector(result);
}

/// Text of an enumerator as part of a test's name.
inline std::string identifier(std::string_view text) {
    std::string name(text);
    for (char& c : name) c = c == '-' ? '_' : c;
    return name;
}

inline constexpr std::array all_models{runtime::ElementModel::linear, runtime::ElementModel::corotational,
                                       runtime::ElementModel::st_venant_kirchhoff};
inline constexpr std::array all_scalars{runtime::ScalarMode::single_precision, runtime::ScalarMode::mixed,
                                        runtime::ScalarMode::double_precision};
inline constexpr std::array all_operators{runtime::OperatorKind::matrix_free, runtime::OperatorKind::edge_blocks,
                                          runtime::OperatorKind::block_rows};
inline constexpr std::array all_scatters{kernels::ScatterStrategy::private_copies, kernels::ScatterStrategy::coloring,
                                         kernels::ScatterStrategy::node_gather};
inline constexpr std::array all_masses{runtime::MassKind::lumped, runtime::MassKind::consistent};
inline constexpr std::array all_preconditioners{runtime::PreconditionerKind::none, runtime::PreconditionerKind::jacobi,
                                                runtime::PreconditionerKind::block_jacobi,
                                                runtime::PreconditionerKind::coarse};

inline double epsilon_of(runtime::ScalarMode scalar) {
    return scalar == runtime::ScalarMode::double_precision ? 0x1p-52 : 0x1p-23;
}

/// An instruction set and a scalar mode.
struct Arithmetic {
    kernels::InstructionSet instruction_set;
    runtime::ScalarMode scalar;

    std::string name() const { return std::string(to_string(instruction_set)) + "_" + std::string(to_string(scalar)); }
    double epsilon() const { return epsilon_of(scalar); }
    void set(runtime::Settings& settings) const {
        settings.instruction_set = instruction_set;
        settings.scalar = scalar;
    }
};

inline std::vector<Arithmetic> compiled_arithmetics() {
    std::vector<Arithmetic> all;
    for (const kernels::InstructionSet instruction_set : kernels::compiled_instruction_sets()) {
        for (const runtime::ScalarMode scalar : all_scalars) all.push_back({instruction_set, scalar});
    }
    return all;
}

/// Tests over every arithmetic that is compiled in; skips what this machine cannot execute.
class ArithmeticTest : public ::testing::TestWithParam<Arithmetic> {
  protected:
    void SetUp() override {
        if (!kernels::is_executable(GetParam().instruction_set)) {
            GTEST_SKIP() << "not run: this processor cannot execute " << to_string(GetParam().instruction_set);
        }
    }
};
struct ArithmeticName {
    std::string operator()(const ::testing::TestParamInfo<Arithmetic>& info) const { return info.param.name(); }
};

/// Every scheduler that is compiled in with 1, 2 and 3 threads, the serial one first.
inline std::vector<std::unique_ptr<runtime::Scheduler>> all_schedulers() {
    std::vector<std::unique_ptr<runtime::Scheduler>> schedulers;
    for (const runtime::SchedulerKind kind : runtime::available_schedulers()) {
        for (const int threads : {1, 2, 3}) {
            schedulers.push_back(runtime::make_scheduler(kind, threads));
            if (kind == runtime::SchedulerKind::serial) break;
        }
    }
    return schedulers;
}

}  // namespace lancet::test
