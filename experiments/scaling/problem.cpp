#include "lancet/experiments/scaling/problem.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "lancet/experiments/bar/reference.hpp"
#include "lancet/experiments/common/hash.hpp"
#include "lancet/experiments/common/organ_mesh.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::scaling {
namespace {

int rounded(double value) {
    return std::max(1, static_cast<int>(std::lround(value)));
}

Benchmark make_bar(int elements, int steps) {
    bar::ProblemOptions options;
    options.cells = bar_cells(elements);
    options.steps = steps;
    return {.name = "bar", .problem = bar::make_problem(options)};
}

/// The same mesh with that extent along x.
mesh::TetMesh with_length(const mesh::TetMesh& mesh, double length) {
    const auto bounds = mesh.bounds();
    const double scale = length / (bounds[1][0] - bounds[0][0]);
    mesh::TetMesh::Definition definition = mesh.definition();
    for (mesh::Point& node : definition.nodes) {
        for (double& coordinate : node) coordinate *= scale;
    }
    return mesh::TetMesh(std::move(definition));
}

Benchmark make_organ(int elements, int steps) {
    constexpr double length = 1, fall = 0.1;  // m
    const auto [rings, layers] = organ_cells(elements);
    Benchmark benchmark{.name = "organ", .model = runtime::ElementModel::linear};
    bar::Problem& problem = benchmark.problem;
    problem.mesh = with_length(organ_mesh(rings, layers), length);
    problem.young_modulus = 1e5;
    problem.poisson_ratio = 0.33;
    problem.density = 1000;
    problem.gravity = {0, 0, -9.81};
    problem.time_step = bar::ProblemOptions{}.time_step;
    problem.steps = steps;
    problem.length = length;
    benchmark.floor = runtime::Floor{.point = {0, 0, problem.mesh.bounds()[0][2] - fall}, .normal = {0, 0, 1}};
    return benchmark;
}

}  // namespace

const std::vector<std::string>& benchmark_names() {
    static const std::vector<std::string> names{"bar", "organ"};
    return names;
}

int own_elements(const std::string& name) {
    return name == "organ" ? 20'870 : 12'800;
}

std::array<int, 3> bar_cells(int elements) {
    const int across = rounded(std::cbrt(elements / 25.0));  // 5 (5 n) n n
    return {rounded(elements / (5.0 * across * across)), across, across};
}

std::array<int, 2> organ_cells(int elements) {
    // 18 rings^2 layers elements; cells are best shaped with 16 layers to 3 rings.
    const int rings = rounded(std::cbrt(elements / 96.0));
    return {rings, rounded(elements / (18.0 * rings * rings))};
}

Benchmark make_benchmark(const std::string& name, int elements, int steps) {
    if (elements < 100) throw Error(std::to_string(elements) + " elements found, expected 100 or more");
    if (steps < 1) throw Error(std::to_string(steps) + " steps found, expected 1 or more");
    if (name == "bar") return make_bar(elements, steps);
    if (name == "organ") return make_organ(elements, steps);
    throw Error("benchmark '" + name + "' found, expected bar or organ");
}

runtime::Scene scene_of(const Benchmark& benchmark) {
    runtime::Scene scene = bar::scene_of(benchmark.problem);
    scene.floor = benchmark.floor;
    return scene;
}

std::string solution_key(const Benchmark& benchmark) {
    Hash hash;
    bar::add_to(hash, benchmark.problem);
    hash.add(std::span<const double>(&error_time, 1));
    if (benchmark.floor) {
        hash.add(std::span<const double>(benchmark.floor->point));
        hash.add(std::span<const double>(benchmark.floor->normal));
    }
    return hash.text();
}

}  // namespace lancet::experiments::scaling
