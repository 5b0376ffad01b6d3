#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lancet::experiments::bar {

/// One way of solving the problem that `bar` measures: a method in a setting. The table of them, entries(), is the
/// place to declare another method.
struct Entry {
    std::string method;   ///< lancet, eigen, thesis
    std::string setting;  ///< original, original-every-step, default, accurate
    std::string program;  ///< the worker's file name, in the folder of `bar` itself
    /// Options of the worker for this setting: sequences of rising accuracy and cost. Of a sequence with more than one
    /// member the first with an error of at most accurate_error_percent at t = 1 s is looked for. The fastest of what
    /// the sequences end with is taken (the least wrong choice when no sequence gets there).
    std::vector<std::vector<std::vector<std::string>>> sequences;
    bool all_schedulers = false;  ///< whether the worker takes --scheduler, --isa and --operator
};

/// The error, in percent of the length, that "accurate" means.
constexpr double accurate_error_percent = 0.5;

/// Everything there is to measure.
[[nodiscard]] std::vector<Entry> entries();

/// One row of the result: an entry with its choices made, which a worker process solves.
struct Job {
    std::string method;
    std::string setting;
    std::filesystem::path program;
    std::vector<std::string> arguments;  ///< all but those of the problem and the snapshots
    int threads = 1;

    /// For progress and messages.
    [[nodiscard]] std::string label() const;
};

/// What to vary. Empty lists mean the worker's own default.
struct Choice {
    std::vector<std::string> settings;
    std::vector<std::string> scalars{"float"};
    std::vector<int> threads{1};
    std::vector<std::string> schedulers, instruction_sets, operators;
};

/// The jobs of `entry` with the worker options `setting` under `choice`: a baseline runs once per scalar type and
/// thread count, a method with all_schedulers once per scheduler, instruction set and operator too.
[[nodiscard]] std::vector<Job> jobs_of(const Entry& entry, const std::vector<std::string>& setting,
                                       const Choice& choice, const std::filesystem::path& folder);

}  // namespace lancet::experiments::bar
