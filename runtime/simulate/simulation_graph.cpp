#include <algorithm>
#include <utility>

#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/simulate/simulation.hpp"

namespace lancet::runtime {

StepGraph::Task Simulation::add_task(const std::string& name, std::function<void()> body) {
    auto known = std::ranges::find(statistics_, name, &TaskStatistics::name);
    if (known == statistics_.end()) known = statistics_.insert(statistics_.end(), TaskStatistics{.name = name});
    const int number = static_cast<int>(known - statistics_.begin());
    TaskStatistics& statistics = *known;
    return graph_.task(name, [this, &statistics, number, body = std::move(body)] {
        const double begin = steady_seconds();
        body();
        const double end = steady_seconds();
        ++statistics.runs;
        statistics.seconds += end - begin;
        statistics.longest = std::max(statistics.longest, end - begin);
        if (task_observer_ != nullptr) task_observer_->ended(number, statistics.name, begin, end);
    });
}

StepGraph::Task Simulation::add_steps(int number, const std::optional<Task>& before) {
    SimulatedBody& body = this->body(number);
    std::optional<Task> last = before;
    const auto add = [&](const std::string& what, std::function<void()> run) {
        const Task task = add_task(body.name() + ": " + what, std::move(run));
        if (last) last->precede(task);
        last = task;
    };
    const int steps = body.steps_per_world_step();
    for (int step = 1; step <= steps; ++step) {
        const std::string of = steps == 1 ? "" : " " + std::to_string(step);
        if (!body.has_system()) {
            add("step" + of, [this, &body] {
                for (const StepStage stage : step_stages) body.run(stage, *scheduler_);
            });
            continue;
        }
        for (const StepStage stage : step_stages) {
            add(std::string(to_string(stage)) + of, [this, &body, stage] { body.run(stage, *scheduler_); });
        }
    }
    return *last;
}

void Simulation::make_room_for_bodies() {
    before_.resize(bodies_.size());
    while (evaluators_.size() < bodies_.size()) {
        evaluators_.emplace_back(bodies_[evaluators_.size()]->body().settings().instruction_set);
    }
    touchable_.resize(bodies_.size());
    cut_statistics_.resize(bodies_.size());
    for (const auto& tool : tools_) {
        if (!tool->definition.blade) continue;
        while (tool->blades.size() < bodies_.size()) {
            tool->blades.emplace_back(8, bodies_[tool->blades.size()]->element_size() / 2);
        }
    }
}

void Simulation::build_graph() {
    graph_ = StepGraph();
    const bool has_tools = !tools_.empty(), collides = bodies_collide() && collision_rate_.ever();
    const bool has_snapshots = has_surfaces() || has_tools || collides;
    make_room_for_bodies();
    body_contact_finder_.reset();
    if (collides) body_contact_finder_.emplace(bodies_, options_.broad_phase);

    std::optional<Task> input, forces, feedback, frame;
    if (has_tools || collides) forces = add_task("contact forces", [this] { push_bodies(); });
    if (has_tools) {
        input = add_task("input", [this] { take_input(); });
        input->precede(*forces);
        feedback = add_task("force feedback", [this] { feel(); });
    }
    const auto add_collision = [&](const std::string& name, std::function<void()> find) {
        const Task collision = add_task(name, std::move(find));
        if (input) input->precede(collision);
        if (!options_.overlap) collision.precede(*forces);
    };
    if (has_tools && collision_rate_.ever()) add_collision("tool collision", [this] { find_tool_contacts(); });
    if (collides) add_collision("body collision", [this] { find_body_contacts(); });
    if (frame_thread_ != nullptr) frame = add_task("frame", [this] { make_frame(); });
    for (std::size_t number = 0; number < bodies_.size(); ++number) {
        SimulatedBody& body = *bodies_[number];
        std::optional<Task> renewal;
        if (body.can_be_cut() && has_blade()) {
            const Task cutting = add_task(body.name() + ": cut", [this, &body, number] { cut(body, number); });
            input->precede(cutting);
            cutting.precede(*forces);
            renewal = add_task(body.name() + ": surface renewal", [&body, collides] {
                if (body.surface_is_old()) body.renew_surface(collides);
            });
            cutting.precede(*renewal);
        }
        const Task last = add_steps(static_cast<int>(number), forces);
        if (feedback) last.precede(*feedback);
        if (!has_snapshots && !(options_.sleep.speed > 0)) continue;
        if (has_snapshots) {
            if (body.surface() == nullptr || (collides && body.surface()->solid == nullptr)) {
                body.renew_surface(collides);
            }
            body.publish(steps_, time());
        }
        const Task snapshot = add_task(body.name() + ": snapshot", [this, &body, has_snapshots] {
            body.rest(options_.time_step);
            if (has_snapshots) body.publish(steps_ + 1, time() + options_.time_step);
        });
        last.precede(snapshot);
        if (renewal) renewal->precede(snapshot);
        if (!has_surfaces()) continue;
        const Task surface = add_task(body.name() + ": surface", [this, number] { evaluate_surface(number); });
        if (!options_.overlap) snapshot.precede(surface);
        if (frame) surface.precede(*frame);
    }
    if (input && frame) input->precede(*frame);
    graph_.validate();
    graph_is_old_ = false;
}

}  // namespace lancet::runtime
