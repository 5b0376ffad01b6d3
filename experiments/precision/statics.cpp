#include "lancet/experiments/precision/statics.hpp"

#include <cmath>
#include <span>
#include <utility>

#include "lancet/experiments/bar/workers.hpp"
#include "lancet/experiments/common/peak_memory.hpp"
#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/precision/words.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/simulate/body.hpp"

namespace lancet::experiments::precision {
namespace {

constexpr double reference_tolerance = 1e-8;

runtime::EquilibriumSettings settings_of(const StaticProblem& problem, const Setting& setting) {
    runtime::EquilibriumSettings settings;
    settings.model = problem.model;
    settings.scalar = runtime::scalar_mode_from_string(setting.scalar);
    settings.instruction_set = kernels::instruction_set_from_string(setting.instruction_set);
    settings.matrix = runtime::operator_kind_from_string(setting.operator_);
    settings.preconditioner = runtime::preconditioner_kind_from_string(setting.preconditioner);
    if (!setting.tangent.empty()) settings.tangent = kernels::tangent_kind_from_string(setting.tangent);
    if (!setting.rotation.empty()) settings.rotation.method = rotation_method(setting.rotation);
    settings.tolerance = setting.tolerance;
    if (setting.iterations > 0) settings.conjugate_gradient_iterations = setting.iterations;
    return settings;
}

/// Operations of one iteration of conjugate gradients: a body with the same operator and preconditioner knows them.
double flops_of_iteration(const runtime::Scene& scene, const runtime::EquilibriumSettings& of,
                          runtime::Scheduler& scheduler) {
    runtime::Settings settings;
    settings.model = of.model;
    settings.tangent = of.tangent;
    settings.scalar = of.scalar;
    settings.instruction_set = of.instruction_set;
    settings.matrix = of.matrix;
    settings.preconditioner = of.preconditioner;
    return runtime::make_body(scene, settings, scheduler)->solve_work().flops;
}

Setting lancet_setting(const StaticProblem& problem, const std::string& scalar, double tolerance, int level) {
    Setting setting;
    setting.method = "lancet";
    setting.series = "lancet " + scalar;
    setting.operator_ = "edge-blocks";
    setting.scalar = scalar;
    setting.preconditioner = "coarse";
    if (problem.model == runtime::ElementModel::corotational) setting.rotation = "robust";
    if (problem.model != runtime::ElementModel::linear) setting.tangent = "exact";
    setting.cells = problem.box(level).cells;
    setting.tolerance = tolerance;
    return setting;
}

Setting reference_setting(const StaticProblem& problem, const Choice& choice, int level) {
    Setting setting = lancet_setting(problem, "double", reference_tolerance, level);
    setting.instruction_set = choice.instruction_sets.front();
    return setting;
}

/// Settings of Lancet on the mesh of a level: tolerance and scalar everywhere, the rest one at a time on `others`.
std::vector<Setting> lancet_settings(const StaticProblem& problem, const Choice& choice, int level, bool others) {
    const std::vector<double> tolerances =
        choice.quick ? std::vector<double>{1e-2, 1e-6} : std::vector<double>{1e-1, 1e-2, 1e-3, 1e-4, 1e-6};
    std::vector<Setting> settings;
    for (const std::string& scalar : choice.scalars) {
        for (const double tolerance : tolerances) {
            // The rounding of float leaves residuals near 1e-4.
            if (scalar == "float" && tolerance < 1e-3) continue;
            settings.push_back(lancet_setting(problem, scalar, tolerance, level));
        }
    }
    if (!others) return settings;
    Setting base = lancet_setting(problem, choice.has_scalar("mixed") ? "mixed" : choice.scalars.front(), 1e-3, level);
    base.series = "lancet, one choice changed";
    const auto vary = [&](std::string Setting::*word, const std::vector<std::string>& values) {
        for (const std::string& value : values) {
            settings.push_back(base);
            settings.back().*word = value;
        }
    };
    vary(&Setting::operator_, {"matrix-free", "block-rows"});
    vary(&Setting::preconditioner, {"none", "jacobi", "block-jacobi"});
    if (problem.model == runtime::ElementModel::corotational) vary(&Setting::tangent, {"rotated"});
    if (problem.model != runtime::ElementModel::linear) vary(&Setting::tangent, {"projected"});
    if (!base.rotation.empty()) vary(&Setting::rotation, {"quaternion", "polar", "svd"});
    return settings;
}

/// Richardson's extrapolation for errors of order 2, at the nodes of the coarser of two meshes: twice the accuracy of
/// the finer one for little more than its time.
Solution find_extrapolated(const StaticProblem& problem, int level, const Setting& setting) {
    const Solution coarse = find_static(problem, level - 1, setting);
    Solution solution = find_static(problem, level, setting);
    const BoxField fine(problem.box(level), solution.positions);
    const mesh::TetMesh mesh = mesh::box(problem.box(level - 1));
    solution.cells = problem.box(level - 1).cells;
    solution.positions = coarse.positions;
    for (std::size_t node = 0; node < solution.positions.size(); ++node) {
        const Point at = fine.at(mesh.nodes()[node]).value;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            solution.positions[node][axis] = at[axis] + (at[axis] - solution.positions[node][axis]) / 3;
        }
    }
    solution.seconds += coarse.seconds;
    solution.flops += coarse.flops;
    solution.iterations += coarse.iterations;
    if (solution.outcome == "converged") solution.outcome = coarse.outcome;
    return solution;
}

std::vector<Setting> extrapolated_settings(const StaticProblem& problem, const Choice& choice, int level) {
    std::vector<Setting> settings;
    for (const std::string& scalar : choice.scalars) {
        settings.push_back(lancet_setting(problem, scalar, scalar == "float" ? 1e-3 : 1e-5, level));
        settings.back().method = "lancet-extrapolated";
        settings.back().series = "lancet, extrapolated from two meshes";
    }
    return settings;
}

/// What the worker is started with, but for the problem.
bar::Job eigen_job(const StaticProblem& problem, const Setting& setting, const Choice& choice) {
    bar::Job job{"eigen", "static", choice.workers / "precision_eigen", {}, setting.threads};
    const bool is_linear = problem.model == runtime::ElementModel::linear;
    job.arguments = {std::string("--model=") + (is_linear ? "linear" : "corotational"),
                     "--scalar=" + setting.scalar,
                     "--preconditioner=" + setting.preconditioner,
                     "--tolerance=" + format_number(setting.tolerance, 3),
                     "--threads=" + std::to_string(setting.threads),
                     "--limit=" + format_number(choice.longest_seconds, 6),
                     "--end-load=" + format_number(problem.end_load[0], 12) + "," +
                         format_number(problem.end_load[1], 12) + "," + format_number(problem.end_load[2], 12)};
    return job;
}

Solution run_eigen(const StaticProblem& problem, int level, const Setting& setting, const Choice& choice) {
    bar::ProblemOptions options = options_of(problem, level);
    options.time_step = 1;
    options.steps = 1;
    std::size_t nodes = 1;
    for (const int cells : options.cells) nodes *= static_cast<std::size_t>(cells) + 1;
    std::vector<std::vector<double>> snapshots;
    const bar::WorkerReport report =
        bar::run_worker(eigen_job(problem, setting, choice), options, {1.0}, nodes, snapshots);
    if (report.variant.starts_with("too slow")) {
        throw RunFailed("too slow", report.variant + " and " + format_number(report.seconds_total, 3) + " s");
    }
    Solution solution;
    solution.seconds = report.seconds_total;
    solution.flops = report.solve_flops;
    if (report.bytes > 0) solution.bytes = report.bytes;
    solution.iterations = report.cg_iterations_total;
    solution.outcome = report.variant;
    solution.positions = points_of(snapshots.front());
    return solution;
}

std::vector<Setting> eigen_settings(const StaticProblem& problem, const Choice& choice, int level) {
    std::vector<Setting> settings;
    const std::vector<double> tolerances =
        choice.quick ? std::vector<double>{1e-4} : std::vector<double>{1e-2, 1e-4, 1e-6};
    for (const std::string scalar : {"double", "float"}) {
        if (!choice.has_scalar(scalar) || (choice.quick && scalar == "float")) continue;
        for (const std::string preconditioner : {"diagonal", "incomplete-cholesky", "ldlt"}) {
            for (const double tolerance : tolerances) {
                // Float ends near 1e-4; a direct solver is nearly as fast at one tolerance as at another.
                if (scalar == "float" && tolerance < 1e-3) continue;
                if (preconditioner == "ldlt" && tolerance != tolerances.back() && scalar == "double") continue;
                Setting setting;
                setting.method = "eigen";
                setting.series = "eigen " + preconditioner;
                setting.operator_ = "csr";
                setting.scalar = scalar;
                setting.preconditioner = preconditioner;
                setting.cells = problem.box(level).cells;
                setting.tolerance = tolerance;
                settings.push_back(setting);
            }
        }
    }
    return settings;
}

}  // namespace

