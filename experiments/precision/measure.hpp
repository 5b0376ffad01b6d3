#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/precision/run.hpp"

namespace lancet::experiments::precision {

/// A problem with all that is to be measured on it.
struct Study {
    std::string problem;
    std::string variant;
    std::vector<Case> cases;
    /// Errors of positions found with a setting.
    std::function<Errors(const Setting&, const Solution&)> judge;
};

/// How much is spent on a study.
struct Effort {
    int repetitions = 3;
    double longest_seconds = 120;  ///< of one run: a case that is expected to take longer is omitted
    double repeat_seconds = 10;    ///< a case that took longer than this is run once
};

/// Runs every case of a study, the repetitions interleaved round robin so that a disturbance of the machine meets all
/// of them alike, and adds rows and omissions. Errors are those of the first repetition. The Pareto front is marked
/// among rows of the same number of threads.
void measure(const Study& study, const Effort& effort, Progress& progress, Results& results);

}  // namespace lancet::experiments::precision
