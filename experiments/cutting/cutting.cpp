// Cutting: bodies that are cut while they move, what that costs and what it gets wrong, and how they look.

#include <algorithm>
#include <iostream>
#include <set>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/cutting/beam_cut.hpp"
#include "lancet/experiments/cutting/cost.hpp"
#include "lancet/experiments/cutting/fraction_floor.hpp"
#include "lancet/experiments/cutting/frames.hpp"
#include "lancet/experiments/cutting/motion.hpp"
#include "lancet/experiments/cutting/picture.hpp"
#include "lancet/experiments/cutting/settings.hpp"
#include "lancet/runtime/observe/machine_stamp.hpp"
#include "lancet/runtime/observe/machine_stamp_json.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::cutting;

Study make_study(const CuttingSettings& settings, runtime::Scheduler& scheduler, Progress& progress) {
    Study study{.arithmetics = {},
                .lane_ratios = {},
                .repetitions = settings.repetitions,
                .is_quick = settings.shared.quick,
                .scheduler = &scheduler};
    for (const std::string& scalar : settings.scalars) {
        for (const std::string& matrix : settings.operators) {
            study.arithmetics.push_back({.matrix = runtime::operator_kind_from_string(matrix),
                                         .scalar = runtime::scalar_mode_from_string(scalar),
                                         .instruction_set = settings.instruction_set});
        }
    }
    for (const Arithmetic& arithmetic : study.arithmetics) {
        progress.show("force and product of once-cut elements, " + std::string(to_string(arithmetic.matrix)) + ", " +
                      std::string(to_string(arithmetic.scalar)));
        study.lane_ratios.push_back(measure_lane_ratio(bar(settings.shared.quick), arithmetic, 0.04, scheduler,
                                                       settings.shared.quick ? 40 : 150));
    }
    return study;
}

Table make_lane_table(const Study& study) {
    Table table({{"operator", "operator"},
                 {"scalar", "scalar"},
                 {"force_ns", "force", "ns"},
                 {"product_ns", "product", "ns"},
                 {"force_ratio", "force", "of uncut"},
                 {"product_ratio", "product", "of uncut"},
                 {"cut_lane_ratio", "both", "of uncut"},
                 {"lane_ratio", "parts", "of uncut"},
                 {"node_ratio", "copies", "of uncut"},
                 {"edge_ratio", "edges", "of uncut"},
                 {"noise_percent", "noise", "%", 2},
                 {"note", "note"}});
    for (std::size_t a = 0; a < study.arithmetics.size(); ++a) {
        const LaneRatio& ratio = study.lane_ratios[a];
        table.add_row({std::string(to_string(study.arithmetics[a].matrix)),
                       std::string(to_string(study.arithmetics[a].scalar)), ratio.force_ns, ratio.product_ns,
                       ratio.force, ratio.product, ratio.both, ratio.lanes, ratio.nodes, ratio.edges,
                       ratio.noise_percent, noise_note(ratio.noise_percent)});
    }
    return table;
}

/// Runs a scenario once more, for pictures alone. Returns what kept them from being drawn.
std::string show(const Scenario& scenario, const Study& study, const CuttingSettings& settings) {
    if (settings.pvd.empty() && settings.plot.empty()) return {};
    std::optional<Frames> frames;
    if (!settings.pvd.empty()) frames.emplace(settings.pvd, scenario.name);
    std::vector<Shape> shapes;
    (void)run(scenario, interactive_settings(study.arithmetics.front(), scenario.time_step), *study.scheduler,
              [&](int step, const runtime::CuttableBody& body) {
                  const bool is_drawn = std::ranges::find(scenario.view.steps, step) != scenario.view.steps.end();
                  if (!frames && !is_drawn) return;
                  Shape shape = take_shape(step, body);
                  if (frames) frames->add(shape);
                  if (is_drawn) shapes.push_back(std::move(shape));
              });
    return settings.plot.empty() ? "" : draw(shapes, scenario.view, scenario.title, settings.plot, scenario.name);
}

/// At most a dozen frames of the first arithmetic: those with cuts, and the last.
std::vector<Row> printed_frames(const std::vector<Row>& frames) {
    std::vector<Row> with_cuts;
    for (const Row& row : frames) {
        const bool is_first = row.variant == frames.front().variant && row.matrix == frames.front().matrix &&
                              row.scalar == frames.front().scalar;
        if (is_first && row.ms_geometry) with_cuts.push_back(row);
    }
    constexpr std::size_t most = 12;
    const std::size_t stride = (with_cuts.size() + most - 1) / most;
    std::vector<Row> printed;
    for (std::size_t k = 0; k < with_cuts.size(); k += stride) printed.push_back(with_cuts[k]);
    return printed;
}

void print(const std::string& title, std::span<const Row> rows, std::span<const std::string_view> keys) {
    std::cout << title << '\n';
    make_table(rows, keys).print(std::cout);
    std::cout << '\n' << std::flush;
}

constexpr std::array<std::string_view, 14> run_keys{
    "variant",     "operator",  "scalar",  "elements",   "cut_elements",  "added_dofs", "ms_geometry",
    "ms_topology", "ms_update", "ms_step", "step_ratio", "cg_iterations", "error_l2",   "note"};
