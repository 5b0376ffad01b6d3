#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "lancet/experiments/microbench/subjects.hpp"
#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/cut/cut_surface.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::experiments {

namespace {

using mesh::Point;

constexpr int segments = 8;  // of the blade's edge, as those of a tool
constexpr int strokes = 8;

/// A blade that goes down through the width of the Bar, at rest. Its edge is not quite straight and not quite even, as
/// it is after a body that moves has been taken back to rest: facets of neighbouring strokes lie nearly in one plane.
std::vector<Point> edge_at(double x, double y) {
    const auto sway = [](double phase) { return 0.004 * std::sin(7.3 * phase) + 0.002 * std::sin(23.1 * phase + 1); };
    std::vector<Point> edge;
    for (int k = 0; k <= segments; ++k) {
        const double z = -0.16 + 1.12 * k / segments;
        edge.push_back({x + sway(z + 3 * y), y + sway(2 * z - y + 0.3), z + sway(3 * z + 5 * y)});
    }
    return edge;
}

mesh::CutSurface swept(const std::vector<Point>& before, const std::vector<Point>& after) {
    std::vector<Point> vertices = before;
    vertices.insert(vertices.end(), after.begin(), after.end());
    std::vector<mesh::Triangle> triangles;
    for (int k = 0; k < segments; ++k) {
        const int next = k + 1, moved = k + segments + 1;
        triangles.push_back({k, next, moved + 1});
        triangles.push_back({k, moved + 1, moved});
    }
    return mesh::CutSurface::triangulated(vertices, triangles);
}

struct Strokes {
    std::array<int, 3> cells;  ///< of the Bar, 4 x 0.8 x 0.8 m
    double first, length;      ///< m: where the blade is before, below the top, and how far it goes at a stroke
    const char* name;
};

/// Through many elements, each of which a few strokes divide; and several strokes within one layer of large elements,
/// of which all but the last end inside.
constexpr Strokes settings[] = {{{40, 8, 8}, -0.03, 0.055, "bar-12800"}, {{5, 1, 1}, 0.02, 0.02, "bar-25"}};

/// Time of one stroke, surface included. The blade starts anew in an uncut mesh after every few.
void measure_strokes(benchmark::State& state, const Strokes& setting) {
    const mesh::CutMesh uncut(mesh::box({.cells = setting.cells, .size = {4, 0.8, 0.8}}));
    double touched = 0, parts = 0;
    while (state.KeepRunningBatch(strokes)) {
        state.PauseTiming();
        mesh::CutMesh cut = uncut;
        state.ResumeTiming();
        std::vector<Point> before = edge_at(2.013, 0.8 - setting.first);
        for (int stroke = 1; stroke <= strokes; ++stroke) {
            std::vector<Point> after = edge_at(2.013, 0.8 - setting.first - stroke * setting.length);
            const mesh::CutReport report = cut.cut(swept(before, after));
            touched += report.touched_elements;
            parts += report.new_parts;
            before = std::move(after);
        }
    }
    state.counters["touched"] = benchmark::Counter(touched, benchmark::Counter::kAvgIterations);
    state.counters["new_parts"] = benchmark::Counter(parts, benchmark::Counter::kAvgIterations);
}

}  // namespace

void register_cut() {
    for (const Strokes& setting : settings) {
        const std::string name = std::string("cut/strokes/") + setting.name;
        benchmark::RegisterBenchmark(name.c_str(), [&setting](benchmark::State& state) {
            measure_strokes(state, setting);
        })->Unit(benchmark::kMicrosecond);
    }
}

}  // namespace lancet::experiments
