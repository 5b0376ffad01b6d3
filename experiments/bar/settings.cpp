#include "lancet/experiments/bar/settings.hpp"

namespace lancet::experiments::bar {
namespace {

using Arguments = std::vector<std::string>;

const Arguments original{"--cg-iterations=10", "--linearise=state", "--rotation-interval=5"};
const Arguments original_every_step{"--cg-iterations=10", "--linearise=state", "--rotation-interval=1"};

/// A solve per step at the prediction, with so many iterations.
Arguments at_prediction(const std::string& preconditioner, int iterations) {
    return {"--cg-iterations=" + std::to_string(iterations), "--linearise=prediction", "--rotation-interval=1",
            "--preconditioner=" + preconditioner};
}

/// The same with rising numbers of iterations.
std::vector<Arguments> rising(const std::string& preconditioner, const std::vector<int>& iterations) {
    std::vector<Arguments> result;
    for (const int count : iterations) result.push_back(at_prediction(preconditioner, count));
    return result;
}

/// Every combination of `arguments` with one "option=value".
std::vector<Arguments> combined(const std::vector<Arguments>& arguments, const std::string& option,
                                const std::vector<std::string>& values) {
    if (values.empty()) return arguments;
    std::vector<Arguments> result;
    for (const Arguments& list : arguments) {
        for (const std::string& value : values) {
            result.push_back(list);
            result.back().push_back(option + "=" + value);
        }
    }
    return result;
}

}  // namespace

std::vector<Entry> entries() {
    const std::string thesis = "bar_thesis";
    const std::string eigen = "bar_eigen";
    const std::vector<int> iterations{10, 20, 30, 40, 50, 60, 70, 80, 100, 120, 160, 240, 400, 1000};
    const auto none = rising("none", iterations);
    const auto diagonal = rising("diagonal", iterations);
    const auto incomplete = rising("incomplete-cholesky", {5, 10, 15, 20, 30, 50, 100, 300});
    return {
        {"thesis", "original", thesis, {{original}}},
        {"thesis", "original-every-step", thesis, {{original_every_step}}},
        {"thesis", "default", thesis, {{at_prediction("none", 10)}}},
        {"thesis", "accurate", thesis, {none}},
        {"eigen", "original", eigen, {{original}}},
        {"eigen", "original-every-step", eigen, {{original_every_step}}},
        {"eigen", "default", eigen, {{at_prediction("diagonal", 10)}}},
        {"eigen", "accurate", eigen, {none, diagonal, incomplete}},
    };
}

std::string Job::label() const {
    std::string text = method + " " + setting;
    for (const std::string& argument : arguments) text += " " + argument;
    return text;
}

std::vector<Job> jobs_of(const Entry& entry, const std::vector<std::string>& setting, const Choice& choice,
                         const std::filesystem::path& folder) {
    std::vector<Arguments> lists = combined({setting}, "--scalar", choice.scalars);
    if (entry.all_schedulers) {
        lists = combined(lists, "--operator", choice.operators);
        lists = combined(lists, "--isa", choice.instruction_sets);
        lists = combined(lists, "--scheduler", choice.schedulers);
    }
    std::vector<Job> jobs;
    for (const Arguments& list : lists) {
        for (const int threads : choice.threads) {
            jobs.push_back({entry.method, entry.setting, folder / entry.program, list, threads});
            jobs.back().arguments.push_back("--threads=" + std::to_string(threads));
        }
    }
    return jobs;
}

}  // namespace lancet::experiments::bar
