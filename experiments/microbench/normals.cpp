#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "lancet/experiments/microbench/subjects.hpp"
#include "lancet/kernels/isa/kernel_set.hpp"
#include "lancet/kernels/layout/vertex_rings.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/mesh/surface/corner_normals.hpp"
#include "lancet/mesh/surface/vertex_normals.hpp"
#include "lancet/runtime/simulate/surface.hpp"

namespace lancet::experiments {

namespace {

using mesh::Point;

/// The surface of the Bar, its vertices moved a little so that no angle is a special one.
struct BarSurface {
    runtime::CarriedSurface surface;
    std::vector<Point> positions;

    BarSurface() {
        const mesh::TetMesh mesh = mesh::box({.cells = {40, 8, 8}, .size = {4, 0.8, 0.8}});
        surface = runtime::boundary_surface(mesh);
        std::mt19937 generator(2007);
        std::uniform_real_distribution<double> shift(-0.02, 0.02);
        for (const std::int32_t node : surface.vertices.as_nodes()) {
            positions.push_back(mesh.nodes()[static_cast<std::size_t>(node)]);
            for (double& coordinate : positions.back()) coordinate += shift(generator);
        }
    }
};

/// In double: every triangle, then every vertex.
std::vector<Point> normals_in_double(const BarSurface& bar, std::vector<Point>& of_corners) {
    std::vector<Point> normals(bar.positions.size());
    of_corners.resize(3 * bar.surface.triangles.size());
    mesh::corner_normals(bar.surface.triangles, bar.positions, of_corners);
    mesh::add_corner_normals(bar.surface.corners, of_corners, 0, normals.size(), normals);
    return normals;
}

/// Time of a triangle, all of whose vertices get their normals.
void measure_double(benchmark::State& state) {
    const BarSurface bar;
    std::vector<Point> of_corners;
    while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(bar.surface.triangles.size()))) {
        benchmark::DoNotOptimize(normals_in_double(bar, of_corners).data());
        benchmark::ClobberMemory();
    }
}

void measure_float(benchmark::State& state, kernels::InstructionSet set) {
    const BarSurface bar;
    const kernels::VertexRings& rings = bar.surface.rings;
    std::vector<Point> normals(bar.positions.size()), of_corners;
    std::vector<std::uint16_t> doubtful(static_cast<std::size_t>(rings.batches()));
    const kernels::VertexNormalArguments arguments{.slot_begin = rings.slot_begin.data(),
                                                   .vertices = rings.vertices.data(),
                                                   .neighbours = rings.neighbours.data(),
                                                   .positions = bar.positions.front().data(),
                                                   .normals = normals.front().data(),
                                                   .doubtful = doubtful.data()};
    const kernels::NormalKernels& kernels = kernels::kernel_set<float>(set).normals;
    while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(bar.surface.triangles.size()))) {
        kernels.vertex_normals(arguments, 0, rings.batches());
        benchmark::DoNotOptimize(normals.data());
        benchmark::ClobberMemory();
    }
    const std::vector<Point> expected = normals_in_double(bar, of_corners);
    double largest = 0;
    for (std::size_t vertex = 0; vertex < normals.size(); ++vertex) {
        const Point &n = normals[vertex], &e = expected[vertex];
        largest = std::max(largest, std::hypot(n[0] - e[0], n[1] - e[1], n[2] - e[2]));
    }
    state.counters["normal_error_max"] = largest;
}

}  // namespace

void register_normals() {
    benchmark::RegisterBenchmark("normals/vertices/double", measure_double);
    for (const kernels::InstructionSet set : instruction_sets_to_measure()) {
        const std::string name = "normals/vertices/float/" + std::string(kernels::to_string(set));
        benchmark::RegisterBenchmark(name.c_str(), [set](benchmark::State& state) { measure_float(state, set); });
    }
}

}  // namespace lancet::experiments