int measured_levels(const StaticProblem& problem, bool quick) {
    return quick ? 2 : problem.levels;
}

Solution find_static(const StaticProblem& problem, int level, const Setting& setting) {
    const runtime::Scene scene = scene_of(problem, level);
    const runtime::EquilibriumSettings settings = settings_of(problem, setting);
    const auto scheduler = runtime::make_scheduler(runtime::scheduler_from_string(setting.scheduler), setting.threads);
    Solution solution;
    solution.positions.assign(scene.mesh.nodes().begin(), scene.mesh.nodes().end());
    const PeakMemory memory;
    const double begin = runtime::steady_seconds();
    const runtime::EquilibriumReport report =
        runtime::find_equilibrium(scene, settings, *scheduler, solution.positions);
    solution.seconds = runtime::steady_seconds() - begin;
    solution.bytes = memory.bytes();
    if (report.load_factor < 1) throw RunFailed(std::string(runtime::to_string(report.end)), report.explanation);
    solution.iterations = report.conjugate_gradient_iterations;
    if (report.end != runtime::EquilibriumEnd::converged) {
        solution.outcome = std::string(runtime::to_string(report.end)) + ": " + report.explanation;
    }
    solution.flops =
        flops_of_iteration(scene, settings, *scheduler) * static_cast<double>(report.conjugate_gradient_iterations);
    return solution;
}

