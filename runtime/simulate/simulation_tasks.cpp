#include <algorithm>
#include <cmath>
#include <utility>

#include "lancet/runtime/collide/vector3.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/simulate/simulation.hpp"

namespace lancet::runtime {

void Simulation::take_input() {
    const double begin = time(), end = time() + options_.time_step;
    for (const auto& tool : tools_) {
        tool->samples.clear();
        tool->before = tool->now;
        if (!tool->path.empty()) {
            // A sample at the very end of the step belongs to it, whatever the rounding of the sum of steps.
            const double last = end + 1e-9 * options_.time_step;
            while (tool->played < tool->path.size() && tool->path[tool->played].time <= last) {
                tool->samples.push_back(tool->path[tool->played++]);
            }
        } else {
            for (ToolSample sample; tool->queue.pop(sample);) tool->samples.push_back(sample);
            const auto count = static_cast<double>(tool->samples.size());
            for (std::size_t k = 0; k < tool->samples.size(); ++k) {
                tool->samples[k].time = begin + (end - begin) * static_cast<double>(k + 1) / count;
            }
        }
        if (tool->definition.is_recorded) {
            tool->recorded.insert(tool->recorded.end(), tool->samples.begin(), tool->samples.end());
        }
        if (tool->samples.empty()) continue;
        tool->now = tool->samples.back();
        tool->is_placed = true;
        tool->axis.resize(segments(tool->definition.shape));
        place_axis(tool->definition.shape, tool->now.pose, tool->axis);
    }
}

void Simulation::cut(SimulatedBody& body, std::size_t number) {
    for (const auto& tool : tools_) {
        if (!tool->definition.blade || !tool->is_placed) continue;
        Blade& blade = tool->blades[number];
        for (std::size_t k = 0; k < tool->samples.size(); ++k) {
            const ToolSample& sample = tool->samples[k];
            if (sample.action != ToolAction::cut) {
                blade.lift();
                continue;
            }
            // Of the places that a blade went through within a step, the last is enough.
            const bool goes_on = k + 1 < tool->samples.size() && tool->samples[k + 1].action == ToolAction::cut;
            if (goes_on && !blade.is_lifted()) continue;
            const auto& [heel, tip] = *tool->definition.blade;
            const double start = steady_seconds();
            const CutUpdate update = body.draw(blade, *scheduler_, place(sample.pose, heel), place(sample.pose, tip));
            if (update.mesh.touched_elements == 0) continue;
            const double seconds = steady_seconds() - start;
            CutStatistics& statistics = cut_statistics_[number];
            ++statistics.cuts;
            statistics.elements += update.mesh.divided_elements;
            statistics.copies += update.mesh.new_copies;
            statistics.seconds += seconds;
            statistics.longest = std::max(statistics.longest, seconds);
        }
    }
}

void Simulation::stiffen_contacts(Tool& tool) {
    // Contacts are found body by body.
    for (auto begin = tool.contacts.begin(); begin != tool.contacts.end();) {
        const auto end =
            std::find_if(begin, tool.contacts.end(), [&](const ToolSpring& s) { return s.body != begin->body; });
        if (begin->stiffness == 0) {
            bodies_[static_cast<std::size_t>(begin->body)]->stiffen(std::span(begin, end), options_.time_step);
        }
        begin = end;
    }
}

void Simulation::push_bodies() {
    for (const auto& body : bodies_) body->clear_forces();
    for (const auto& tool : tools_) {
        if (!tool->is_placed) continue;
        if (tool->now.action != ToolAction::grab) {
            tool->grabs.clear();
        } else if (tool->grabs.empty()) {
            take_hold(*tool);
        }
        if (!tool->is_felt()) tool->contacts.clear();
        stiffen_contacts(*tool);
        for (const auto* springs : {&tool->grabs, &tool->contacts}) {
            for (const ToolSpring& spring : *springs) {
                SimulatedBody& body = *bodies_[static_cast<std::size_t>(spring.body)];
                const Point on_tool = place(tool->now.pose, spring.on_tool);
                Point force = force_on_tool(spring, on_tool, body.position(spring.on_body));
                for (double& value : force) value = -value;
                body.add_force(spring.on_body, force);
            }
        }
    }
    push_apart();
    for (const auto& body : bodies_) body->apply_forces();
}

void Simulation::push_apart() {
    const double h = options_.time_step;
    for (const BodyContact& contact : body_contacts_) {
        SimulatedBody& first = *bodies_[static_cast<std::size_t>(contact.first)];
        SimulatedBody& second = *bodies_[static_cast<std::size_t>(contact.second)];
        // As they have moved since the contact was found.
        const Point gap = subtract(first.position(contact.on_first), second.position(contact.on_second));
        const double depth = contact.depth - dot(gap, contact.normal);
        if (!(depth > 0)) continue;
        // Several vertices may be in one element: less than a tool gets, see SimulatedBody::stiffen.
        const double stiffness = std::min(first.mean_mass(), second.mean_mass()) / (4 * h * h);
        const Point force = scale(contact.normal, stiffness * depth);
        first.add_force(contact.on_first, force, !second.is_quiet(contact.on_second));
        second.add_force(contact.on_second, scale(force, -1), !first.is_quiet(contact.on_first));
    }
}

void Simulation::evaluate_surface(std::size_t number) {
    if (!frame_is_due_) return;
    Snapshots<MotionSnapshot>::Reader reader;
    const MotionSnapshot* snapshot = seen(number, reader);
    SurfaceShape* shape = snapshot == nullptr ? nullptr : bodies_[number]->shapes().begin();
    if (shape == nullptr) return;
    shape->surface = snapshot->surface;
    shape->step = snapshot->step;
    shape->time = snapshot->time;
    if (snapshot->vertices.empty()) {
        snapshot->surface->vertices.place(*scheduler_, snapshot->positions, shape->positions);
    } else {
        shape->positions = snapshot->vertices;
    }
    evaluators_[number].find_normals(*scheduler_, *snapshot->surface, *shape);
    bodies_[number]->shapes().publish();
}

void Simulation::make_frame() {
    if (!frame_is_due_) return;
    const std::int64_t number = frames_due_++;
    if (options_.frames == FramePolicy::wait) frame_thread_->wait();
    Frame* frame = frame_thread_->begin();
    if (frame == nullptr) {
        ++frames_dropped_;
        return;
    }
    frame->number = number;
    frame->bodies.reset(bodies_.size());
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        auto shape = bodies_[body]->shapes().latest();
        if (!shape) continue;
        frame->step = shape->step;
        frame->time = shape->time;
        frame->bodies.hold(body, std::move(shape));
    }
    frame->input_stamp = 0;
    frame->tools.clear();
    for (const auto& tool : tools_) {
        frame->tools.push_back(options_.overlap ? tool->before : tool->now);
        frame->input_stamp = std::max(frame->input_stamp, frame->tools.back().stamp);
    }
    frame_thread_->submit();
}

void Simulation::feel() {
    for (const auto& tool : tools_) {
        ForceModel* model = tool->forces.begin();
        if (model == nullptr) continue;
        model->step = steps_ + 1;
        model->time = time() + options_.time_step;
        model->input_stamp = tool->now.stamp;
        model->anchors.clear();
        for (const auto* springs : {&tool->grabs, &tool->contacts}) {
            for (const ToolSpring& spring : *springs) {
                const SimulatedBody& body = *bodies_[static_cast<std::size_t>(spring.body)];
                model->anchors.push_back({spring, body.position(spring.on_body)});
            }
        }
        tool->forces.publish();
    }
}

const MotionSnapshot* Simulation::seen(std::size_t body, Snapshots<MotionSnapshot>::Reader& reader) {
    if (options_.overlap) return before_[body] ? &*before_[body] : nullptr;
    reader = bodies_[body]->latest();
    return reader ? &*reader : nullptr;
}

}  // namespace lancet::runtime
