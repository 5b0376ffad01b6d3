#include "lancet/experiments/collision/measure.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>

#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/statistics.hpp"
#include "lancet/runtime/collide/tool_contact.hpp"
#include "lancet/runtime/collide/vertex_contact.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments::collision {
namespace {

using runtime::Box;
using runtime::BoxPair;

template <class Function>
double milliseconds(const Function& function) {
    const double start = runtime::steady_seconds();
    function();
    return 1e3 * (runtime::steady_seconds() - start);
}

/// What is asked in one step: where bodies and tool are, and the boxes that come from that.
struct Moment {
    std::vector<Point> body, other;
    std::vector<Box> boxes;    ///< of the body's primitives
    std::vector<Box> queries;  ///< of the tool's segments, or points at the vertices
    runtime::ToolMotion motion{};
};

Moment moment_at(const Scene& scene, double time, double time_before) {
    Moment moment;
    moment.body.resize(scene.body.nodes);
    scene.body.place(time, moment.body);
    moment.boxes.resize(scene.primitives());
    const std::span<const Point> positions(moment.body);
    if (scene.tool) {
        runtime::boxes_around(positions, std::span(scene.body.surface), 0, moment.boxes);
        moment.motion.set(*scene.tool, scene.tool_pose(time_before), scene.tool_pose(time));
        for (std::size_t pose = 0; pose < moment.motion.poses(); ++pose) {
            for (const runtime::Segment& segment : moment.motion.axis(pose)) {
                const std::array ends{segment.start, segment.end};
                moment.queries.push_back(runtime::box_around(ends, moment.motion.radius()));
            }
        }
        return moment;
    }
    runtime::boxes_around(positions, std::span(scene.body.tetrahedra), 0, moment.boxes);
    if (scene.other) {
        moment.other.resize(scene.other->nodes);
        scene.other->place(time, moment.other);
    }
    for (const Point& point : scene.other ? moment.other : moment.body) moment.queries.push_back({point, point});
    return moment;
}

/// One kind in one scene, over all steps and repetitions.
class Contestant {
  public:
    Contestant(const Scene& scene, runtime::BroadPhaseKind kind)
        : scene_(scene),
          phase_(runtime::make_broad_phase(kind)),
          body_(scene.body.nodes, scene.body.tetrahedra, scene.body.surface, kind) {
        if (scene.other) {
            other_.emplace(scene.other->nodes, scene.other->tetrahedra, scene.other->surface, kind);
        }
    }

    void start(const Moment& moment, std::size_t steps) {
        // A new one: building into the arrays of an earlier build would be faster.
        phase_ = runtime::make_broad_phase(phase_->kind());
        build_.push_back(milliseconds([&] { phase_->build(moment.boxes); }));
        refit_.emplace_back(steps);
        query_.emplace_back(steps);
        contact_.emplace_back(steps);
    }

    void step(const Moment& moment, std::size_t step, runtime::Scheduler& scheduler) {
        refit_.back()[step] = milliseconds([&] { phase_->refit(moment.boxes); });
        query_.back()[step] = milliseconds([&] { phase_->pairs(scheduler, moment.queries, pairs_); });
        body_.update(moment.body);
        if (other_) other_->update(moment.other);
        contact_.back()[step] = milliseconds([&] {
            if (scene_.tool) {
                tool_finder_.find(body_.surface_boxes(), body_.positions(), body_.surface(), moment.motion,
                                  tool_contacts_);
            } else {
                vertex_finder_.find(scheduler, other_ ? *other_ : body_, body_, contacts_);
            }
        });
        if (build_.size() > 1) return;  // the same in every repetition
        candidates_ += pairs_.size();
        contacts_count_ += contact_count();
        unresolved_ += scene_.tool ? 0 : vertex_finder_.unresolved();
        rebuilds_ = phase_->rebuilds();
    }

    const std::vector<BoxPair>& pairs() const { return pairs_; }
    std::size_t contact_count() const { return scene_.tool ? tool_contacts_.size() : contacts_.size(); }

    Row row(std::size_t steps) const {
        Row row{.scene = scene_.name, .kind = std::string(to_string(phase_->kind()))};
        const auto mean = [steps](std::size_t sum) { return static_cast<std::int64_t>(sum / steps); };
        row.ms_build = *std::ranges::min_element(build_);
        row.ms_refit = shortest(refit_);
        row.ms_query = shortest(query_);
        row.ms_contacts = shortest(contact_);
        row.rebuilds = static_cast<double>(rebuilds_) / static_cast<double>(steps);
        row.candidates = mean(candidates_);
        row.contacts = mean(contacts_count_);
        if (!scene_.tool) row.unresolved = mean(unresolved_);
        row.megabytes = static_cast<double>(phase_->bytes()) / 1e6;
        std::vector<double> medians;
        for (std::size_t repetition = 0; repetition < refit_.size(); ++repetition) {
            std::vector<double> both(steps);
            std::ranges::transform(refit_[repetition], query_[repetition], both.begin(), std::plus());
            medians.push_back(median(both));
        }
        const Summary summary = summarize(medians);
        if (summary.median > 0) row.noise_percent = 100 * (summary.maximum - summary.minimum) / summary.median;
        if (row.noise_percent > 20) row.note = "noisy";
        return row;
    }

