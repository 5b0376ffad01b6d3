#include "lancet/experiments/cutting/motion.hpp"

#include <array>
#include <utility>

namespace lancet::experiments::cutting {
namespace {

/// A scenario's exact steps.
struct Reference {
    std::vector<Frame> frames;
    std::vector<Point> rest;  ///< of all copies at the end; earlier frames have the first of them
};

/// What is run: a scenario, and how fronts of cuts are treated.
struct Body {
    std::string variant;
    const Scenario* scenario;
    mesh::Fronts fronts;
};

Reference make_reference(const Body& body, const Study& study) {
    const Scenario& scenario = *body.scenario;
    Reference reference;
    const auto settings = converged_settings(scenario.time_step, study.arithmetics.front().instruction_set);
    const auto take_rest = [&](int step, const runtime::CuttableBody& cut) {
        if (step == scenario.steps) reference.rest = cut.mesh().rest_positions();
    };
    reference.frames = run(scenario, settings, *study.scheduler, take_rest, body.fronts);
    return reference;
}

/// Repetitions of one run, by arithmetic; only the first keeps the positions.
using Repetitions = std::vector<std::vector<Frame>>;

Row frame_row(const Row& run, const Repetitions& repetitions, std::size_t step) {
    const Frame& frame = repetitions.front()[step];
    Row row = run;
    row.frame = frame.step;
    row.time = frame.time;
    row.cut_elements = frame.cut_elements;
    row.parts = frame.parts;
    row.added_dofs = 3 * frame.added_nodes;
    row.ms_geometry = row.ms_topology = row.ms_update = std::nullopt;
    row.step_ratio = row.step_ratio_of_cut_element = row.noise_percent = std::nullopt;
    if (frame.cut) {
        row.ms_geometry = shortest(repetitions, step, [](const Frame& f) { return f.cut->ms_geometry; });
        row.ms_topology = shortest(repetitions, step, [](const Frame& f) { return f.cut->ms_topology; });
        row.ms_update = shortest(repetitions, step, [](const Frame& f) { return f.cut->ms_update; });
    }
    row.ms_step = shortest(repetitions, step, [](const Frame& f) { return f.ms_step; });
    row.ms_solve = shortest(repetitions, step, [](const Frame& f) { return f.ms_solve; });
    row.cg_iterations = frame.cg_iterations;
    row.note.clear();
    return row;
}

}  // namespace

Row start_row(const std::string& scene, const std::string& variant, const Study& study, std::size_t arithmetic) {
    Row row{.scene = scene,
            .variant = variant,
            .matrix = std::string(to_string(study.arithmetics[arithmetic].matrix)),
            .scalar = std::string(to_string(study.arithmetics[arithmetic].scalar))};
    const LaneRatio& ratio = study.lane_ratios[arithmetic];
    row.cut_lane_ratio = ratio.both;
    row.force_ratio = ratio.force;
    row.product_ratio = ratio.product;
    row.edge_ratio = ratio.edges;
    return row;
}

void fill(Row& row, const std::vector<std::vector<Frame>>& repetitions, const Scenario& scenario) {
    const Frame& last = repetitions.front().back();
    row.elements = static_cast<std::int64_t>(scenario.scene.mesh.tetrahedra().size());
    row.nodes = static_cast<std::int64_t>(scenario.scene.mesh.nodes().size());
    row.cut_elements = last.cut_elements;
    row.parts = last.parts;
    row.added_dofs = 3 * last.added_nodes;
    row.time = last.time;
    // Of each cut the shortest of its times.
    CutTimes sum;
    int cuts = 0;
    double iterations = 0;
    for (std::size_t k = 0; k < repetitions.front().size(); ++k) {
        const Frame& frame = repetitions.front()[k];
        iterations += frame.cg_iterations;
        if (!frame.cut) continue;
        ++cuts;
        sum.ms_geometry += shortest(repetitions, k, [](const Frame& f) { return f.cut->ms_geometry; });
        sum.ms_topology += shortest(repetitions, k, [](const Frame& f) { return f.cut->ms_topology; });
        sum.ms_update += shortest(repetitions, k, [](const Frame& f) { return f.cut->ms_update; });
    }
    if (cuts > 0) {
        row.ms_geometry = sum.ms_geometry / cuts;
        row.ms_topology = sum.ms_topology / cuts;
        row.ms_update = sum.ms_update / cuts;
    }
    row.cg_iterations = iterations / static_cast<double>(repetitions.front().size());
    const Timing step = timing(repetitions, [](const Frame& frame) { return frame.ms_step; });
    row.ms_step = step.median;
    row.ms_solve = timing(repetitions, [](const Frame& frame) { return frame.ms_solve; }).median;
    if (repetitions.size() > 1) row.noise_percent = step.noise_percent;
    row.note = noise_note(row.noise_percent);
}

Motion measure_motion(const Scenario& scenario, const Study& study, Progress& progress) {
    Scenario uncut = scenario;
    uncut.strokes.clear();
    const std::array<Body, 3> bodies{{{"uncut", &uncut, mesh::Fronts::sharp},
                                      {"cut", &scenario, mesh::Fronts::sharp},
                                      {"cut, blended front", &scenario, mesh::Fronts::blended}}};
    std::vector<Reference> references;
    for (const Body& body : bodies) {
        progress.show(scenario.name + ": converged reference, " + body.variant);
        references.push_back(make_reference(body, study));
    }
    const std::size_t arithmetics = study.arithmetics.size();
    std::array<std::vector<Repetitions>, bodies.size()> measured;
    for (auto& of_body : measured) of_body.resize(arithmetics);
    std::array<std::vector<std::vector<std::optional<double>>>, bodies.size()> errors;  // [body][arithmetic][frame]
    for (auto& of_body : errors) of_body.resize(arithmetics);
    for (int repetition = 0; repetition < study.repetitions; ++repetition) {
        for (std::size_t a = 0; a < arithmetics; ++a) {
            progress.show(scenario.name + ": run " + std::to_string(repetition + 1) + " of " +
                          std::to_string(study.repetitions) + ", " +
                          std::string(to_string(study.arithmetics[a].matrix)) + ", " +
                          std::string(to_string(study.arithmetics[a].scalar)));
            for (std::size_t b = 0; b < bodies.size(); ++b) {
                auto frames = run(*bodies[b].scenario, interactive_settings(study.arithmetics[a], scenario.time_step),
                                  *study.scheduler, {}, bodies[b].fronts);
                for (std::size_t step = 0; step < frames.size(); ++step) {
                    if (repetition == 0) {
                        errors[b][a].push_back(error_l2(frames[step], references[b].frames[step], references[b].rest));
                    }
                    frames[step].positions = {};
                    frames[step].mass = {};
                }
                measured[b][a].push_back(std::move(frames));
            }
        }
    }

    Motion motion;
    for (std::size_t a = 0; a < arithmetics; ++a) {
        Row before;
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            Row row = start_row(scenario.name, bodies[b].variant, study, a);
            fill(row, measured[b][a], scenario);
            row.error_l2 = errors[b][a].back();
            if (b == 0) {
                before = row;
            } else {
                row.step_ratio = *row.ms_step / *before.ms_step;
                for (std::size_t step = 0; step < errors[b][a].size(); ++step) {
                    motion.frames.push_back(frame_row(row, measured[b][a], step));
                    motion.frames.back().error_l2 = errors[b][a][step];
                }
            }
            motion.runs.push_back(std::move(row));
        }
    }
    return motion;
}

}  // namespace lancet::experiments::cutting
