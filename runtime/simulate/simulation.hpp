#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lancet/runtime/observe/task_observer.hpp"
#include "lancet/runtime/schedule/step_graph.hpp"
#include "lancet/runtime/simulate/body_contacts.hpp"
#include "lancet/runtime/simulate/frame_thread.hpp"
#include "lancet/runtime/simulate/rate.hpp"
#include "lancet/runtime/simulate/sample_queue.hpp"
#include "lancet/runtime/simulate/touchable_surface.hpp"

namespace lancet::runtime {

/// What happens to a frame that is due while the last one is still being observed.
enum class FramePolicy {
    drop,  ///< it is left out, and counted: the simulation never waits
    wait   ///< the simulation waits: no frame is missing
};

struct SimulationOptions {
    double time_step = 0.04;                                 ///< s, of the world: a whole multiple of each body's
    std::array<double, 3> gravity{0, -9.81, 0};              ///< m / s^2
    double frame_rate = 30;                                  ///< Hz of simulated time
    double collision_rate = 200;                             ///< Hz of simulated time
    BroadPhaseKind broad_phase = BroadPhaseKind::aabb_tree;  ///< of bodies
    FramePolicy frames = FramePolicy::drop;
    /// Surfaces, frames and collision work on the state that a step starts from, beside its solve; what they find acts
    /// in the step after. Without it they follow on the solve.
    bool overlap = true;
    SleepOptions sleep{};
};

/// A tool, in its own frame.
struct ToolDefinition {
    std::string name{};
    ToolShape shape{};
    std::optional<std::array<Point, 2>> blade{};  ///< heel and tip of its cutting edge; none: it does not cut
    double grab_distance = 0.01;                  ///< m from its surface within which it takes hold
    bool is_recorded = false;                     ///< keeps all samples: see Simulation::recorded
};

/// How often a task has run, and how long it took.
struct TaskStatistics {
    std::string name;
    std::int64_t runs = 0;
    double seconds = 0;
    double longest = 0;  ///< s
};

/// How frames went.
struct FrameStatistics {
    std::int64_t due = 0;
    std::int64_t observed = 0;
    std::int64_t dropped = 0;
};

/// What cuts have taken, all together.
struct CutStatistics {
    std::int64_t cuts = 0;  ///< that touched an element
    std::int64_t elements = 0;
    std::int64_t copies = 0;
    double seconds = 0;
    double longest = 0;  ///< s
};

/// A world of bodies and tools, stepped on a scheduler (Jerabkova 2007, chapter 4). One thread builds it and steps it;
/// other threads may move tools, and ask for surfaces and forces, at any time after it has been built.
///
/// The tasks of a step and what they wait for:
///
///     input -> cut -> contact forces -> [forces -> matrix -> solve -> update] -> snapshot, force feedback
///     surface -> frame                     beside them, from the last snapshot
///     tool collision, body collision       likewise
///
/// Contacts are penalties: springs that are as stiff as is stable for a force that is constant over a step, so they
/// give way by more with longer steps. There is no friction.
///
/// What a scene does not need is no task of its graph.
class Simulation {
  public:
    /// The scheduler must outlive the simulation. Throws lancet::Error for options that make no sense.
    explicit Simulation(Scheduler& scheduler, const SimulationOptions& options = {});
    ~Simulation();

    /// Both return the number by which it is addressed, from 0. Throw lancet::Error for what makes no sense, or a name
    /// that is taken.
    int add_body(BodyDefinition definition);
    int add_tool(ToolDefinition definition);
    /// Asks for frames: `observer` is called for each on a thread of its own. What it throws, the next step throws.
    void observe_frames(std::function<void(const Frame&)> observer);
    /// Asks for surfaces at the frame rate, for latest_surface, without frames.
    void keep_surfaces();
    /// Tells of each task that has run; nullptr: nobody. Must outlive the simulation's use of it.
    void observe_tasks(TaskObserver* observer);

    /// Moves a tool, from any thread but one at a time for each tool. It is there at the end of the next step. Of
    /// several samples in one step the last counts; a blade starts and ends its cuts where the samples say. False if
    /// the tool is so far ahead of the simulation that there is no room: the sample is lost. Throws lancet::Error as
    /// require_valid does.
    bool move(int tool, const Pose& pose, ToolAction action);
    /// Moves a tool along a path from now on: at each step the samples since the last one. Replaces what move brings.
    void play(int tool, ToolPath path);
    /// All samples that a tool has followed, in the time of the simulation, where its definition asks for it: played
    /// again on the same world, they repeat it to the bit.
    const ToolPath& recorded(int tool) const;

    /// Takes one step of the world. What a task throws is thrown; steps can be taken again afterwards.
    void step();
    /// Brings surfaces and frames up to the last step, and returns when no frame is being observed.
    void finish();

