#include "lancet/experiments/scheduler/subject.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/generate/box.hpp"

namespace lancet::experiments::scheduler {
namespace {

using mesh::Point;

runtime::Scene scene_of(const BarProblem& problem) {
    runtime::Scene scene;
    scene.mesh = mesh::box({.cells = problem.cells, .size = {4, 0.8, 0.8}});
    const auto clamped = scene.mesh.node_set("x_min");
    scene.fixed_nodes.assign(clamped.begin(), clamped.end());
    scene.materials = {{0, {.young_modulus = 1e5, .poisson_ratio = 0.33, .density = 100}}};
    return scene;
}

std::vector<Point> positions_of(const runtime::DeformableBody& body) {
    std::vector<Point> positions(body.nodes());
    body.positions(positions);
    return positions;
}

class Loops final : public Subject {
  public:
    Loops(const BarProblem& problem, runtime::Scheduler& scheduler)
        : scheduler_(&scheduler), body_(make_body(scene_of(problem), problem.settings, scheduler)) {}

    void step() override { body_->step(*scheduler_); }
    std::vector<Point> positions() override { return positions_of(*body_); }
    TaskSeconds task_seconds() const override { return {}; }
    std::string graph() override { return {}; }

  private:
    runtime::Scheduler* scheduler_;
    std::unique_ptr<runtime::DeformableBody> body_;
};

struct Interval {
    double begin = 0, end = 0;

    double length() const noexcept { return end - begin; }
};

double common_length(const Interval& a, const Interval& b) noexcept {
    return std::max(0.0, std::min(a.end, b.end) - std::max(a.begin, b.begin));
}

/// When the last step's tasks ran, by their numbers.
class TaskTimes final : public runtime::TaskObserver {
  public:
    void ended(int task, std::string_view, double begin, double end) noexcept override {
        // Every task has a place of its own, and the step's end orders them with who reads.
        if (static_cast<std::size_t>(task) < times_.size()) times_[static_cast<std::size_t>(task)] = {begin, end};
    }
    Interval of(std::size_t task) const noexcept { return task < times_.size() ? times_[task] : Interval{}; }

  private:
    std::array<Interval, 64> times_{};
};

bool is_stage(const std::string& task) {
    return std::ranges::any_of(runtime::step_stages, [&task](runtime::StepStage stage) {
        return task.ends_with(": " + std::string(to_string(stage)));
    });
}

bool is_of_frames(const std::string& task) {
    return task == "frame" || task.ends_with(": surface");
}

/// To and fro 5 cm above the bar near the clamp, where it does not rise; sampled at 200 Hz.
runtime::ToolPath hover(double radius) {
    constexpr double seconds = 40, interval = 0.005, period = 2;
    runtime::ToolPath path;
    for (int sample = 0; sample * interval < seconds; ++sample) {
        const double time = sample * interval;
        const double x = 0.5 - 0.4 * std::cos(2 * std::numbers::pi * time / period);
        path.push_back({.time = time, .pose = {.position = {x, 0.8 + 0.05 + radius, 0.4}}});
    }
    return path;
}

class Tasks final : public Subject {
  public:
    Tasks(const BarProblem& problem, runtime::Scheduler& scheduler, Extras extras)
        : simulation_(scheduler, {.time_step = problem.settings.time_step,
                                  .frame_rate = extras == Extras::nothing ? 0.0 : 30.0,
                                  .collision_rate = extras == Extras::everything ? 200.0 : 0.0}) {
        simulation_.add_body({.name = "bar",
                              .scene = scene_of(problem),
                              .settings = problem.settings,
                              .can_be_cut = extras == Extras::everything});
        if (extras != Extras::nothing) {
            simulation_.observe_frames([this](const runtime::Frame& frame) { seen_ += frame.bodies.size(); });
        }
        if (extras == Extras::everything) {
            constexpr double radius = 0.1;
            const int tool = simulation_.add_tool({.name = "knife",
                                                   .shape = runtime::SphereTool{.radius = radius},
                                                   .blade = std::array<Point, 2>{{{0, 0, -0.1}, {0, 0, 0.1}}}});
            simulation_.play(tool, hover(radius));
        }
        if (extras != Extras::nothing) simulation_.observe_tasks(&times_);
    }

    void step() override { simulation_.step(); }
    std::vector<Point> positions() override { return positions_of(simulation_.body(0).body()); }
    std::string graph() override { return simulation_.graph().to_dot(); }

    TaskSeconds task_seconds() const override {
        TaskSeconds seconds;
        const auto tasks = simulation_.task_statistics();
        for (std::size_t task = 0; task < tasks.size(); ++task) {
            const Interval time = times_.of(task);
            seconds.all += time.length();
            if (!is_stage(tasks[task].name)) seconds.side += time.length();
            if (!is_of_frames(tasks[task].name)) continue;
            seconds.frames += time.length();
            // The stages of one body follow each other.
            for (std::size_t other = 0; other < tasks.size(); ++other) {
                if (is_stage(tasks[other].name)) seconds.frames_beside += common_length(time, times_.of(other));
            }
        }
        return seconds;
    }

  private:
    TaskTimes times_;
    std::atomic<std::size_t> seen_{0};  // before the simulation, whose frame thread ends first
    runtime::Simulation simulation_;
};

}  // namespace

std::string_view to_string(Extras extras) noexcept {
    return extras == Extras::nothing ? "nothing" : extras == Extras::frames ? "frames" : "everything";
}

Extras extras_from_string(std::string_view text) {
    for (const Extras extras : {Extras::nothing, Extras::frames, Extras::everything}) {
        if (text == to_string(extras)) return extras;
    }
    throw Error("extras: '" + std::string(text) + "'; expected nothing, frames or everything");
}

std::unique_ptr<Subject> make_loops(const BarProblem& problem, runtime::Scheduler& scheduler) {
    return std::make_unique<Loops>(problem, scheduler);
}

std::unique_ptr<Subject> make_tasks(const BarProblem& problem, runtime::Scheduler& scheduler, Extras extras) {
    return std::make_unique<Tasks>(problem, scheduler, extras);
}

}  // namespace lancet::experiments::scheduler
