#include "lancet/runtime/simulate/body_contacts.hpp"

namespace lancet::runtime {

BodyContactFinder::BodyContactFinder(std::span<const std::unique_ptr<SimulatedBody>> bodies, BroadPhaseKind kind)
    : kind_(kind), solids_(bodies.size()) {
    for (const auto& body : bodies) {
        with_others_.push_back(body->collides_with_others());
        with_itself_.push_back(body->collides_with_itself());
    }
}

void BodyContactFinder::find(Scheduler& scheduler, std::span<const MotionSnapshot* const> snapshots,
                             std::vector<BodyContact>& contacts) {
    contacts.clear();
    for (std::size_t k = 0; k < solids_.size(); ++k) {
        if (snapshots[k] == nullptr || snapshots[k]->surface->solid == nullptr) continue;
        const CarriedSurface& surface = *snapshots[k]->surface;
        Solid& solid = solids_[k];
        const bool is_new = solid.version != surface.version;
        if (is_new) {
            solid.body.emplace(surface.solid->points.size(), surface.solid->tetrahedra, surface.solid->triangles,
                               kind_);
            solid.version = surface.version;
        }
        surface.solid->points.place(scheduler, snapshots[k]->positions, solid.positions);
        solid.box = box_around(solid.positions);
        // The first time at once: then it allocates.
        if (is_new) solid.body->update(solid.positions);
        solid.is_up_to_date = is_new;
    }
    // What no other body is near costs no more than its box.
    const auto update = [&](std::size_t body) {
        if (!solids_[body].is_up_to_date) solids_[body].body->update(solids_[body].positions);
        solids_[body].is_up_to_date = true;
    };
    const int count = static_cast<int>(solids_.size());
    for (int first = 0; first < count; ++first) {
        for (int second = 0; second < count; ++second) {
            const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
            const bool is_wanted = first == second ? with_itself_[a] : with_others_[a] && with_others_[b];
            if (!is_wanted || !solids_[a].body || !solids_[b].body || !touch(solids_[a].box, solids_[b].box)) continue;
            update(a);
            update(b);
            add(scheduler, first, second, snapshots, contacts);
        }
    }
}

void BodyContactFinder::add(Scheduler& scheduler, int first, int second,
                            std::span<const MotionSnapshot* const> snapshots, std::vector<BodyContact>& contacts) {
    const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
    finder_.find(scheduler, *solids_[a].body, *solids_[b].body, found_);
    const CarriedPoints& of_first = snapshots[a]->surface->solid->points;
    const CarriedPoints& of_second = snapshots[b]->surface->solid->points;
    for (const VertexContact& found : found_) {
        BodyContact contact{.first = first, .second = second, .normal = found.normal, .depth = found.depth};
        const auto vertex = static_cast<std::size_t>(found.vertex);
        contact.on_first.corners[0] = {of_first.parts[vertex], of_first.weights[vertex]};
        contact.on_second.weights = found.weights;
        const mesh::Tetrahedron& corners = solids_[b].body->tetrahedra()[static_cast<std::size_t>(found.tetrahedron)];
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const auto point = static_cast<std::size_t>(corners[corner]);
            contact.on_second.corners[corner] = {of_second.parts[point], of_second.weights[point]};
        }
        contacts.push_back(contact);
    }
}

}  // namespace lancet::runtime
