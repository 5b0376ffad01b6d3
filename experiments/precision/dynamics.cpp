#include "lancet/experiments/precision/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <span>
#include <utility>

#include "lancet/experiments/bar/workers.hpp"
#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/precision/words.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/clock.hpp"
#include "lancet/runtime/simulate/body.hpp"

namespace lancet::experiments::precision {
namespace {

using runtime::Integrator;

// The whole list of what is measured: another integrator is another word here.
constexpr std::array implicit_integrators{Integrator::implicit_euler, Integrator::implicit_midpoint,
                                          Integrator::newmark};
constexpr std::array explicit_integrators{Integrator::symplectic_euler, Integrator::central_differences};

std::string name(Integrator integrator) {
    return std::string(runtime::to_string(integrator));
}

runtime::Settings settings_of(const Setting& setting) {
    runtime::Settings settings;
    settings.time_step = setting.time_step;
    settings.integrator = runtime::integrator_from_string(setting.integrator);
    settings.scalar = runtime::scalar_mode_from_string(setting.scalar);
    settings.instruction_set = kernels::instruction_set_from_string(setting.instruction_set);
    settings.rotation.method = rotation_method(setting.rotation);
    settings.rotation_interval = std::max(1, setting.rotation_interval);
    settings.energy_safeguard = false;
    if (runtime::is_explicit(settings.integrator)) return settings;
    settings.matrix = runtime::operator_kind_from_string(setting.operator_);
    settings.preconditioner = runtime::preconditioner_kind_from_string(setting.preconditioner);
    settings.linearisation =
        setting.linearisation == "state" ? runtime::Linearisation::state : runtime::Linearisation::prediction;
    constexpr int to_tolerance = 2000;
    settings.conjugate_gradients = {.iterations = setting.iterations > 0 ? setting.iterations : to_tolerance,
                                    .tolerance = setting.tolerance};
    if (setting.newton_tolerance > 0) {
        settings.newton_iterations = 100;
        settings.newton_tolerance = setting.newton_tolerance;
    }
    settings.energy_safeguard = settings.integrator == Integrator::implicit_euler &&
                                settings.linearisation == runtime::Linearisation::prediction &&
                                settings.rotation_interval == 1 && settings.newton_iterations == 1;
    return settings;
}

/// What a free body keeps: its energy and its angular momentum about the origin.
struct Kept {
    double energy = 0;
    Point momentum{};
};

Kept kept(runtime::DeformableBody& body, runtime::Scheduler& scheduler) {
    std::vector<Point> x(body.nodes()), v(body.nodes());
    body.positions(x);
    body.velocities(v);
    Kept result;
    result.energy = body.energies(scheduler).total();
    for (std::size_t node = 0; node < x.size(); ++node) {
        const double mass = body.nodal_mass(static_cast<std::int32_t>(node));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
            result.momentum[axis] += mass * (x[node][b] * v[node][c] - x[node][c] * v[node][b]);
        }
    }
    return result;
}

double length(const Point& p) {
    return std::hypot(p[0], p[1], p[2]);
}

/// How a run is set where nothing else is said: the fastest accurate choice.
Setting base_setting(const DynamicProblem& problem, Integrator integrator, double time_step) {
    const bool is_explicit = runtime::is_explicit(integrator);
    Setting setting;
    setting.integrator = name(integrator);
    setting.series = "lancet " + setting.integrator;
    setting.scalar = "float";
    setting.rotation = "robust";
    setting.rotation_interval = 1;
    setting.cells = problem.options.cells;
    setting.time_step = time_step;
    if (is_explicit) return setting;
    setting.operator_ = "edge-blocks";
    setting.preconditioner = "coarse";
    setting.linearisation = "prediction";
    setting.iterations = 10;
    return setting;
}

/// Every step solved, in double.
Setting solved_setting(const DynamicProblem& problem, Integrator integrator, double time_step) {
    Setting setting = base_setting(problem, integrator, time_step);
    setting.scalar = "double";
    setting.iterations = 0;
    setting.tolerance = 1e-4;
    setting.newton_tolerance = 1e-8;
    return setting;
}

/// One choice changed at a time from the default, at the longest time step.
std::vector<Setting> other_choices(const DynamicProblem& problem, const Choice& choice) {
    const double longest = problem.implicit_steps.front();
    std::vector<Setting> settings;
    const auto vary = [&](const char* series, const auto& change) {
        Setting setting = base_setting(problem, problem.integrator, longest);
        change(setting);
        setting.series = series;
        settings.push_back(setting);
    };
    const std::vector<int> counts = choice.quick ? std::vector<int>{4, 20} : std::vector<int>{2, 4, 6, 15, 20, 40, 80};
    for (const int count : counts) {
        vary("lancet, other iterations or tolerances", [&](Setting& s) { s.iterations = count; });
    }
    for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
        vary("lancet, other iterations or tolerances", [&](Setting& s) {
            s.iterations = 0;
            s.tolerance = tolerance;
        });
    }
    const char* const others = "lancet, one choice changed";
    for (const std::string word : {"mixed", "double"}) {
        if (choice.has_scalar(word)) vary(others, [&](Setting& s) { s.scalar = word; });
    }
    for (const std::string word : {"matrix-free", "block-rows"}) vary(others, [&](Setting& s) { s.operator_ = word; });
    for (const std::string word : {"none", "jacobi", "block-jacobi"}) {
        for (const int count : {10, 80}) {
            vary(others, [&](Setting& s) {
                s.preconditioner = word;
                s.iterations = count;
            });
        }
    }
    for (const std::string word : {"quaternion", "polar", "svd"}) vary(others, [&](Setting& s) { s.rotation = word; });
    for (const int interval : {1, 2, 5}) {
        vary(others, [&](Setting& s) {
            s.linearisation = "state";
            s.rotation_interval = interval;
        });
    }
    vary(others, [&](Setting& s) {
        s.iterations = 0;
        s.tolerance = 1e-3;
        s.newton_tolerance = 1e-4;
    });
    return settings;
}