    double time() const noexcept { return static_cast<double>(steps_) * options_.time_step; }
    std::int64_t steps() const noexcept { return steps_; }
    int bodies() const noexcept { return static_cast<int>(bodies_.size()); }
    SimulatedBody& body(int body);
    /// The latest surface; empty before the first. From any thread.
    SurfaceSnapshots::Reader latest_surface(int body);
    /// The force on a tool at a pose, by the model of the last step; zero before the first. From any thread.
    Wrench force(int tool, const Pose& pose);
    /// The model itself; empty before the first. From any thread.
    Snapshots<ForceModel>::Reader latest_forces(int tool);

    /// The tasks as they are now.
    const StepGraph& graph();
    std::vector<TaskStatistics> task_statistics() const;
    FrameStatistics frame_statistics() const;
    /// How often contacts have been looked for.
    std::int64_t collisions() const noexcept { return collisions_; }
    CutStatistics cut_statistics() const noexcept;

  private:
    struct Tool {
        ToolDefinition definition;
        SampleQueue queue;
        ToolPath path;           ///< to be played
        std::size_t played = 0;  ///< samples of it
        ToolPath recorded;
        ToolPath samples;   ///< of this step
        ToolSample now;     ///< at the end of this step
        ToolSample before;  ///< at the end of the last
        bool is_placed = false;
        std::vector<Blade> blades;   ///< [body]: it is drawn through them at the same time
        std::vector<Segment> axis;   ///< of its shape in space, now
        std::optional<Pose> tested;  ///< where contacts were last looked for
        ToolMotion motion;           ///< from there
        std::vector<ToolSpring> grabs;
        std::vector<ToolSpring> contacts;
        std::vector<ToolSpring> found;  ///< contacts, by the collision task; taken up by the next step
        Snapshots<ForceModel> forces;

        bool is_felt() const noexcept {
            return is_placed && (now.action == ToolAction::touch || now.action == ToolAction::grab);
        }
    };
    using Task = StepGraph::Task;

    void build_graph();
    Task add_task(const std::string& name, std::function<void()> body);
    /// The tasks of one body's steps; `before` precedes the first. Returns the last.
    Task add_steps(int body, const std::optional<Task>& before);
    bool has_surfaces() const noexcept { return frame_thread_ != nullptr || keeps_surfaces_; }
    bool has_blade() const noexcept;
    /// Makes what is kept for each body, so that the tasks of different bodies change nothing in common.
    void make_room_for_bodies();

    void take_input();
    void cut(SimulatedBody& body, std::size_t number);
    /// Whether bodies can collide with each other or themselves.
    bool bodies_collide() const noexcept;
    void push_bodies();
    void push_apart();
    void take_hold(Tool& tool);
    void stiffen_contacts(Tool& tool);
    void find_tool_contacts();
    void find_body_contacts();
    void evaluate_surface(std::size_t body);
    void make_frame();
    void feel();
    const MotionSnapshot* seen(std::size_t body, Snapshots<MotionSnapshot>::Reader& reader);

    Tool& tool_at(int tool);
    const Tool& tool_at(int tool) const;

    Scheduler* scheduler_;
    SimulationOptions options_;
    std::vector<std::unique_ptr<SimulatedBody>> bodies_;
    std::vector<std::unique_ptr<Tool>> tools_;
    std::unique_ptr<FrameThread> frame_thread_;
    bool keeps_surfaces_ = false;
    TaskObserver* task_observer_ = nullptr;

    StepGraph graph_;
    bool graph_is_old_ = true;
    std::deque<TaskStatistics> statistics_;  ///< a deque: observers keep the names

    std::int64_t steps_ = 0;
    Rate frame_rate_, collision_rate_;
    bool frame_is_due_ = false, collision_is_due_ = false;
    std::vector<Snapshots<MotionSnapshot>::Reader> before_;  ///< [body] the state that the step starts from
    std::vector<Point> vertex_places_;                       ///< of a body that a tool may take hold of
    std::vector<Point> touched_places_;                      ///< of a body that tools may touch
    std::vector<SurfaceEvaluator> evaluators_;               ///< [body]
    std::vector<TouchableSurface> touchable_;                ///< [body]
    std::optional<BodyContactFinder> body_contact_finder_;
    std::vector<BodyContact> body_contacts_, found_body_contacts_;  ///< acting, and found by the collision task
    std::vector<Snapshots<MotionSnapshot>::Reader> held_;           ///< [body] by the search for contacts of bodies
    std::vector<const MotionSnapshot*> seen_;                       ///< [body] likewise
    std::int64_t collisions_ = 0, frames_due_ = 0, frames_dropped_ = 0;
    std::vector<CutStatistics> cut_statistics_;  ///< [body]: the bodies are cut at the same time
};

}  // namespace lancet::runtime
