#include "lancet/runtime/simulate/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/collide/vector3.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::runtime {

namespace {

void validate(const SimulationOptions& options) {
    if (!(options.time_step > 0) || !std::isfinite(options.time_step)) {
        throw Error("simulation: a time step of " + std::to_string(options.time_step) + " s; expected a positive one");
    }
    for (const double value : options.gravity) {
        if (!std::isfinite(value)) throw Error("simulation: gravity is not finite");
    }
    if (!(options.sleep.speed >= 0) || !(options.sleep.after >= 0)) {
        throw Error("simulation: the speed and the time of sleep must not be negative");
    }
}

void validate(const ToolDefinition& tool) {
    const auto fail = [&](const std::string& what) { throw Error("tool '" + tool.name + "': " + what); };
    try {
        validate(tool.shape);
    } catch (const Error& error) {
        fail(error.what());
    }
    if (tool.blade && !(is_finite((*tool.blade)[0]) && is_finite((*tool.blade)[1]))) {
        fail("a coordinate of its blade is not finite");
    }
    if (!(tool.grab_distance >= 0) || !std::isfinite(tool.grab_distance)) fail("its grab distance is negative");
}

}  // namespace

Simulation::Simulation(Scheduler& scheduler, const SimulationOptions& options)
    : scheduler_(&scheduler),
      options_(options),
      frame_rate_(options.frame_rate),
      collision_rate_(options.collision_rate) {
    validate(options);
}

Simulation::~Simulation() = default;

int Simulation::add_body(BodyDefinition definition) {
    if (definition.name.empty()) definition.name = "body " + std::to_string(bodies_.size());
    for (const auto& body : bodies_) {
        if (body->name() == definition.name) {
            throw Error("simulation: there are two bodies named '" + definition.name + "'; names must differ");
        }
    }
    bodies_.push_back(std::make_unique<SimulatedBody>(std::move(definition), options_.time_step, options_.gravity,
                                                      options_.sleep, *scheduler_));
    graph_is_old_ = true;
    return bodies() - 1;
}

int Simulation::add_tool(ToolDefinition definition) {
    if (definition.name.empty()) definition.name = "tool " + std::to_string(tools_.size());
    validate(definition);
    for (const auto& tool : tools_) {
        if (tool->definition.name == definition.name) {
            throw Error("simulation: there are two tools named '" + definition.name + "'; names must differ");
        }
    }
    tools_.push_back(std::make_unique<Tool>());
    tools_.back()->definition = std::move(definition);
    graph_is_old_ = true;
    return static_cast<int>(tools_.size()) - 1;
}

void Simulation::observe_frames(std::function<void(const Frame&)> observer) {
    if (!frame_rate_.ever()) throw Error("simulation: frames are observed, but their rate is 0");
    frame_thread_ = std::make_unique<FrameThread>(std::move(observer));
    graph_is_old_ = true;
}

void Simulation::keep_surfaces() {
    if (!frame_rate_.ever()) throw Error("simulation: surfaces are kept at the rate of frames, which is 0");
    keeps_surfaces_ = true;
    graph_is_old_ = true;
}

void Simulation::observe_tasks(TaskObserver* observer) {
    task_observer_ = observer;
}

bool Simulation::move(int tool, const Pose& pose, ToolAction action) {
    const ToolSample sample{.time = 0, .pose = pose, .action = action, .stamp = steady_seconds()};
    require_valid(std::span(&sample, 1));
    return tool_at(tool).queue.push(sample);
}

void Simulation::play(int tool, ToolPath path) {
    require_valid(path);
    Tool& played = tool_at(tool);
    played.path = std::move(path);
    played.played = 0;
    while (played.played < played.path.size() && played.path[played.played].time < time()) ++played.played;
}

const ToolPath& Simulation::recorded(int tool) const {
    return tool_at(tool).recorded;
}

