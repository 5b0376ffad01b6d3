#include "lancet/experiments/scaling/plan.hpp"

#include <algorithm>
#include <utility>

#include "lancet/experiments/scaling/problem.hpp"

namespace lancet::experiments::scaling {
namespace {

constexpr int thesis_steps = 125;  // 5 s

class Planner {
  public:
    explicit Planner(const ScalingSettings& settings) : settings_(&settings) {}

    /// A series over the threads of all schedulers: with all elements, or so many to each thread.
    void add_series(const std::string& series, const Job& base, const std::vector<int>& threads, bool is_weak) {
        Job natural = base;
        natural.scheduler = "serial";
        natural.is_natural_order = true;
        natural.scatter = "private-copies";  // of one block there are none: it says nothing
        const std::size_t natural_place = place(natural);
        add({series, natural_place, natural_place, natural_place, natural_place});
        Job serial = base;
        serial.scheduler = "serial";
        const std::size_t serial_place = place(serial);
        add({series, serial_place, serial_place, natural_place, serial_place});
        for (const std::string& scheduler : settings_->schedulers) {
            Job one = base;
            one.scheduler = scheduler;
            const std::size_t one_place = place(one);
            for (const int count : threads) {
                Job job = one, same_blocks = serial;
                job.threads = count;
                if (is_weak) job.elements = same_blocks.elements = base.elements * count;
                add({series, place(job), one_place, natural_place, place(same_blocks)});
            }
        }
    }

    Plan take() { return std::move(plan_); }

  private:
    std::size_t place(const Job& job) {
        const auto found = std::ranges::find(plan_.jobs, job);
        if (found != plan_.jobs.end()) return static_cast<std::size_t>(found - plan_.jobs.begin());
        plan_.jobs.push_back(job);
        return plan_.jobs.size() - 1;
    }

    /// Rows that differ in the scatter strategy have the row in natural order in common.
    void add(const Entry& entry) {
        const bool is_there = std::ranges::any_of(plan_.entries, [&entry](const Entry& other) {
            return other.series == entry.series && other.job == entry.job;
        });
        if (!is_there) plan_.entries.push_back(entry);
    }

    const ScalingSettings* settings_;
    Plan plan_;
};

/// Every choice of arithmetic, the first of all lists first; one list at a time where the user gave none.
std::vector<Job> arithmetics(const ScalingSettings& s, const Job& base) {
    std::vector<Job> jobs;
    for (std::size_t i = 0; i < s.instruction_sets.size(); ++i) {
        for (std::size_t j = 0; j < s.scalars.size(); ++j) {
            for (std::size_t k = 0; k < s.operators.size(); ++k) {
                for (std::size_t l = 0; l < s.scatters.size(); ++l) {
                    const int varied = (i > 0 ? 1 : 0) + (j > 0 ? 1 : 0) + (k > 0 ? 1 : 0) + (l > 0 ? 1 : 0);
                    if (s.varies_one_by_one && varied > 1) continue;
                    Job job = base;
                    job.isa = s.instruction_sets[i];
                    job.scalar = s.scalars[j];
                    job.matrix = s.operators[k];
                    job.scatter = s.scatters[l];
                    jobs.push_back(job);
                }
            }
        }
    }
    return jobs;
}

}  // namespace

std::string Job::label() const {
    return benchmark + " " + std::to_string(elements) + " " + setting + " " +
           (is_natural_order ? "natural order" : scheduler + " " + std::to_string(threads)) + " " + isa + " " + scalar +
           " " + matrix + (is_natural_order ? "" : " " + scatter);
}

std::vector<std::string> worker_arguments(const Job& job) {
    std::vector<std::string> arguments{"--problem=" + job.benchmark,
                                       "--elements=" + std::to_string(job.elements),
                                       "--steps=" + std::to_string(job.steps),
                                       "--scheduler=" + job.scheduler,
                                       "--threads=" + std::to_string(job.threads),
                                       "--isa=" + job.isa,
                                       "--scalar=" + job.scalar,
                                       "--operator=" + job.matrix,
                                       "--scatter=" + job.scatter,
                                       "--cg-iterations=10"};
    const std::vector<std::string> setting =
        job.setting == "original"
            ? std::vector<std::string>{"--linearise=state", "--rotation-interval=5", "--preconditioner=none"}
            : std::vector<std::string>{"--linearise=prediction", "--rotation-interval=1", "--preconditioner=coarse"};
    arguments.insert(arguments.end(), setting.begin(), setting.end());
    if (job.is_natural_order) arguments.emplace_back("--natural-order");
    return arguments;
}

Plan make_plan(const ScalingSettings& settings) {
    Planner planner(settings);
    const auto wants = [&settings](const std::string& series) {
        return std::ranges::find(settings.series, series) != settings.series.end();
    };
    const auto elements_of = [&settings](const std::string& benchmark) {
        return settings.elements.empty() ? default_elements(benchmark, settings.shared.quick) : settings.elements;
    };
    const auto base_of = [&settings](const std::string& benchmark, int elements) {
        return Job{.benchmark = benchmark,
                   .elements = elements,
                   .steps = settings.steps,
                   .setting = settings.setting,
                   .scheduler = "serial",
                   .isa = settings.instruction_sets.front(),
                   .scalar = settings.scalars.front(),
                   .matrix = settings.operators.front(),
                   .scatter = settings.scatters.front()};
    };
    for (const std::string& benchmark : settings.benchmarks) {
        for (const int elements : elements_of(benchmark)) {
            const Job base = base_of(benchmark, elements);
            const auto all = settings.varies_one_by_one ? std::vector<Job>{base} : arithmetics(settings, base);
            for (const Job& job : all) {
                if (wants("strong")) planner.add_series("strong", job, settings.threads, false);
            }
        }
    }
    // Of a weak series the largest size grows with the threads: the smallest is where it starts.
    for (const std::string& benchmark : settings.benchmarks) {
        if (!wants("weak")) break;
        const int elements = std::ranges::min(elements_of(benchmark));
        planner.add_series("weak", base_of(benchmark, elements), settings.threads, true);
    }
    if (wants("variants") && settings.varies_one_by_one) {
        const std::string& benchmark = settings.benchmarks.front();
        const std::vector<int> ends = settings.threads.size() > 1
                                          ? std::vector<int>{settings.threads.front(), settings.threads.back()}
                                          : settings.threads;
        const Job base = base_of(benchmark, std::ranges::min(elements_of(benchmark)));
        for (const Job& job : arithmetics(settings, base)) planner.add_series("variants", job, ends, false);
    }
    if (wants("thesis")) {
        for (const std::string& benchmark : settings.benchmarks) {
            Job base = base_of(benchmark, own_elements(benchmark));
            base.setting = "original";
            base.steps = thesis_steps;
            planner.add_series("thesis", base, settings.threads, false);
        }
    }
    return planner.take();
}

}  // namespace lancet::experiments::scaling
