#pragma once

#include <string>

#include "lancet/runtime/schedule/step_graph.hpp"

namespace lancet::experiments::scheduler {

/// A graph of the same tasks and edges as `dot` (of StepGraph::to_dot, names without quotes), whose tasks do nothing:
/// what running it takes is the scheduler's own. Throws lancet::Error for another text.
runtime::StepGraph empty_graph(const std::string& dot);

/// Seconds that one run of the graph takes: the median over `batches` of ten runs each, after a first run.
double seconds_of_run(runtime::StepGraph& graph, runtime::Scheduler& scheduler, int batches);

}  // namespace lancet::experiments::scheduler