StaticReference make_static_reference(const StaticProblem& problem, const Choice& choice, Progress& progress) {
    const int level = measured_levels(problem, choice.quick);
    const auto solve = [&](int at) {
        const Setting setting = reference_setting(problem, choice, at);
        progress.show(problem.problem + " " + problem.variant + ": reference, " + setting.label());
        const Solution solution = find_static(problem, at, setting);
        if (solution.outcome != "converged") {
            throw Error(problem.problem + " " + problem.variant + ": the reference is not found: " + solution.outcome);
        }
        return displacement_field(problem.box(at), solution.positions);
    };
    const BoxField coarse = solve(level - 1);
    const BoxField fine = solve(level);
    // Richardson's correction for errors of order 2 is known at the nodes of the coarser mesh, and smooth.
    const mesh::TetMesh coarse_mesh = mesh::box(problem.box(level - 1));
    std::vector<Point> correction(coarse.values().begin(), coarse.values().end());
    for (std::size_t node = 0; node < correction.size(); ++node) {
        const Point at = fine.at(coarse_mesh.nodes()[node]).value;
        for (std::size_t axis = 0; axis < 3; ++axis) correction[node][axis] = (at[axis] - correction[node][axis]) / 3;
    }
    const BoxField corrections(problem.box(level - 1), correction);
    const mesh::TetMesh fine_mesh = mesh::box(problem.box(level));
    std::vector<Point> extrapolated(fine.values().begin(), fine.values().end());
    for (std::size_t node = 0; node < extrapolated.size(); ++node) {
        const Point change = corrections.at(fine_mesh.nodes()[node]).value;
        for (std::size_t axis = 0; axis < 3; ++axis) extrapolated[node][axis] += change[axis];
    }
    StaticReference reference{.level = level,
                              .displacement = BoxField(problem.box(level), extrapolated),
                              .form = {.young_modulus = problem.options.young_modulus,
                                       .poisson_ratio = problem.options.poisson_ratio,
                                       .rotated = problem.model != runtime::ElementModel::linear},
                              .size = {}};
    reference.size = norms(reference.displacement, reference.form);
    reference.own_percent = percent(error_norms(fine, reference.displacement, reference.form).l2, reference.size.l2);
    reference.tip = fine.at(problem.tip_point()).value;
    reference.tip_extrapolated = reference.displacement.at(problem.tip_point()).value;
    return reference;
}

double published_difference_percent(const StaticProblem& problem, const Point& tip) {
    double difference = 0, length = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!problem.tip[axis]) continue;
        difference += (tip[axis] - *problem.tip[axis]) * (tip[axis] - *problem.tip[axis]);
        length += *problem.tip[axis] * *problem.tip[axis];
    }
    return percent(std::sqrt(difference), std::sqrt(length));
}

