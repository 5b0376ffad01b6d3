#include "lancet/experiments/scheduler/empty_graph.hpp"

#include <map>
#include <sstream>
#include <vector>

#include "lancet/experiments/common/statistics.hpp"
#include "lancet/kernels/error.hpp"
#include "lancet/runtime/observe/clock.hpp"

namespace lancet::experiments::scheduler {

runtime::StepGraph empty_graph(const std::string& dot) {
    runtime::StepGraph graph;
    std::map<std::string, runtime::StepGraph::Task> tasks;
    std::istringstream lines(dot);
    for (std::string line; std::getline(lines, line);) {
        std::vector<std::string> names;  // what stands in quotes: one name is a task, two are an edge
        for (std::size_t open = line.find('"'); open != std::string::npos;) {
            const std::size_t close = line.find('"', open + 1);
            if (close == std::string::npos) throw Error("graph: '" + line + "' has a quote without an end");
            names.push_back(line.substr(open + 1, close - open - 1));
            open = line.find('"', close + 1);
        }
        if (names.size() == 1) tasks.emplace(names[0], graph.task(names[0], [] {}));
        if (names.size() == 2) {
            const auto from = tasks.find(names[0]), to = tasks.find(names[1]);
            if (from == tasks.end() || to == tasks.end()) {
                throw Error("graph: '" + line + "' is an edge of unknown tasks");
            }
            from->second.precede(to->second);
        }
    }
    if (tasks.empty()) throw Error("graph: the text has no tasks");
    return graph;
}

double seconds_of_run(runtime::StepGraph& graph, runtime::Scheduler& scheduler, int batches) {
    constexpr int runs = 10;
    graph.run(scheduler);
    std::vector<double> seconds;
    for (int batch = 0; batch < batches; ++batch) {
        const double begin = runtime::steady_seconds();
        for (int run = 0; run < runs; ++run) graph.run(scheduler);
        seconds.push_back((runtime::steady_seconds() - begin) / runs);
    }
    return median(seconds);
}

}  // namespace lancet::experiments::scheduler