constexpr std::array<std::string_view, 11> frame_keys{"frame",       "time_s",        "cut_elements", "added_dofs",
                                                      "ms_geometry", "ms_topology",   "ms_update",    "ms_step",
                                                      "ms_solve",    "cg_iterations", "error_l2"};
constexpr std::array<std::string_view, 13> cost_keys{"variant",
                                                     "operator",
                                                     "scalar",
                                                     "cut_elements",
                                                     "added_dofs",
                                                     "ms_geometry",
                                                     "ms_topology",
                                                     "ms_update",
                                                     "ms_step",
                                                     "step_ratio",
                                                     "step_ratio_of_cut_element",
                                                     "error_l2",
                                                     "note"};
constexpr std::array<std::string_view, 12> beam_keys{"variant",      "model",        "elements",    "cut_elements",
                                                     "unknowns",     "added_dofs",   "ms_geometry", "ms_solve",
                                                     "error_energy", "order_energy", "error_l2",    "order_l2"};

constexpr std::array<std::string_view, 6> floor_keys{"variant",       "elements", "cut_elements",
                                                     "cg_iterations", "error_l2", "error_energy"};

std::vector<Row> study_scene(const std::string& name, const Study& study, const CuttingSettings& settings,
                             Progress& progress, std::set<std::string>& complaints) {
    if (name == "cost") {
        std::vector<Row> rows = measure_cost(study, progress);
        progress.clear();
        print(
            "Cost: a step of the Bar (ten CG iterations) by how much of it is cut; 'cut element' is what one adds to "
            "the step, over an uncut one",
            rows, cost_keys);
        return rows;
    }
    if (name.starts_with("beam-case")) {
        const std::string load = name.substr(9);
        std::vector<Row> rows = measure_beam_cut(load, settings.levels, *study.scheduler, progress);
        progress.clear();
        print("Beam cut, case " + load + ": statics against an independent code's extrapolated solution", rows,
              beam_keys);
        return rows;
    }
    if (name == "fraction-floor") {
        std::vector<Row> rows = measure_fraction_floor(*study.scheduler, study.is_quick, progress);
        progress.clear();
        print(
            "Floor under the fractions of thin parts: a block cut in two beside its nodes, against one cut along them",
            rows, floor_keys);
        return rows;
    }
    const Scenario scenario = name == "dissected-beam" ? dissected_beam(study.is_quick)
                              : name == "organ"        ? organ(settings.organ, study.is_quick)
                                                       : scalpel(study.is_quick, *study.scheduler);
    const Motion motion = measure_motion(scenario, study, progress);
    progress.show(name + ": pictures");
    complaints.insert(show(scenario, study, settings));
    progress.clear();
    print(scenario.title + "; errors against converged steps of the same length", motion.runs, run_keys);
    std::vector<Row> rows = motion.runs;
    if (scenario.strokes.size() > 1) {
        print("The same, frame by frame: " + motion.frames.front().variant + ", " + motion.frames.front().matrix +
                  ", " + motion.frames.front().scalar,
              printed_frames(motion.frames), frame_keys);
        rows.insert(rows.end(), motion.frames.begin(), motion.frames.end());
    }
    return rows;
}

ExitCode body(int argc, const char* const* argv) {
    const std::optional<CuttingSettings> settings = parse_settings(argc, argv);
    if (!settings) return ExitCode::success;
    const auto scheduler = runtime::make_scheduler(settings->scheduler, settings->threads);
    Progress progress;
    const auto is_statics = [](const std::string& name) {
        return name.starts_with("beam-case") || name == "fraction-floor";
    };
    // Statics time nothing that the cost of cut elements would explain.
    Study study{.is_quick = settings->shared.quick, .scheduler = scheduler.get()};
    nlohmann::ordered_json lanes = nlohmann::ordered_json::array();
    if (!std::ranges::all_of(settings->scenes, is_statics)) {
        study = make_study(*settings, *scheduler, progress);
        progress.clear();
        const Table table = make_lane_table(study);
        std::cout << "Cut elements: force and product of the Bar with every element cut once, per element\n";
        table.print(std::cout);
        std::cout << '\n' << std::flush;
        lanes = table.to_json();
    }
    std::vector<Row> rows;
    std::set<std::string> complaints;
    for (const std::string& name : settings->scenes) {
        const std::vector<Row> found = study_scene(name, study, *settings, progress, complaints);
        rows.insert(rows.end(), found.begin(), found.end());
    }
    complaints.erase("");
    for (const std::string& complaint : complaints) {
        std::cerr << "no pictures: " << complaint << "; " << settings->plot.string()
                  << " has the data and the scripts, and the Debian package gnuplot-nox draws them\n";
    }
    const Table table = make_table(rows);
    if (settings->shared.csv) table.write_csv(*settings->shared.csv);
    if (settings->shared.json) {
        nlohmann::ordered_json document;
        document["machine"] = runtime::machine_stamp(kernels::to_string(settings->instruction_set), settings->scheduler,
                                                     settings->threads);
        document["lane_ratios"] = lanes;
        document["rows"] = table.to_json();
        write_json_file(*settings->shared.json, document);
    }
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
