#include "lancet/experiments/cutting/cost.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

namespace lancet::experiments::cutting {
namespace {

/// The planes of nodes across an axis.
std::vector<double> planes(const mesh::TetMesh& mesh, std::size_t axis) {
    std::set<double> found;
    for (const Point& node : mesh.nodes()) found.insert(node[axis]);
    return {found.begin(), found.end()};
}

/// Slots through the middle of layers of cells, from above down to a plane of nodes, that cut so much of the elements.
std::vector<Stroke> slots(const mesh::TetMesh& bar, double percent) {
    if (percent == 0) return {};
    const std::vector<double> xs = planes(bar, 0), ys = planes(bar, 1);
    const int layers = static_cast<int>(xs.size()) - 1, rows = static_cast<int>(ys.size()) - 1;
    const int wanted = std::max(1, static_cast<int>(std::lround(percent / 100 * layers * rows)));
    const int deepest = 3 * rows / 4, count = (wanted + deepest - 1) / deepest;
    std::vector<Point> vertices;
    std::vector<mesh::Triangle> triangles;
    for (int slot = 0; slot < count; ++slot) {
        // Evenly along the Bar, and as equally deep as whole cells allow.
        const auto layer = static_cast<std::size_t>((2 * slot + 1) * layers / (2 * count));
        const int depth = (slot + 1) * wanted / count - slot * wanted / count;
        const double x = (xs[layer] + xs[layer + 1]) / 2, bottom = ys[static_cast<std::size_t>(rows - depth)];
        const auto first = static_cast<std::int32_t>(vertices.size());
        for (const Point& corner : {Point{x, bottom, -1}, Point{x, bottom, 2}, Point{x, 2, 2}, Point{x, 2, -1}}) {
            vertices.push_back(corner);
        }
        triangles.push_back({first, first + 1, first + 2});
        triangles.push_back({first, first + 2, first + 3});
    }
    return {{0, mesh::CutSurface::triangulated(vertices, triangles)}};
}

}  // namespace

std::vector<Row> measure_cost(const Study& study, Progress& progress) {
    constexpr std::array<int, 6> percents{0, 1, 2, 5, 10, 30};
    std::vector<Scenario> scenarios;
    std::vector<std::vector<Frame>> references;
    std::vector<std::vector<Point>> rests;
    for (const int percent : percents) {
        progress.show("cost: converged reference, " + std::to_string(percent) + " % cut");
        Scenario scenario{.name = "cost", .title = {}, .scene = bar(study.is_quick), .time_step = 0.04, .steps = 8};
        scenario.strokes = slots(scenario.scene.mesh, percent);
        const auto settings = converged_settings(scenario.time_step, study.arithmetics.front().instruction_set);
        rests.emplace_back();
        references.push_back(run(scenario, settings, *study.scheduler, [&](int step, const auto& body) {
            if (step == scenario.steps) rests.back() = body.mesh().rest_positions();
        }));
        scenarios.push_back(std::move(scenario));
    }
    std::vector<Row> rows;
    for (std::size_t a = 0; a < study.arithmetics.size(); ++a) {
        runtime::Settings settings = interactive_settings(study.arithmetics[a], scenarios.front().time_step);
        settings.conjugate_gradients = {.iterations = 10, .tolerance = 0};
        settings.energy_safeguard = false;  // a repeated step would be counted as a dear one
        std::array<std::vector<std::vector<Frame>>, percents.size()> measured;
        std::array<std::optional<double>, percents.size()> errors;
        const int repetitions = study.repetitions + 2;  // they are short
        for (int repetition = 0; repetition < repetitions; ++repetition) {
            progress.show("cost: run " + std::to_string(repetition + 1) + " of " + std::to_string(repetitions) + ", " +
                          std::string(to_string(study.arithmetics[a].matrix)) + ", " +
                          std::string(to_string(study.arithmetics[a].scalar)));
            for (std::size_t p = 0; p < percents.size(); ++p) {
                measured[p].push_back(run(scenarios[p], settings, *study.scheduler));
                if (repetition == 0) {
                    errors[p] = error_l2(measured[p].back().back(), references[p].back(), rests[p]);
                }
            }
        }
        for (std::size_t p = 0; p < percents.size(); ++p) {
            Row row = start_row("cost", std::to_string(percents[p]) + " %", study, a);
            fill(row, measured[p], scenarios[p]);
            row.error_l2 = errors[p];
            if (p > 0) {
                row.step_ratio = *row.ms_step / *rows[rows.size() - p].ms_step;
                row.step_ratio_of_cut_element = 1 + (*row.step_ratio - 1) * static_cast<double>(row.elements) /
                                                        static_cast<double>(row.cut_elements);
            }
            rows.push_back(std::move(row));
        }
    }
    return rows;
}

}  // namespace lancet::experiments::cutting
