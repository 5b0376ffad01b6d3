#include "lancet/runtime/simulate/simulated_body.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lancet/kernels/error.hpp"
#include "lancet/mesh/components.hpp"
#include "lancet/runtime/cut/divided_scene.hpp"
#include "lancet/runtime/simulate/loads.hpp"

namespace lancet::runtime {

namespace {

int whole_steps(const BodyDefinition& definition, double world_step) {
    const double ratio = world_step / definition.settings.time_step;
    const double steps = std::round(ratio);
    if (!(steps >= 1) || std::abs(ratio - steps) > 1e-9 * steps) {
        throw Error("body '" + definition.name + "': the world's step of " + std::to_string(world_step) +
                    " s is not a whole multiple of its time step of " + std::to_string(definition.settings.time_step) +
                    " s");
    }
    return static_cast<int>(steps);
}

}  // namespace

std::span<const Point> MotionSnapshot::find_vertices(Scheduler& scheduler, std::vector<Point>& places) const {
    if (!vertices.empty()) return vertices;
    surface->vertices.place(scheduler, positions, places);
    return places;
}

SimulatedBody::SimulatedBody(BodyDefinition definition, double world_step, const std::array<double, 3>& gravity,
                             const SleepOptions& sleep, Scheduler& scheduler)
    : definition_(std::move(definition)), sleep_(sleep), steps_per_world_step_(whole_steps(definition_, world_step)) {
    definition_.scene.gravity = gravity;
    if (definition_.can_be_cut) {
        cuttable_ =
            std::make_unique<CuttableBody>(definition_.scene, definition_.settings, scheduler, definition_.cuts);
    } else {
        body_ = make_body(definition_.scene, definition_.settings, scheduler);
    }
    const mesh::TetMesh& mesh = definition_.scene.mesh;
    if (definition_.surface) {
        fine_ = std::make_unique<mesh::EmbeddedSurface>(cuttable_ ? cuttable_->mesh() : mesh::CutMesh(mesh),
                                                        *definition_.surface);
    }
    // A regular tetrahedron of edge a has the volume a^3 / (6 sqrt 2).
    element_size_ = std::cbrt(mesh.volume() / static_cast<double>(mesh.tetrahedra().size()) * 6 * std::numbers::sqrt2);
    scene_loads_ = external_loads(definition_.scene);
    start_loads();
    find_mean_mass();
    if (may_sleep()) find_islands();
}

void SimulatedBody::find_islands() {
    std::vector<std::int32_t> restless;
    for (const PrescribedDisplacement& prescribed : definition_.scene.prescribed) {
        // What is prescribed in time goes on by itself.
        const auto nodes =
            cuttable_ ? cuttable_->copies_of_node(prescribed.node) : std::vector<std::int32_t>{prescribed.node};
        restless.insert(restless.end(), nodes.begin(), nodes.end());
    }
    islands_ = Islands(body(), cuttable_ ? cuttable_->components() : mesh::components(definition_.scene.mesh).of_node,
                       restless);
}

void SimulatedBody::find_mean_mass() {
    double mass = 0;
    for (std::size_t node = 0; node < body().nodes(); ++node) {
        mass += body().nodal_mass(static_cast<std::int32_t>(node));
    }
    mean_mass_ = mass / static_cast<double>(body().nodes());
}

void SimulatedBody::run(StepStage stage, Scheduler& scheduler) {
    if (is_asleep()) return;
    const StepReport report = body().run(stage, scheduler);
    if (stage == StepStage::update && report.lost) ++lost_steps_;
}

CutUpdate SimulatedBody::draw(Blade& blade, Scheduler& scheduler, const Point& heel, const Point& tip) {
    Islands::Before before;
    if (may_sleep()) {
        before = islands_.before(body());
        before.kept_nodes = static_cast<std::int32_t>(cuttable_->mesh().node_of_copy().size());
    }
    CutUpdate update = blade.draw(*cuttable_, scheduler, heel, tip);
    if (update.mesh.touched_elements > 0) {
        ++cuts_;
        scene_loads_ = cuttable_->loads();
        // What was collected for the last step is on nodes that may have gone.
        start_loads();
        body().set_loads(loads_);
        find_mean_mass();
        if (may_sleep()) follow_cut(before, update);
    }
    return update;
}

void SimulatedBody::follow_cut(const Islands::Before& before, const CutUpdate& update) {
    find_islands();
    std::vector<std::int32_t> touched;
    for (const std::int32_t element : update.mesh.elements) {
        for (const std::int32_t part : cuttable_->mesh().parts_of_element(element)) {
            const mesh::Tetrahedron& copies = nodes_of(part);
            touched.insert(touched.end(), copies.begin(), copies.end());
        }
    }
    islands_.go_on(body(), before, touched);
}

void SimulatedBody::renew_surface(bool is_solid) {
    const bool is_cut = cuttable_ && cuts_ > 0;
    const mesh::TetMesh& mesh = definition_.scene.mesh;
    mesh::PartGeometry geometry;
    if (is_cut && (is_solid || !fine_)) geometry = part_geometry(cuttable_->mesh());
    auto surface = std::make_shared<CarriedSurface>();
    if (fine_) {
        if (is_cut) fine_->update(cuttable_->mesh());
        *surface = carried_surface(*fine_);
    } else {
        *surface = is_cut ? boundary_surface(cuttable_->mesh(), geometry) : boundary_surface(mesh);
    }
    if (is_solid) {
        surface->solid = std::make_shared<const CarriedSolid>(is_cut ? carried_solid(cuttable_->mesh(), geometry)
                                                                     : carried_solid(mesh));
    }
    surface->version = surface_ ? surface_->version + 1 : 0;
    surface_ = std::move(surface);
    surface_cuts_ = cuts_;
}

void SimulatedBody::start_loads() {
    loads_ = scene_loads_;
    is_forced_.assign(loads_.size(), 0);
    forced_.clear();
    was_forced_.clear();
}

void SimulatedBody::set_loads(std::span<const Point> loads) {
    body().set_loads(loads);
    std::vector<std::int32_t> changed;
    for (std::size_t node = 0; node < loads.size(); ++node) {
        if (loads[node] != scene_loads_[node]) changed.push_back(static_cast<std::int32_t>(node));
    }
    scene_loads_.assign(loads.begin(), loads.end());
    start_loads();
    islands_.wake(body(), changed);
}

void SimulatedBody::clear_forces() {
    for (const std::int32_t node : forced_) {
        loads_[static_cast<std::size_t>(node)] = scene_loads_[static_cast<std::size_t>(node)];
        is_forced_[static_cast<std::size_t>(node)] = 0;
    }
    was_forced_.swap(forced_);
    forced_.clear();
}

void SimulatedBody::add_force(const AttachedPoint& point, const Point& force, bool wakes) {
    if (force == Point{}) return;
    if (wakes) {
        for_each_node(point, [&](std::int32_t node, double) { islands_.wake(body(), std::span(&node, 1)); });
    }
    for_each_node(point, [&](std::int32_t node, double weight) {
        const auto at = static_cast<std::size_t>(node);
        if (is_forced_[at] == 0) forced_.push_back(node);
        is_forced_[at] = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) loads_[at][axis] += weight * force[axis];
    });
}

