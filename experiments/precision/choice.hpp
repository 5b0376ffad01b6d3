#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lancet/experiments/precision/run.hpp"

namespace lancet::experiments::precision {

/// What the user asked to vary, and where things are.
struct Choice {
    bool quick = false;
    double longest_seconds = 120;  ///< of the processor: a run that takes longer is given up
    std::vector<std::string> scalars{"float", "mixed", "double"};
    std::vector<int> threads{1};
    std::vector<std::string> schedulers{"serial"};
    std::vector<std::string> instruction_sets;  ///< at least one
    std::filesystem::path workers;              ///< folder of this program
    std::filesystem::path bar_workers;          ///< folder of the workers of `bar`

    [[nodiscard]] bool has_scalar(const std::string& scalar) const;
    /// A setting for each scheduler, number of threads and instruction set: the serial scheduler has one thread.
    [[nodiscard]] std::vector<Setting> machines(const Setting& setting) const;
    /// The same for a baseline, which has threads alone.
    [[nodiscard]] std::vector<Setting> baseline_machines(const Setting& setting) const;
};

}  // namespace lancet::experiments::precision
