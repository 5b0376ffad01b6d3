#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <nlohmann/json.hpp>

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

int run(int count, char** arguments) {
    // Counters as columns, unless asked otherwise.
    std::string tabular = "--benchmark_counters_tabular=true";
    std::vector<char*> all(arguments, arguments + count);
    all.insert(all.begin() + 1, tabular.data());
    int size = static_cast<int>(all.size());
    all.push_back(nullptr);
    benchmark::Initialize(&size, all.data());
    if (benchmark::ReportUnrecognizedArguments(size, all.data())) return 2;
    add_machine_stamp();
    register_peak();
    register_rotation();
    if (benchmark::RunSpecifiedBenchmarks() == 0) {
        std::cerr << "microbench: no benchmark matches the filter\n";
        return 2;
    }
    benchmark::Shutdown();
    return 0;
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
