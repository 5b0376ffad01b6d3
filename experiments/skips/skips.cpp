// Skips: what is left out where a scene does not need it, what that saves and what it gets wrong.

#include <iostream>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/skips/settings.hpp"
#include "lancet/experiments/skips/tables.hpp"
#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/runtime/observe/machine_stamp.hpp"
#include "lancet/runtime/observe/machine_stamp_json.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::skips;

ExitCode body(int argc, const char* const* argv) {
    const std::optional<SkipsSettings> settings = parse_settings(argc, argv);
    if (!settings) return ExitCode::success;
    const runtime::MachineStamp stamp = runtime::machine_stamp(kernels::to_string(kernels::active_instruction_set()),
                                                               runtime::SchedulerKind::serial, 1);
    const std::vector<Item> items = all_items(settings->shared.quick);
    std::vector<Gain> gains;
    Progress progress;
    for (std::size_t k = 0; k < items.size(); ++k) {
        progress.show(k + 1, items.size(), items[k].name);
        gains.push_back(
            measure(items[k], items[k].units > 0 ? items[k].units : settings->units, settings->repetitions));
    }
    progress.clear();
    const Table table = gain_table(items, gains), others = remark_table(remarks());
    std::cout << "What is skipped where a scene does not need it; one thread, both taken in turns\n";
    table.print(std::cout);
    std::cout << "\nRatio: of lower quartiles, skipped over done; median, lowest and highest of "
              << settings->repetitions
              << " repetitions. Error: rms of\nthe difference of positions at the end. Load of the machine: "
              << format_number(stamp.load_average[0], 3) << " on " << stamp.cores_allowed << " cores\n\n";
    for (std::size_t k = 0; k < items.size(); ++k) {
        if (!items[k].note.empty()) std::cout << "- " << items[k].name << ": " << items[k].note << '\n';
    }
    std::cout << "\nWhat cannot be switched, or is not there\n";
    for (const Remark& remark : remarks()) std::cout << "- " << remark.name << ": " << remark.what << '\n';
    std::cout << std::flush;
    if (settings->shared.csv) table.write_csv(*settings->shared.csv);
    if (settings->shared.json) {
        nlohmann::ordered_json document;
        document["machine"] = stamp;
        document["rows"] = table.to_json();
        document["remarks"] = others.to_json();
        write_json_file(*settings->shared.json, document);
    }
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
