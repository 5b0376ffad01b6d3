#include <algorithm>
#include <array>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/collide/vector3.hpp"
#include "lancet/runtime/simulate/simulation.hpp"

namespace lancet::runtime {

namespace {

/// Around all that is nearer than `reach` to a tool, and a little more: what is outside is farther, whatever is
/// rounded.
Box box_of_reach(std::span<const Segment> axis, double reach) {
    Box box = empty_box;
    for (const Segment& segment : axis) {
        box = unite(box, box_around(std::array{segment.start, segment.end}, (1 + 1e-6) * reach));
    }
    return box;
}

/// Where a place is in the frame of a pose: R is orthogonal, its inverse the conjugate quaternion.
Point local(const Pose& pose, const Point& place) {
    const auto& [w, x, y, z] = pose.orientation;
    return runtime::place({.position = {}, .orientation = {w, -x, -y, -z}}, subtract(place, pose.position));
}

AttachedPoint point_of(const CarriedSurface& surface, const ToolContact& contact) {
    AttachedPoint point{.weights = {contact.weights[0], contact.weights[1], contact.weights[2], 0}};
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto vertex =
            static_cast<std::size_t>(surface.triangles[static_cast<std::size_t>(contact.triangle)][corner]);
        point.corners[corner] = {surface.vertices.parts[vertex], surface.vertices.weights[vertex]};
    }
    return point;
}

}  // namespace

void Simulation::take_hold(Tool& tool) {
    const double reach = tool.definition.grab_distance, tool_radius = radius(tool.definition.shape);
    const Box box = box_of_reach(tool.axis, tool_radius + reach);
    for (std::size_t number = 0; number < bodies_.size(); ++number) {
        if (!before_[number]) continue;
        SimulatedBody& body = *bodies_[number];
        const CarriedSurface& surface = *before_[number]->surface;
        const auto begin = static_cast<std::ptrdiff_t>(tool.grabs.size());
        // Nothing has moved since: where vertices were is enough to leave out those far away.
        const std::span<const Point> places = before_[number]->find_vertices(*scheduler_, vertex_places_);
        for (std::size_t vertex = 0; vertex < surface.vertices.size(); ++vertex) {
            const Point& place = places[vertex];
            if (!touch(box, {place, place})) continue;
            ToolSpring spring{.body = static_cast<int>(number)};
            spring.on_body.corners[0] = {surface.vertices.parts[vertex], surface.vertices.weights[vertex]};
            const Point at = body.position(spring.on_body);
            if (tool_distance(tool.axis, tool_radius, at).distance > reach) continue;
            spring.on_tool = local(tool.now.pose, at);
            tool.grabs.push_back(spring);
        }
        body.stiffen(std::span(tool.grabs).subspan(static_cast<std::size_t>(begin)), options_.time_step);
    }
}

void Simulation::find_tool_contacts() {
    for (const auto& tool : tools_) {
        std::vector<ToolSpring>& found = options_.overlap ? tool->found : tool->contacts;
        if (!collision_is_due_) {
            // What was found last still holds.
            if (options_.overlap) tool->found = tool->contacts;
            continue;
        }
        found.clear();
    }
    if (!collision_is_due_) return;
    bool is_any_felt = false;
    for (const auto& tool : tools_) {
        is_any_felt = is_any_felt || tool->is_felt();
        // A tool that has gone through everything is not on its way from anywhere.
        if (!tool->is_felt()) {
            tool->tested.reset();
        } else {
            const Pose& now = tool->now.pose;
            try {
                tool->motion.set(tool->definition.shape, tool->tested.value_or(now), now);
            } catch (const Error&) {  // too far for a motion: it has been put elsewhere
                tool->motion.set(tool->definition.shape, now);
            }
        }
    }
    if (!is_any_felt) return;
    for (std::size_t number = 0; number < bodies_.size(); ++number) {
        Snapshots<MotionSnapshot>::Reader reader;
        const MotionSnapshot* snapshot = seen(number, reader);
        if (snapshot == nullptr) continue;
        const CarriedSurface& surface = *snapshot->surface;
        touchable_[number].update(snapshot->find_vertices(*scheduler_, touched_places_));
        for (const auto& tool : tools_) {
            if (!tool->is_felt()) continue;
            std::vector<ToolSpring>& found = options_.overlap ? tool->found : tool->contacts;
            for (const ToolContact& contact : touchable_[number].contacts(surface, tool->motion)) {
                // The tool's point is so far behind the surface as the contact is deep.
                const Point deepest = add_scaled(contact.place, -contact.depth, contact.normal);
                found.push_back({.body = static_cast<int>(number),
                                 .on_body = point_of(surface, contact),
                                 .on_tool = local(tool->now.pose, deepest),
                                 .normal = contact.normal,
                                 .share = contact.share});
            }
        }
    }
    for (const auto& tool : tools_) {
        if (tool->is_felt()) tool->tested = tool->now.pose;
    }
}

void Simulation::find_body_contacts() {
    std::vector<BodyContact>& found = options_.overlap ? found_body_contacts_ : body_contacts_;
    if (!collision_is_due_) {
        if (options_.overlap) found_body_contacts_ = body_contacts_;
        return;
    }
    held_.resize(bodies_.size());
    seen_.resize(bodies_.size());
    for (std::size_t body = 0; body < bodies_.size(); ++body) seen_[body] = seen(body, held_[body]);
    body_contact_finder_->find(*scheduler_, seen_, found);
    for (auto& reader : held_) reader = {};
}

}  // namespace lancet::runtime
