#include "lancet/runtime/cut/cuttable_body.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::runtime {

namespace {

std::vector<bool> held_nodes(const Scene& scene) {
    validate_constraints(scene);
    std::vector<bool> is_held(scene.mesh.nodes().size(), false);
    for (const std::int32_t node : scene.fixed_nodes) is_held[static_cast<std::size_t>(node)] = true;
    for (const PrescribedDisplacement& prescribed : scene.prescribed) {
        is_held[static_cast<std::size_t>(prescribed.node)] = true;
    }
    return is_held;
}

}  // namespace

CuttableBody::CuttableBody(Scene scene, const Settings& settings, Scheduler& scheduler, const CutOptions& options)
    : scene_(std::move(scene)),
      settings_(settings),
      options_(options),
      mesh_(scene_.mesh),
      inertia_(scene_, mass_kind(settings)),
      scene_loads_(scene_, mesh_),
      elements_(mesh_, options.fronts),
      components_(mesh_, elements_, held_nodes(scene_)) {
    if (!(options.room >= 0 && options.room <= 1)) {
        throw Error("cuts: room " + std::to_string(options.room) + "; expected a share from 0 to 1");
    }
    is_fixed_.assign(scene_.mesh.nodes().size(), false);
    for (const std::int32_t node : scene_.fixed_nodes) is_fixed_[static_cast<std::size_t>(node)] = true;
    body_ = make_body(scene_, settings_with_room(mesh_.node_of_copy().size()), scheduler);
}

bool CuttableBody::can_change() const {
    const bool has_fitting_layout = settings_.scatter == kernels::ScatterStrategy::private_copies &&
                                    (is_explicit(settings_.integrator) || settings_.matrix != OperatorKind::block_rows);
    const bool keeps_step = !is_explicit(settings_.integrator) || settings_.force_time_step;
    return options_.room > 0 && options_.smallest_fraction == 0 && options_.crumbs != CrumbTreatment::drop &&
           has_fitting_layout && keeps_step;
}

Settings CuttableBody::settings_with_room(std::size_t nodes) const {
    Settings settings = settings_;
    constexpr int least = 64;  // of a small body a cut touches a larger share
    if (can_change()) {
        settings.numbering.spare_nodes = std::max(least, static_cast<int>(options_.room * static_cast<double>(nodes)));
    }
    return settings;
}

CutUpdate CuttableBody::cut(Scheduler& scheduler, const mesh::CutSurface& surface, Configuration configuration,
                            mesh::FrontTreatment front) {
    std::vector<Point> positions;
    if (configuration == Configuration::current) {
        positions.resize(body_->nodes());
        body_->positions(positions);
        positions.resize(mesh_.node_of_copy().size());
    }
    // A body that is laid out anew may refuse its time step, and with it the cut.
    std::optional<mesh::CutMesh> apart;
    if (!can_change()) apart = mesh_;
    mesh::CutMesh& mesh = apart ? *apart : mesh_;
    const std::vector<std::int32_t> opened_before = elements_.opened_from();
    const BodyBeforeCut before{.body = body_.get(),
                               .copies = static_cast<std::int32_t>(mesh.node_of_copy().size()),
                               .opened_from = opened_before};
    std::map<std::int32_t, NodeMomentum> momenta;
    for (const std::int32_t copy : opened_before) {
        const std::int32_t node = mesh_.node_of_copy()[static_cast<std::size_t>(copy)];
        if (!momenta.contains(node)) momenta[node] = momentum_of_node(node);
    }
    CutUpdate update;
    update.mesh = mesh.cut(surface, front, positions);
    const bool moves_front = options_.fronts == mesh::Fronts::blended && update.mesh.touched_elements > 0;
    if (update.mesh.new_parts == 0 && update.mesh.new_copies == 0 && !moves_front) {
        if (apart) mesh_ = *std::move(apart);
        return update;
    }
    const double start = steady_seconds();
    if (apart) {
        rebuild(scheduler, mesh, before, update);
        mesh_ = *std::move(apart);
    } else {
        const auto lanes = elements_.update(mesh_, update.mesh.elements, before.copies);
        components_.update(mesh_, elements_);
        scene_loads_.update(mesh_, elements_.changed_elements());
        if (!body_->change(body_change(lanes, before))) rebuild(scheduler, mesh_, before, update);
        update.crumbs = components_.crumbs(mesh_, elements_, options_.largest_crumb);
    }
    blend_ = mesh::FrontBlend(mesh_, options_.fronts);
    keep_momentum(momenta);
    apply_loads();
    for (const auto& [node, target] : holds_) {
        for (const std::int32_t copy : copies_of_node(node)) body_->hold(copy, target);
    }
    if (options_.crumbs != CrumbTreatment::keep) stop(update.crumbs);
    update.seconds_update = steady_seconds() - start;
    return update;
}

