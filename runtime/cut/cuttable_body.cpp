#include "lancet/runtime/cut/cuttable_body.hpp"

#include <string>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/simulate/loads.hpp"

namespace lancet::runtime {

CuttableBody::CuttableBody(Scene scene, const Settings& settings, Scheduler& scheduler)
    : scene_(std::move(scene)),
      settings_(settings),
      mesh_(scene_.mesh),
      body_(make_body(scene_, settings, scheduler)),
      scene_loads_(external_loads(scene_)) {}

CutUpdate CuttableBody::cut(Scheduler& scheduler, const mesh::CutSurface& surface, Configuration configuration,
                            mesh::FrontTreatment front) {
    std::vector<Point> positions(body_->nodes()), velocities(body_->nodes());
    body_->positions(positions);
    body_->velocities(velocities);
    mesh::CutMesh mesh = mesh_;
    CutUpdate update;
    update.mesh = mesh.cut(surface, front,
                           configuration == Configuration::current ? std::span(positions) : std::span<const Point>());
    if (update.mesh.new_parts == 0 && update.mesh.new_copies == 0) {
        mesh_ = std::move(mesh);
        return update;
    }
    const double start = steady_seconds();
    // A parent has a lower number: its values are there before those of its copy are asked for.
    for (std::size_t copy = positions.size(); copy < mesh.node_of_copy().size(); ++copy) {
        const auto parent = static_cast<std::size_t>(mesh.parent_of_copy()[copy]);
        positions.push_back(positions[parent]);
        velocities.push_back(velocities[parent]);
    }
    const Scene scene = divided(scene_, mesh);
    std::vector<Point> loads = external_loads(scene);
    auto body = make_body(scene, settings_, scheduler);
    body->set_time(body_->time());
    body->set_positions(positions);
    body->set_velocities(velocities);

    mesh_ = std::move(mesh);
    body_ = std::move(body);
    scene_loads_ = std::move(loads);
    apply_loads();
    for (const auto& [node, target] : holds_) {
        for (const std::int32_t copy : mesh_.copies_of_node(node)) body_->hold(copy, target);
    }
    update.seconds_update = steady_seconds() - start;
    return update;
}

void CuttableBody::hold(std::int32_t node, const Point& target) {
    if (node < 0 || static_cast<std::size_t>(node) >= mesh_.mesh().nodes().size()) {
        throw Error("hold: node " + std::to_string(node) + " does not exist; the mesh has nodes 0 to " +
                    std::to_string(mesh_.mesh().nodes().size() - 1));
    }
    for (const std::int32_t copy : mesh_.copies_of_node(node)) body_->hold(copy, target);
    holds_[node] = target;
}

void CuttableBody::release(std::int32_t node) {
    if (holds_.erase(node) == 0) return;
    for (const std::int32_t copy : mesh_.copies_of_node(node)) body_->release(copy);
}

void CuttableBody::set_point_loads(std::span<const PointLoad> loads) {
    for (const PointLoad& load : loads) {
        if (load.element < 0 || static_cast<std::size_t>(load.element) >= mesh_.mesh().tetrahedra().size()) {
            throw Error("point load: element " + std::to_string(load.element) + " does not exist; the mesh has " +
                        std::to_string(mesh_.mesh().tetrahedra().size()) + " elements");
        }
    }
    point_loads_.assign(loads.begin(), loads.end());
    apply_loads();
}

void CuttableBody::apply_loads() {
    std::vector<Point> loads = scene_loads_;
    for (const PointLoad& load : point_loads_) {
        const mesh::MaterialPoint point = mesh_.material_point(load.element, load.place);
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const std::int32_t copy = mesh_.parts()[static_cast<std::size_t>(point.part)][corner];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                loads[static_cast<std::size_t>(copy)][axis] += point.weights[corner] * load.force[axis];
            }
        }
    }
    body_->set_loads(loads);
}

Point CuttableBody::position(std::int32_t element, const mesh::Barycentric& place) const {
    const mesh::MaterialPoint point = mesh_.material_point(element, place);
    std::vector<Point> positions(body_->nodes());
    body_->positions(positions);
    Point at{};
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const std::int32_t copy = mesh_.parts()[static_cast<std::size_t>(point.part)][corner];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            at[axis] += point.weights[corner] * positions[static_cast<std::size_t>(copy)][axis];
        }
    }
    return at;
}

}  // namespace lancet::runtime
