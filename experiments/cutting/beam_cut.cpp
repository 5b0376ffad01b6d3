#include "lancet/experiments/cutting/beam_cut.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/cutting/beam_reference.hpp"
#include "lancet/experiments/cutting/run.hpp"
#include "lancet/mesh/boundary.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"

namespace lancet::experiments::cutting {
namespace {

constexpr std::array<double, 3> size{0.03, 0.06, 0.2};
constexpr double border = 0.015, height = 0.1, strip = 0.0075;

bool is_near(double a, double b) {
    return std::abs(a - b) < 1e-9;
}

enum class Kind { aligned, through_elements, through_blended, front_retracts, front_extends, front_blended };
constexpr std::array kinds{Kind::aligned,        Kind::through_elements, Kind::through_blended,
                           Kind::front_retracts, Kind::front_extends,    Kind::front_blended};

bool is_blended(Kind kind) {
    return kind == Kind::through_blended || kind == Kind::front_blended;
}

std::string name_of(Kind kind) {
    switch (kind) {
        case Kind::aligned:
            return "aligned";
        case Kind::through_elements:
            return "through elements";
        case Kind::through_blended:
            return "the same, blended";
        case Kind::front_retracts:
            return "front retracts";
        case Kind::front_extends:
            return "front extends";
        default:
            return "front blended";
    }
}

mesh::TetMesh beam_mesh(Kind kind, int level) {
    const bool is_inside = kind == Kind::front_retracts || kind == Kind::front_extends || kind == Kind::front_blended;
    const std::array<int, 3> cells{4 * level + (is_inside ? 1 : 0), 8 * level,
                                   26 * level + (kind == Kind::aligned ? 0 : 1)};
    const mesh::TetMesh box = mesh::box({.cells = cells, .size = size, .swap_parity = true});
    if (!is_inside) return box;
    // The outer cells keep the width strip / level, so that loads end at faces. The 2 level + 1 between share the rest,
    // a little unequally: the front comes to lie at 0.3 of a cell. Halfway would be on an edge of an element.
    const double front = (level + 0.3) / (2 * level + 1), stretch = (0.5 - front) / (front * (1 - front));
    mesh::TetMesh::Definition definition = box.definition();
    for (Point& node : definition.nodes) {
        const int plane = static_cast<int>(std::lround(node[0] / size[0] * cells[0]));
        const int from_right = cells[0] - plane;
        if (plane <= level) {
            node[0] = strip * plane / level;
        } else if (from_right <= level) {
            node[0] = size[0] - strip * from_right / level;
        } else {
            const double t = static_cast<double>(plane - level) / (2 * level + 1);
            node[0] = strip + (size[0] - 2 * strip) * (t + stretch * t * (1 - t));
        }
    }
    return mesh::TetMesh(std::move(definition));
}

/// A total force, uniform over a strip of the top.
runtime::Traction pull(const mesh::TetMesh& mesh, double from, double to, const Point& force) {
    const double area = strip * size[1];
    return {runtime::triangles_where(
                mesh, mesh::boundary(mesh).triangles,
                [&](const Point& p) { return is_near(p[2], size[2]) && p[0] > from - 1e-9 && p[0] < to + 1e-9; }),
            {force[0] / area, force[1] / area, force[2] / area}};
}

runtime::Scene loaded_beam(std::string_view load, mesh::TetMesh mesh) {
    runtime::Scene scene;
    scene.mesh = std::move(mesh);
    for (std::size_t node = 0; node < scene.mesh.nodes().size(); ++node) {
        if (scene.mesh.nodes()[node][2] == 0) scene.fixed_nodes.push_back(static_cast<std::int32_t>(node));
    }
    scene.materials = {{0, {.young_modulus = 3e5, .poisson_ratio = 0.35, .density = 1070}}};
    scene.gravity = {load == "1" ? 9.81 : 0, 0, 0};
    if (load == "2T") scene.tractions.push_back(pull(scene.mesh, 0, strip, {0, 0, 20}));
    if (load == "3T") {
        scene.tractions.push_back(pull(scene.mesh, 0, strip, {0, 0, 10}));
        scene.tractions.push_back(pull(scene.mesh, size[0] - strip, size[0], {-1, 0, -10}));
    }
    return scene;
}

/// The point of the material at a place at rest.
mesh::MaterialPoint locate(const mesh::CutMesh& cut, const Point& place) {
    const std::span<const Point> nodes = cut.mesh().nodes();
    const auto tetrahedra = cut.mesh().tetrahedra();
    std::int32_t best = 0;
    mesh::Barycentric best_weights{};
    double depth = -1;
    for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
        const mesh::Tetrahedron& t = tetrahedra[e];
        const std::array<Point, 4> corners{nodes[t[0]], nodes[t[1]], nodes[t[2]], nodes[t[3]]};
        bool may_hold = true;
        for (std::size_t axis = 0; axis < 3 && may_hold; ++axis) {
            const auto at = [&](std::size_t k) { return corners[k][axis]; };
            may_hold = place[axis] > std::min({at(0), at(1), at(2), at(3)}) - 1e-9 &&
                       place[axis] < std::max({at(0), at(1), at(2), at(3)}) + 1e-9;
        }
        if (!may_hold) continue;
        mesh::Barycentric weights{};
        const double volume = mesh::signed_volume(corners[0], corners[1], corners[2], corners[3]);
        for (std::size_t k = 0; k < 4; ++k) {
            std::array<Point, 4> moved = corners;
            moved[k] = place;
            weights[k] = mesh::signed_volume(moved[0], moved[1], moved[2], moved[3]) / volume;
        }
        const double lowest = *std::ranges::min_element(weights);
        if (lowest <= depth) continue;
        depth = lowest;
        best = static_cast<std::int32_t>(e);
        best_weights = weights;
    }
    return cut.material_point(best, best_weights);
}

double sample_error(const BeamReference& reference, const mesh::CutMesh& cut, std::span<const Point> rest,
                    std::span<const Point> positions) {
    double difference = 0, norm = 0;
    for (std::size_t sample = 0; sample < BeamReference::samples; ++sample) {
        const mesh::MaterialPoint at = locate(cut, BeamReference::place(sample));
        const Point expected = reference.displacement(sample);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            double displacement = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                const auto copy = static_cast<std::size_t>(cut.parts()[static_cast<std::size_t>(at.part)][k]);
                displacement += at.weights[k] * (positions[copy][axis] - rest[copy][axis]);
            }
            difference += std::pow(displacement - expected[axis], 2);
            norm += expected[axis] * expected[axis];
        }
    }
    return std::sqrt(difference / norm);
}