Errors judge_static(const StaticProblem& problem, const StaticReference& reference, const std::array<int, 3>& cells,
                    const std::vector<Point>& positions) {
    mesh::Box box = problem.box(0);
    box.cells = cells;
    const BoxField field = displacement_field(box, positions);
    const Norms difference = error_norms(field, reference.displacement, reference.form);
    const Point tip = field.at(problem.tip_point()).value;
    Errors errors;
    errors.l2 = percent(difference.l2, reference.size.l2);
    errors.energy = percent(difference.energy, reference.size.energy);
    errors.quantity = published_difference_percent(problem, tip);
    errors.value = tip[static_cast<std::size_t>(problem.judged_axis)];
    return errors;
}

Study static_study(const StaticProblem& problem, const StaticReference& reference, const Choice& choice) {
    Study study{.problem = problem.problem, .variant = problem.variant, .cases = {}, .judge = {}};
    study.judge = [&problem, &reference](const Setting& setting, const Solution& solution) {
        const bool is_other_mesh = solution.cells[0] > 0;
        return judge_static(problem, reference, is_other_mesh ? solution.cells : setting.cells, solution.positions);
    };
    const int levels = measured_levels(problem, choice.quick);
    const bool is_offered = problem.model != runtime::ElementModel::st_venant_kirchhoff;
    if (!is_offered) {
        Setting setting;
        setting.method = "eigen";
        setting.cells = problem.box(0).cells;
        study.cases.push_back({setting, 0, "", 1, []() -> Solution {
                                   throw RunFailed("not offered", "the baseline has no St. Venant-Kirchhoff elements");
                               }});
    }
    for (int level = 0; level < levels; ++level) {
        // One choice at a time on the finest mesh but one.
        for (const Setting& plain : lancet_settings(problem, choice, level, level == levels - 2)) {
            for (const Setting& setting : choice.machines(plain)) {
                study.cases.push_back({setting, elements_of(setting.cells), family(setting), 4.0 / 3,
                                       [&problem, level, setting] { return find_static(problem, level, setting); }});
            }
        }
        if (level > 0) {
            for (const Setting& plain : extrapolated_settings(problem, choice, level)) {
                for (const Setting& setting : choice.machines(plain)) {
                    study.cases.push_back(
                        {setting, elements_of(setting.cells), family(setting), 4.0 / 3,
                         [&problem, level, setting] { return find_extrapolated(problem, level, setting); }});
                }
            }
        }
        if (!is_offered) continue;
        for (const Setting& plain : eigen_settings(problem, choice, level)) {
            for (const Setting& setting : choice.baseline_machines(plain)) {
                const double growth = setting.preconditioner == "ldlt" ? 2 : 4.0 / 3;
                study.cases.push_back(
                    {setting, elements_of(setting.cells), family(setting), growth,
                     [&problem, level, setting, choice] { return run_eigen(problem, level, setting, choice); }});
            }
        }
    }
    return study;
}

StaticBudget static_budget(const StaticProblem& problem, const StaticReference& reference, const Choice& choice,
                           Progress& progress) {
    constexpr double tolerance = 1e-3;
    const int level = measured_levels(problem, choice.quick) - 1;
    const auto solve = [&](const std::string& scalar, double to) {
        Setting setting = lancet_setting(problem, scalar, to, level);
        setting.instruction_set = choice.instruction_sets.front();
        progress.show(problem.problem + " " + problem.variant + ": error budget, " + setting.label());
        return displacement_field(problem.box(level), find_static(problem, level, setting).positions);
    };
    const BoxField exact = solve("double", reference_tolerance);
    const BoxField loose = solve("double", tolerance);
    const BoxField single = solve("float", 1e-7);  // as far as float goes
    const auto distance = [&](const BoxField& a, const BoxField& b) {
        return percent(error_norms(a, b, reference.form).l2, reference.size.l2);
    };
    StaticBudget budget;
    Setting setting = lancet_setting(problem, "float", tolerance, level);
    budget.setting = setting.label();
    budget.mesh = distance(exact, reference.displacement);
    budget.solve = distance(loose, exact);
    budget.scalar = distance(single, exact);
    budget.total = distance(solve("float", tolerance), reference.displacement);
    return budget;
}

}  // namespace lancet::experiments::precision
