#include "lancet/runtime/cut/cuttable_body.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/simulate/loads.hpp"

namespace lancet::runtime {

namespace {

/// The motion of a body by its nodes.
struct Motion {
    std::vector<Point> positions, velocities;
    std::vector<double> masses;

    explicit Motion(const DeformableBody& body) : positions(body.nodes()), velocities(body.nodes()) {
        body.positions(positions);
        body.velocities(velocities);
        for (std::size_t node = 0; node < body.nodes(); ++node) {
            masses.push_back(body.nodal_mass(static_cast<std::int32_t>(node)));
        }
    }
};

/// The copy that was opening from each copy, if any: its number in the body.
std::map<std::int32_t, std::size_t> far_copies(const mesh::CutMesh& mesh, std::span<const std::int32_t> opened_from) {
    std::map<std::int32_t, std::size_t> far;
    for (std::size_t k = 0; k < opened_from.size(); ++k) far[opened_from[k]] = mesh.node_of_copy().size() + k;
    return far;
}

/// Sets a body going where another was before a cut; copies are numbered as in the meshes before and after.
void take_over(const Motion& before, const mesh::CutMesh& mesh_before, std::span<const std::int32_t> opened_before,
               const mesh::CutMesh& mesh, std::span<const std::int32_t> opened_from, DeformableBody& body) {
    const auto far_before = far_copies(mesh_before, opened_before);
    const std::size_t copies_before = mesh_before.node_of_copy().size(), copies = mesh.node_of_copy().size();
    std::vector<Point> positions(body.nodes()), velocities(body.nodes());
    // A parent has a lower number: its values are there before those of its copy are asked for.
    for (std::size_t node = 0; node < body.nodes(); ++node) {
        if (node < copies_before) {
            positions[node] = before.positions[node];
            velocities[node] = before.velocities[node];
            continue;
        }
        const auto parent =
            static_cast<std::size_t>(node < copies ? mesh.parent_of_copy()[node] : opened_from[node - copies]);
        positions[node] = positions[parent];
        velocities[node] = velocities[parent];
        const auto far = far_before.find(static_cast<std::int32_t>(parent));
        if (far == far_before.end()) continue;
        // What has come over since brings the parent's velocity.
        positions[node] = before.positions[far->second];
        const double mass = body.nodal_mass(static_cast<std::int32_t>(node));
        const double kept = mass > 0 ? std::min(1.0, before.masses[far->second] / mass) : 1.0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            velocities[node][axis] =
                kept * before.velocities[far->second][axis] + (1 - kept) * velocities[parent][axis];
        }
    }
    body.set_positions(positions);
    body.set_velocities(velocities);
}

}  // namespace

CuttableBody::CuttableBody(Scene scene, const Settings& settings, Scheduler& scheduler, const CutOptions& options)
    : scene_(std::move(scene)),
      settings_(settings),
      options_(options),
      mesh_(scene_.mesh),
      body_(make_body(scene_, settings, scheduler)),
      scene_loads_(external_loads(scene_)) {}

CutUpdate CuttableBody::cut(Scheduler& scheduler, const mesh::CutSurface& surface, Configuration configuration,
                            mesh::FrontTreatment front) {
    const Motion before(*body_);
    mesh::CutMesh mesh = mesh_;
    CutUpdate update;
    update.mesh =
        mesh.cut(surface, front,
                 configuration == Configuration::current ? std::span(before.positions).first(mesh.node_of_copy().size())
                                                         : std::span<const Point>());
    const bool moves_front = options_.fronts == mesh::Fronts::blended && update.mesh.touched_elements > 0;
    if (update.mesh.new_parts == 0 && update.mesh.new_copies == 0 && !moves_front) {
        mesh_ = std::move(mesh);
        return update;
    }
    const double start = steady_seconds();
    std::vector<std::int32_t> opened_from;
    Scene scene = divided(scene_, mesh, options_.fronts, &opened_from, options_.smallest_fraction);
    update.crumbs = crumbs(scene, options_.largest_crumb);
    if (options_.crumbs == CrumbTreatment::drop) take_weight(scene, update.crumbs);
    std::vector<Point> loads = external_loads(scene);
    auto body = make_body(scene, settings_, scheduler);
    body->set_time(body_->time());
    take_over(before, mesh_, opened_from_, mesh, opened_from, *body);

    mesh_ = std::move(mesh);
    opened_from_ = std::move(opened_from);
    blend_ = mesh::FrontBlend(mesh_, options_.fronts);
    body_ = std::move(body);
    scene_loads_ = std::move(loads);
    apply_loads();
    for (const auto& [node, target] : holds_) {
        for (const std::int32_t copy : copies_of_node(node)) body_->hold(copy, target);
    }
    if (options_.crumbs != CrumbTreatment::keep) stop(update.crumbs);
    update.seconds_update = steady_seconds() - start;
    return update;
}

void CuttableBody::stop(std::span<const Crumb> crumbs) {
    std::vector<Point> positions(body_->nodes());
    body_->positions(positions);
    for (const Crumb& crumb : crumbs) {
        for (const std::int32_t node : crumb.nodes) body_->hold(node, positions[static_cast<std::size_t>(node)]);
    }
}

std::vector<std::int32_t> CuttableBody::copies_of_node(std::int32_t node) const {
    std::vector<std::int32_t> copies = mesh_.copies_of_node(node);
    for (std::size_t k = 0; k < opened_from_.size(); ++k) {
        if (mesh_.node_of_copy()[static_cast<std::size_t>(opened_from_[k])] == node) {
            copies.push_back(static_cast<std::int32_t>(mesh_.node_of_copy().size() + k));
        }
    }
    return copies;
}

void CuttableBody::hold(std::int32_t node, const Point& target) {
    if (node < 0 || static_cast<std::size_t>(node) >= mesh_.mesh().nodes().size()) {
        throw Error("hold: node " + std::to_string(node) + " does not exist; the mesh has nodes 0 to " +
                    std::to_string(mesh_.mesh().nodes().size() - 1));
    }
    for (const std::int32_t copy : copies_of_node(node)) body_->hold(copy, target);
    holds_[node] = target;
}

void CuttableBody::release(std::int32_t node) {
    if (holds_.erase(node) == 0) return;
    for (const std::int32_t copy : copies_of_node(node)) body_->release(copy);
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

std::vector<Point> CuttableBody::loads() const {
    std::vector<Point> loads = scene_loads_;
    for (const PointLoad& load : point_loads_) {
        const mesh::CopyWeights hold = blend_.hold(mesh_, mesh_.material_point(load.element, load.place));
        for (std::size_t i = 0; i < static_cast<std::size_t>(hold.count); ++i) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                loads[static_cast<std::size_t>(hold.copies[i])][axis] += hold.weights[i] * load.force[axis];
            }
        }
    }
    return loads;
}

void CuttableBody::apply_loads() {
    body_->set_loads(loads());
}

Point CuttableBody::position(std::int32_t element, const mesh::Barycentric& place) const {
    std::vector<Point> positions(body_->nodes());
    body_->positions(positions);
    return blend_.hold(mesh_, mesh_.material_point(element, place)).place(positions);
}

}  // namespace lancet::runtime
