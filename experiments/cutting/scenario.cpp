#include "lancet/experiments/cutting/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lancet/experiments/common/organ_mesh.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/mesh/io/read.hpp"

namespace lancet::experiments::cutting {
namespace {

template <class Predicate>
std::vector<std::int32_t> nodes_where(const mesh::TetMesh& mesh, const Predicate& is_inside) {
    std::vector<std::int32_t> chosen;
    for (std::size_t node = 0; node < mesh.nodes().size(); ++node) {
        if (is_inside(mesh.nodes()[node])) chosen.push_back(static_cast<std::int32_t>(node));
    }
    return chosen;
}

mesh::TetMesh read_organ(const OrganFile& organ) {
    if (organ.scale && !(*organ.scale > 0)) throw Error("--mesh-scale: expected a positive factor");
    mesh::TetMesh mesh = mesh::read(organ.file, {.scale = organ.scale.value_or(1), .drop_flat = true}).mesh;
    if (organ.scale) return mesh;
    constexpr double length = 0.2;
    const auto [low, high] = mesh.bounds();
    const double longest = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
    mesh::TetMesh::Definition definition = mesh.definition();
    for (Point& node : definition.nodes) {
        for (double& coordinate : node) coordinate *= length / longest;
    }
    return mesh::TetMesh(std::move(definition));
}

Point unit_vector(std::size_t axis, double length = 1) {
    Point vector{};
    vector[axis] = length;
    return vector;
}

}  // namespace

Scenario dissected_beam(bool is_quick) {
    // An odd number of layers: the plane z = 0.1 runs through elements; its border x = 0.015 lies on their faces.
    const std::array<int, 3> cells = is_quick ? std::array{4, 8, 21} : std::array{6, 12, 41};
    Scenario scenario{.name = "dissected-beam",
                      .title = "Dissected beam: 0.03 x 0.06 x 0.2 m, cut half through, bends under gravity",
                      .scene = {},
                      .time_step = 0.01,
                      .steps = is_quick ? 10 : 60};
    scenario.scene.mesh = mesh::box({.cells = cells, .size = {0.03, 0.06, 0.2}});
    scenario.scene.fixed_nodes = nodes_where(scenario.scene.mesh, [](const Point& p) { return p[2] == 0; });
    scenario.scene.materials = {{0, {.young_modulus = 3e5, .poisson_ratio = 0.35, .density = 1070}}};
    scenario.scene.gravity = {9.81, 0, 0};
    double border = 0;  // as the mesh rounds it
    for (const Point& node : scenario.scene.mesh.nodes()) {
        if (std::abs(node[0] - 0.015) < std::abs(border - 0.015)) border = node[0];
    }
    scenario.strokes = {{0, mesh::CutSurface::half_plane({border, 0, 0.1}, {0, 0, 1}, {-1, 0, 0})}};
    scenario.view = {.axes = {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}},
                     .elevation = 75,
                     .azimuth = 20,
                     .steps = {0, scenario.steps / 6, scenario.steps / 3, scenario.steps}};
    return scenario;
}

Scenario organ(const std::optional<OrganFile>& file, bool is_quick) {
    Scenario scenario{.name = "organ",
                      .title = "Organ: held at one end, cut from above along a plane, opens under gravity",
                      .scene = {},
                      .time_step = 0.01,
                      .steps = is_quick ? 12 : 50};
    if (file) {
        scenario.title = "Organ: " + file->file.filename().string() + ", " + scenario.title.substr(7);
    }
    scenario.scene.mesh = file ? read_organ(*file) : is_quick ? organ_mesh(4, 8) : organ_mesh(8, 18);
    scenario.scene.materials = {{0, {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 1000}}};
    const auto [low, high] = scenario.scene.mesh.bounds();
    const Point size{high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    // Along the longest side, up along the shortest.
    const auto along = static_cast<std::size_t>(std::ranges::max_element(size) - size.begin());
    auto up = static_cast<std::size_t>(std::ranges::min_element(size) - size.begin());
    if (up == along) up = (along + 2) % 3;
    const std::size_t across = 3 - along - up;
    const double held = low[along] + 0.2 * size[along];
    scenario.scene.fixed_nodes = nodes_where(scenario.scene.mesh, [&](const Point& p) { return p[along] <= held; });
    scenario.scene.gravity = unit_vector(up, -9.81);
    Point border = low, normal = unit_vector(along);
    border[along] += 0.45 * size[along];
    border[across] += 0.5 * size[across];
    border[up] += 0.45 * size[up];
    normal[across] = 0.2;
    normal[up] = -0.15;
    const int first = is_quick ? 2 : 5;
    scenario.strokes = {{first, mesh::CutSurface::half_plane(border, normal, unit_vector(up))}};
    // Right-handed: to the right, to the back, up.
    const double hand = (along + 1) % 3 == across ? 1 : -1;
    scenario.view = {.axes = {{unit_vector(along), unit_vector(across, hand), unit_vector(up)}},
                     .elevation = 60,
                     .azimuth = 25,
                     .steps = {0, first + 3, (first + scenario.steps) / 2, scenario.steps}};
    return scenario;
}

runtime::Scene bar(bool is_quick) {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = is_quick ? std::array{20, 4, 4} : std::array{40, 8, 8}, .size = {4, 0.8, 0.8}});
    scene.fixed_nodes = nodes_where(scene.mesh, [](const Point& p) { return p[0] == 0; });
    scene.materials = {{0, {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 100}}};
    return scene;
}

}  // namespace lancet::experiments::cutting
