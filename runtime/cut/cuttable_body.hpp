#pragma once

#include <map>
#include <memory>
#include <span>
#include <vector>

#include "lancet/mesh/cut/cut_mesh.hpp"
#include "lancet/mesh/cut/front_blend.hpp"
#include "lancet/mesh/cut/lanes.hpp"
#include "lancet/runtime/cut/crumbs.hpp"
#include "lancet/runtime/cut/divided_components.hpp"
#include "lancet/runtime/cut/divided_elements.hpp"
#include "lancet/runtime/cut/divided_inertia.hpp"
#include "lancet/runtime/cut/divided_loads.hpp"
#include "lancet/runtime/cut/motion_after_cut.hpp"
#include "lancet/runtime/simulate/body.hpp"

namespace lancet::runtime {

/// In which configuration a cut surface is given.
enum class Configuration {
    rest,    ///< as the mesh was made
    current  ///< where the body is now
};

/// What a cut changed, and what it took.
struct CutUpdate {
    mesh::CutReport mesh;
    std::vector<Crumb> crumbs{};  ///< all there are now, by nodes of the body
    double seconds_update = 0;    ///< changing the body to the new parts and copies
    bool rebuilt = false;         ///< the body was laid out anew as a whole (see CutOptions::room)
};

/// How cuts are treated.
struct CutOptions {
    mesh::Fronts fronts = mesh::Fronts::sharp;
    CrumbTreatment crumbs = CrumbTreatment::keep;
    double largest_crumb = 0.01;  ///< of the body's volume
    /// Parts of less of their element are taken as thick as this; see mesh::raise_fractions. Nothing needs it.
    double smallest_fraction = 0;
    /// How many new nodes a cut body takes up before it is laid out anew, as a share of those that it has then. As long
    /// as there is room, a cut changes the elements and nodes around it in place; its work is proportional to their
    /// number, with blended fronts to that of all elements that have been cut. 0: every cut lays the body out anew, in
    /// time proportional to its size. So does every cut of a body with a smallest fraction, with block rows, with a
    /// scatter strategy other than private copies, with crumbs that are dropped, or with an explicit integrator whose
    /// critical step has to be found after each cut (unless Settings::force_time_step).
    double room = 0.1;
};

/// A body that can be cut between steps. A cut moves nothing: new copies start where those that they were separated
/// from are, with their velocities, so that positions and velocities are continuous and momentum is kept; what is
/// apart goes its own way from the next step on. A cut that throws leaves the body as it was.
///
/// With blended fronts (lanes.hpp) mass goes over from a copy to the one that opens from it as the front moves on; it
/// takes its velocity along. Where cuts cross a front, mass also goes back, and all copies of the node share what it
/// brings. So linear momentum is kept, and angular momentum but for the opening times that mass.
class CuttableBody {
  public:
    /// Starts without a cut. Throws as make_body does.
    CuttableBody(Scene scene, const Settings& settings, Scheduler& scheduler, const CutOptions& options = {});

    CutUpdate cut(Scheduler& scheduler, const mesh::CutSurface& surface,
                  Configuration configuration = Configuration::current,
                  mesh::FrontTreatment front = mesh::FrontTreatment::retract);
    StepReport step(Scheduler& scheduler) { return body_->step(scheduler); }

    /// Parts and copies as they are now. The nodes of the body are the copies, in their order, and then those that open
    /// at blended fronts.
    const mesh::CutMesh& mesh() const noexcept { return mesh_; }
    /// Where points of the material are beside blended fronts.
    const mesh::FrontBlend& blend() const noexcept { return blend_; }
    /// The body as it is now; the next cut changes or replaces it. What is held or loaded through it is forgotten then.
    DeformableBody& body() noexcept { return *body_; }
    const DeformableBody& body() const noexcept { return *body_; }

    /// Leads all copies of a node of the mesh to a place, as DeformableBody::hold does, also those of cuts to come.
    void hold(std::int32_t node, const Point& target);
    void release(std::int32_t node);

    /// A dead force on a point of the material.
    struct PointLoad {
        std::int32_t element = 0;
        mesh::Barycentric place{};
        Point force{};  ///< N
    };
    /// Replaces the loads on points, beside the scene's own. They stay with their points through cuts to come.
    void set_point_loads(std::span<const PointLoad> loads);

    /// What loads the nodes of the body now: the scene's own, and those on points.
    std::vector<Point> loads() const;

    /// [node of the body] the connected component of parts that it is of, from 0; a node of no part is one by itself.
    std::vector<std::int32_t> components() const { return components_.of_nodes(); }
    /// The nodes of the body that a node of the mesh has become.
    std::vector<std::int32_t> copies_of_node(std::int32_t node) const;

    /// Where a point of the material is now.
    Point position(std::int32_t element, const mesh::Barycentric& place) const;

  private:
    void apply_loads();
    void stop(std::span<const Crumb> crumbs);
    /// The momentum of all copies of a node of the mesh, and their mass.
    struct NodeMomentum {
        Point momentum{};
        double mass = 0;
    };
    NodeMomentum momentum_of_node(std::int32_t node) const;
    /// Gives the copies of some nodes of the mesh the momentum that they had, by the same change of all velocities.
    void keep_momentum(const std::map<std::int32_t, NodeMomentum>& before);
    /// True where cuts change the body in place as long as there is room.
    bool can_change() const;
    Settings settings_with_room(std::size_t nodes) const;
    BodyChange body_change(std::span<const DividedElements::Change> lanes, const BodyBeforeCut& before) const;
    void rebuild(Scheduler& scheduler, const mesh::CutMesh& mesh, const BodyBeforeCut& before, CutUpdate& update);

    Scene scene_;  ///< without cuts
    Settings settings_;
    CutOptions options_;
    mesh::CutMesh mesh_;
    mesh::FrontBlend blend_;
    DividedInertia inertia_;
    DividedLoads scene_loads_;
    DividedElements elements_;
    DividedComponents components_;
    std::vector<bool> is_fixed_;  ///< [node of the mesh]
    std::unique_ptr<DeformableBody> body_;
    bool has_loads_ = true;  ///< the body may have some
    std::map<std::int32_t, Point> holds_;
    std::vector<PointLoad> point_loads_;
};

}  // namespace lancet::runtime
