#include "lancet/experiments/bar/settings.hpp"

#include <algorithm>

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

/// The same with numbers of iterations that rise from `first` to 1000, by about 5 % each.
std::vector<Arguments> rising(const std::string& preconditioner, int first) {
    constexpr int last = 1000;
    std::vector<Arguments> result;
    for (int count = first; count <= last; count += std::max(1, count / 20)) {
        result.push_back(at_prediction(preconditioner, count));
    }
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
            result.back().push_back(option);
            result.back().back().append("=").append(value);
        }
    }
    return result;
}

}  // namespace

std::vector<Entry> entries() {
    const std::string thesis = "bar_thesis";
    const std::string eigen = "bar_eigen";
    const auto none = rising("none", 10);
    const auto diagonal = rising("diagonal", 10);
    const auto incomplete = rising("incomplete-cholesky", 5);
    const std::string lancet = "bar_lancet";
    // The worker's own preconditioner for every setting but the original one, which has none.
    const auto plain = [](Arguments arguments) {
        arguments.emplace_back("--preconditioner=none");
        return arguments;
    };
    // Fifty products to an assembly: full rows, which are dearer to assemble, may pay where they fit the cache.
    Arguments rows = plain(original), edges = rows;
    rows.emplace_back("--operator=block-rows");
    edges.emplace_back("--operator=edge-blocks");
    Arguments one_block = at_prediction("coarse", 10);
    one_block.insert(one_block.end(), {"--scheduler=serial", "--nodes-per-block=2000000000"});
    return {
        {"lancet", "original", lancet, {{rows}, {edges}}, true},
        {"lancet", "original-every-step", lancet, {{plain(original_every_step)}}, true},
        {"lancet", "default", lancet, {{at_prediction("coarse", 10)}}, true},
        {"lancet", "default", lancet, {{one_block}}},
        {"lancet", "accurate", lancet, {rising("coarse", 2)}, true},
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
    std::vector<std::string> scalars = choice.scalars;
    if (entry.method != "lancet") std::erase(scalars, "mixed");  // the baselines have no such mode
    if (scalars.empty()) return {};
    std::vector<Arguments> lists = combined({setting}, "--scalar", scalars);
    if (entry.all_schedulers) {
        if (!choice.operators.empty()) {
            for (Arguments& list : lists) {
                std::erase_if(list, [](const std::string& argument) { return argument.starts_with("--operator="); });
            }
        }
        lists = combined(lists, "--operator", choice.operators);
        lists = combined(lists, "--isa", choice.instruction_sets);
        lists = combined(lists, "--scheduler", choice.schedulers);
    }
    std::vector<Job> jobs;
    for (const Arguments& list : lists) {
        const bool is_serial = std::find(list.begin(), list.end(), "--scheduler=serial") != list.end();
        for (const int threads : choice.threads) {
            if (is_serial && threads != 1) continue;
            jobs.push_back({entry.method, entry.setting, folder / entry.program, list, threads});
            jobs.back().arguments.push_back("--threads=" + std::to_string(threads));
        }
    }
    return jobs;
}

}  // namespace lancet::experiments::bar
