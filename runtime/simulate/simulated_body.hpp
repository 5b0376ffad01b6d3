#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lancet/runtime/cut/blade.hpp"
#include "lancet/runtime/cut/cuttable_body.hpp"
#include "lancet/runtime/simulate/islands.hpp"
#include "lancet/runtime/simulate/snapshots.hpp"
#include "lancet/runtime/simulate/surface.hpp"
#include "lancet/runtime/simulate/tool_spring.hpp"

namespace lancet::runtime {

/// A body of a simulation, as it is described to it.
struct BodyDefinition {
    std::string name{};  ///< of its tasks; distinct
    Scene scene{};       ///< its gravity is that of the world
    Settings settings{};
    bool can_be_cut = false;  ///< without it nothing of cutting is kept or run
    CutOptions cuts{};
    /// What is drawn and touched by tools, closed and inside of the mesh; none: the boundary of the mesh. At blended
    /// fronts surfaces open when the front has passed.
    std::optional<mesh::TriangleMesh> surface{};
    bool collides_with_others = true;   ///< that do, too
    bool collides_with_itself = false;  ///< with the walls of its wounds, for example
};

/// The motion of a body as it was at some time, for tasks that run while the body goes on.
struct MotionSnapshot {
    std::shared_ptr<const CarriedSurface> surface;  ///< empty where nobody asks for it
    std::int64_t step = 0;
    double time = 0;
    /// [vertex of the surface], where all of them are nodes and nobody asks for more; else empty.
    std::vector<Point> vertices;
    std::vector<Point> positions;  ///< [node of the body] where `vertices` is empty

    /// Where the vertices of the surface are: those of the snapshot, or found in `places`.
    std::span<const Point> find_vertices(Scheduler& scheduler, std::vector<Point>& places) const;
};

/// A body among others: whatever its method, it is stepped, cut, pushed and looked at in the same way.
class SimulatedBody {
  public:
    /// Throws lancet::Error where the world's time step is not a whole multiple of the body's, and as make_body does.
    SimulatedBody(BodyDefinition definition, double world_step, const std::array<double, 3>& gravity,
                  const SleepOptions& sleep, Scheduler& scheduler);

    const std::string& name() const noexcept { return definition_.name; }
    bool collides_with_others() const noexcept { return definition_.collides_with_others; }
    bool collides_with_itself() const noexcept { return definition_.collides_with_itself; }
    bool can_be_cut() const noexcept { return cuttable_ != nullptr; }
    bool has_system() const noexcept { return !is_explicit(definition_.settings.integrator); }
    int steps_per_world_step() const noexcept { return steps_per_world_step_; }

    DeformableBody& body() noexcept { return cuttable_ ? cuttable_->body() : *body_; }
    const DeformableBody& body() const noexcept { return cuttable_ ? cuttable_->body() : *body_; }
    /// nullptr for a body that cannot be cut.
    CuttableBody* cuttable() noexcept { return cuttable_.get(); }
    const CuttableBody* cuttable() const noexcept { return cuttable_.get(); }

    /// One stage of one step; nothing while all islands are asleep.
    void run(StepStage stage, Scheduler& scheduler);

    /// Steps in which no finite state was found: the body was stopped where it was.
    std::int64_t lost_steps() const noexcept { return lost_steps_; }

    /// The edge of the regular tetrahedron that has the mean volume of the elements, in metres.
    double element_size() const noexcept { return element_size_; }
    /// Draws a tool's blade to where it is now.
    CutUpdate draw(Blade& blade, Scheduler& scheduler, const Point& heel, const Point& tip);
    /// Whether cuts have changed the surface since it was made.
    bool surface_is_old() const noexcept { return surface_cuts_ != cuts_; }
    std::int64_t cuts() const noexcept { return cuts_; }
    /// Makes the surface as cuts have left it; with the solid, where `is_solid`.
    void renew_surface(bool is_solid);
    std::shared_ptr<const CarriedSurface> surface() const noexcept { return surface_; }

    /// Dead loads on the nodes of the body as it is now, in place of those of its scene. Wakes the islands whose loads
    /// are others than before. After a cut the scene's own act again, on the nodes that there are then. Throws
    /// lancet::Error as DeformableBody::set_loads does.
    void set_loads(std::span<const Point> loads);