bool SimulatedBody::is_quiet(const AttachedPoint& point) const {
    bool is_quiet = true;
    for_each_node(point, [&](std::int32_t node, double) { is_quiet = is_quiet && islands_.is_quiet(body(), node); });
    return is_quiet;
}

void SimulatedBody::apply_forces() {
    for (const auto* nodes : {&was_forced_, &forced_}) {
        for (const std::int32_t node : *nodes) body().set_load(node, loads_[static_cast<std::size_t>(node)]);
    }
}

Point SimulatedBody::position(const AttachedPoint& point) const {
    Point at{};
    for_each_node(point, [&](std::int32_t node, double weight) {
        const Point of_node = body().position(node);
        for (std::size_t axis = 0; axis < 3; ++axis) at[axis] += weight * of_node[axis];
    });
    return at;
}

void SimulatedBody::stiffen(std::span<ToolSpring> springs, double h) {
    const double stiffness = mean_mass_ / (2 * h * h);
    shares_.resize(body().nodes());
    for (ToolSpring& spring : springs) {
        spring.stiffness = spring.share * stiffness;
        for_each_node(spring.on_body, [&](std::int32_t node, double) { shares_[static_cast<std::size_t>(node)] = 0; });
    }
    // k w w^T <= k diag |w| for weights of sum 1: what all springs together do to a node.
    for (const ToolSpring& spring : springs) {
        for_each_node(spring.on_body, [&](std::int32_t node, double weight) {
            shares_[static_cast<std::size_t>(node)] += std::abs(weight) * spring.stiffness;
        });
    }
    for (ToolSpring& spring : springs) {
        double factor = 1;
        for_each_node(spring.on_body, [&](std::int32_t node, double) {
            const double most = 2 * body().nodal_mass(node) / (h * h), sum = shares_[static_cast<std::size_t>(node)];
            if (sum > most) factor = std::min(factor, most / sum);
        });
        spring.stiffness *= factor;
    }
}

void SimulatedBody::publish(std::int64_t step, double time) {
    MotionSnapshot* snapshot = snapshots_.begin();
    if (snapshot == nullptr) return;
    snapshot->surface = surface_;
    snapshot->step = step;
    snapshot->time = time;
    // Of a body without cuts and a surface of its own, half of the nodes and more are inside, for nobody to see.
    const std::span<const std::int32_t> nodes = surface_->vertices.as_nodes();
    if (surface_->solid == nullptr && !nodes.empty()) {
        snapshot->positions.clear();
        snapshot->vertices.resize(nodes.size());
        body().positions(nodes, snapshot->vertices);
    } else {
        snapshot->vertices.clear();
        snapshot->positions.resize(body().nodes());
        body().positions(snapshot->positions);
    }
    snapshots_.publish();
}

void SimulatedBody::rest(double world_step) {
    if (!may_sleep() || is_asleep()) return;
    islands_.rest(body(), sleep_, world_step);
}

void SimulatedBody::wake() {
    islands_.wake(body());
}

}  // namespace lancet::runtime
