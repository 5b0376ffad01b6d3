// Pipeline: an interactive scene in real time, and what became of its rates, deadlines and latencies.

#include <iostream>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/pipeline/interactive.hpp"
#include "lancet/experiments/pipeline/soak.hpp"
#include "lancet/runtime/observe/machine_stamp.hpp"
#include "lancet/runtime/observe/machine_stamp_json.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::pipeline;

void write(const PipelineSettings& settings, const Table& rows, nlohmann::ordered_json more) {
    if (settings.shared.csv) rows.write_csv(*settings.shared.csv);
    if (!settings.shared.json) return;
    nlohmann::ordered_json document;
    document["machine"] =
        runtime::machine_stamp(kernels::to_string(settings.instruction_set), settings.scheduler, settings.threads);
    document["rows"] = rows.to_json();
    document.update(more);
    write_json_file(*settings.shared.json, document);
}

ExitCode soak(const PipelineSettings& settings) {
    Progress progress;
    const Soak soak = run_soak(settings, progress);
    const Table table = soak_table(soak);
    std::cout << "Soak of " << settings.scene << ": random input and cuts, seed " << settings.seed << ", "
              << to_string(settings.scheduler) << ", " << settings.threads << " thread(s); a reset after each life\n";
    table.print(std::cout);
    write(settings, table, {{"complaints", soak.complaints}});
    for (const std::string& complaint : soak.complaints) std::cout << "NOT HELD: " << complaint << '\n';
    if (!soak.complaints.empty()) throw CheckFailed("soak: " + soak.complaints.front());
    std::cout << "All states finite; the same strokes came to the same bits in every life"
              << (soak.rounds.size() >= 6 ? "; memory did not grow.\n" : ".\n");
    return ExitCode::success;
}

void print_summary(const Interactive& run, const PipelineSettings& settings) {
    std::cout << run.cuts.cuts << " cuts through " << run.cuts.elements << " elements";
    if (run.cuts.cuts > 0) {
        std::cout << ": " << format_number(1e3 * run.cuts.seconds / static_cast<double>(run.cuts.cuts), 3)
                  << " ms each, the longest " << format_number(1e3 * run.cuts.longest, 3) << " ms";
    }
    std::cout << "; " << run.frames.dropped << " of " << run.frames.due
              << " frames dropped, for the picture before was still being drawn; " << run.lost_steps
              << " steps lost.\n";
    if (settings.is_paced) {
        std::cout << "Largest force felt: " << format_number(run.device.largest_force, 3)
                  << " N. Latencies are ages of the "
                  << "latest hand position that a picture, or a force, knows of.\n";
        if (run.device.lost > 0) std::cout << run.device.lost << " tool samples were lost: the queue was full.\n";
    } else {
        std::cout << "Fingerprint of the last positions: " << run.fingerprint << '\n';
    }
    if (run.events_lost > 0) std::cout << run.events_lost << " events had no place in the trace.\n";
}

ExitCode body(int argc, const char* const* argv) {
    const std::optional<PipelineSettings> settings = parse_settings(argc, argv);
    if (!settings) return ExitCode::success;
    if (settings->soak) return soak(*settings);
    Progress progress;
    const Interactive run = run_interactive(*settings, progress);
    std::cout << settings->scene << ", " << run.elements << " elements, " << format_number(settings->seconds, 4)
              << " s in steps of " << format_number(1e3 * settings->time_step, 3) << " ms, "
              << to_string(settings->scheduler) << ", " << settings->threads << " thread(s)"
              << (settings->is_paced ? ", by the clock" : ", as fast as it goes") << '\n';
    const Table rates = rate_table(run, *settings);
    rates.print(std::cout);
    std::cout << "\nTasks\n";
    const Table tasks = task_table(run);
    tasks.print(std::cout);
    std::cout << '\n';
    print_summary(run, *settings);
    write(*settings, rates,
          {{"tasks", tasks.to_json()},
           {"cuts", run.cuts.cuts},
           {"cut_elements", run.cuts.elements},
           {"longest_cut_ms", 1e3 * run.cuts.longest},
           {"lost_steps", run.lost_steps},
           {"fingerprint", run.fingerprint}});
    if (!run.is_finite) throw CheckFailed("a position is not finite at the end");
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
