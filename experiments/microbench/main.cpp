#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <benchmark/benchmark.h>
#include <nlohmann/json.hpp>

#include "lancet/experiments/microbench/samples.hpp"
#include "lancet/experiments/microbench/subjects.hpp"
#include "lancet/runtime/observe/machine_stamp.hpp"
#include "lancet/runtime/observe/machine_stamp_json.hpp"

namespace lancet::experiments {

std::vector<kernels::InstructionSet> instruction_sets_to_measure() {
    std::vector<kernels::InstructionSet> sets;
    for (const kernels::InstructionSet set : kernels::compiled_instruction_sets()) {
        if (kernels::is_executable(set)) sets.push_back(set);
    }
    return sets;
}

namespace {

/// The machine stamp stands beside the numbers, in print and in JSON.
void add_machine_stamp() {
    const auto stamp = runtime::machine_stamp(kernels::to_string(kernels::active_instruction_set()),
                                              runtime::SchedulerKind::serial, 1);
    const nlohmann::ordered_json json = stamp;
    for (const auto& [key, value] : json.items()) {
        benchmark::AddCustomContext(key, value.is_string() ? value.get<std::string>() : value.dump());
    }
    for (const kernels::InstructionSet set : kernels::compiled_instruction_sets()) {
        if (kernels::is_executable(set)) continue;
        const std::string name(kernels::to_string(set));
        benchmark::AddCustomContext("not_run_" + name, "this processor cannot execute it");
    }
}

/// The sizes of the Bar, from the first caches to memory. Those that take long are left out unless `--large` was given
/// or the filter names their number of elements.
std::vector<std::array<int, 3>> cells_to_measure(bool large, const std::string& filter) {
    std::vector<std::array<int, 3>> cells{{10, 2, 2}, {40, 8, 8}};
    for (const std::array<int, 3>& one : {std::array{80, 16, 16}, std::array{160, 32, 32}}) {
        if (large || filter.find(std::to_string(elements_of(one))) != std::string::npos) cells.push_back(one);
    }
    return cells;
}

int run(int count, char** arguments) {
    // Counters as columns and short runs, unless asked otherwise: what comes later on the command line counts.
    std::string tabular = "--benchmark_counters_tabular=true";
    std::string shortly = "--benchmark_min_time=0.1";
    std::vector<char*> all(arguments, arguments + count);
    const bool large =
        std::erase_if(all, [](const char* argument) { return std::string_view(argument) == "--large"; }) > 0;
    all.insert(all.begin() + 1, tabular.data());
    if (std::getenv("BENCHMARK_MIN_TIME") == nullptr) all.insert(all.begin() + 1, shortly.data());
    int size = static_cast<int>(all.size());
    all.push_back(nullptr);
    benchmark::Initialize(&size, all.data());
    if (benchmark::ReportUnrecognizedArguments(size, all.data())) return 2;
    add_machine_stamp();
    register_peak();
    register_rotation();
    register_normals();
    register_cut();
    const std::shared_ptr<Samples> samples = register_solver(cells_to_measure(large, benchmark::GetBenchmarkFilter()));
    if (benchmark::RunSpecifiedBenchmarks() == 0) {
        std::cerr << "microbench: no benchmark matches the filter\n";
        return 2;
    }
    benchmark::Shutdown();
    return samples->failures() == 0 ? 0 : 1;
}

}  // namespace

}  // namespace lancet::experiments

int main(int count, char** arguments) {
    try {
        return lancet::experiments::run(count, arguments);
    } catch (const std::exception& error) {
        std::cerr << "microbench: " << error.what() << '\n';
        return 2;
    }
}