BodyChange CuttableBody::body_change(std::span<const DividedElements::Change> lanes,
                                     const BodyBeforeCut& before) const {
    BodyChange change{.first_node = before.copies};
    for (const DividedElements::Change& lane : lanes) {
        change.elements.push_back(inertia_.element(mesh_, elements_, lane));
    }
    for (const CopyName name : elements_.changed_copies()) {
        if (elements_.node_of(mesh_, name) < 0) continue;
        change.masses.push_back(inertia_.nodal_mass(mesh_, elements_, name));
    }
    std::ranges::sort(change.masses, {}, &BodyChange::NodalMass::node);
    const auto mass_after = [&](std::int32_t node) {
        const auto found = std::ranges::lower_bound(change.masses, node, {}, &BodyChange::NodalMass::node);
        if (found != change.masses.end() && found->node == node) return found->mass;
        // What has not changed was opening before, or is of no element.
        const auto copies = static_cast<std::int32_t>(mesh_.node_of_copy().size());
        const std::int32_t old =
            node < copies ? -1 : before.opening_from(elements_.opened_from()[static_cast<std::size_t>(node - copies)]);
        return old < 0 ? 0.0 : body_->nodal_mass(old);
    };
    const auto copies = mesh_.node_of_copy().size();
    std::int32_t number = before.copies;
    for (const DeformableBody::NodeMotion& motion :
         motion_after_cut(before, mesh_, elements_.opened_from(), mass_after)) {
        const auto at = static_cast<std::size_t>(number++);
        const std::int32_t parent = at < copies ? -1 : elements_.opened_from()[at - copies];
        const std::int32_t node = mesh_.node_of_copy()[at < copies ? at : static_cast<std::size_t>(parent)];
        const auto& rest = scene_.mesh.nodes()[static_cast<std::size_t>(node)];
        const std::int32_t old = parent < 0 ? -1 : before.opening_from(parent);
        change.nodes.push_back({.before = old,
                                .rest = rest,
                                .is_fixed = is_fixed_[static_cast<std::size_t>(node)],
                                .position = motion.position,
                                .velocity = motion.velocity});
        if (old >= 0) continue;
        for (const PrescribedDisplacement& prescribed : scene_.prescribed) {
            if (prescribed.node != node) continue;
            change.prescribed.push_back({static_cast<std::int32_t>(at), prescribed.axis, prescribed.displacement});
        }
    }
    return change;
}

void CuttableBody::rebuild(Scheduler& scheduler, const mesh::CutMesh& mesh, const BodyBeforeCut& before,
                           CutUpdate& update) {
    update.rebuilt = true;
    DividedElements elements(mesh, options_.fronts);
    Scene scene = divided(scene_, mesh, options_.fronts, nullptr, options_.smallest_fraction);
    if (!can_change()) {
        update.crumbs = crumbs(scene, options_.largest_crumb);
        if (options_.crumbs == CrumbTreatment::drop) take_weight(scene, update.crumbs);
        scene_loads_ = DividedLoads(scene_, mesh);
    }
    auto body = make_body(scene, settings_with_room(scene.mesh.nodes().size()), scheduler);
    body->set_time(body_->time());
    std::vector<Point> positions(body_->nodes()), velocities(body_->nodes());
    body_->positions(positions);
    body_->velocities(velocities);
    positions.resize(static_cast<std::size_t>(before.copies));
    velocities.resize(positions.size());
    for (const DeformableBody::NodeMotion& motion :
         motion_after_cut(before, mesh, elements.opened_from(), [&](auto node) { return body->nodal_mass(node); })) {
        positions.push_back(motion.position);
        velocities.push_back(motion.velocity);
    }
    body->set_positions(positions);
    body->set_velocities(velocities);
    elements_ = std::move(elements);
    if (!can_change()) components_ = DividedComponents(mesh, elements_, held_nodes(scene_));
    body_ = std::move(body);
    has_loads_ = true;
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
    const std::vector<std::int32_t>& opened_from = elements_.opened_from();
    for (std::size_t k = 0; k < opened_from.size(); ++k) {
        if (mesh_.node_of_copy()[static_cast<std::size_t>(opened_from[k])] == node) {
            copies.push_back(static_cast<std::int32_t>(mesh_.node_of_copy().size() + k));
        }
    }
    return copies;
}

CuttableBody::NodeMomentum CuttableBody::momentum_of_node(std::int32_t node) const {
    NodeMomentum sum;
    for (const std::int32_t copy : copies_of_node(node)) {
        const double mass = body_->nodal_mass(copy);
        const Point velocity = body_->motion(copy).velocity;
        for (std::size_t axis = 0; axis < 3; ++axis) sum.momentum[axis] += mass * velocity[axis];
        sum.mass += mass;
    }
    return sum;
}

void CuttableBody::keep_momentum(const std::map<std::int32_t, NodeMomentum>& before) {
    if (before.empty()) return;
    std::vector<Point> velocities(body_->nodes());
    body_->velocities(velocities);
    for (const auto& [node, had] : before) {
        const NodeMomentum has = momentum_of_node(node);
        for (const std::int32_t copy : copies_of_node(node)) {
            Point& velocity = velocities[static_cast<std::size_t>(copy)];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                velocity[axis] += (had.momentum[axis] - has.momentum[axis]) / has.mass;
            }
        }
    }
    body_->set_velocities(velocities);
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
    std::vector<Point> loads(body_->nodes(), Point{});
    for (const NodalLoad& load : scene_loads_.on_copies()) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            loads[static_cast<std::size_t>(load.node)][axis] += load.force[axis];
        }
    }
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
    // Without loads the body has none: new nodes come without.
    const bool has_loads = !scene_loads_.empty() || !point_loads_.empty();
    if (has_loads || has_loads_) body_->set_loads(loads());
    has_loads_ = has_loads;
}

Point CuttableBody::position(std::int32_t element, const mesh::Barycentric& place) const {
    std::vector<Point> positions(body_->nodes());
    body_->positions(positions);
    return blend_.hold(mesh_, mesh_.material_point(element, place)).place(positions);
}

}  // namespace lancet::runtime