  private:
    using Times = std::vector<std::vector<double>>;  ///< [repetition][step] ms

    /// Every repetition does the same: whatever else runs on the machine can only make it longer.
    static double shortest(const Times& times) {
        std::vector<double> best = times.front();
        for (const std::vector<double>& repetition : times) {
            std::ranges::transform(best, repetition, best.begin(), [](double a, double b) { return std::min(a, b); });
        }
        return median(best);
    }

    const Scene& scene_;
    std::unique_ptr<runtime::BroadPhase> phase_;
    runtime::CollidableBody body_;
    std::optional<runtime::CollidableBody> other_;
    runtime::ToolContactFinder tool_finder_;
    runtime::VertexContactFinder vertex_finder_;
    std::vector<runtime::ToolContact> tool_contacts_;
    std::vector<runtime::VertexContact> contacts_;
    std::vector<BoxPair> pairs_;
    std::vector<double> build_;
    Times refit_, query_, contact_;
    std::size_t candidates_ = 0, contacts_count_ = 0, unresolved_ = 0;
    std::int64_t rebuilds_ = 0;
};

void require_same(const Contestant& first, const Contestant& other, const std::string& what) {
    if (first.pairs() != other.pairs()) {
        throw CheckFailed(what + ": " + std::to_string(other.pairs().size()) + " pairs of boxes instead of " +
                          std::to_string(first.pairs().size()));
    }
    if (first.contact_count() != other.contact_count()) {
        throw CheckFailed(what + ": " + std::to_string(other.contact_count()) + " contacts instead of " +
                          std::to_string(first.contact_count()));
    }
}

}  // namespace

std::vector<Row> measure(const Scene& scene, const CollisionSettings& settings, runtime::Scheduler& scheduler,
                         Progress& progress) {
    const auto steps = static_cast<std::size_t>(settings.steps);
    std::vector<Moment> moments;
    for (int step = 0; step < settings.steps; ++step) {
        moments.push_back(moment_at(scene, double(step) / settings.steps, std::max(step - 1.0, 0.0) / settings.steps));
    }
    std::size_t queries = 0;
    for (const Moment& moment : moments) queries += moment.queries.size();
    queries /= steps;
    const bool is_too_many =
        static_cast<double>(scene.primitives()) * static_cast<double>(queries) > settings.most_tests;
    std::vector<runtime::BroadPhaseKind> kinds = settings.kinds;
    if (is_too_many) std::erase(kinds, runtime::BroadPhaseKind::brute_force);
    std::vector<Contestant> contestants;
    for (const runtime::BroadPhaseKind kind : kinds) contestants.emplace_back(scene, kind);

    for (int repetition = 0; repetition < settings.repetitions; ++repetition) {
        progress.show(scene.name + ", " + std::to_string(scene.primitives()) + " primitives: repetition " +
                      std::to_string(repetition + 1) + " of " + std::to_string(settings.repetitions));
        for (Contestant& contestant : contestants) contestant.start(moments.front(), steps);
        for (std::size_t step = 0; step < steps; ++step) {
            for (Contestant& contestant : contestants) {
                contestant.step(moments[step], step, scheduler);
                require_same(contestants.front(), contestant, scene.name + ", step " + std::to_string(step));
            }
        }
    }

    std::vector<Row> rows;
    for (const Contestant& contestant : contestants) rows.push_back(contestant.row(steps));
    if (is_too_many && kinds.size() < settings.kinds.size()) {
        rows.push_back({.scene = scene.name,
                        .kind = std::string(to_string(runtime::BroadPhaseKind::brute_force)),
                        .note = "left out: too many tests"});
    }
    const auto brute =
        std::ranges::find(rows, std::string(to_string(runtime::BroadPhaseKind::brute_force)), &Row::kind);
    for (Row& row : rows) {
        row.primitives = static_cast<std::int64_t>(scene.primitives());
        row.queries = static_cast<std::int64_t>(queries);
        if (brute != rows.end() && brute->ms_query && row.ms_query) {
            row.times_brute_force = (*brute->ms_refit + *brute->ms_query) / (*row.ms_refit + *row.ms_query);
        }
    }
    return rows;
}

}  // namespace lancet::experiments::collision
