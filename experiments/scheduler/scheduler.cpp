// Scheduler: the same step as a flow graph, as phases of parallel loops, and as OpenMP loops and tasks.

#include <algorithm>
#include <iostream>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/scheduler/tables.hpp"
#include "lancet/experiments/scheduler/workers.hpp"
#include "lancet/runtime/observe/machine_stamp.hpp"
#include "lancet/runtime/observe/machine_stamp_json.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::scheduler;

ExitCode body(int argc, const char* const* argv) {
    const std::optional<SchedulerSettings> settings = parse_settings(argc, argv);
    if (!settings) return ExitCode::success;
    if (settings->work) {
        std::cout << to_line(measure(*settings->work)) << std::endl;
        return ExitCode::success;
    }
    const runtime::MachineStamp stamp =
        runtime::machine_stamp(kernels::to_string(settings->body.instruction_set), settings->kinds.front(),
                               *std::ranges::max_element(settings->threads));
    Progress progress;
    const std::vector<Measured> rows = measure_all(*settings, progress);
    progress.clear();
    const std::vector<Target> aims = targets(rows);
    const std::vector<std::string> lines = verdict(rows, aims);
    const Table forms = form_table(rows), met = target_table(aims);

    std::cout << "The Bar, 10 CG iterations a step of " << format_exact(1e3 * settings->body.time_step)
              << " ms: forms of the step, each scheduler in a process of its own\n";
    forms.print(std::cout);
    std::cout << "\nOverhead: over the same step without a graph on as many threads of the same scheduler (on one\n"
                 "thread: without a scheduler), taken in turns in the same process; medians of "
              << settings->repetitions
              << " repetitions, and the\nlowest and highest of them. p999 of fewer than 1,000 steps is about the "
                 "longest.\n\n";
    if (!aims.empty()) {
        std::cout << "Aims\n";
        met.print(std::cout);
        std::cout << '\n';
    }
    std::cout << "Verdict (two forms differ if all repetitions of one are faster than all of the other, and by "
              << format_number(resolution_percent, 2) << " %)\n";
    for (const std::string& line : lines) std::cout << "- " << line << '\n';
    std::cout << "Load of the machine over the minute before: " << format_number(stamp.load_average[0], 3) << " on "
              << stamp.cores_allowed << " cores\n";
    if (stamp.load_average[0] + *std::ranges::max_element(settings->threads) > stamp.cores_allowed + 0.5) {
        std::cout
            << "Other work ran on these cores: rows of several threads say what is left then, not what they gain\n";
    }
    std::cout << std::flush;
    if (settings->shared.csv) forms.write_csv(*settings->shared.csv);
    if (settings->shared.json) {
        nlohmann::ordered_json document;
        document["machine"] = stamp;
        document["rows"] = forms.to_json();
        document["targets"] = met.to_json();
        document["verdict"] = lines;
        write_json_file(*settings->shared.json, document);
    }
    if (!std::ranges::all_of(rows, &Measured::bit_identical)) {
        throw CheckFailed("a form of the step ends at other positions than the serial step");
    }
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