std::vector<Setting> lancet_settings(const DynamicProblem& problem, const Choice& choice) {
    std::vector<Setting> settings;
    for (const Integrator integrator : implicit_integrators) {
        for (const double step : problem.implicit_steps) {
            settings.push_back(base_setting(problem, integrator, step));
            // Iterated to a tolerance at the three longest steps: what the order of an integrator is worth.
            const bool is_short = step < problem.implicit_steps[2];
            if (integrator == Integrator::implicit_euler || is_short || !choice.has_scalar("double")) continue;
            settings.push_back(solved_setting(problem, integrator, step));
            settings.back().series += ", iterated";
            settings.back().newton_tolerance = 1e-6;
        }
    }
    for (const Integrator integrator : explicit_integrators) {
        for (const double step : problem.explicit_steps) {
            for (const std::string scalar : {"float", "double"}) {
                if (!choice.has_scalar(scalar)) continue;
                settings.push_back(base_setting(problem, integrator, step));
                settings.back().scalar = scalar;
            }
        }
    }
    for (const Setting& setting : other_choices(problem, choice)) settings.push_back(setting);
    if (!choice.has_scalar("float")) {
        for (Setting& setting : settings) {
            if (setting.scalar == "float") setting.scalar = choice.scalars.front();
        }
    }
    return settings;
}

std::vector<Setting> eigen_settings(const DynamicProblem& problem, const Choice& choice) {
    std::vector<Setting> settings;
    for (const std::string scalar : {"float", "double"}) {
        if (!choice.has_scalar(scalar) || (choice.quick && scalar == "double" && choice.has_scalar("float"))) continue;
        for (const std::string preconditioner : {"diagonal", "incomplete-cholesky"}) {
            for (const double step : problem.implicit_steps) {
                for (const double tolerance : {1e-2, 1e-3}) {
                    Setting setting = base_setting(problem, Integrator::implicit_euler, step);
                    setting.method = "eigen";
                    setting.series = "eigen " + preconditioner;
                    setting.operator_ = "csr";
                    setting.scalar = scalar;
                    setting.preconditioner = preconditioner;
                    setting.rotation = "";
                    setting.iterations = 0;
                    setting.tolerance = tolerance;
                    settings.push_back(setting);
                }
            }
        }
    }
    return settings;
}

int steps_of(const DynamicProblem& problem, double time_step) {
    return static_cast<int>(std::lround(problem.duration / time_step));
}

