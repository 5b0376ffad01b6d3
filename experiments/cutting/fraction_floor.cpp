#include "lancet/experiments/cutting/fraction_floor.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/cutting/run.hpp"
#include "lancet/mesh/generate/box.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/simulate/equilibrium.hpp"

namespace lancet::experiments::cutting {
namespace {

constexpr double middle = 0.5;

runtime::Scene block(bool is_quick) {
    runtime::Scene scene;
    const int cells = is_quick ? 4 : 8;
    scene.mesh = mesh::box({.cells = {2 * cells, cells, cells}, .size = {1, 0.5, 0.5}});
    scene.materials = {{0, {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 1000}}};
    for (const char* end : {"x_min", "x_max"}) {
        const auto nodes = scene.mesh.node_set(end);
        scene.fixed_nodes.insert(scene.fixed_nodes.end(), nodes.begin(), nodes.end());
    }
    return scene;
}

mesh::CutMesh cut_at(const runtime::Scene& scene, double distance) {
    mesh::CutMesh cut(scene.mesh);
    cut.cut(mesh::CutSurface::plane({middle + distance, 0, 0}, {1, 0, 0}));
    return cut;
}

double thinnest_part(const mesh::CutMesh& cut) {
    double thinnest = 1;
    for (std::size_t part = 0; part < cut.parts().size(); ++part) {
        thinnest = std::min(thinnest, cut.moments(static_cast<std::int32_t>(part)).fraction);
    }
    return thinnest;
}

struct Sag {
    runtime::EquilibriumReport report{};
    std::vector<Point> positions{};
};

Sag sag(const runtime::Scene& scene, runtime::Scheduler& scheduler) {
    Sag sag{.positions = {scene.mesh.nodes().begin(), scene.mesh.nodes().end()}};
    runtime::EquilibriumSettings settings;
    settings.tolerance = 1e-8;  // far below every error of the table
    sag.report = find_equilibrium(scene, settings, scheduler, sag.positions);
    if (sag.report.end != runtime::EquilibriumEnd::converged) {
        throw CheckFailed("fraction-floor: " + sag.report.explanation);
    }
    return sag;
}

/// Relative, over the nodes beside the layer: those on it are of either side, or of both.
double error_l2(const Sag& found, const Sag& reference, std::span<const Point> rest) {
    double difference = 0, norm = 0;
    for (std::size_t node = 0; node < rest.size(); ++node) {
        if (rest[node][0] == middle) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            difference += std::pow(found.positions[node][axis] - reference.positions[node][axis], 2);
            norm += std::pow(reference.positions[node][axis] - rest[node][axis], 2);
        }
    }
    return std::sqrt(difference / norm);
}

}  // namespace

std::vector<Row> measure_fraction_floor(runtime::Scheduler& scheduler, bool is_quick, Progress& progress) {
    const runtime::Scene scene = block(is_quick);
    const Sag reference = sag(divided(scene, cut_at(scene, 0)), scheduler);
    const double cell = is_quick ? 0.125 : 0.0625;
    std::vector<Row> rows;
    for (const double fraction : {1e-3, 1e-6, 1e-9, 1e-12}) {
        // The thinnest parts are corners, which grow with the cube of their height.
        const mesh::CutMesh cut = cut_at(scene, cell * std::cbrt(fraction));
        for (const double floor : {0.0, 1e-6, 1e-4, 1e-2, 1e-1}) {
            Row row{
                .scene = "fraction-floor",
                .variant = "thinnest " + format_number(thinnest_part(cut), 2) + ", floor " + format_number(floor, 2),
                .matrix = "edge-blocks",
                .scalar = "double"};
            progress.show(row.scene + ": " + row.variant);
            const runtime::Scene parts = divided(scene, cut, mesh::Fronts::sharp, nullptr, floor);
            const Sag found = sag(parts, scheduler);
            row.elements = static_cast<std::int64_t>(scene.mesh.tetrahedra().size());
            row.nodes = static_cast<std::int64_t>(scene.mesh.nodes().size());
            row.cut_elements = count_cut_elements(cut);
            row.parts = static_cast<std::int64_t>(cut.parts().size());
            row.added_dofs = 3 * static_cast<std::int64_t>(parts.mesh.nodes().size() - scene.mesh.nodes().size());
            row.cg_iterations = found.report.conjugate_gradient_iterations;
            row.error_l2 = error_l2(found, reference, scene.mesh.nodes());
            row.error_energy = std::abs(found.report.elastic_energy / reference.report.elastic_energy - 1);
            rows.push_back(std::move(row));
        }
    }
    return rows;
}

}  // namespace lancet::experiments::cutting