void Simulation::step() {
    if (frame_thread_ != nullptr && frame_thread_->begin() != nullptr) frame_thread_->rethrow();
    if (graph_is_old_) build_graph();
    // What runs beside the solve sees the state that the step starts from, whenever it runs.
    for (std::size_t body = 0; body < bodies_.size(); ++body) before_[body] = bodies_[body]->latest();
    const double shown = options_.overlap ? time() : time() + options_.time_step;
    frame_is_due_ = has_surfaces() && frame_rate_.due(shown);
    collision_is_due_ = (!tools_.empty() || bodies_collide()) && collision_rate_.due(shown);
    if (collision_is_due_) ++collisions_;
    if (options_.overlap) {
        for (const auto& tool : tools_) tool->contacts.swap(tool->found);
        body_contacts_.swap(found_body_contacts_);
    }
    graph_.run(*scheduler_);
    ++steps_;
}

void Simulation::finish() {
    if (graph_is_old_) build_graph();
    if (frame_thread_ != nullptr) {
        frame_thread_->wait();
        frame_thread_->rethrow();
    }
    if (!has_surfaces() || !options_.overlap || !frame_rate_.due(time())) return;
    frame_is_due_ = true;
    for (const auto& tool : tools_) tool->before = tool->now;
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        before_[body] = bodies_[body]->latest();
        evaluate_surface(body);
    }
    if (frame_thread_ == nullptr) return;
    make_frame();
    frame_thread_->wait();
    frame_thread_->rethrow();
}

SimulatedBody& Simulation::body(int body) {
    if (body < 0 || body >= bodies()) {
        throw Error("simulation: body " + std::to_string(body) + " does not exist; there are " +
                    std::to_string(bodies()));
    }
    return *bodies_[static_cast<std::size_t>(body)];
}

SurfaceSnapshots::Reader Simulation::latest_surface(int body) {
    return this->body(body).shapes().latest();
}

Wrench Simulation::force(int tool, const Pose& pose) {
    const auto model = latest_forces(tool);
    return model ? model->at(pose) : Wrench{};
}

Snapshots<ForceModel>::Reader Simulation::latest_forces(int tool) {
    return tool_at(tool).forces.latest();
}

const StepGraph& Simulation::graph() {
    if (graph_is_old_) build_graph();
    return graph_;
}

std::vector<TaskStatistics> Simulation::task_statistics() const {
    return {statistics_.begin(), statistics_.end()};
}

FrameStatistics Simulation::frame_statistics() const {
    return {.due = frames_due_,
            .observed = frame_thread_ != nullptr ? frame_thread_->observed() : 0,
            .dropped = frames_dropped_};
}

CutStatistics Simulation::cut_statistics() const noexcept {
    CutStatistics all;
    for (const CutStatistics& of_body : cut_statistics_) {
        all.cuts += of_body.cuts;
        all.elements += of_body.elements;
        all.copies += of_body.copies;
        all.seconds += of_body.seconds;
        all.longest = std::max(all.longest, of_body.longest);
    }
    return all;
}

Simulation::Tool& Simulation::tool_at(int tool) {
    return const_cast<Tool&>(std::as_const(*this).tool_at(tool));
}

const Simulation::Tool& Simulation::tool_at(int tool) const {
    if (tool < 0 || static_cast<std::size_t>(tool) >= tools_.size()) {
        throw Error("simulation: tool " + std::to_string(tool) + " does not exist; there are " +
                    std::to_string(tools_.size()));
    }
    return *tools_[static_cast<std::size_t>(tool)];
}

bool Simulation::bodies_collide() const noexcept {
    const auto others = std::ranges::count_if(bodies_, [](const auto& body) { return body->collides_with_others(); });
    return others > 1 || std::ranges::any_of(bodies_, [](const auto& body) { return body->collides_with_itself(); });
}

bool Simulation::has_blade() const noexcept {
    return std::ranges::any_of(tools_, [](const auto& tool) { return tool->definition.blade.has_value(); });
}

}  // namespace lancet::runtime
