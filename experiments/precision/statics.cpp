#include "lancet/experiments/precision/statics.hpp"

#include <cmath>
#include <span>
#include <utility>

#include "lancet/experiments/bar/workers.hpp"
#include "lancet/experiments/common/peak_memory.hpp"
#include "lancet/experiments/common/table.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/simulate/body.hpp"

namespace lancet::experiments::precision {
namespace {

constexpr double reference_tolerance = 1e-8;

kernels::RotationMethod rotation_method(const std::string& name) {
    using kernels::RotationMethod;
    for (const RotationMethod method :
         {RotationMethod::quaternion, RotationMethod::polar, RotationMethod::svd, RotationMethod::robust}) {
        if (kernels::to_string(method) == name) return method;
    }
    throw Error("unknown rotation method '" + name + "'; expected quaternion, polar, svd or robust");
}

runtime::EquilibriumSettings settings_of(const StaticProblem& problem, const Setting& setting) {
    runtime::EquilibriumSettings settings;
    settings.model = problem.model;
    settings.scalar = runtime::scalar_mode_from_string(setting.scalar);
    settings.instruction_set = kernels::instruction_set_from_string(setting.instruction_set);
    settings.matrix = runtime::operator_kind_from_string(setting.operator_);
    settings.preconditioner = runtime::preconditioner_kind_from_string(setting.preconditioner);
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
    settings.scalar = of.scalar;
    settings.instruction_set = of.instruction_set;
    settings.matrix = of.matrix;
    settings.preconditioner = of.preconditioner;
    return runtime::make_body(scene, settings, scheduler)->solve_work().flops;
}

std::vector<Point> displacement(const mesh::Box& box, std::span<const Point> positions) {
    const mesh::TetMesh mesh = mesh::box(box);
    std::vector<Point> result(positions.begin(), positions.end());
    for (std::size_t node = 0; node < result.size(); ++node) {
        for (std::size_t axis = 0; axis < 3; ++axis) result[node][axis] -= mesh.nodes()[node][axis];
    }
    return result;
}

std::size_t elements_of(const std::array<int, 3>& cells) {
    return 5 * static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) *
           static_cast<std::size_t>(cells[2]);
}

double percent(double part, double whole) {
    return 100 * part / whole;
}

Setting lancet_setting(const StaticProblem& problem, const std::string& scalar, double tolerance, int level) {
    Setting setting;
    setting.method = "lancet";
    setting.series = "lancet " + scalar;
    setting.operator_ = "edge-blocks";
    setting.scalar = scalar;
    setting.preconditioner = "coarse";
    setting.rotation = problem.model == runtime::ElementModel::linear ? "" : "robust";
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
    if (!base.rotation.empty()) vary(&Setting::rotation, {"quaternion", "polar", "svd"});
    return settings;
}

/// The published options that the worker understands.
bar::Job eigen_job(const StaticProblem& problem, const Setting& setting, const Choice& choice) {
    bar::Job job{"eigen", "static", choice.workers / "precision_eigen", {}, setting.threads};
    const bool is_linear = problem.model == runtime::ElementModel::linear;
    job.arguments = {std::string("--model=") + (is_linear ? "linear" : "corotational"),
                     "--scalar=" + setting.scalar,
                     "--preconditioner=" + setting.preconditioner,
                     "--tolerance=" + format_number(setting.tolerance, 3),
                     "--threads=" + std::to_string(setting.threads),
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
    Solution solution;
    solution.seconds = report.seconds_total;
    solution.flops = report.solve_flops;
    if (report.bytes > 0) solution.bytes = report.bytes;
    solution.iterations = report.cg_iterations_total;
    solution.outcome = report.variant;
    for (std::size_t i = 0; i < nodes; ++i) {
        solution.positions.push_back(
            {snapshots.front()[3 * i], snapshots.front()[3 * i + 1], snapshots.front()[3 * i + 2]});
    }
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

std::string family(const Setting& setting) {
    Setting any = setting;
    any.cells = {0, 0, 0};
    return any.label();
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
        return BoxField(problem.box(at), displacement(problem.box(at), solution.positions));
    };
    const BoxField coarse = solve(level - 1);
    StaticReference reference{.level = level,
                              .displacement = solve(level),
                              .form = {.young_modulus = problem.options.young_modulus,
                                       .poisson_ratio = problem.options.poisson_ratio,
                                       .rotated = problem.model != runtime::ElementModel::linear},
                              .size = {}};
    reference.size = norms(reference.displacement, reference.form);
    reference.tip = reference.displacement.at(problem.tip_point()).value;
    const Point coarse_tip = coarse.at(problem.tip_point()).value;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        reference.tip_extrapolated[axis] = reference.tip[axis] + (reference.tip[axis] - coarse_tip[axis]) / 3;
    }
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
    const BoxField field(box, displacement(box, positions));
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
        return judge_static(problem, reference, setting.cells, solution.positions);
    };
    const int levels = measured_levels(problem, choice.quick);
    for (int level = 0; level < levels; ++level) {
        // One choice at a time on the finest mesh but one.
        for (const Setting& plain : lancet_settings(problem, choice, level, level == levels - 2)) {
            for (const Setting& setting : choice.machines(plain)) {
                study.cases.push_back({setting, elements_of(setting.cells), family(setting), 4.0 / 3,
                                       [&problem, level, setting] { return find_static(problem, level, setting); }});
            }
        }
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
        return BoxField(problem.box(level),
                        displacement(problem.box(level), find_static(problem, level, setting).positions));
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