    /// Starts collecting forces for the next step.
    void clear_forces();
    /// A force on a point of the material. Where it `wakes`, the island of the point wakes.
    void add_force(const AttachedPoint& point, const Point& force, bool wakes = true);
    /// Whether all that a point of the material hangs on is asleep, or on the way to it.
    bool is_quiet(const AttachedPoint& point) const;
    double mean_mass() const noexcept { return mean_mass_; }
    /// Hands the collected forces to the body, beside the loads of its scene.
    void apply_forces();

    /// Where a point of the material is.
    Point position(const AttachedPoint& point) const;
    /// Calls visit(node, weight) for what a point of the material hangs on; nodes may repeat.
    template <class Visit>
    void for_each_node(const AttachedPoint& point, const Visit& visit) const {
        for (std::size_t corner = 0; corner < 4; ++corner) {
            if (point.weights[corner] == 0) continue;
            const mesh::Tetrahedron& nodes = nodes_of(point.corners[corner].part);
            for (std::size_t k = 0; k < 4; ++k) {
                const double weight = point.weights[corner] * point.corners[corner].weights[k];
                if (weight != 0) visit(nodes[k], weight);
            }
        }
    }
    /// Sets the stiffness of springs of a tool on this body. With a force that is constant over steps of length h, a
    /// spring k on a mass m is stable for k < 4 m / h^2 (symplectic Euler). Each gets its share of m / (2 h^2) with the
    /// mean mass m of the nodes, so that a tool that slides feels nothing of the mesh; but where all together would
    /// come to more than 2 m_i / h^2 at a node, they get less.
    void stiffen(std::span<ToolSpring> springs, double h);

    /// Takes a snapshot of the motion: what latest() returns until the next.
    void publish(std::int64_t step, double time);
    Snapshots<MotionSnapshot>::Reader latest() noexcept { return snapshots_.latest(); }
    SurfaceSnapshots& shapes() noexcept { return shapes_; }

    /// Lets islands fall asleep, or count towards it, after a world step. Islands in which something is prescribed stay
    /// awake.
    void rest(double world_step);
    /// Wakes all islands.
    void wake();
    /// Whether all islands are asleep.
    bool is_asleep() const { return islands_.are_asleep(body()); }

    /// Islands are what hangs together: one, where nothing has been cut off and the mesh is connected. After a cut they
    /// are numbered anew. None are known where nothing may sleep (SleepOptions).
    int islands() const noexcept { return islands_.count(); }
    bool is_asleep(int island) const { return islands_.is_asleep(body(), island); }
    /// The island of a node of the body; -1 for a node of no element.
    std::int32_t island_of(std::int32_t node) const { return islands_.of_node(node); }

  private:
    bool may_sleep() const noexcept { return sleep_.speed > 0; }
    void find_islands();
    /// Finds the islands that a cut has left, of which those that it has touched wake.
    void follow_cut(const Islands::Before& before, const CutUpdate& update);
    void find_mean_mass();
    /// Forgets collected forces: the loads are those of the scene.
    void start_loads();
    const mesh::Tetrahedron& nodes_of(std::int32_t part) const {
        return cuttable_ ? cuttable_->mesh().parts()[static_cast<std::size_t>(part)]
                         : definition_.scene.mesh.tetrahedra()[static_cast<std::size_t>(part)];
    }

    BodyDefinition definition_;
    SleepOptions sleep_;
    int steps_per_world_step_ = 1;
    double element_size_ = 0;
    std::unique_ptr<DeformableBody> body_;
    std::unique_ptr<CuttableBody> cuttable_;
    std::unique_ptr<mesh::EmbeddedSurface> fine_;
    std::shared_ptr<const CarriedSurface> surface_;
    std::int64_t lost_steps_ = 0;
    std::int64_t cuts_ = 0;           ///< that have changed something
    std::int64_t surface_cuts_ = -1;  ///< that the surface shows
    std::vector<Point> scene_loads_;  ///< [node of the body]
    std::vector<Point> loads_;        ///< [node of the body] with the collected forces
    /// The nodes with collected forces, and those that had some in the last step: the others' loads do not change.
    std::vector<std::int32_t> forced_, was_forced_;
    std::vector<std::uint8_t> is_forced_;  ///< [node of the body]
    double mean_mass_ = 0;                 ///< of the nodes, kg
    std::vector<double> shares_;           ///< [node] of springs, while they are stiffened
    Snapshots<MotionSnapshot> snapshots_;
    SurfaceSnapshots shapes_;
    Islands islands_;
};

}  // namespace lancet::runtime
