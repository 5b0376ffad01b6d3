// Collision: broad phases against each other, in scenes that move, with the contacts that come of it.

#include <iostream>
#include <vector>

#include "lancet/experiments/collision/measure.hpp"
#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/runtime/observe/machine_stamp.hpp"
#include "lancet/runtime/observe/machine_stamp_json.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::collision;

ExitCode body(int argc, const char* const* argv) {
    const std::optional<CollisionSettings> settings = parse_settings(argc, argv);
    if (!settings) return ExitCode::success;
    const auto scheduler = runtime::make_scheduler(settings->scheduler, settings->threads);
    Progress progress;
    std::vector<Row> all;
    for (const std::string& name : settings->scenes) {
        std::vector<Row> rows;
        std::string title;
        for (const int primitives : settings->primitives) {
            const Scene scene = make_scene(name, primitives);
            title = scene.title;
            const std::vector<Row> some = measure(scene, *settings, *scheduler, progress);
            rows.insert(rows.end(), some.begin(), some.end());
        }
        progress.clear();
        std::cout << title << ": the times of a step, " << settings->steps << " steps, "
                  << to_string(settings->scheduler) << ", " << settings->threads << " threads\n";
        make_table(rows).print(std::cout);
        std::cout << '\n' << std::flush;
        all.insert(all.end(), rows.begin(), rows.end());
    }
    std::cout << "All kinds found the same pairs and contacts in every step. 'contacts' are the times of queries and "
                 "exact tests together; refits are apart.\n";
    const Table table = make_table(all);
    if (settings->shared.csv) table.write_csv(*settings->shared.csv);
    if (settings->shared.json) {
        nlohmann::ordered_json document;
        document["machine"] = runtime::machine_stamp("none", settings->scheduler, settings->threads);
        document["steps"] = settings->steps;
        document["repetitions"] = settings->repetitions;
        document["rows"] = table.to_json();
        write_json_file(*settings->shared.json, document);
    }
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
