#include "lancet/experiments/precision/static_problem.hpp"

#include "lancet/mesh/boundary.hpp"
#include "lancet/runtime/simulate/loads.hpp"

namespace lancet::experiments::precision {

using runtime::ElementModel;

mesh::Point StaticProblem::tip_point() const {
    return {options.size[0], options.size[1] / 2, options.size[2] / 2};
}

mesh::Box StaticProblem::box(int level) const {
    mesh::Box result{.cells = options.cells, .size = options.size};
    for (int& cells : result.cells) cells <<= level;
    return result;
}

std::vector<StaticProblem> static_problems() {
    // Published displacements: 20-node hexahedra, up to 3,240 and 4,320 of them, of a code apart from this project; the
    // finest of three meshes, whose last two differ by a few units of the fourth digit.
    const std::string hexahedra = "20-node hexahedra, three meshes";
    bar::ProblemOptions bar;
    bar.cells = {10, 2, 2};
    bar.size = {1.0, 0.2, 0.2};
    bar::ProblemOptions long_bar = bar;
    long_bar.size = {4.0, 0.8, 0.8};
    bar::ProblemOptions beam;  // of Schoch 2013, without its cut; bent across its smallest side
    beam.cells = {13, 2, 4};
    beam.size = {0.2, 0.03, 0.06};
    beam.young_modulus = 3e5;
    beam.poisson_ratio = 0.35;
    beam.density = 1070;
    bar::ProblemOptions cantilever;  // of Nienhuys 2003
    cantilever.cells = {16, 4, 4};
    cantilever.size = {1.2, 0.2, 0.3};
    cantilever.young_modulus = 1e6;
    cantilever.poisson_ratio = 0;
    cantilever.gravity = {0, 0, 0};
    const std::string two_meshes = "20-node hexahedra, two meshes";
    return {
        {.problem = "bar-static",
         .variant = "1 m",
         .model = ElementModel::corotational,
         .options = bar,
         .tip = {{-0.066902940, -0.34383376, {}}},
         .source = hexahedra,
         .source_percent = 0.02,
         .levels = 4},
        {.problem = "bar-static",
         .variant = "4 m",
         .model = ElementModel::corotational,
         .options = long_bar,
         .tip = {{-1.6487665, -3.1257352, {}}},
         .source = hexahedra,
         .source_percent = 0.1,
         .is_quick = false},  // bends so far that small meshes say nothing about it
        {.problem = "bar-static",
         .variant = "1 m, St. Venant-Kirchhoff",
         .model = ElementModel::st_venant_kirchhoff,
         .options = bar,
         .tip = {{-0.069301277, -0.34486856, {}}},
         .source = two_meshes,
         .source_percent = 0.1},
        // Timoshenko's formula with Cowper's shear coefficient 5/6: P l^3 / 3 E I + P l / k G A. Nienhuys compared with
        // the first term alone, 8.64e-3 m.
        {.problem = "cantilever",
         .variant = "linear",
         .model = ElementModel::linear,
         .options = cantilever,
         .end_load = {0, -3, 0},
         .tip = {{{}, -8.784e-3, {}}},
         .source = "Timoshenko's formula (8.64e-3 without shear)",
         .source_percent = 0.1},
        {.problem = "beam",
         .variant = "linear",
         .model = ElementModel::linear,
         .options = beam,
         .tip = {{0.0, -0.092509919, {}}},
         .source = hexahedra,
         .source_percent = 0.02},
        {.problem = "beam",
         .variant = "corotational",
         .model = ElementModel::corotational,
         .options = beam,
         .tip = {{-0.019247772, -0.080916943, {}}},
         .source = hexahedra,
         .source_percent = 0.02},
        {.problem = "beam",
         .variant = "St. Venant-Kirchhoff",
         .model = ElementModel::st_venant_kirchhoff,
         .options = beam,
         .tip = {{-0.019659689, -0.081090567, {}}},
         .source = two_meshes,
         .source_percent = 0.1},
    };
}

bar::ProblemOptions options_of(const StaticProblem& problem, int level) {
    bar::ProblemOptions options = problem.options;
    options.cells = problem.box(level).cells;
    return options;
}

runtime::Scene scene_of(const StaticProblem& problem, int level) {
    const bar::ProblemOptions& options = problem.options;
    runtime::Scene scene;
    scene.mesh = mesh::box(problem.box(level));
    scene.materials = {{0, {options.young_modulus, options.poisson_ratio, options.density}}};
    const auto fixed = scene.mesh.node_set("x_min");
    scene.fixed_nodes.assign(fixed.begin(), fixed.end());
    scene.gravity = options.gravity;
    const double area = options.size[1] * options.size[2];
    runtime::Traction traction{.triangles = {}, .force_per_area = {}};
    bool is_loaded = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        traction.force_per_area[axis] = problem.end_load[axis] / area;
        is_loaded = is_loaded || problem.end_load[axis] != 0;
    }
    if (is_loaded) {
        const double end = options.size[0] * (1 - 1e-9);
        const auto boundary = mesh::boundary(scene.mesh);
        traction.triangles = runtime::triangles_where(scene.mesh, boundary.triangles,
                                                      [end](const mesh::Point& p) { return p[0] >= end; });
        scene.tractions.push_back(std::move(traction));
    }
    return scene;
}

}  // namespace lancet::experiments::precision
