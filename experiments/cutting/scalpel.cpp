#include <algorithm>
#include <cmath>
#include <numbers>

#include "lancet/experiments/cutting/run.hpp"
#include "lancet/experiments/cutting/scenario.hpp"
#include "lancet/runtime/cut/blade.hpp"

namespace lancet::experiments::cutting {
namespace {

/// A place of the Bar's material.
struct Mark {
    std::int32_t element = 0;
    mesh::Barycentric weights{};
};

Mark mark_at(const mesh::TetMesh& mesh, const Point& place) {
    Mark mark;
    double deepest = -1;
    for (std::size_t e = 0; e < mesh.tetrahedra().size(); ++e) {
        std::array<Point, 4> corners{};
        for (std::size_t k = 0; k < 4; ++k) {
            corners[k] = mesh.nodes()[static_cast<std::size_t>(mesh.tetrahedra()[e][k])];
        }
        const mesh::Barycentric weights = mesh::barycentric(corners, place);
        const double depth = *std::ranges::min_element(weights);
        if (depth <= deepest) continue;
        deepest = depth;
        mark = {static_cast<std::int32_t>(e), weights};
    }
    return mark;
}

/// A hand that follows the Bar's swing as with a ruler laid along it, below where it cuts: it knows where two places of
/// the Bar are, and nothing of how the Bar is strained.
class Hand {
  public:
    explicit Hand(const mesh::TetMesh& mesh) : back_(mark_at(mesh, from)), front_(mark_at(mesh, to)) {}

    /// Where a place beside the Bar at rest goes with the ruler.
    Point follow(const runtime::CuttableBody& body, const Point& place) const {
        const Point back = body.position(back_.element, back_.weights),
                    front = body.position(front_.element, front_.weights);
        const double length = std::hypot(front[0] - back[0], front[1] - back[1]);
        const double cosine = (front[0] - back[0]) / length, sine = (front[1] - back[1]) / length;
        const double x = place[0] - from[0], y = place[1] - from[1];
        return {back[0] + cosine * x - sine * y, back[1] + sine * x + cosine * y, place[2]};
    }

  private:
    static constexpr Point from{1.25, 0.15, 0.4}, to{1.95, 0.15, 0.4};
    Mark back_, front_;
};

}  // namespace

Scenario scalpel(bool is_quick, runtime::Scheduler& scheduler) {
    Scenario scenario{.name = "scalpel",
                      .title = "Scalpel: a blade goes through the Bar from above, on an arc, while the Bar swings",
                      .scene = bar(is_quick),
                      .time_step = 0.04,
                      .steps = is_quick ? 20 : 60};
    const int strokes = is_quick ? 8 : 30, first = is_quick ? 4 : 10;
    // The blade is longer than the Bar is wide and goes down a quarter of a circle, to 0.45 m below the top.
    const auto edge = [&](int place) {
        const double angle = 0.5 * std::numbers::pi * place / strokes;
        const double x = 1.3 + 0.5 * std::sin(angle), y = 0.35 + 0.5 * std::cos(angle);
        return std::array<Point, 2>{Point{x, y, -0.1}, Point{x, y, 0.9}};
    };
    const Arithmetic arithmetic{.scalar = runtime::ScalarMode::double_precision};
    runtime::CuttableBody body(scenario.scene, interactive_settings(arithmetic, scenario.time_step), scheduler);
    const Hand hand(scenario.scene.mesh);
    runtime::Blade blade;
    const auto sweep_to = [&](int place) {
        const auto [heel, tip] = edge(place);
        return blade.sweep(body, hand.follow(body, heel), hand.follow(body, tip));
    };
    for (int step = 0; step < first; ++step) body.step(scheduler);
    (void)sweep_to(0);  // puts it there
    for (int k = 0; k < strokes; ++k) {
        if (const auto surface = sweep_to(k + 1)) {
            body.cut(scheduler, *surface, runtime::Configuration::rest);
            scenario.strokes.push_back({first + k, *surface});
        }
        body.step(scheduler);
    }
    scenario.view = {.axes = {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}},
                     .elevation = 72,
                     .azimuth = 25,
                     .steps = {first, first + strokes / 2, first + strokes, scenario.steps}};
    return scenario;
}

}  // namespace lancet::experiments::cutting