Row solve(const BeamReference& reference, Kind kind, int level, runtime::Scheduler& scheduler) {
    const runtime::Scene scene = loaded_beam(reference.load, beam_mesh(kind, level));
    mesh::CutMesh cut(scene.mesh);
    // Where nodes are meant to lie on the plane or on its border, their rounded places decide.
    Point through{border, 0, height};
    for (const Point& node : scene.mesh.nodes()) {
        if (is_near(node[0], border)) through[0] = node[0];
        if (is_near(node[2], height)) through[2] = node[2];
    }
    const mesh::CutReport report =
        cut.cut(mesh::CutSurface::half_plane(through, {0, 0, 1}, {-1, 0, 0}),
                kind == Kind::front_extends ? mesh::FrontTreatment::extend : mesh::FrontTreatment::retract);
    const runtime::Scene parts = divided(scene, cut, is_blended(kind) ? mesh::Fronts::blended : mesh::Fronts::sharp);
    runtime::EquilibriumSettings settings;
    settings.model = reference.model;
    settings.tolerance = 1e-8;
    const std::span<const Point> rest = parts.mesh.nodes();
    std::vector<Point> positions(rest.begin(), rest.end());
    const double start = runtime::steady_seconds();
    const runtime::EquilibriumReport found = find_equilibrium(parts, settings, scheduler, positions);
    const double seconds = runtime::steady_seconds() - start;
    if (found.end != runtime::EquilibriumEnd::converged) {
        throw CheckFailed("beam, case " + std::string(reference.load) + ", " + name_of(kind) + ", level " +
                          std::to_string(level) + ": " + found.explanation);
    }
    Row row{.scene = "beam-case" + std::string(reference.load),
            .variant = name_of(kind),
            .model = reference.model == runtime::ElementModel::linear ? "linear" : "corotational",
            .matrix = std::string(to_string(settings.matrix)),
            .scalar = std::string(to_string(settings.scalar))};
    row.elements = static_cast<std::int64_t>(scene.mesh.tetrahedra().size());
    row.nodes = static_cast<std::int64_t>(scene.mesh.nodes().size());
    row.cut_elements = count_cut_elements(cut);
    row.parts = static_cast<std::int64_t>(cut.parts().size());
    row.added_dofs = 3 * (static_cast<std::int64_t>(rest.size()) - row.nodes);
    row.unknowns = 3 * static_cast<std::int64_t>(rest.size() - parts.fixed_nodes.size());
    row.ms_geometry = 1e3 * report.seconds_geometry;
    row.ms_topology = 1e3 * report.seconds_topology;
    row.ms_solve = 1e3 * seconds;
    row.cg_iterations = found.conjugate_gradient_iterations;
    row.error_energy = std::abs(found.elastic_energy / reference.energy - 1);
    row.error_l2 = sample_error(reference, cut, rest, positions);
    return row;
}

std::optional<double> order(const Row& coarse, const Row& fine, std::optional<double> Row::*error) {
    const double cells = std::log(static_cast<double>(*fine.unknowns) / static_cast<double>(*coarse.unknowns)) / 3;
    return std::log(*(coarse.*error) / *(fine.*error)) / cells;
}

}  // namespace

std::vector<Row> measure_beam_cut(const std::string& load, int levels, runtime::Scheduler& scheduler,
                                  Progress& progress) {
    std::vector<Row> rows;
    for (const BeamReference& reference : beam_references()) {
        if (reference.load != load) continue;
        for (const Kind kind : kinds) {
            std::optional<Row> before;
            for (int level = 1; level <= levels; ++level) {
                progress.show("beam, case " + load + ", " + name_of(kind) + ", mesh " + std::to_string(level) + " of " +
                              std::to_string(levels));
                Row row = solve(reference, kind, level, scheduler);
                if (before) {
                    row.order_energy = order(*before, row, &Row::error_energy);
                    row.order_l2 = order(*before, row, &Row::error_l2);
                }
                before = row;
                rows.push_back(std::move(row));
            }
        }
    }
    return rows;
}

}  // namespace lancet::experiments::cutting
