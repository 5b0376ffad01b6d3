#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <stop_token>
#include <string>
#include <vector>

#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/stability/report.hpp"

/// Cases run in processes of their own, some at a time: one that crashes or does not end is a failure like others.
namespace lancet::experiments::stability {

struct WorkerSettings {
    std::filesystem::path program{};       ///< this one
    std::vector<std::string> arguments{};  ///< that select the same cases
    std::string instruction_set{};         ///< empty: the active one
    int processes = 1;                     ///< at the same time
    int cases = 20;                        ///< of each process, at most
    double seconds = 1200;                 ///< that one may take
    std::stop_token stop{};                ///< when it asks, what runs is given up, and nothing more is begun
    /// Takes what there is, in the order of the cases, whenever so much time has passed. May be empty.
    std::function<void(const std::vector<Outcome>&)> interim{};
    std::chrono::seconds between_interims{10};
};

/// Runs all cases; the outcomes are in their order. When it is stopped: of those that came to an end.
std::vector<Outcome> run_cases(const std::vector<Case>& cases, const WorkerSettings& settings, Progress& progress);

/// What a worker does: runs cases begin to end, and prints a line for each.
void work(const std::vector<Case>& cases, std::size_t begin, std::size_t end, runtime::Scheduler& scheduler,
          std::ostream& stream);

}  // namespace lancet::experiments::stability
