// Scaling: threads x scheduler x instruction set x scalar x operator x scatter strategy x size, strong and weak, with
// errors beside times and the machine's own load beside both.

#include <algorithm>
#include <array>
#include <iostream>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "lancet/experiments/common/file.hpp"
#include "lancet/experiments/common/main.hpp"
#include "lancet/experiments/common/process.hpp"
#include "lancet/experiments/common/progress.hpp"
#include "lancet/experiments/scaling/measure.hpp"
#include "lancet/experiments/scaling/pictures.hpp"
#include "lancet/experiments/scaling/plan.hpp"
#include "lancet/experiments/scaling/rows.hpp"
#include "lancet/experiments/scaling/settings.hpp"
#include "lancet/experiments/scaling/thesis.hpp"
#include "lancet/kernels/isa/instruction_set.hpp"
#include "lancet/runtime/observe/machine.hpp"
#include "lancet/runtime/observe/machine_stamp.hpp"
#include "lancet/runtime/observe/machine_stamp_json.hpp"

namespace {

using namespace lancet;
using namespace lancet::experiments;
using namespace lancet::experiments::scaling;

/// Of a row's choices only those that differ within a table.
std::vector<std::string_view> printed_keys(std::span<const Row> rows) {
    std::vector<std::string_view> keys{"problem", "elements", "scheduler", "threads"};
    const auto add_if_varied = [&](std::string_view key, std::string Job::*member) {
        std::set<std::string> values;
        for (const Row& row : rows) {
            if (!row.job.is_natural_order || member != &Job::scatter) values.insert(row.job.*member);
        }
        if (values.size() > 1) keys.push_back(key);
    };
    add_if_varied("isa", &Job::isa);
    add_if_varied("scalar", &Job::scalar);
    add_if_varied("operator", &Job::matrix);
    add_if_varied("scatter", &Job::scatter);
    for (const std::string_view key :
         {"ms_per_step", "ms_minimum", "spread_percent", "speedup", "efficiency_percent", "speedup_over_serial",
          "efficiency_over_serial_percent", "cg_share_percent", "bytes_per_element", "gflops", "gflops_share_percent",
          "gbytes_per_s", "gbytes_per_s_share_percent", "error_t1_percent", "bit_identical", "lost_percent",
          "other_cores", "note"}) {
        keys.push_back(key);
    }
    return keys;
}

std::string title_of(const std::string& series) {
    if (series == "strong") return "Strong scaling: the same size on more threads";
    if (series == "weak")
        return "Weak scaling: as many elements for each thread; speed-ups are those of elements a second";
    if (series == "variants") return "Variants: one choice at a time";
    return "The original's setting: 10 plain iterations, rotations every 5th step, 125 steps";
}

void print(const std::string& title, const Table& table) {
    std::cout << title << '\n';
    table.print(std::cout);
    std::cout << '\n';
}

std::vector<Row> rows_of(std::span<const Row> rows, const std::string& series) {
    std::vector<Row> chosen;
    std::ranges::copy_if(rows, std::back_inserter(chosen), [&](const Row& row) { return row.series == series; });
    return chosen;
}

void print_all(std::span<const Row> rows, const ScalingSettings& settings) {
    for (const std::string& series : series_names()) {
        const std::vector<Row> chosen = rows_of(rows, series);
        if (chosen.empty()) continue;
        const Job& job = chosen.front().job;
        print(title_of(series) + "\n(" + job.isa + ", " + job.scalar + ", " + job.matrix + ", " +
                  settings.scatters.front() + " unless a column says otherwise; " + job.setting + " setting)",
              make_table(chosen, printed_keys(chosen)));
        if (series == "strong") print("Serial fraction by Amdahl's law", make_table(fit_serial_fractions(chosen)));
        if (series != "thesis") continue;
        print("In the form of the thesis' table 5.1: the whole run of 5 s", make_table_5_1(chosen));
        print("The numbers of its figures 5.8 and 5.9", make_figures_5_8_and_5_9(chosen));
    }
}

nlohmann::ordered_json describe_machine(const ScalingSettings& settings, std::span<const Row> rows,
                                        const std::array<double, 3>& load_before) {
    nlohmann::ordered_json json =
        runtime::machine_stamp("see rows", runtime::default_scheduler, settings.threads.back());
    json["load_average_before"] = load_before;
    std::vector<double> others;
    for (const Row& row : rows) others.push_back(row.others);
    json["other_cores_least"] = others.empty() ? 0.0 : *std::ranges::min_element(others);
    json["other_cores_most"] = others.empty() ? 0.0 : *std::ranges::max_element(others);
    return json;
}

ExitCode body(int argc, const char* const* argv) {
    const std::optional<ScalingSettings> settings = parse_settings(argc, argv);
    if (!settings) return ExitCode::success;
    const std::array<double, 3> load_before = runtime::load_averages();
    if (load_before[0] > 0.5) {
        std::cerr << "note: the load average is " << format_number(load_before[0], 3)
                  << "; rows that others disturb are marked, and take longer\n";
    }
    const Plan plan = make_plan(*settings);
    Progress progress;
    const Measurement measurement = measure(plan, *settings, this_program().parent_path(), progress);
    const std::vector<Row> rows = make_rows(plan, measurement, settings->repetitions);
    std::string complaint;
    if (!settings->plot.empty()) {
        progress.show("pictures");
        complaint = draw(rows, settings->plot);
    }
    progress.clear();

    print_all(rows, *settings);
    const auto meaningless =
        std::ranges::count_if(rows, [](const Row& row) { return row.mark == LoadMark::meaningless; });
    std::cout << runtime::cpu_model() << ", " << runtime::cores_allowed() << " cores, load average "
              << format_number(load_before[0], 3) << " before and " << format_number(runtime::load_averages()[0], 3)
              << " after.\n"
              << describe_load_rule() << '\n'
              << meaningless << " of " << rows.size() << " rows are meaningless.\n";
    if (!complaint.empty()) {
        std::cerr << "no pictures: " << complaint << "; " << settings->plot.string()
                  << " has the data and the scripts, and the Debian package gnuplot-nox draws them\n";
    }
    const Table table = make_table(rows);
    if (settings->shared.csv) table.write_csv(*settings->shared.csv);
    if (settings->shared.json) {
        nlohmann::ordered_json document;
        document["machine"] = describe_machine(*settings, rows, load_before);
        document["load_rule"] = describe_load_rule();
        document["rows"] = table.to_json();
        document["serial_fractions"] = make_table(fit_serial_fractions(rows)).to_json();
        document["table_5_1"] = make_table_5_1(rows).to_json();
        document["figures_5_8_and_5_9"] = make_figures_5_8_and_5_9(rows).to_json();
        write_json_file(*settings->shared.json, document);
    }
    for (const Row& row : rows) {
        // Whatever the scheduler and the threads: the bits are a promise of the library.
        if (row.is_bit_identical && !*row.is_bit_identical) {
            throw CheckFailed(row.job.label() + " does not end like the serial scheduler, bit for bit");
        }
    }
    return ExitCode::success;
}

}  // namespace

int main(int argc, char** argv) {
    return run_main(argc, argv, body);
}