Solution run_eigen(const DynamicProblem& problem, const Setting& setting, const Choice& choice) {
    bar::ProblemOptions options = problem.options;
    options.time_step = setting.time_step;
    options.steps = steps_of(problem, setting.time_step);
    const bar::Job job{"eigen",
                       "dynamic",
                       choice.bar_workers / "bar_eigen",
                       {"--scalar=" + setting.scalar, "--preconditioner=" + setting.preconditioner,
                        "--linearise=" + setting.linearisation, "--cg-tolerance=" + format_number(setting.tolerance, 3),
                        "--threads=" + std::to_string(setting.threads)},
                       setting.threads};
    std::size_t nodes = 1;
    for (const int cells : options.cells) nodes *= static_cast<std::size_t>(cells) + 1;
    std::vector<std::vector<double>> snapshots;
    const bar::WorkerReport report = bar::run_worker(job, options, {problem.duration}, nodes, snapshots);
    Solution solution;
    solution.positions = points_of(snapshots.front());
    solution.seconds = report.seconds_total;
    solution.flops = report.solve_flops;
    solution.bytes = report.bytes;
    solution.iterations = report.cg_iterations_total;
    return solution;
}

BoxField end_of(const DynamicProblem& problem, int level, Setting setting, const Choice& choice, const char* what,
                Progress& progress) {
    setting.instruction_set = choice.instruction_sets.front();
    setting.cells = problem.box(level).cells;
    progress.show(problem.problem + ": " + what + ", " + setting.label());
    const Solution solution = simulate(problem, level, setting, std::numeric_limits<double>::infinity());
    for (const Point& p : solution.positions) {
        if (!std::isfinite(length(p))) throw Error(problem.problem + ": " + what + " diverged, " + setting.label());
    }
    return displacement_field(problem.box(level), solution.positions);
}

}  // namespace

Solution simulate(const DynamicProblem& problem, int level, const Setting& setting, double longest_seconds) {
    const runtime::Scene scene = scene_of(problem, level);
    const auto scheduler = runtime::make_scheduler(runtime::scheduler_from_string(setting.scheduler), setting.threads);
    const auto body = runtime::make_body(scene, settings_of(setting), *scheduler);
    if (length(problem.spin) > 0) body->set_velocities(start_velocities(problem, scene));
    const int steps = steps_of(problem, setting.time_step);
    if (std::abs(steps * setting.time_step - problem.duration) > 1e-9 * problem.duration) {
        throw Error("time step " + format_number(setting.time_step, 6) + " s found, expected one that divides " +
                    format_number(problem.duration, 6) + " s");
    }
    constexpr int samples = 40;
    const bool is_free = !problem.is_held;
    const Kept before = is_free ? kept(*body, *scheduler) : Kept{};
    Solution solution;
    double drift_energy = 0, drift_momentum = 0;
    const std::clock_t start = std::clock();
    for (int done = 0, sample = 1; done < steps; ++sample) {
        const int until = std::max(done + 1, static_cast<int>(std::int64_t{steps} * sample / samples));
        const double begin = runtime::steady_seconds();
        for (; done < until; ++done) body->step(*scheduler);
        solution.seconds += runtime::steady_seconds() - begin;
        // Of the processor, not the wall clock: a machine that stands still for a while does not make a run slow.
        const double busy = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / setting.threads;
        if (busy > longest_seconds) {
            throw RunFailed("too slow", "given up after " + format_number(busy, 3) + " s and " + std::to_string(done) +
                                            " of " + std::to_string(steps) + " steps");
        }
        if (!is_free) continue;
        const Kept now = kept(*body, *scheduler);
        Point change{};
        for (std::size_t axis = 0; axis < 3; ++axis) change[axis] = now.momentum[axis] - before.momentum[axis];
        drift_energy = std::max(drift_energy, percent(std::abs(now.energy - before.energy), before.energy));
        drift_momentum = std::max(drift_momentum, percent(length(change), length(before.momentum)));
    }
    if (body->totals().lost > 0) {
        throw RunFailed("diverged", "no finite state was found in " + std::to_string(body->totals().lost) + " of " +
                                        std::to_string(steps) + " steps");
    }
    if (is_free) {
        solution.drift_energy = drift_energy;
        solution.drift_momentum = drift_momentum;
    }
    solution.positions.resize(body->nodes());
    body->positions(solution.positions);
    solution.iterations = body->totals().conjugate_gradient_iterations;
    solution.flops = body->solve_work().flops * static_cast<double>(solution.iterations);
    solution.bytes = static_cast<std::int64_t>(body->bytes());
    return solution;
}

