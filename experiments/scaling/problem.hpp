#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lancet/experiments/bar/lancet_options.hpp"
#include "lancet/experiments/bar/problem.hpp"
#include "lancet/runtime/simulate/scene.hpp"

namespace lancet::experiments::scaling {

/// A benchmark of Jerabkova (2007) at some number of elements.
struct Benchmark {
    std::string name;        ///< bar or organ
    bar::Problem problem{};  ///< the organ has no fixed nodes
    runtime::ElementModel model = runtime::ElementModel::corotational;
    std::optional<runtime::Floor> floor{};
};

/// "bar", "organ".
[[nodiscard]] const std::vector<std::string>& benchmark_names();

/// The elements of a benchmark in its own definition, about: 12,800 and 20,870.
[[nodiscard]] int own_elements(const std::string& name);

/// The cells of a Bar of about so many elements, five to a cell, five times as many cells along it as across.
[[nodiscard]] std::array<int, 3> bar_cells(int elements);

/// Rings and layers of an organ (see organ_mesh) of about so many elements.
[[nodiscard]] std::array<int, 2> organ_cells(int elements);

/// The benchmark `name` with about that many elements and that many steps of 40 ms:
/// - bar: the Bar's size, material and clamped end, whatever the cells (see bar::ProblemOptions);
/// - organ: a closed body 1 m long of a linear material of 0.1 MPa, 0.33 and 1,000 kg/m^3, so with a constant
///   operator, that falls 0.1 m onto a floor. The original body, its length and its height are not known; this length
///   makes a step as long as the Bar makes it, in which waves cross a dozen elements.
/// Throws lancet::Error for a name that is none, and for less than 100 elements.
[[nodiscard]] Benchmark make_benchmark(const std::string& name, int elements, int steps);

/// The benchmark as the library takes it.
[[nodiscard]] runtime::Scene scene_of(const Benchmark& benchmark);

/// The time at which errors are measured, s, where the steps get there.
constexpr double error_time = 1;

/// A name for the converged solution at error_time: a hash of all that it depends on, but for the number of steps.
[[nodiscard]] std::string solution_key(const Benchmark& benchmark);

}  // namespace lancet::experiments::scaling
