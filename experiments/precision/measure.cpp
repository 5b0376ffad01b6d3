#include "lancet/experiments/precision/measure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "lancet/experiments/common/statistics.hpp"
#include "lancet/experiments/common/table.hpp"
#include "lancet/experiments/precision/pareto.hpp"
#include "lancet/kernels/error.hpp"

namespace lancet::experiments::precision {
namespace {

/// A result that is further from the reference than the reference from rest is none.
constexpr double useless_percent = 100;

struct Measured {
    std::vector<double> seconds;
    Row row;
};

bool is_finite(const Solution& solution) {
    return std::all_of(solution.positions.begin(), solution.positions.end(), [](const Point& p) {
        return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
    });
}

/// Throws RunFailed for what is not worth starting.
void require_affordable(const Case& one, const std::map<std::string, std::pair<std::size_t, double>>& smaller,
                        const Effort& effort) {
    const auto before = smaller.find(one.family);
    if (before == smaller.end()) return;
    const auto [elements, seconds] = before->second;
    const double ratio = static_cast<double>(one.elements) / static_cast<double>(elements);
    const double expected = seconds * std::pow(std::max(1.0, ratio), one.growth);
    if (expected <= effort.longest_seconds) return;
    throw RunFailed("too slow", "about " + format_number(expected, 2) + " s expected from the " +
                                    format_number(seconds, 2) + " s of the next coarser mesh, at most " +
                                    format_number(effort.longest_seconds, 3) + " s are spent on a run");
}

Measured first_run(const Study& study, const Case& one) {
    Solution solution;
    try {
        solution = one.run();
    } catch (const Error& error) {
        throw RunFailed("refused", error.what());
    }
    if (!is_finite(solution)) throw RunFailed("diverged", "positions are not finite at the end");
    const Errors errors = study.judge(one.setting, solution);
    if (!(errors.judged() <= useless_percent)) {
        throw RunFailed("inaccurate", "an error of " + format_number(errors.judged(), 3) + " %, more than the whole");
    }
    Measured measured{.seconds = {solution.seconds}, .row = {}};
    measured.row.problem = study.problem;
    measured.row.variant = study.variant;
    measured.row.setting = one.setting;
    measured.row.elements = one.elements;
    measured.row.errors = errors;
    measured.row.solution = std::move(solution);
    measured.row.solution.positions.clear();
    return measured;
}

void mark_front(std::vector<Measured>& measured) {
    std::set<int> thread_counts;
    for (const Measured& m : measured) thread_counts.insert(m.row.setting.threads);
    for (const int threads : thread_counts) {
        std::vector<std::size_t> places;
        std::vector<TimeAndError> points;
        for (std::size_t i = 0; i < measured.size(); ++i) {
            if (measured[i].row.setting.threads != threads) continue;
            places.push_back(i);
            points.push_back({measured[i].row.seconds, measured[i].row.errors.judged()});
        }
        const std::vector<bool> front = pareto_front(points);
        for (std::size_t i = 0; i < places.size(); ++i) measured[places[i]].row.pareto = front[i];
    }
}

}  // namespace

void measure(const Study& study, const Effort& effort, Progress& progress, Results& results) {
    std::vector<std::optional<Measured>> found(study.cases.size());
    std::map<std::string, std::pair<std::size_t, double>> smaller;
    const std::string title = study.problem + (study.variant.empty() ? "" : " " + study.variant);
    for (int repetition = 0; repetition < effort.repetitions; ++repetition) {
        for (std::size_t i = 0; i < study.cases.size(); ++i) {
            const Case& one = study.cases[i];
            const bool again = found[i] && found[i]->seconds.front() <= effort.repeat_seconds;
            if (repetition > 0 && !again) continue;
            progress.show(title + ": round " + std::to_string(repetition + 1) + "/" +
                          std::to_string(effort.repetitions) + ", run " + std::to_string(i + 1) + "/" +
                          std::to_string(study.cases.size()) + ": " + one.setting.label());
            if (repetition > 0) {
                found[i]->seconds.push_back(one.run().seconds);
                continue;
            }
            try {
                require_affordable(one, smaller, effort);
                found[i] = first_run(study, one);
                smaller[one.family] = {one.elements, found[i]->seconds.front()};
            } catch (const RunFailed& failure) {
                results.omissions.push_back(
                    {study.problem, study.variant, one.setting, failure.kind(), failure.what()});
            }
        }
    }
    std::vector<Measured> measured;
    for (std::optional<Measured>& one : found) {
        if (!one) continue;
        const Summary times = summarize(one->seconds);
        Row& row = one->row;
        row.seconds = times.median;
        row.seconds_minimum = times.minimum;
        row.seconds_maximum = times.maximum;
        row.repetitions = static_cast<int>(one->seconds.size());
        if (row.solution.outcome != "converged") {
            results.omissions.push_back(
                {study.problem, study.variant, row.setting, "kept with a reservation", row.solution.outcome});
        }
        measured.push_back(std::move(*one));
    }
    mark_front(measured);
    for (Measured& one : measured) results.rows.push_back(std::move(one.row));
}

}  // namespace lancet::experiments::precision