DynamicReference make_dynamic_reference(const DynamicProblem& problem, const Choice& choice, Progress& progress) {
    const auto solve = [&](double step) {
        Setting setting = base_setting(problem, Integrator::central_differences, step);
        setting.scalar = "double";
        return end_of(problem, 0, setting, choice, "reference", progress);
    };
    const BoxField coarse = solve(problem.reference_step);
    const BoxField fine = solve(problem.reference_step / 2);
    std::vector<Point> extrapolated(fine.values().begin(), fine.values().end());
    for (std::size_t node = 0; node < extrapolated.size(); ++node) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            extrapolated[node][axis] += (fine.values()[node][axis] - coarse.values()[node][axis]) / 3;
        }
    }
    DynamicReference reference{.displacement = BoxField(problem.box(0), extrapolated),
                               .form = {.young_modulus = problem.options.young_modulus,
                                        .poisson_ratio = problem.options.poisson_ratio,
                                        .rotated = true},
                               .size = {}};
    reference.size = norms(reference.displacement, reference.form);
    reference.own_percent = percent(error_norms(fine, reference.displacement, reference.form).l2, reference.size.l2);
    return reference;
}

Study dynamic_study(const DynamicProblem& problem, const DynamicReference& reference, const Choice& choice) {
    Study study{.problem = problem.problem, .variant = "", .cases = {}, .judge = {}};
    study.judge = [&problem, &reference](const Setting&, const Solution& solution) {
        const BoxField field = displacement_field(problem.box(0), solution.positions);
        const Norms difference = error_norms(field, reference.displacement, reference.form);
        Errors errors;
        errors.l2 = percent(difference.l2, reference.size.l2);
        errors.energy = percent(difference.energy, reference.size.energy);
        const Point at = field.at(problem.watched_point()).value;
        const Point exact = reference.displacement.at(problem.watched_point()).value;
        errors.quantity = percent(length({at[0] - exact[0], at[1] - exact[1], at[2] - exact[2]}), length(exact));
        errors.value = at[1];
        if (solution.drift_energy) {
            errors.quantity = std::max(*solution.drift_energy, *solution.drift_momentum);
            errors.value = *errors.quantity;
        }
        return errors;
    };
    for (const Setting& plain : lancet_settings(problem, choice)) {
        for (const Setting& setting : choice.machines(plain)) {
            study.cases.push_back(
                {setting, elements_of(setting.cells), setting.label(), 4.0 / 3,
                 [&problem, setting, limit = choice.longest_seconds] { return simulate(problem, 0, setting, limit); }});
        }
    }
    if (!problem.is_held) {
        Setting setting;
        setting.method = "eigen";
        setting.cells = problem.options.cells;
        study.cases.push_back({setting, 0, "", 1, []() -> Solution {
                                   throw RunFailed("not offered", "the baseline starts at rest, and is held somewhere");
                               }});
        return study;
    }
    for (const Setting& plain : eigen_settings(problem, choice)) {
        for (const Setting& setting : choice.baseline_machines(plain)) {
            study.cases.push_back({setting, elements_of(setting.cells), setting.label(), 4.0 / 3,
                                   [&problem, setting, choice] { return run_eigen(problem, setting, choice); }});
        }
    }
    return study;
}

BudgetLine dynamic_budget(const DynamicProblem& problem, const DynamicReference& reference, const Choice& choice,
                          Progress& progress) {
    const double longest = problem.implicit_steps.front();
    const auto end = [&](int level, const Setting& setting) {
        return end_of(problem, level, setting, choice, "error budget", progress);
    };
    const auto distance = [&](const BoxField& a, const BoxField& b) {
        return percent(error_norms(a, b, reference.form).l2, reference.size.l2);
    };
    const Setting fast = base_setting(problem, problem.integrator, longest);
    const Setting solved = solved_setting(problem, problem.integrator, longest);
    Setting once = solved;
    once.newton_tolerance = 0;
    once.tolerance = 1e-10;
    Setting early = fast;
    early.scalar = "double";

    const BoxField exact = end(0, solved);
    const BoxField linearised = end(0, once);
    const BoxField ended_early = end(0, early);
    const BoxField in_float = end(0, fast);
    Setting shown = fast;
    return {.problem = problem.problem,
            .variant = "",
            .setting = shown.label(),
            .time_step = distance(exact, reference.displacement),
            .linearisation = distance(linearised, exact),
            .mesh = distance(exact, end(1, solved)),
            .solve = distance(ended_early, linearised),
            .scalar = distance(in_float, ended_early),
            .total = distance(in_float, reference.displacement),
            .total_has_mesh = false};
}

}  // namespace lancet::experiments::precision
